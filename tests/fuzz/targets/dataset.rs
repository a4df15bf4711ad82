#![no_main]

libfuzzer_sys::fuzz_target!(
    init: pinpose_fuzz::write_seeds("dataset"),
    |bytes: &[u8]| pinpose_fuzz::dataset(bytes)
);
