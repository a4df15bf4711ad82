#![no_main]

libfuzzer_sys::fuzz_target!(
    init: pinpose_fuzz::write_seeds("scene_gt"),
    |bytes: &[u8]| pinpose_fuzz::scene_gt(bytes)
);
