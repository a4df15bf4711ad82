//! `pinpose inspect IN…`: what files are and what is in them; what a folder or a zip is, and what of it is found, guessed and
//! missing.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::source::Source;
use super::{Failure, Outcome, open};
use crate::formats::{FileWithCompanions, NamedFile, Parsed, with_companions};
use crate::mesh::{FileUnit, MeshUnit};

pub fn run(mut parser: lexopt::Parser) -> Outcome {
    let mut paths: Vec<PathBuf> = Vec::new();
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
    let mut files = Vec::new();
    for path in paths {
        match Source::open(&path) {
            Ok(Some(source)) => match describe_dataset(&path, source) {
                Ok(described) => found.push(described),
                Err(problem) => problems.push(problem),
            },
            Ok(None) => files.push(path),
            Err(problem) => problems.push(problem),
        }
    }
    for FileWithCompanions { file, companions } in with_companions(open::read_files(&files)?) {
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

fn describe_dataset(path: &Path, mut source: Source) -> Result<Value, String> {
    let all: Vec<usize> = (0..source.recognised.choices.len()).collect();
    let dataset = source.interpret(&all).map_err(|problem| format!("{}: {problem}", path.display()))?;
    let scenes: Vec<Value> = source
        .recognised
        .choices
        .iter()
        .map(|choice| json!({"name": choice.label, "photos": choice.photos, "bytes": choice.bytes}))
        .collect();
    Ok(json!({
        "file": path.display().to_string(),
        "kind": dataset.kind.name(),
        "content": {
            "name": dataset.name,
            "scenes": scenes,
            "photos": dataset.photos.len(),
            "meshes": dataset.meshes.iter().map(|mesh| mesh.path.as_str()).collect::<Vec<_>>(),
            "poses": dataset.pose_count(),
        },
        "found": dataset.found,
        "guessed": dataset.guessed,
        "missing": dataset.missing,
    }))
}

fn describe(file: &NamedFile, parsed: &Parsed, warnings: &[String]) -> Value {
    let (kind, content) = match parsed {
        Parsed::Photo(photo) => (
            "photo",
            json!({
                "width": photo.width,
                "height": photo.height,
                "sha256": photo.sha256.to_string(),
                "exif_focal_px": photo.exif_focal.map(|exif| exif.focal_px),
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
        Parsed::Pins(pins) => ("pins", json!({ "pins": pins.len() })),
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

/// Sizes are those that the mesh has once it is open.
fn mesh_content(asset: &crate::scene::MeshAsset) -> Value {
    let mesh = &asset.mesh;
    let bounds = mesh.bounds();
    let (unit, source, mm) = match asset.file_unit() {
        FileUnit::Gltf => (MeshUnit::Metre, "its format", 1.0),
        FileUnit::Named(unit) => (unit, "its file", unit.in_mm()),
        FileUnit::Unknown => match MeshUnit::likely(bounds.size().max_element()) {
            (unit, true) => (unit, "its size, doubtful", unit.in_mm()),
            (unit, false) => (unit, "its size", unit.in_mm()),
        },
    };
    json!({
        "vertices": mesh.positions_mm().len(),
        "triangles": mesh.triangles().len(),
        "normals": mesh.normals().is_some(),
        "colors": mesh.has_colors(),
        "textures": mesh.paint().map_or(0, |paint| paint.textures.len()),
        "unit": unit.symbol(),
        "unit_from": source,
        "min_mm": (bounds.min * mm).to_array(),
        "max_mm": (bounds.max * mm).to_array(),
        "size_mm": (bounds.size() * mm).to_array(),
        "sha256": asset.sha256.to_string(),
    })
}

fn print_plain(found: &Value) {
    let text = |key: &str| found[key].as_str().unwrap_or_default().to_owned();
    match &found["bytes"] {
        Value::Null => println!("{}: {}", text("file"), text("kind")),
        bytes => println!("{}: {}, {bytes} bytes", text("file"), text("kind")),
    }
    // What a data set holds is told in words below.
    let counted = found["found"].is_array();
    for (key, value) in found["content"].as_object().into_iter().flatten().filter(|_| !counted) {
        println!("  {key}: {value}");
    }
    for scene in found["content"]["scenes"].as_array().into_iter().flatten() {
        println!("  scene: {}, {} photos", scene["name"].as_str().unwrap_or_default(), scene["photos"]);
    }
    for (key, label) in
        [("found", "found"), ("guessed", "guessed"), ("missing", "missing"), ("warnings", "note")]
    {
        for line in found[key].as_array().into_iter().flatten() {
            println!("  {label}: {}", line.as_str().unwrap_or_default());
        }
    }
}
