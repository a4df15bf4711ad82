// Photo, masks, overlay and outlines into one picture. All colours are sRGB-encoded and blended as such, like the
// interface's.

@group(1) @binding(0) var photo_texture: texture_2d<f32>;
@group(1) @binding(1) var photo_sampler: sampler;
@group(1) @binding(2) var overlay_texture: texture_2d<f32>;
@group(1) @binding(3) var id_texture: texture_2d<f32>;
@group(1) @binding(4) var ghost_texture: texture_2d<f32>;
@group(1) @binding(5) var mask_texture: texture_2d<f32>;
@group(1) @binding(6) var hidden_id_texture: texture_2d<f32>;
@group(1) @binding(7) var backdrop_texture: texture_2d<f32>;
@group(1) @binding(8) var base_texture: texture_2d<f32>;

// Software renderers run every branch of a shader for every pixel, so the parts of a picture are draws of their own:
// background, photo and masks; surfaces and outlines over the window that they are in; and the line of a wipe.

// The target's corners as positions: (0, 0) is its top left, (1, 1) its bottom right.
fn target_corner(place: vec2<f32>) -> vec4<f32> {
    return vec4<f32>(place.x * 2.0 - 1.0, 1.0 - place.y * 2.0, 0.0, 1.0);
}

// Corners of two triangles.
fn rectangle_corner(index: u32) -> vec2<f32> {
    let corner = select(index, 6u - index, index > 2u);
    return vec2<f32>(f32(corner & 1u), f32(corner >> 1u));
}

// One triangle that covers the target.
@vertex
fn vs_target(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return target_corner(vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u)));
}

// What the photo covers.
@vertex
fn vs_photo(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    // Pixel (0, 0) has its centre at 0, so the photo begins half a pixel before it.
    let pixel = rectangle_corner(index) * frame.photo.xy - 0.5;
    return target_corner((pixel - frame.image_rect.xy) / frame.image_rect.zw);
}

@vertex
fn vs_window(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let place = frame.window.xy + rectangle_corner(index) * frame.window.zw;
    return target_corner(place / frame.target_rect.zw);
}

@vertex
fn vs_wipe(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let corner = rectangle_corner(index);
    let reach = 2.0 * frame.shown.z + 1.0;
    return target_corner(vec2<f32>((frame.shown.y + (corner.x * 2.0 - 1.0) * reach) / frame.target_rect.z, corner.y));
}

// The photo's own coordinates, 0 to 1.
fn photo_uv(target_position: vec2<f32>) -> vec2<f32> {
    let pixel = frame.image_rect.xy + target_position / frame.target_rect.zw * frame.image_rect.zw;
    // Pixel (0, 0) has its centre at 0, so the photo begins half a pixel before it.
    return (pixel + 0.5) / frame.photo.xy;
}

// With changes, without masks.
fn photo_color(target_position: vec2<f32>) -> vec3<f32> {
    let uv = photo_uv(target_position);
    let photo = adjusted(textureSampleLevel(photo_texture, photo_sampler, uv, frame.photo.z).rgb);
    return mix(frame.background.rgb, photo, frame.photo.w);
}

// What is around objects in a free view: lighter towards a soft horizon, with the photo's plane and lines before it.
fn backdrop_color(target_position: vec2<f32>, texel: vec2<i32>) -> vec3<f32> {
    let place = target_position / frame.target_rect.zw;
    let horizon = 1.0 - smoothstep(0.0, 0.62, abs(place.y - 0.58));
    let vignette = 1.0 - 0.35 * dot(place - 0.5, place - 0.5);
    // Half a step of noise: a slow gradient in 8 bits has visible steps.
    let noise = fract(sin(dot(floor(target_position), vec2<f32>(12.9898, 78.233))) * 43758.547) - 0.5;
    let color = frame.background.rgb * vignette * (1.0 + 0.75 * horizon) + noise / 255.0;
    let backdrop = textureLoad(backdrop_texture, texel, 0);
    return color * (1.0 - backdrop.a) + backdrop.rgb;
}

// The line along the border between two ids, centred on it: colour and coverage.
fn outline_at(ids: texture_2d<f32>, texel: vec2<i32>, half_widths: vec2<f32>) -> vec4<f32> {
    let last = vec2<i32>(textureDimensions(ids)) - 1;
    let here = textureLoad(ids, texel, 0);
    // From here on nothing is covered; a disc has half the pixels of the square around it.
    let radius = half_widths.y + 1.0;
    let reach = i32(radius);
    var best = vec4<f32>(0.0);
    for (var y = -reach; y <= reach; y++) {
        let row_reach = i32(sqrt(radius * radius - f32(y * y)));
        for (var x = -row_reach; x <= row_reach; x++) {
            let there = textureLoad(ids, clamp(texel + vec2<i32>(x, y), vec2<i32>(0), last), 0);
            if (abs(there.a - here.a) > 0.001) {
                // The selected object's line goes over the others', an object's over the background's.
                let winner = select(there, here, here.a > there.a);
                let half_width = select(half_widths.x, half_widths.y, winner.a > 0.5);
                // The border is half a pixel before the first pixel that differs.
                let distance = length(vec2<f32>(f32(x), f32(y))) - 0.5;
                let coverage = clamp(half_width + 0.5 - distance, 0.0, 1.0);
                if (coverage > best.a) {
                    best = vec4<f32>(winner.rgb, coverage);
                }
            }
        }
    }
    return best;
}

fn window_texel(target_position: vec2<f32>) -> vec2<i32> {
    return vec2<i32>(clamp(floor(target_position) - frame.window.xy, vec2<f32>(0.0), frame.window.zw - 1.0));
}

@fragment
fn fs_background() -> @location(0) vec4<f32> {
    return vec4<f32>(frame.background.rgb, 1.0);
}

// Nearly always the photo is shown as it is.
@fragment
fn fs_photo(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let uv = photo_uv(position.xy - frame.target_rect.xy);
    return vec4<f32>(textureSample(photo_texture, photo_sampler, uv).rgb, 1.0);
}

@fragment
fn fs_changed_photo(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return vec4<f32>(photo_color(position.xy - frame.target_rect.xy), 1.0);
}

@fragment
fn fs_masks(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let uv = photo_uv(position.xy - frame.target_rect.xy);
    let mask = textureSampleLevel(mask_texture, photo_sampler, uv, frame.photo.z);
    return vec4<f32>(mask.rgb * mask.a, mask.a);
}

@fragment
fn fs_backdrop(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let target_position = position.xy - frame.target_rect.xy;
    return vec4<f32>(backdrop_color(target_position, window_texel(target_position)), 1.0);
}

// Photo and masks as they were drawn before, at the same place.
@fragment
fn fs_base(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return textureLoad(base_texture, vec2<i32>(floor(position.xy)), 0);
}

// A pixel is on one side of a wipe or the other by its centre.
fn is_wiped(target_position: vec2<f32>) -> bool {
    return frame.shown.z > 0.0 && target_position.x >= frame.shown.y;
}

// All that follow are premultiplied, to be blended over what lies below.

@fragment
fn fs_overlay(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let target_position = position.xy - frame.target_rect.xy;
    if (is_wiped(target_position)) {
        discard;
    }
    return textureLoad(overlay_texture, window_texel(target_position), 0) * frame.background.a;
}

// How overlay and photo differ, in place of the overlay.
@fragment
fn fs_difference(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let target_position = position.xy - frame.target_rect.xy;
    if (is_wiped(target_position)) {
        discard;
    }
    let overlay = textureLoad(overlay_texture, window_texel(target_position), 0);
    // Drawn opaque for this, so alpha is how much of the pixel the meshes cover.
    let own = overlay.rgb / max(overlay.a, 1e-3);
    let alpha = overlay.a * frame.background.a;
    var photo = frame.background.rgb;
    let uv = photo_uv(target_position);
    if (all(uv >= vec2<f32>(0.0)) && all(uv < vec2<f32>(1.0))) {
        photo = photo_color(target_position);
        if (frame.more.x > 0.5) {
            let mask = textureSampleLevel(mask_texture, photo_sampler, uv, frame.photo.z);
            photo = mix(photo, mask.rgb, mask.a);
        }
    }
    return vec4<f32>(abs(photo - own) * alpha, alpha);
}

@fragment
fn fs_outlines(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let target_position = position.xy - frame.target_rect.xy;
    if (is_wiped(target_position)) {
        discard;
    }
    let line = outline_at(id_texture, window_texel(target_position), frame.outline.xy);
    return vec4<f32>(line.rgb * line.a, line.a);
}

// Of what others hide.
@fragment
fn fs_hidden_outlines(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let target_position = position.xy - frame.target_rect.xy;
    if (is_wiped(target_position)) {
        discard;
    }
    let line = outline_at(hidden_id_texture, window_texel(target_position), frame.outline.xx);
    return vec4<f32>(line.rgb * line.a, line.a) * 0.75;
}

// References are dashed: told apart by more than colour.
@fragment
fn fs_ghost_outlines(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let target_position = position.xy - frame.target_rect.xy;
    let dash = fract((target_position.x + target_position.y) / (2.0 * frame.outline.w));
    if (is_wiped(target_position) || dash >= 0.6) {
        discard;
    }
    let line = outline_at(ghost_texture, window_texel(target_position), frame.outline.zz);
    return vec4<f32>(line.rgb * line.a, line.a);
}

// White with a dark rim: seen on every photo.
@fragment
fn fs_wipe(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let distance = abs(position.x - frame.target_rect.x - frame.shown.y);
    let rim = 0.45 * clamp(2.0 * frame.shown.z + 0.5 - distance, 0.0, 1.0);
    let line = clamp(frame.shown.z + 0.5 - distance, 0.0, 1.0);
    return vec4<f32>(vec3<f32>(line), line + rim * (1.0 - line));
}
