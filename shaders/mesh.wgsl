// Meshes as the eye sees them: lit, coloured, as coordinates, normals or depth for the overlay, as flat ids for outlines.

@group(2) @binding(0) var surface_texture: texture_2d<f32>;
@group(2) @binding(1) var surface_sampler: sampler;

struct Vertex {
    @location(0) position_object: vec3<f32>,
    @location(1) normal_object: vec4<f32>,
    @location(2) color: vec4<f32>,
    @location(3) uv: vec2<f32>,
}

struct Lit {
    @builtin(position) @invariant position_clip: vec4<f32>,
    @location(0) position_eye: vec3<f32>,
    @location(1) normal_eye: vec3<f32>,
}

struct Colored {
    @builtin(position) @invariant position_clip: vec4<f32>,
    @location(0) position_eye: vec3<f32>,
    @location(1) normal_eye: vec3<f32>,
    @location(2) color: vec4<f32>,
    @location(3) uv: vec2<f32>,
}

struct Coordinates {
    @builtin(position) @invariant position_clip: vec4<f32>,
    @location(0) position_object: vec3<f32>,
}

struct Position {
    @builtin(position) @invariant position_clip: vec4<f32>,
}

fn eye_position(position_object: vec3<f32>) -> vec3<f32> {
    return (object.eye_from_object * vec4<f32>(position_object, 1.0)).xyz;
}

@vertex
fn vs_lit(@location(0) position_object: vec3<f32>, @location(1) normal_object: vec4<f32>) -> Lit {
    var out: Lit;
    out.position_eye = eye_position(position_object);
    out.position_clip = clip_position(out.position_eye);
    out.normal_eye = (object.eye_from_object * vec4<f32>(normal_object.xyz, 0.0)).xyz;
    return out;
}

@vertex
fn vs_colored(vertex: Vertex) -> Colored {
    var out: Colored;
    out.position_eye = eye_position(vertex.position_object);
    out.position_clip = clip_position(out.position_eye);
    out.normal_eye = (object.eye_from_object * vec4<f32>(vertex.normal_object.xyz, 0.0)).xyz;
    out.color = vertex.color;
    out.uv = vertex.uv;
    return out;
}

@vertex
fn vs_coordinates(@location(0) position_object: vec3<f32>) -> Coordinates {
    var out: Coordinates;
    out.position_clip = clip_position(eye_position(position_object));
    out.position_object = position_object;
    return out;
}

@vertex
fn vs_position(@location(0) position_object: vec3<f32>) -> Position {
    var out: Position;
    out.position_clip = clip_position(eye_position(position_object));
    return out;
}

// The normal on the viewer's side: both sides of a face are drawn.
fn facing_normal(normal_eye: vec3<f32>, to_viewer: vec3<f32>) -> vec3<f32> {
    let normal = normal_eye / max(length(normal_eye), 1e-12);
    return select(normal, -normal, dot(normal, to_viewer) < 0.0);
}

// A headlight, a little from above: what matters is that shape can be read.
fn lit_color(position_eye: vec3<f32>, normal_eye: vec3<f32>) -> vec3<f32> {
    let to_viewer = normalize(-position_eye);
    let to_light = normalize(to_viewer + vec3<f32>(-0.25, -0.45, 0.0));
    let normal = facing_normal(normal_eye, to_viewer);
    let diffuse = max(dot(normal, to_light), 0.0);
    let shine = pow(max(dot(normal, normalize(to_light + to_viewer)), 0.0), 24.0);
    return min(object.color.rgb * (0.28 + 0.72 * diffuse) + vec3<f32>(0.16 * shine), vec3<f32>(1.0));
}

// Nine colours of matplotlib's viridis (CC0), evenly spaced: equal steps of depth look like equal steps of colour. The
// nearest is yellow, the farthest violet.
fn depth_color(depth_mm: f32) -> vec3<f32> {
    var ramp = array<vec3<f32>, 9>(
        vec3<f32>(253.0, 231.0, 37.0), vec3<f32>(170.0, 220.0, 50.0), vec3<f32>(92.0, 200.0, 99.0),
        vec3<f32>(39.0, 173.0, 129.0), vec3<f32>(33.0, 144.0, 141.0), vec3<f32>(44.0, 113.0, 142.0),
        vec3<f32>(59.0, 81.0, 139.0), vec3<f32>(71.0, 44.0, 122.0), vec3<f32>(68.0, 1.0, 84.0),
    );
    let place = clamp((depth_mm - frame.lines.x) * frame.lines.y, 0.0, 1.0) * 8.0;
    let step = min(u32(place), 7u);
    return mix(ramp[step], ramp[step + 1u], place - f32(step)) / 255.0;
}

// All that follow write premultiplied colour, so that multisampling blends edges correctly.
@fragment
fn fs_lit(in: Lit) -> @location(0) vec4<f32> {
    return vec4<f32>(lit_color(in.position_eye, in.normal_eye) * object.color.a, object.color.a);
}

@fragment
fn fs_normals(in: Lit) -> @location(0) vec4<f32> {
    let color = facing_normal(in.normal_eye, normalize(-in.position_eye)) * 0.5 + 0.5;
    return vec4<f32>(color * object.color.a, object.color.a);
}

@fragment
fn fs_depth(in: Lit) -> @location(0) vec4<f32> {
    return vec4<f32>(depth_color(in.position_eye.z) * object.color.a, object.color.a);
}

@fragment
fn fs_colored(in: Colored) -> @location(0) vec4<f32> {
    let texel = textureSample(surface_texture, surface_sampler, in.uv).rgb;
    // Half of it is lit: shape can be read, and colours stay close to those of the photo.
    let to_viewer = normalize(-in.position_eye);
    let facing = max(dot(facing_normal(in.normal_eye, to_viewer), to_viewer), 0.0);
    var color = in.color.rgb * texel * (0.5 + 0.5 * facing);
    if (object.surface.x < 0.5) {
        color = lit_color(in.position_eye, in.normal_eye);
    }
    return vec4<f32>(color * object.color.a, object.color.a);
}

// Normalised object coordinates: the centre of the bounds is 0.5, and one scale for all axes keeps angles.
@fragment
fn fs_nocs(in: Coordinates) -> @location(0) vec4<f32> {
    let color = (in.position_object - object.bounds.xyz) * object.bounds.w + 0.5;
    return vec4<f32>(clamp(color, vec3<f32>(0.0), vec3<f32>(1.0)) * object.color.a, object.color.a);
}

@fragment
fn fs_id(in: Position) -> @location(0) vec4<f32> {
    return object.id_color;
}
