//! Every shader, checked for every language it is translated to.

use naga::back::glsl;
use naga::proc::BoundsCheckPolicies;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use pinpose::render::SHADERS;

#[test]
fn every_shader_is_valid_wgsl_and_becomes_glsl_es_300() {
    for source in SHADERS {
        let module = naga::front::wgsl::parse_str(source.wgsl)
            .unwrap_or_else(|error| panic!("{}: {}", source.name, error.emit_to_string(source.wgsl)));
        let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|error| panic!("{}: {error:?}", source.name));
        for entry_point in &module.entry_points {
            let options = glsl::Options { version: glsl::Version::new_gles(300), ..glsl::Options::default() };
            let pipeline = glsl::PipelineOptions {
                shader_stage: entry_point.stage,
                entry_point: entry_point.name.clone(),
                multiview: None,
            };
            let mut text = String::new();
            glsl::Writer::new(&mut text, &module, &info, &options, &pipeline, BoundsCheckPolicies::default())
                .and_then(|mut writer| writer.write())
                .unwrap_or_else(|error| panic!("{}, {}: {error}", source.name, entry_point.name));
            assert!(text.contains("#version 300 es"), "{}", source.name);
        }
    }
}
