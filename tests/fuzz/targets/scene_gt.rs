#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| pinpose_fuzz::scene_gt(bytes));
