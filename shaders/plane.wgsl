// The photo in its frustum, as a surface that a free eye sees.

@group(2) @binding(0) var photo_texture: texture_2d<f32>;
@group(2) @binding(1) var photo_sampler: sampler;
@group(2) @binding(2) var mask_texture: texture_2d<f32>;

struct Plane {
    @builtin(position) position_clip: vec4<f32>,
    @location(0) uv: vec2<f32>,
}

@vertex
fn vs_plane(@location(0) position_object: vec3<f32>, @location(1) uv: vec2<f32>) -> Plane {
    var out: Plane;
    out.position_clip = clip_position((object.eye_from_object * vec4<f32>(position_object, 1.0)).xyz);
    out.uv = uv;
    return out;
}

@fragment
fn fs_plane(in: Plane) -> @location(0) vec4<f32> {
    var color = adjusted(textureSample(photo_texture, photo_sampler, in.uv).rgb);
    let mask = textureSample(mask_texture, photo_sampler, in.uv);
    if (frame.more.x > 0.5) {
        color = mix(color, mask.rgb, mask.a);
    }
    return vec4<f32>(color * object.color.a, object.color.a);
}
