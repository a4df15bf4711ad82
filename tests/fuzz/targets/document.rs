#![no_main]

libfuzzer_sys::fuzz_target!(
    init: pinpose_fuzz::write_seeds("document"),
    |bytes: &[u8]| pinpose_fuzz::document(bytes)
);
