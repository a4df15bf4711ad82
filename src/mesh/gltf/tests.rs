use glam::{DVec3, Vec3};
use proptest::prelude::*;

use crate::mesh::{LoadedMesh, MeshError, load};

/// A triangle in the xy plane, one metre a side: 36 bytes of positions, then 6 of indices.
fn triangle_bytes() -> Vec<u8> {
    let positions = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let indices = [0_u16, 1, 2];
    positions
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .chain(indices.iter().flat_map(|i| i.to_le_bytes()))
        .collect()
}

fn document(nodes: &str, primitive: &str, extra: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{nodes}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}{primitive}}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},
                     {{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":6}}],
        "buffers":[{{"byteLength":42}}]{extra}}}"#
    )
}

fn glb(json: &str) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut binary = triangle_bytes();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let length = (12 + 8 + json.len() + 8 + binary.len()) as u32;
    let mut bytes = [b"glTF".as_slice(), &2_u32.to_le_bytes(), &length.to_le_bytes()].concat();
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", binary)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

fn loaded(nodes: &str, primitive: &str) -> Result<LoadedMesh, MeshError> {
    load("a.glb", &glb(&document(nodes, primitive, "")))
}

const INDEXED: &str = r#","indices":1"#;

#[test]
fn nodes_are_applied_and_metres_become_millimetres() {
    // The child is scaled, turned a quarter about z, and moved; the parent moves it further.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let nodes = format!(
        r#"{{"children":[1],"translation":[0,0,1]}},
           {{"mesh":0,"rotation":[0,0,{half},{half}],"scale":[2,1,1],"translation":[1,0,0]}}"#
    );
    let LoadedMesh { mesh, warnings } = loaded(&nodes, INDEXED).unwrap();
    let expected = [[1000.0, 0.0, 1000.0], [1000.0, 2000.0, 1000.0], [0.0, 0.0, 1000.0]];
    for (position, expected) in mesh.positions_mm().iter().zip(expected) {
        // The quaternion is given to f32, 1e-7 of 2 m.
        assert!(position.distance(Vec3::from_array(expected)) < 1e-3, "{position}");
    }
    assert!(warnings[0].contains("metres"));
}

#[test]
fn a_mirroring_node_turns_the_triangles_round() {
    let normal = |nodes: &str| {
        let mesh = loaded(nodes, INDEXED).unwrap().mesh;
        let [a, b, c] = mesh.corners(mesh.triangles()[0]);
        (b - a).cross(c - a).normalize()
    };
    assert_eq!(normal(r#"{"mesh":0}"#), DVec3::Z);
    assert_eq!(normal(r#"{"mesh":0,"scale":[-1,1,1]}"#), DVec3::Z);
}

#[test]
fn strips_and_fans_and_no_indices() {
    for primitive in ["", INDEXED, r#","mode":5"#, r#","mode":6,"indices":1"#] {
        let mesh = loaded(r#"{"mesh":0}"#, primitive).unwrap().mesh;
        assert_eq!(mesh.triangles(), [[0, 1, 2]]);
    }
    assert_eq!(loaded(r#"{"mesh":0}"#, r#","mode":1"#), Err(MeshError::NoFaces { vertices: 0 }));
}

#[test]
fn a_cycle_of_nodes_is_refused() {
    let error = loaded(r#"{"mesh":0,"children":[1]},{"children":[0]}"#, INDEXED).unwrap_err();
    assert_eq!(error.to_string(), "glTF, node 0: it is reached twice, expected a tree of nodes");
}

#[test]
fn what_this_version_cannot_read_is_said_in_words() {
    let refused = |json: &str| load("a.glb", &glb(json)).unwrap_err().to_string();
    let node = r#"{"mesh":0}"#;
    let extension = |name: &str| document(node, INDEXED, &format!(r#","extensionsRequired":["{name}"]"#));
    assert!(refused(&extension("KHR_draco_mesh_compression")).contains("Draco"));
    assert!(refused(&extension("KHR_mesh_quantization")).contains("quantised"));
    assert!(load("a.glb", &glb(&extension("KHR_materials_unlit"))).is_ok());
    let external =
        document(node, INDEXED, "").replace(r#""byteLength":42"#, r#""uri":"a.bin","byteLength":42"#);
    assert!(refused(&external).contains("“a.bin”"));
    let too_many =
        document(node, INDEXED, "").replace(r#""count":3,"type":"VEC3""#, r#""count":4,"type":"VEC3""#);
    assert!(refused(&too_many).starts_with("glTF, accessor 0: 4 items"));
    let wrong_type = document(node, r#","indices":0"#, "");
    assert!(refused(&wrong_type).contains("expected one number each"));
}

proptest! {
    #[test]
    fn broken_files_never_panic(
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4),
        digits in prop::collection::vec((any::<prop::sample::Index>(), b'0'..=b'9'), 0..4),
        kept in any::<prop::sample::Index>(),
        is_cut in any::<bool>(),
    ) {
        let mut bytes = glb(&document(r#"{"mesh":0,"children":[1]},{"mesh":0}"#, INDEXED, ""));
        for (at, byte) in &flips {
            let at = at.index(bytes.len());
            bytes[at] = *byte;
        }
        // Other digits keep the JSON whole, and so reach the checks behind it.
        let digit_places: Vec<usize> = (0..bytes.len()).filter(|&at| bytes[at].is_ascii_digit()).collect();
        for (at, digit) in &digits {
            bytes[digit_places[at.index(digit_places.len())]] = *digit;
        }
        if is_cut {
            bytes.truncate(kept.index(bytes.len()));
        }
        let _ = load("broken.glb", &bytes);
    }
}
