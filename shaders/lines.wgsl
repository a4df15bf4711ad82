// Lines of so many pixels: each is one instance of two triangles that the vertex shader lays around its two ends.

struct Line {
    @builtin(position) position_clip: vec4<f32>,
    // sRGB and opacity
    @location(0) color: vec4<f32>,
    // Target pixels: along the line from its beginning, across it from its middle, its length, half its width
    @location(1) place: vec4<f32>,
    // The length of a dash and its gap in target pixels; 0 is a solid line
    @location(2) dash: f32,
}

// An end on a surface is moved to the viewer by this part of its depth, so that the surface does not hide its own edges.
// The rest of the way, across the line's width, is the depth bias of the meshes drawn before.
const TOWARDS_VIEWER: f32 = 1.0003;

// An edge shorter than this many pixels is fainter: a dense mesh becomes a tint and keeps its shape.
const FULL_FROM_PX: f32 = 6.0;

fn line_vertex(
    index: u32, from_eye: vec3<f32>, to_eye: vec3<f32>, width_px: f32, color: vec4<f32>, dash_px: f32,
) -> Line {
    // The part in front of the near plane, which is at 1 mm (`NEAR_MM`).
    let near = 1.0;
    var a = from_eye;
    var b = to_eye;
    var out: Line;
    out.dash = dash_px;
    if (a.z < near && b.z < near) {
        out.position_clip = vec4<f32>(0.0, 0.0, -1.0, 1.0);
        out.color = vec4<f32>(0.0);
        out.place = vec4<f32>(0.0);
        return out;
    }
    let step = (near - a.z) / (b.z - a.z);
    if (a.z < near) {
        a = mix(from_eye, to_eye, step);
    }
    if (b.z < near) {
        b = mix(from_eye, to_eye, step);
    }
    let half_size = frame.window.zw * 0.5;
    let a_clip = clip_position(a);
    let b_clip = clip_position(b);
    let a_px = a_clip.xy / a_clip.w * half_size;
    let b_px = b_clip.xy / b_clip.w * half_size;
    let length_px = distance(a_px, b_px);
    var direction = vec2<f32>(1.0, 0.0);
    if (length_px > 1e-4) {
        direction = (b_px - a_px) / length_px;
    }
    // Thinner than a pixel is a pixel, fainter.
    let half_width = max(width_px, 1.0) * 0.5;
    let reach = half_width + 1.0;
    // Triangles (0, 1, 2) and (2, 1, 3) of a rectangle.
    let corner = select(index, 6u - index, index > 2u);
    let is_end = f32(corner & 1u);
    let side = f32(corner >> 1u) * 2.0 - 1.0;
    let along = mix(-reach, length_px + reach, is_end);
    let position_px = a_px + direction * along + vec2<f32>(-direction.y, direction.x) * side * reach;
    let depth = mix(a_clip.z / a_clip.w, b_clip.z / b_clip.w, is_end);
    // With w = 1 everything is interpolated along the screen, as pixels are, and as depth is.
    out.position_clip = vec4<f32>(position_px / half_size, min(depth * TOWARDS_VIEWER, 1.0), 1.0);
    out.color = vec4<f32>(color.rgb, color.a * min(width_px, 1.0));
    out.place = vec4<f32>(along, side * reach, length_px, half_width);
    return out;
}

@vertex
fn vs_edge(
    @builtin(vertex_index) index: u32,
    @location(0) from_object: vec3<f32>,
    @location(1) to_object: vec3<f32>,
) -> Line {
    let from_eye = (object.eye_from_object * vec4<f32>(from_object, 1.0)).xyz;
    let to_eye = (object.eye_from_object * vec4<f32>(to_object, 1.0)).xyz;
    var out = line_vertex(index, from_eye, to_eye, frame.lines.z, object.color, 0.0);
    out.color.a *= clamp(out.place.z / FULL_FROM_PX, 0.3, 1.0);
    return out;
}

@vertex
fn vs_line(
    @builtin(vertex_index) index: u32,
    @location(0) from_object: vec3<f32>,
    @location(1) to_object: vec3<f32>,
    @location(2) width_and_dash_px: vec2<f32>,
    @location(3) color: vec4<f32>,
) -> Line {
    let from_eye = (object.eye_from_object * vec4<f32>(from_object, 1.0)).xyz;
    let to_eye = (object.eye_from_object * vec4<f32>(to_object, 1.0)).xyz;
    return line_vertex(index, from_eye, to_eye, width_and_dash_px.x, color, width_and_dash_px.y);
}

// Round ends, and a pixel of soft rim.
fn coverage(in: Line) -> f32 {
    let beyond = max(max(-in.place.x, in.place.x - in.place.z), 0.0);
    let distance = length(vec2<f32>(beyond, in.place.y));
    var covered = clamp(in.place.w + 0.5 - distance, 0.0, 1.0);
    if (in.dash > 0.0) {
        // The middle three fifths of each period, with soft ends.
        let from_middle = abs(fract(in.place.x / in.dash) - 0.5) * in.dash;
        covered *= clamp(0.3 * in.dash - from_middle + 0.5, 0.0, 1.0);
    }
    return covered;
}

@fragment
fn fs_line(in: Line) -> @location(0) vec4<f32> {
    let alpha = in.color.a * coverage(in);
    return vec4<f32>(in.color.rgb * alpha, alpha);
}

// What is hidden, where it shows through.
@fragment
fn fs_faint_line(in: Line) -> @location(0) vec4<f32> {
    let alpha = 0.35 * in.color.a * coverage(in);
    return vec4<f32>(in.color.rgb * alpha, alpha);
}
