#![no_main]

libfuzzer_sys::fuzz_target!(
    init: pinpose_fuzz::write_seeds("obj"),
    |bytes: &[u8]| pinpose_fuzz::obj(bytes)
);
