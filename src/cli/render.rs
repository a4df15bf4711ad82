//! `pinpose render IN… --out FOLDER`: each photo with its objects, at its own resolution.

use std::path::PathBuf;
use std::sync::Arc;

use serde_json::json;

use super::{Failure, Outcome, open};
use crate::mesh::MeshUnit;
use crate::photo::{decode, decode_depth, png_rgba};
use crate::render::{ExportKind, Layer, Renderer, export_picture, raster_png, silhouette_png};
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

    let mut renderer = None;
    let mut written = Vec::new();
    for photo in &scene.photos {
        for object in subjects(scene, photo, options.kind) {
            let png = match options.kind {
                ExportKind::Overlay | ExportKind::Silhouette => {
                    let renderer = match &mut renderer {
                        Some(renderer) => renderer,
                        empty => {
                            empty.insert(Renderer::headless().map_err(|error| problem(error.to_string()))?)
                        }
                    };
                    draw(renderer, scene, photo, options.kind, object).map_err(problem)?
                }
                kind => raster_png(scene, photo.id, kind, object),
            };
            let png =
                png.ok_or_else(|| problem(format!("{}: the picture cannot be made", photo.asset.file_name)))?;
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

fn draw(
    renderer: &mut Renderer,
    scene: &Scene,
    photo: &Photo,
    kind: ExportKind,
    object: Option<ObjectId>,
) -> Result<Option<Vec<u8>>, String> {
    let decoded =
        decode(&photo.asset.bytes).map_err(|error| format!("{}: {error}", photo.asset.file_name))?;
    let occluding = photo.depth.as_ref().filter(|depth| depth.occludes);
    let depth = occluding.map(|depth| decode_depth(&depth.asset.bytes).map(Arc::new)).transpose();
    let depth = depth.map_err(|error| format!("the depth map of {}: {error}", photo.name))?;
    let pixels = Some(Arc::new(decoded.pixels));
    let Some(picture) = export_picture(scene, photo.id, pixels, depth, object) else { return Ok(None) };
    let layer = if kind == ExportKind::Silhouette { Layer::Ids } else { Layer::Picture };
    let pending = renderer.draw_and_read(&picture, [photo.camera.width, photo.camera.height], layer);
    let pixels = pending.wait(renderer.gpu()).map_err(|error| error.to_string())?;
    Ok(if kind == ExportKind::Silhouette { silhouette_png(&pixels) } else { png_rgba(&pixels) })
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
