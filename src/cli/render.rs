//! `pinpose render IN… --out FOLDER`: each photo with its objects, at its own resolution.

use std::path::PathBuf;

use serde_json::json;

use super::draw::LazyRenderer;
use super::{Failure, Outcome, open};
use crate::mesh::MeshUnit;
use crate::render::ExportKind;
use crate::scene::{ObjectId, Photo, Scene, file_stem};

struct Options {
    paths: Vec<PathBuf>,
    out: PathBuf,
    kind: ExportKind,
    mesh_unit: Option<MeshUnit>,
    as_json: bool,
}

pub fn run(parser: lexopt::Parser) -> Outcome {
    let options = read_options(parser)?;
    let session = open::open_session(&options.paths, options.mesh_unit)?;
    let scene = session.scene();
    let problem = |text: String| Failure::Input(vec![text]);
    std::fs::create_dir_all(&options.out)
        .map_err(|error| problem(format!("{}: {error}", options.out.display())))?;

    let mut renderer = LazyRenderer::default();
    let mut written = Vec::new();
    for photo in &scene.photos {
        for object in subjects(scene, photo, options.kind) {
            let png = renderer.draw(scene, photo.id, options.kind, object);
            let png = png.map_err(|reason| problem(format!("{}: {reason}", photo.asset.file_name)))?;
            let name = picture_name(scene, photo, options.kind, object);
            let path = options.out.join(&name);
            std::fs::write(&path, png).map_err(|error| problem(format!("{}: {error}", path.display())))?;
            written.push(name);
        }
    }
    if options.as_json {
        println!("{}", json!({"out": options.out, "files": written}));
    } else {
        written.iter().for_each(|name| println!("{}", options.out.join(name).display()));
    }
    Ok(())
}

fn read_options(mut parser: lexopt::Parser) -> Result<Options, Failure> {
    let mut paths = Vec::new();
    let mut out = None;
    let mut kind = ExportKind::Overlay;
    let mut mesh_unit = None;
    let mut as_json = false;
    while let Some(argument) = parser.next()? {
        match argument {
            lexopt::Arg::Long("out") => out = Some(PathBuf::from(parser.value()?)),
            lexopt::Arg::Long("json") => as_json = true,
            lexopt::Arg::Long("mesh-unit") => mesh_unit = Some(open::mesh_unit(&mut parser)?),
            lexopt::Arg::Long("kind") => {
                let name = parser.value()?.to_string_lossy().into_owned();
                kind = ExportKind::from_name(&name)
                    .ok_or_else(|| Failure::Usage(format!("\"{name}\" is no kind of picture")))?;
            }
            lexopt::Arg::Value(path) => paths.push(path.into()),
            other => return Err(other.unexpected().into()),
        }
    }
    match out {
        Some(out) if !paths.is_empty() => Ok(Options { paths, out, kind, mesh_unit, as_json }),
        _ => Err(Failure::Usage("render needs an input and --out FOLDER".to_owned())),
    }
}

/// One picture of all objects, or one of each.
fn subjects(scene: &Scene, photo: &Photo, kind: ExportKind) -> Vec<Option<ObjectId>> {
    if kind.is_of_one_object() {
        scene.objects_in(photo.id).map(|(object, _)| Some(object.id)).collect()
    } else {
        vec![None]
    }
}

fn picture_name(scene: &Scene, photo: &Photo, kind: ExportKind, object: Option<ObjectId>) -> String {
    let kind =
        ExportKind::ALL.iter().find(|(candidate, _)| *candidate == kind).map_or("picture", |(_, name)| name);
    let photo = file_stem(&photo.asset.file_name);
    match object.and_then(|id| scene.object(id)) {
        Some(object) => format!("{photo}_{}_{kind}.png", object.name),
        None => format!("{photo}_{kind}.png"),
    }
}
