#![no_main]

libfuzzer_sys::fuzz_target!(
    init: pinpose_fuzz::write_seeds("poses"),
    |bytes: &[u8]| pinpose_fuzz::poses(bytes)
);
