//! A ball as a file of each format.

use std::fmt::Write as _;

pub struct Ball {
    pub vertices: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
}

/// Of 2 · `segments` · (`rings` − 1) triangles, with a surface that is nowhere the same, as a scan's is.
pub fn ball(segments: u32, rings: u32) -> Ball {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for ring in 0..=rings {
        for segment in 0..segments {
            let latitude = std::f32::consts::PI * ring as f32 / rings as f32;
            let longitude = std::f32::consts::TAU * segment as f32 / segments as f32;
            let (sin, cos) = latitude.sin_cos();
            let radius_mm = 50.0 + (13.0 * latitude).sin() * (7.0 * longitude).cos();
            vertices.push([sin * longitude.cos(), sin * longitude.sin(), cos].map(|value| value * radius_mm));
        }
    }
    for ring in 0..rings {
        for segment in 0..segments {
            let next = (segment + 1) % segments;
            let (near, far) = (ring * segments, (ring + 1) * segments);
            // At the poles one side of the quadrilateral is a point.
            if ring + 1 < rings {
                triangles.push([near + segment, far + segment, far + next]);
            }
            if ring > 0 {
                triangles.push([near + segment, far + next, near + next]);
            }
        }
    }
    Ball { vertices, triangles }
}

fn ply_header(format: &str, ball: &Ball) -> String {
    format!(
        "ply\nformat {format} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        ball.vertices.len(),
        ball.triangles.len()
    )
}

pub fn binary_ply(ball: &Ball) -> Vec<u8> {
    let mut bytes = ply_header("binary_little_endian", ball).into_bytes();
    bytes.extend(bytemuck::cast_slice(&ball.vertices));
    for triangle in &ball.triangles {
        bytes.push(3);
        bytes.extend(bytemuck::cast_slice(triangle));
    }
    bytes
}

pub fn ascii_ply(ball: &Ball) -> Vec<u8> {
    let mut text = ply_header("ascii", ball);
    for [x, y, z] in &ball.vertices {
        writeln!(text, "{x:.6} {y:.6} {z:.6}").expect("a text takes it");
    }
    for [a, b, c] in &ball.triangles {
        writeln!(text, "3 {a} {b} {c}").expect("a text takes it");
    }
    text.into_bytes()
}

pub fn obj(ball: &Ball) -> Vec<u8> {
    let mut text = String::new();
    for [x, y, z] in &ball.vertices {
        writeln!(text, "v {x:.6} {y:.6} {z:.6}").expect("a text takes it");
    }
    for triangle in &ball.triangles {
        let [a, b, c] = triangle.map(|vertex| vertex + 1);
        writeln!(text, "f {a} {b} {c}").expect("a text takes it");
    }
    text.into_bytes()
}

pub fn glb(ball: &Ball) -> Vec<u8> {
    let (vertices, triangles) = (ball.vertices.len(), ball.triangles.len());
    let (vertex_bytes, index_bytes) = (12 * vertices, 12 * triangles);
    let all = vertex_bytes + index_bytes;
    let mut json = format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": {vertices}, "type": "VEC3",
        "min": [-51, -51, -51], "max": [51, 51, 51]}},
        {{"bufferView": 1, "componentType": 5125, "count": {}, "type": "SCALAR"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": {vertex_bytes}}},
        {{"buffer": 0, "byteOffset": {vertex_bytes}, "byteLength": {index_bytes}}}],
        "buffers": [{{"byteLength": {all}}}]}}"#,
        3 * triangles
    )
    .into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((28 + json.len() as u32 + all as u32).to_le_bytes());
    glb.extend((json.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(json);
    glb.extend((all as u32).to_le_bytes());
    glb.extend(b"BIN\0");
    glb.extend(bytemuck::cast_slice(&ball.vertices));
    glb.extend(bytemuck::cast_slice(&ball.triangles));
    glb
}
