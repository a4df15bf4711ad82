use glam::{DVec3, Vec2, Vec3};
use proptest::prelude::*;

use crate::mesh::test_shapes::{Folder, checker_png};
use crate::mesh::{LoadedMesh, MeshError, companion_names, load, no_companions};

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
    glb_with(json, triangle_bytes())
}

fn glb_with(json: &str, mut binary: Vec<u8>) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
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
    load("a.glb", &glb(&document(nodes, primitive, "")), &no_companions)
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
    let refused = |json: &str| load("a.glb", &glb(json), &no_companions).unwrap_err().to_string();
    let node = r#"{"mesh":0}"#;
    let extension = |name: &str| document(node, INDEXED, &format!(r#","extensionsRequired":["{name}"]"#));
    assert!(refused(&extension("KHR_draco_mesh_compression")).contains("Draco"));
    assert!(refused(&extension("KHR_mesh_quantization")).contains("quantised"));
    assert!(load("a.glb", &glb(&extension("KHR_materials_unlit")), &no_companions).is_ok());
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
        let _ = load("broken.glb", &bytes, &no_companions);
    }
}

/// The triangle with texture coordinates behind its indices, and behind those a picture.
fn textured_glb(image: &str, material: &str) -> Vec<u8> {
    let mut binary = triangle_bytes();
    binary.resize(44, 0);
    binary.extend([0.0_f32, 0.0, 1.0, 0.0, 0.0, 1.0].iter().flat_map(|value| value.to_le_bytes()));
    let picture = checker_png();
    binary.extend(&picture);
    let json = document(
        r#"{"mesh":0}"#,
        r#","indices":1,"material":0"#,
        &format!(
            r#","materials":[{{"pbrMetallicRoughness":{{{material}"baseColorTexture":{{"index":0}}}}}}],
            "textures":[{{"source":0}}],"images":[{{{image}}}]"#
        ),
    )
    .replace(r#"{"POSITION":0}"#, r#"{"POSITION":0,"TEXCOORD_0":2}"#)
    .replace(
        r#""type":"SCALAR"}]"#,
        r#""type":"SCALAR"},{"bufferView":2,"componentType":5126,"count":3,"type":"VEC2"}]"#,
    )
    .replace(
        r#""byteLength":6}],"#,
        &format!(
            r#""byteLength":6}},{{"buffer":0,"byteOffset":44,"byteLength":24}},
               {{"buffer":0,"byteOffset":68,"byteLength":{}}}],"#,
            picture.len()
        ),
    );
    glb_with(&json, binary)
}

#[test]
fn a_picture_within_the_file_is_a_texture() {
    let bytes = textured_glb(r#""bufferView":3,"mimeType":"image/png""#, r#""baseColorFactor":[1,0,0,0.5],"#);
    let LoadedMesh { mesh, warnings } = load("a.glb", &bytes, &no_companions).unwrap();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    let paint = mesh.paint().unwrap();
    // v is down in the file as it is here.
    assert_eq!(paint.corner_uvs, [[Vec2::ZERO, Vec2::X, Vec2::Y]]);
    assert_eq!(paint.textures[0].rgba[..8], [255, 0, 0, 255, 0, 255, 0, 255]);
    assert_eq!(paint.materials[0].base_color, [255, 0, 0, 255]);
    assert!(companion_names("a.glb", &bytes, &no_companions).is_empty());
}

#[test]
fn pictures_and_buffers_may_be_files_beside() {
    let bytes = textured_glb(r#""uri":"maps/my%20Tex.png""#, "");
    assert_eq!(companion_names("a.glb", &bytes, &no_companions), ["my tex.png"]);
    let folder = Folder::of(&[("my tex.png", &checker_png()), ("a.bin", &triangle_bytes())]);
    let with = load("a.glb", &bytes, &|key| folder.find(key)).unwrap();
    assert_eq!((with.mesh.paint().unwrap().textures.len(), with.warnings.len()), (1, 1));
    let without = load("a.glb", &bytes, &no_companions).unwrap();
    assert!(without.warnings[1].contains("“my Tex.png” did not come"), "{:?}", without.warnings);
    assert!(!without.mesh.has_colors());
    let unreadable = load("a.glb", &textured_glb(r#""bufferView":0"#, ""), &no_companions).unwrap();
    assert!(unreadable.warnings[1].contains("“image 0” cannot be read"), "{:?}", unreadable.warnings);
    let json = document(r#"{"mesh":0}"#, INDEXED, "")
        .replace(r#""byteLength":42"#, r#""uri":"A.bin","byteLength":42"#);
    assert!(load("a.gltf", json.as_bytes(), &|key| folder.find(key)).is_ok());
}
