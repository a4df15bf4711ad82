// What every pass knows: the camera, the part of its image that fills the target, the target, and how things are shown.

struct Frame {
    // To the clip space of the window
    clip_from_eye: mat4x4<f32>,
    // The part of the `image` frame that fills the target: min x, min y, width, height, in photo pixels.
    image_rect: vec4<f32>,
    // Target pixels: the corner in the framebuffer, and the size.
    target_rect: vec4<f32>,
    // k1 k2 p1 p2
    distortion: vec4<f32>,
    // k3, the largest squared radius of the lens, 1 if there is distortion, 0
    distortion_more: vec4<f32>,
    // Photo width, height, mip level, opacity (0: there is none)
    photo: vec4<f32>,
    // sRGB, and the opacity over all objects
    background: vec4<f32>,
    // Half the outline's width in target pixels (0: no outline), the same for the selected object, and for references
    // (0: there are none), the length of their dashes
    outline: vec4<f32>,
    // Brightness, factors of contrast and saturation, 1 if any of them changes anything
    adjustment: vec4<f32>,
    // 0, where the wipe is in target pixels, half the width of its line (0: no wipe), 0
    shown: vec4<f32>,
    // 1 if there are masks, 0, 0, 0
    more: vec4<f32>,
    // The nearest depth in mm, 1 / the range of depths, the width of mesh edges in target pixels, 0
    lines: vec4<f32>,
    // The part of the target that meshes are drawn for: its corner and size in target pixels
    window: vec4<f32>,
}

@group(0) @binding(0) var<uniform> frame: Frame;

// Brown-Conrady, applied to the vertices; the same function as `Distortion::distort`.
fn distort(position_eye: vec3<f32>) -> vec3<f32> {
    // A point behind the camera is clipped anyway.
    let z = max(position_eye.z, 1e-6);
    let p = position_eye.xy / z;
    let r2 = min(dot(p, p), frame.distortion_more.y);
    let k = frame.distortion;
    let radial = 1.0 + r2 * (k.x + r2 * (k.y + r2 * frame.distortion_more.x));
    let tangential = vec2<f32>(
        2.0 * k.z * p.x * p.y + k.w * (r2 + 2.0 * p.x * p.x),
        k.z * (r2 + 2.0 * p.y * p.y) + 2.0 * k.w * p.x * p.y,
    );
    return vec3<f32>((p * radial + tangential) * z, position_eye.z);
}

fn clip_position(position_eye: vec3<f32>) -> vec4<f32> {
    var seen = position_eye;
    if (frame.distortion_more.z > 0.5) {
        seen = distort(position_eye);
    }
    return frame.clip_from_eye * vec4<f32>(seen, 1.0);
}

// The photo's colours as the eye wants them. Where nothing is changed, nothing is computed: the bytes stay.
fn adjusted(color: vec3<f32>) -> vec3<f32> {
    if (frame.adjustment.w < 0.5) {
        return color;
    }
    let gray = dot(color, vec3<f32>(0.299, 0.587, 0.114));
    let saturated = gray + (color - gray) * frame.adjustment.z;
    let contrasted = (saturated - 0.5) * frame.adjustment.y + 0.5;
    return clamp(contrasted + frame.adjustment.x, vec3<f32>(0.0), vec3<f32>(1.0));
}
