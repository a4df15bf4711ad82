//! Every mesh of the shared data loads, or is refused for a reason that is written down here.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use pinpose::mesh::{self, LoadedMesh, MeshError};

/// Generous: the largest file takes some 10 ms, but machines that run tests are busy.
const LONGEST_LOAD: Duration = Duration::from_secs(5);

/// Files of `meshes_misc` that no reader could make a surface of, each with what the message has to say.
const RIGHTLY_REFUSED: &[(&str, &str)] = &[
    // Faces of one and two corners, points, lines, or no geometry at all.
    ("invalid-face-definition.obj", "no faces: 8 vertices"),
    ("line-prim.obj", "no faces: 8 vertices"),
    ("points-prim.obj", "no faces: 8 vertices"),
    ("issue-356-leading-spaces-newmtl.obj", "no faces: 0 vertices"),
    ("models/empty.obj", "no faces: 0 vertices"),
    ("models/empty.ply", "no faces: 0 vertices"),
    ("empty_nodes.glb", "no faces: 0 vertices"),
    ("face_in_group_name.obj", "no faces: 1 vertices"),
    ("obj_empty.obj", "no faces: 0 vertices"),
    ("obj_points.obj", "no faces: 8 vertices"),
    ("obj_wireframe.obj", "no faces: 8 vertices"),
    ("ply_empty_ascii.ply", "no faces: 0 vertices"),
    ("ply_empty_bin.ply", "no faces: 0 vertices"),
    ("ply_empty_header.ply", "no faces: 0 vertices"),
    ("ply_points_ascii.ply", "no faces: 8 vertices"),
    ("ply_points_bin.ply", "no faces: 8 vertices"),
    ("models/empty.stl", "no faces: 0 vertices"),
    ("stl_empty_ascii.stl", "no faces: 0 vertices"),
    ("stl_empty_bin.stl", "no faces: 0 vertices"),
    ("points_ascii.ply", "no faces: 5 vertices"),
    ("points_ascii_with_lists.ply", "no faces: 5 vertices"),
    ("points_bin.ply", "no faces: 5 vertices"),
    ("points_emptyascii.ply", "no faces: 12 vertices"),
    ("points_emptyface.ply", "no faces: 1024 vertices"),
    // Corners that name no vertex.
    ("invalid-relative-texture-index.obj", "line 2: the face names vertex 1"),
    ("invalid-relative-vertex-index.obj", "line 1: the face's corner “-4”"),
    ("issue-140-zero-face-idx.obj", "line 16: the face's corner “0/0/0”"),
    // A vertex that is nowhere.
    ("test-nan.obj", "line 12: the vertex is at [NaN, NaN, NaN]"),
];

fn mesh_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut pending = vec![folder.to_path_buf()];
    while let Some(folder) = pending.pop() {
        for entry in fs::read_dir(&folder).expect("the data can be listed") {
            let path = entry.expect("the data can be listed").path();
            let extension = path.extension().and_then(OsStr::to_str).unwrap_or_default().to_ascii_lowercase();
            if path.is_dir() {
                pending.push(path);
            } else if ["ply", "obj", "stl", "glb", "gltf", "off"].contains(&extension.as_str()) {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

fn files_by_key(folder: &Path) -> BTreeMap<String, PathBuf> {
    let entries =
        fs::read_dir(folder).expect("the data can be listed").map(|entry| entry.expect("listed").path());
    let files = entries.filter(|path| path.is_file());
    files.map(|path| (mesh::companion_key(&path.to_string_lossy()), path)).collect()
}

fn load(path: &Path) -> Result<LoadedMesh, MeshError> {
    let bytes = fs::read(path).expect("the file can be read");
    let started = Instant::now();
    let folder = path.parent().unwrap_or(path);
    let beside = files_by_key(folder);
    let find =
        |key: &str| beside.get(key).map(|path| Arc::from(fs::read(path).expect("the file can be read")));
    let loaded = mesh::load(&path.file_name().unwrap_or_default().to_string_lossy(), &bytes, &find);
    assert!(started.elapsed() < LONGEST_LOAD, "{} took {:?}", path.display(), started.elapsed());
    loaded
}

#[test]
fn each_file_of_the_corpus_loads_or_is_rightly_refused() {
    let Some(folder) = crate::data_folder("meshes_misc") else { return };
    let files = mesh_files(&folder);
    let mut problems = Vec::new();
    let mut refused = 0;
    for path in &files {
        let name = path.strip_prefix(&folder).unwrap_or(path).to_string_lossy().replace('\\', "/");
        let expected =
            RIGHTLY_REFUSED.iter().find(|(file, _)| name.ends_with(file)).map(|(_, reason)| *reason);
        match (load(path), expected) {
            (Ok(_), None) => {}
            (Ok(_), Some(_)) => problems.push(format!("{name} loads, but is listed as refused")),
            (Err(error), Some(reason)) if error.to_string().contains(reason) => refused += 1,
            (Err(error), _) => problems.push(format!("{name}: {error}")),
        }
    }
    println!(
        "{} of {} files load, {refused} are rightly refused",
        files.len() - refused - problems.len(),
        files.len()
    );
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn the_corpus_comes_with_its_looks() {
    let Some(folder) = crate::data_folder("meshes_misc/trimesh/models") else { return };
    // File, textures, materials; and the most vertices that the GPU is given for each of the file.
    let expected = [
        ("fuze.obj", 1, 2, 2.0),
        ("fuze.ply", 1, 1, 2.0),
        ("BoxTextured.glb", 1, 1, 1.0),
        ("Duck.glb", 1, 1, 1.0),
        ("ballA.off", 0, 0, 1.5),
        ("comments.off", 0, 2, 3.0),
        ("rgb_cube_with_primitives.gltf", 0, 1, 3.0),
    ];
    for (name, textures, least_materials, most_growth) in expected {
        let LoadedMesh { mesh, warnings } = load(&folder.join(name)).unwrap();
        let shading = mesh::shading_vertices(&mesh);
        let growth = shading.vertices.len() as f64 / mesh.positions_mm().len() as f64;
        let paint = mesh.paint().cloned().unwrap_or_default();
        println!(
            "{name}: {} textures, {} materials, {} groups, × {growth:.2}, {warnings:?}",
            paint.textures.len(),
            paint.materials.len(),
            shading.groups.len()
        );
        assert_eq!(paint.textures.len(), textures, "{name}");
        assert!(paint.materials.len() >= least_materials, "{name}: {:?}", paint.materials);
        assert!(growth <= most_growth, "{name}: {growth}");
    }
}

#[test]
fn each_mesh_with_truth_loads() {
    let cases =
        ["linemod10", "lmo16", "visp_rbt14", "megapose_bbq", "m3t_triangle", "rbot_squirrel", "sixdpat_duck"];
    for case in cases {
        let Some(folder) = crate::data_folder(case) else { continue };
        let files = mesh_files(&folder);
        assert!(!files.is_empty(), "{case} has no meshes");
        for path in files {
            let LoadedMesh { mesh, warnings } =
                load(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            let (vertices, triangles) = (mesh.positions_mm().len(), mesh.triangles().len());
            println!(
                "{case}: {vertices} vertices, {triangles} triangles, box {}, {warnings:?}",
                mesh.bounds().size()
            );
        }
    }
}
