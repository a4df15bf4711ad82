// One thing that is drawn.

struct Object {
    eye_from_object: mat4x4<f32>,
    // sRGB and opacity
    color: vec4<f32>,
    // Outline colour, sRGB, and (id + 128 if selected) / 255
    id_color: vec4<f32>,
    // The centre of the mesh's bounds, and 1 / their largest extent
    bounds: vec4<f32>,
    // 1 if the mesh has colours of its own, 0, 0, 0
    surface: vec4<f32>,
}

@group(1) @binding(0) var<uniform> object: Object;
