//! `pinpose inspect FILE…`: what files are and what is in them.

use serde_json::{Value, json};

use super::{Failure, Outcome, open};
use crate::formats::{FileWithCompanions, NamedFile, Parsed, with_companions};

pub fn run(mut parser: lexopt::Parser) -> Outcome {
    let mut paths = Vec::new();
    let mut as_json = false;
    while let Some(argument) = parser.next()? {
        match argument {
            lexopt::Arg::Long("json") => as_json = true,
            lexopt::Arg::Value(path) => paths.push(path.into()),
            other => return Err(other.unexpected().into()),
        }
    }
    if paths.is_empty() {
        return Err(Failure::Usage("inspect needs a file".to_owned()));
    }
    let mut problems = Vec::new();
    let mut found = Vec::new();
    for FileWithCompanions { file, companions } in with_companions(open::read_files(&paths)?) {
        match open::parse(&file, &companions) {
            Ok((parsed, warnings)) => found.push(describe(&file, &parsed, &warnings)),
            Err(problem) => problems.push(problem),
        }
    }
    if as_json {
        println!("{}", Value::Array(found));
    } else {
        found.iter().for_each(print_plain);
    }
    if problems.is_empty() { Ok(()) } else { Err(Failure::Input(problems)) }
}

fn describe(file: &NamedFile, parsed: &Parsed, warnings: &[String]) -> Value {
    let (kind, content) = match parsed {
        Parsed::Photo(photo) => (
            "photo",
            json!({
                "width": photo.width,
                "height": photo.height,
                "sha256": photo.sha256.to_string(),
                "exif_focal_px": photo.exif_focal_px,
            }),
        ),
        Parsed::Mesh(asset) => ("mesh", mesh_content(asset)),
        Parsed::Camera(camera) => (
            "camera",
            json!({"K": camera.k, "distortion": camera.distortion.to_array(), "size": camera.size}),
        ),
        Parsed::Poses(poses) => (
            "poses",
            json!({
                "photos": poses.photos.iter().map(|photo| photo.key.stem()).collect::<Vec<_>>(),
                "objects": poses.objects.iter().map(|object| object.key.stem()).collect::<Vec<_>>(),
                "poses": poses.pose_count(),
                "remarks": poses.remarks,
            }),
        ),
        Parsed::Workspace(workspace) => (
            "workspace",
            json!({
                "name": workspace.document.name,
                "poses": workspace.document.pose_count(),
                "files": workspace.files.iter().map(|entry| entry.file.name.as_str()).collect::<Vec<_>>(),
            }),
        ),
    };
    json!({"file": file.name, "bytes": file.bytes.len(), "kind": kind, "content": content, "warnings": warnings})
}

fn mesh_content(asset: &crate::scene::MeshAsset) -> Value {
    let mesh = &asset.mesh;
    let bounds = mesh.bounds();
    json!({
        "vertices": mesh.positions_mm().len(),
        "triangles": mesh.triangles().len(),
        "normals": mesh.normals().is_some(),
        "colors": mesh.has_colors(),
        "textures": mesh.paint().map_or(0, |paint| paint.textures.len()),
        "min_mm": bounds.min.to_array(),
        "max_mm": bounds.max.to_array(),
        "size_mm": bounds.size().to_array(),
        "sha256": asset.sha256.to_string(),
    })
}

fn print_plain(found: &Value) {
    let text = |key: &str| found[key].as_str().unwrap_or_default().to_owned();
    println!("{}: {}, {} bytes", text("file"), text("kind"), found["bytes"]);
    for (key, value) in found["content"].as_object().into_iter().flatten() {
        println!("  {key}: {value}");
    }
    for warning in found["warnings"].as_array().into_iter().flatten() {
        println!("  note: {}", warning.as_str().unwrap_or_default());
    }
}
