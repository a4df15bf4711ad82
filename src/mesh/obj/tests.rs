use proptest::prelude::*;

use super::*;
use crate::mesh::companions::{companion_names, no_companions};
use crate::mesh::test_shapes::{Folder, checker_png};
use crate::mesh::{Mesh, load, shading_vertices};

fn parse(bytes: &[u8]) -> Result<Parsed, MeshError> {
    super::parse(&Source { file_name: "a.obj", bytes, find: &no_companions })
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn parsed(rest: &str) -> Result<Parsed, MeshError> {
    parse(format!("{SQUARE}{rest}").as_bytes())
}

fn message(rest: &str) -> String {
    parsed(rest).unwrap_err().to_string()
}

#[test]
fn polygons_become_fans_and_negative_numbers_count_back() {
    let data = parsed("f 1/1 2/2/ 3// 4\nf -4 -3 \\\n -2\n").unwrap().data;
    assert_eq!(data.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
    assert_eq!(data.positions_mm.len(), 4);
}

#[test]
fn vertices_keep_their_number_whatever_the_corners_say() {
    let normals = "vn 0 0 1\nvn 0 0 2\nvn 1 0 0\n";
    let same = parsed(&format!("{normals}f 1//1 2//1 3//1\nf 1//1 3//1 4//2\n")).unwrap().data;
    assert_eq!(same.normals.as_deref().and_then(|normals| normals.get(3)), Some(&Vec3::new(0.0, 0.0, 2.0)));
    let hard_edge = parsed(&format!("{normals}f 1//1 2//1 3//1\nf 1//3 3//1 4//2\n")).unwrap().data;
    assert_eq!((hard_edge.normals, hard_edge.positions_mm.len()), (None, 4));
}

#[test]
fn colors_come_in_both_scales() {
    let unit = parse(b"v 0 0 0 1 0.5 0\nv 1 0 0\nv 0 1 0 nan 0 0\nf 1 2 3").unwrap().data;
    assert_eq!(unit.colors, Some(vec![[255, 128, 0, 255], [255; 4], [0, 0, 0, 255]]));
    let bytes = parse(b"v 0 0 0 255 128 0\nv 1 0 0 0 0 0\nv 0 1 0 0 0 0\nf 1 2 3").unwrap().data;
    assert_eq!(bytes.colors.and_then(|colors| colors.first().copied()), Some([255, 128, 0, 255]));
}

#[test]
fn messages_name_the_line() {
    assert!(message("f 1 2 9\n").starts_with("OBJ, line 5: the face names vertex 9"));
    assert!(message("f 0 1 2\n").starts_with("OBJ, line 5: the face's corner “0”"));
    assert!(message("f -5 1 2\n").contains("back to -4"));
    assert!(message("v 1 2\n").ends_with("a vertex of 2 numbers, expected three"));
    assert!(message("v 1 2 1.#IND\n").contains("“1.#IND”"));
    assert!(message("v 1 2 nan\n").contains("finite"));
}

#[test]
fn small_faces_and_materials_are_warnings() {
    let warnings = parsed("mtllib a.mtl\nf 1 2\nf 1 2 3\n").unwrap().warnings;
    assert!(warnings[0].starts_with("1 faces") && warnings[1].contains("a.mtl"), "{warnings:?}");
}

proptest! {
    #[test]
    fn no_bytes_panic(text in "((v|vn|vt|f|mtllib|usemtl) [-0-9/. #\\\\]{0,12}\n){0,12}") {
        let _ = parse(text.as_bytes());
    }
}

const TWO_MATERIALS: &str =
    "vt 0 0\nvt 1 0\nvt 1 1\nmtllib sub/two.mtl\nusemtl pictured\nf 1/1 2/2 3/3\nusemtl plain\nf 1 3 4\n";

fn two_materials() -> Folder {
    Folder::of(&[
        ("Two.MTL", b"newmtl pictured\nKd 0 0 0\nmap_Kd C:\\maps\\Checker.png\nnewmtl plain\nKd 1 0 0\nmap_Ks s.png\n"),
        ("checker.PNG", &checker_png()),
    ])
}

#[test]
fn two_materials_make_two_groups() {
    let text = format!("{SQUARE}{TWO_MATERIALS}");
    let folder = two_materials();
    let loaded = load("two.obj", text.as_bytes(), &|key| folder.find(key)).unwrap();
    assert_eq!(loaded.warnings, Vec::<String>::new());
    let paint = loaded.mesh.paint().unwrap();
    assert_eq!(paint.textures.len(), 1);
    // v is up in the file: its origin is the image's lower left corner.
    assert_eq!(paint.corner_uvs[0], [Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::X]);
    let shading = shading_vertices(&loaded.mesh);
    assert_eq!(shading.groups.iter().map(|group| group.texture).collect::<Vec<_>>(), [None, Some(0)]);
    let colors = [0, 3].map(|corner: usize| shading.vertices[shading.indices[corner] as usize].color);
    assert_eq!(colors, [[255, 0, 0, 255], [255; 4]]);
    assert_eq!(
        companion_names("two.obj", text.as_bytes(), &|key| folder.find(key)),
        ["checker.png", "s.png", "two.mtl"]
    );
}

#[test]
fn what_is_missing_is_named_once() {
    let text = format!("{SQUARE}{TWO_MATERIALS}");
    let alone = load("a.obj", text.as_bytes(), &no_companions).unwrap();
    assert_eq!(alone.warnings.len(), 1);
    assert!(alone.warnings[0].contains("“sub/two.mtl” did not come"), "{:?}", alone.warnings);
    assert!(!alone.mesh.has_colors());
    let folder = two_materials().without("checker.png");
    let untextured = load("a.obj", text.as_bytes(), &|key| folder.find(key)).unwrap();
    assert_eq!(untextured.warnings.len(), 1);
    assert!(untextured.warnings[0].contains("“Checker.png” did not come"), "{:?}", untextured.warnings);
    assert!(untextured.mesh.has_colors(), "the other material is red");
    // The mesh was renamed together with its library.
    let renamed = text.replace("two.mtl", "untitled.mtl");
    let folder = two_materials();
    let loaded = load("two.obj", renamed.as_bytes(), &|key| folder.find(key)).unwrap();
    assert!(loaded.mesh.paint().is_some_and(|paint| !paint.textures.is_empty()));
    assert_eq!(loaded.warnings.len(), 1, "{:?}", loaded.warnings);
    assert_eq!(companion_names("two.obj", renamed.as_bytes(), &|key| folder.find(key)).len(), 4);
}

#[test]
fn corners_may_lack_coordinates_and_name_wrong_ones() {
    let folder = two_materials();
    let text =
        format!("{SQUARE}vt 0 1\nmtllib two.mtl\nf 1 2 3\nusemtl pictured\nf 1/9 3/1 4/-1\nf 1/0 2 3/-7\n");
    let mesh: Mesh = load("a.obj", text.as_bytes(), &|key| folder.find(key)).unwrap().mesh;
    let paint = mesh.paint().unwrap();
    assert_eq!(paint.corner_uvs, [[Vec2::ZERO; 3]; 3]);
    assert_eq!(paint.material_of_triangle, [0, 1, 1]);
}
