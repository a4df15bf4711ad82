// Meshes as the camera sees them: lit for the overlay, and as flat ids for outlines.

struct Object {
    camera_from_object: mat4x4<f32>,
    // sRGB and opacity
    color: vec4<f32>,
    // Outline colour, sRGB, and (id + 128 if selected) / 255
    id_color: vec4<f32>,
}

@group(1) @binding(0) var<uniform> object: Object;

struct Vertex {
    @location(0) position_object: vec3<f32>,
    @location(1) normal_object: vec3<f32>,
}

struct Varyings {
    @builtin(position) position_clip: vec4<f32>,
    @location(0) position_camera: vec3<f32>,
    @location(1) normal_camera: vec3<f32>,
}

// Brown-Conrady, applied to the vertices; the same function as `Distortion::distort`.
fn distort(position_camera: vec3<f32>) -> vec3<f32> {
    // A point behind the camera is clipped anyway.
    let z = max(position_camera.z, 1e-6);
    let p = position_camera.xy / z;
    let r2 = min(dot(p, p), frame.distortion_more.y);
    let k = frame.distortion;
    let radial = 1.0 + r2 * (k.x + r2 * (k.y + r2 * frame.distortion_more.x));
    let tangential = vec2<f32>(
        2.0 * k.z * p.x * p.y + k.w * (r2 + 2.0 * p.x * p.x),
        k.z * (r2 + 2.0 * p.y * p.y) + 2.0 * k.w * p.x * p.y,
    );
    return vec3<f32>((p * radial + tangential) * z, position_camera.z);
}

@vertex
fn vs_main(vertex: Vertex) -> Varyings {
    let position_camera = (object.camera_from_object * vec4<f32>(vertex.position_object, 1.0)).xyz;
    var seen = position_camera;
    if (frame.distortion_more.z > 0.5) {
        seen = distort(position_camera);
    }
    var out: Varyings;
    out.position_clip = frame.clip_from_camera * vec4<f32>(seen, 1.0);
    out.position_camera = position_camera;
    out.normal_camera = (object.camera_from_object * vec4<f32>(vertex.normal_object, 0.0)).xyz;
    return out;
}

// A headlight, a little from above, on both sides of each face: what matters is that shape can be read. Written
// premultiplied, so that multisampling blends edges correctly.
@fragment
fn fs_lit(in: Varyings) -> @location(0) vec4<f32> {
    let to_viewer = normalize(-in.position_camera);
    let to_light = normalize(to_viewer + vec3<f32>(-0.25, -0.45, 0.0));
    var normal = in.normal_camera / max(length(in.normal_camera), 1e-12);
    if (dot(normal, to_viewer) < 0.0) {
        normal = -normal;
    }
    let diffuse = max(dot(normal, to_light), 0.0);
    let shine = pow(max(dot(normal, normalize(to_light + to_viewer)), 0.0), 24.0);
    let color = min(object.color.rgb * (0.28 + 0.72 * diffuse) + vec3<f32>(0.16 * shine), vec3<f32>(1.0));
    return vec4<f32>(color * object.color.a, object.color.a);
}

@fragment
fn fs_id(in: Varyings) -> @location(0) vec4<f32> {
    return object.id_color;
}
