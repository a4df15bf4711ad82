#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| pinpose_fuzz::obj(bytes));
