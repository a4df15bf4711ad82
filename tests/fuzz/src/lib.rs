//! What each target does with bytes from anywhere: an error or something bounded has to come back.

#![allow(dead_code, unused_imports, reason = "of the program's rooms the fuzzers use the readers alone")]

#[path = "../../../src/formats/mod.rs"]
pub mod formats;
#[path = "../../../src/math/mod.rs"]
pub mod math;
#[path = "../../../src/mesh/mod.rs"]
pub mod mesh;
#[path = "../../../src/photo/mod.rs"]
pub mod photo;
#[path = "../../../src/raster/mod.rs"]
pub mod raster;
#[path = "../../../src/scene/mod.rs"]
pub mod scene;
pub mod seeds;

use std::sync::Arc;

use crate::formats::dataset::{Contents, Listing, recognise};
use crate::formats::{
    Archive, FileKind, Incoming, NamedFile, classify, parse_text_or_archive, read_document, read_mesh_with,
    read_workspace, write_document,
};
use crate::math::Pose;
use crate::mesh::{coarse_mesh, mesh_edges, shading_vertices};
use crate::photo::{decode, decode_depth, is_depth_like, read_header};
use seeds::SEPARATOR;

/// Puts a target's seeds into `corpus/TARGET`, where the fuzzer is told to look.
pub fn write_seeds(target: &str) {
    let folder = std::path::Path::new("corpus").join(target);
    std::fs::create_dir_all(&folder).expect("the corpus can be written");
    let of_target = seeds::by_target().into_iter().filter(|(name, _)| *name == target);
    for (number, bytes) in of_target.flat_map(|(_, files)| files).enumerate() {
        std::fs::write(folder.join(number.to_string()), bytes).expect("the corpus can be written");
    }
}

pub fn ply(bytes: &[u8]) {
    mesh("mesh.ply", &[("t.png", &seeds::pixel_png())], bytes);
}

/// The mesh, and behind a separator its material library.
pub fn obj(bytes: &[u8]) {
    let (mesh_bytes, library) = halves(bytes);
    mesh("mesh.obj", &[("m.mtl", library), ("t.png", &seeds::pixel_png())], mesh_bytes);
}

pub fn stl(bytes: &[u8]) {
    mesh("mesh.stl", &[], bytes);
}

/// A GLB, or JSON and behind a separator its buffer.
pub fn gltf(bytes: &[u8]) {
    if bytes.starts_with(b"glTF") {
        mesh("mesh.glb", &[], bytes);
    } else {
        let (json, buffer) = halves(bytes);
        mesh("mesh.gltf", &[("b.bin", buffer), ("t.png", &seeds::pixel_png())], json);
    }
}

pub fn off(bytes: &[u8]) {
    mesh("mesh.off", &[], bytes);
}

/// Reads a mesh and makes of it what the renderer is given.
fn mesh(name: &str, companions: &[(&str, &[u8])], bytes: &[u8]) {
    let file = |name: &str, bytes: &[u8]| NamedFile { name: name.to_owned(), bytes: bytes.into() };
    let companions: Vec<NamedFile> = companions.iter().map(|(name, bytes)| file(name, bytes)).collect();
    let Ok((asset, _)) = read_mesh_with(&file(name, bytes), &companions) else { return };
    let shading = shading_vertices(&asset.mesh);
    // Normals of a file come with all of its vertices, whether or not a triangle names them; a texture splits corners.
    let most = asset.mesh.positions_mm().len() + 3 * asset.mesh.triangles().len();
    assert!(shading.vertices.len() <= most);
    mesh_edges(&asset.mesh);
    coarse_mesh(&asset.mesh);
}

pub fn photo(bytes: &[u8]) {
    let header = read_header(bytes);
    let Ok(decoded) = decode(bytes) else { return };
    let (pixels, header) = (decoded.pixels, header.expect("what can be decoded has a header"));
    assert_eq!(pixels.rgba.len(), 4 * pixels.width as usize * pixels.height as usize);
    assert_eq!((pixels.width, pixels.height), (header.width, header.height));
}

pub fn depth(bytes: &[u8]) {
    is_depth_like(bytes);
    if let Ok(depth) = decode_depth(bytes) {
        assert_eq!(depth.raw.len(), depth.width as usize * depth.height as usize);
    }
}

/// The same bytes as each kind of file that a camera may come in.
pub fn camera(bytes: &[u8]) {
    for (name, kind) in [
        ("camera.json", FileKind::Json),
        ("camera.yml", FileKind::Yaml),
        ("K.npy", FileKind::Npy),
        ("K.txt", FileKind::Matrix),
    ] {
        parse(name, kind, bytes);
    }
}

pub fn poses(bytes: &[u8]) {
    for (name, kind) in [
        ("poses.json", FileKind::Json),
        ("poses.csv", FileKind::Csv),
        ("pose.txt", FileKind::Matrix),
        ("truth.txt", FileKind::Vision6dTruth),
    ] {
        parse(name, kind, bytes);
    }
    if let Ok(text) = std::str::from_utf8(bytes) {
        // What matters is that it returns; so it is below.
        let _ = crate::formats::read_pose_text(text, &Pose::IDENTITY);
    }
}

fn parse(name: &str, kind: FileKind, bytes: &[u8]) {
    let file = NamedFile { name: name.to_owned(), bytes: bytes.into() };
    classify(name, bytes);
    let _ = parse_text_or_archive(&file, kind);
}

/// `scene_gt.json`, `scene_camera.json` and `models_info.json` of a BOP data set, behind each other.
pub fn scene_gt(bytes: &[u8]) {
    parse("scene_gt.json", FileKind::Json, bytes);
    let paths = ["1/scene_gt.json", "1/scene_camera.json", "models/models_info.json"];
    let files: Vec<_> = paths.into_iter().zip(bytes.split(|byte| *byte == SEPARATOR)).collect();
    let names = ["1/rgb/000003.png", "1/mask/000003_000000.png", "models/obj_000005.ply"];
    let all = names.into_iter().chain(files.iter().map(|(path, _)| *path));
    let listing = Listing::new("set", all.map(|path| (path.to_owned(), 100)));
    let listing = Arc::new(listing.expect("few files"));
    let contents: Contents =
        files.iter().map(|(path, bytes)| ((*path).to_owned(), Arc::from(*bytes))).collect();
    let Some(recognised) = recognise(&listing) else { return };
    for choice in 0..recognised.choices.len() {
        let _ = recognised.interpret(&[choice], &contents);
    }
}

/// What is read is written as it is read again.
pub fn document(bytes: &[u8]) {
    let Ok(document) = read_document(bytes) else { return };
    let text = write_document(&document);
    let again = read_document(text.as_bytes()).expect("what was written can be read");
    assert_eq!(write_document(&again), text);
    let _ = Incoming::from_document("scene.json", &document);
}

/// A zip as a workspace and as a folder.
pub fn archive(bytes: &[u8]) {
    let _ = read_workspace(bytes);
    let Ok(mut archive) = Archive::open(bytes.into()) else { return };
    let Ok(listing) = archive.listing("zip") else { return };
    for path in listing.paths() {
        let _ = archive.read(path);
    }
    if let Some(recognised) = recognise(&Arc::new(listing)) {
        let all: Vec<usize> = (0..recognised.choices.len()).collect();
        recognised.needed(&all);
    }
}

/// Paths and contents by turns, as they lie in a folder.
pub fn dataset(bytes: &[u8]) {
    let mut parts = bytes.split(|byte| *byte == SEPARATOR);
    let mut contents = Contents::new();
    while let Some(path) = parts.next() {
        let content = parts.next().unwrap_or_default();
        // As a listing has them.
        let path = String::from_utf8_lossy(path).replace('\\', "/");
        contents.insert(path, content.into());
    }
    let files = contents.iter().map(|(path, content)| (path.clone(), content.len() as u64));
    let Ok(listing) = Listing::new("set", files) else { return };
    let Some(recognised) = recognise(&Arc::new(listing)) else { return };
    let all: Vec<usize> = (0..recognised.choices.len()).collect();
    for path in recognised.needed(&all) {
        assert!(contents.contains_key(&path), "{path} is needed, but was not listed");
    }
    let _ = recognised.interpret(&all, &contents);
}

/// What stands before the first separator and behind it.
fn halves(bytes: &[u8]) -> (&[u8], &[u8]) {
    match bytes.iter().position(|byte| *byte == SEPARATOR) {
        Some(place) => (&bytes[..place], &bytes[place + 1..]),
        None => (bytes, &[]),
    }
}
