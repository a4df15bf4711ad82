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

@vertex
fn vs_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    // One triangle that covers the target.
    let corner = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4<f32>(corner * 2.0 - 1.0, 0.0, 1.0);
}

fn photo_color(target_position: vec2<f32>) -> vec3<f32> {
    let pixel = frame.image_rect.xy + target_position / frame.target_rect.zw * frame.image_rect.zw;
    // Pixel (0, 0) has its centre at 0, so the photo begins half a pixel before it.
    let uv = (pixel + 0.5) / frame.photo.xy;
    let inside = all(uv >= vec2<f32>(0.0)) && all(uv < vec2<f32>(1.0));
    var color = frame.background.rgb;
    if (inside && frame.photo.w > 0.5) {
        color = adjusted(textureSampleLevel(photo_texture, photo_sampler, uv, frame.photo.z).rgb);
    }
    if (inside && frame.more.x > 0.5) {
        let mask = textureSampleLevel(mask_texture, photo_sampler, uv, frame.photo.z);
        color = mix(color, mask.rgb, mask.a);
    }
    return color;
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
    let reach = i32(ceil(half_widths.y));
    var best = vec4<f32>(0.0);
    for (var y = -reach; y <= reach; y++) {
        for (var x = -reach; x <= reach; x++) {
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

fn with_overlay(below: vec3<f32>, texel: vec2<i32>) -> vec3<f32> {
    if (frame.shown.x < 0.5) {
        return below;
    }
    let overlay = textureLoad(overlay_texture, texel, 0);
    if (frame.shown.w > 0.5) {
        // Drawn opaque for this, so alpha is how much of the pixel the meshes cover.
        let own = overlay.rgb / max(overlay.a, 1e-3);
        return mix(below, abs(below - own), overlay.a * frame.background.a);
    }
    return below * (1.0 - overlay.a * frame.background.a) + overlay.rgb * frame.background.a;
}

fn with_outlines(below: vec3<f32>, target_position: vec2<f32>, texel: vec2<i32>) -> vec3<f32> {
    let within = all(target_position >= frame.outlined.xy) && all(target_position <= frame.outlined.zw);
    if (!within) {
        return below;
    }
    var color = below;
    if (frame.more.y > 0.5) {
        let line = outline_at(hidden_id_texture, texel, frame.outline.xx);
        color = mix(color, line.rgb, line.a * 0.75);
    }
    if (frame.outline.x > 0.0) {
        let line = outline_at(id_texture, texel, frame.outline.xy);
        color = mix(color, line.rgb, line.a);
    }
    if (frame.outline.z > 0.0) {
        // References are dashed: told apart by more than colour.
        let dash = fract((target_position.x + target_position.y) / (2.0 * frame.outline.w));
        let ghost = outline_at(ghost_texture, texel, frame.outline.zz);
        color = mix(color, ghost.rgb, ghost.a * select(0.0, 1.0, dash < 0.6));
    }
    return color;
}

@fragment
fn fs_main(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let target_position = position.xy - frame.target_rect.xy;
    let last = vec2<i32>(frame.target_rect.zw) - 1;
    let texel = clamp(vec2<i32>(floor(target_position)), vec2<i32>(0), last);

    var color: vec3<f32>;
    if (frame.more.z > 0.5) {
        color = backdrop_color(target_position, texel);
    } else {
        color = photo_color(target_position);
    }
    // A pixel is on one side or the other by its centre.
    if (frame.shown.z <= 0.0 || target_position.x < frame.shown.y) {
        color = with_overlay(color, texel);
        color = with_outlines(color, target_position, texel);
    }
    if (frame.shown.z > 0.0) {
        // White with a dark rim: seen on every photo.
        let distance = abs(target_position.x - frame.shown.y);
        color = mix(color, vec3<f32>(0.0), 0.45 * clamp(2.0 * frame.shown.z + 0.5 - distance, 0.0, 1.0));
        color = mix(color, vec3<f32>(1.0), clamp(frame.shown.z + 0.5 - distance, 0.0, 1.0));
    }
    return vec4<f32>(color, 1.0);
}
