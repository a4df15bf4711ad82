#![no_main]

libfuzzer_sys::fuzz_target!(
    init: pinpose_fuzz::write_seeds("depth"),
    |bytes: &[u8]| pinpose_fuzz::depth(bytes)
);
