// A photo's depth map as depth alone: what is behind it fails the depth test.

// Millimetres along the optical axis; 0 where nothing was measured.
@group(1) @binding(0) var depth_texture: texture_2d<f32>;

// Sensors err by so much: the surface that was measured must not hide its own mesh. BOP's tolerance of visibility.
const TOLERANCE_MM: f32 = 15.0;

@vertex
fn vs_occluder(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4<f32>(corner.x * 2.0 - 1.0, 1.0 - corner.y * 2.0, 0.0, 1.0);
}

struct Occluder {
    @builtin(frag_depth) depth: f32,
    @location(0) color: vec4<f32>,
}

@fragment
fn fs_occluder(@builtin(position) position: vec4<f32>) -> Occluder {
    let target_position = position.xy + frame.window.xy;
    let pixel = frame.image_rect.xy + target_position / frame.target_rect.zw * frame.image_rect.zw;
    // Pixel (0, 0) has its centre at 0.
    let texel = vec2<i32>(floor(pixel + 0.5));
    let size = vec2<i32>(textureDimensions(depth_texture));
    var depth_mm = 0.0;
    if (all(texel >= vec2<i32>(0)) && all(texel < size)) {
        depth_mm = textureLoad(depth_texture, texel, 0).x;
    }
    var out: Occluder;
    out.color = vec4<f32>(0.0);
    // As far as can be: hides nothing.
    out.depth = 0.0;
    if (depth_mm > 0.0) {
        let clip = frame.clip_from_eye * vec4<f32>(0.0, 0.0, depth_mm + TOLERANCE_MM, 1.0);
        out.depth = clamp(clip.z / clip.w, 0.0, 1.0);
    }
    return out;
}
