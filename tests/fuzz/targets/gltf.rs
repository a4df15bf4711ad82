#![no_main]

libfuzzer_sys::fuzz_target!(
    init: pinpose_fuzz::write_seeds("gltf"),
    |bytes: &[u8]| pinpose_fuzz::gltf(bytes)
);
