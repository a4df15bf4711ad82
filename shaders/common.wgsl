// What every pass knows: the camera, the part of the photo that fills the target, and the target.

struct Frame {
    clip_from_camera: mat4x4<f32>,
    // The part of the `image` frame that fills the target: min x, min y, width, height, in photo pixels.
    image_rect: vec4<f32>,
    // Target pixels: the corner in the framebuffer, and the size.
    target_rect: vec4<f32>,
    // k1 k2 p1 p2
    distortion: vec4<f32>,
    // k3, the largest squared radius of the lens, 1 if there is distortion, 0
    distortion_more: vec4<f32>,
    // Photo width, height, mip level, 1 if there is a photo
    photo: vec4<f32>,
    // sRGB, and the opacity over all objects
    background: vec4<f32>,
    // Half the outline's width in target pixels (0: no outline), the same for the selected object, and for references
    // (0: there are none), the length of their dashes
    outline: vec4<f32>,
}

@group(0) @binding(0) var<uniform> frame: Frame;
