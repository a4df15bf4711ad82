//! `pinpose snap IN…`: every pose refined to its photo, from where it is.

use std::path::PathBuf;
use std::sync::Arc;

use serde_json::{Value, json};

use super::{Failure, Outcome, open};
use crate::formats::{Keep, write_document};
use crate::mesh::MeshUnit;
use crate::photo::{Pixels, decode};
use crate::platform;
use crate::raster::Mask;
use crate::scene::{Annotation, AnnotationState, DepthInMm, Object, ObjectId, Photo, PoseSource, Scene};
use crate::session::{Command, Session};
use crate::solve::contour::ContourModel;
use crate::solve::snap::{Snap, SnapHints, SnapOptions, SnapOutcome, SnapReach, SnapVerdict};

struct Options {
    paths: Vec<PathBuf>,
    out: Option<PathBuf>,
    /// Names of photos; empty for all.
    photos: Vec<String>,
    mesh_unit: Option<MeshUnit>,
    reach: SnapReach,
    as_json: bool,
}

pub fn run(parser: lexopt::Parser) -> Outcome {
    let options = read_options(parser)?;
    let mut session = open::open_session(&options.paths, options.mesh_unit)?;
    let is_wanted = |photo: &&Photo| options.photos.is_empty() || options.photos.contains(&photo.name);
    let scene = session.scene().clone();
    let photos: Vec<&Photo> = scene.photos.iter().filter(is_wanted).collect();
    let is_there = |name: &&String| scene.photos.iter().any(|photo| photo.name == **name);
    if let Some(name) = options.photos.iter().find(|name| !is_there(name)) {
        return Err(Failure::Input(vec![format!("{name}: there is no such photo")]));
    }
    let models: Vec<(ObjectId, Option<Arc<ContourModel>>)> = scene
        .objects
        .iter()
        .map(|object| (object.id, ContourModel::new(&object.mesh.mesh).map(Arc::new)))
        .collect();
    let mut lines = Vec::new();
    for photo in photos {
        let pixels = decode(&photo.asset.bytes)
            .map_err(|error| Failure::Input(vec![format!("{}: {error}", photo.asset.file_name)]))?
            .pixels;
        let seen = Seen { photo, pixels, depth: depth_of(photo)? };
        for (object, annotation) in scene.objects_in(photo.id) {
            if annotation.state == AnnotationState::Untouched {
                continue;
            }
            if let Err(error) = session.check_movable((photo.id, object.id)) {
                lines.push(left(photo, object, &error.to_string()));
                continue;
            }
            // What was snapped already is where it is now.
            let outcome = snap(session.scene(), &seen, (object, annotation), &models, options.reach)?;
            if let Some(outcome) = &outcome {
                take(&mut session, photo, object, outcome)?;
            }
            lines.push(describe(photo, object, outcome.as_ref()));
        }
    }
    if lines.is_empty() {
        return Err(Failure::Input(vec!["there is no pose to begin with".to_owned()]));
    }
    if let Some(out) = &options.out {
        let text = write_document(&session.document(Keep::Annotated));
        std::fs::write(out, text)
            .map_err(|error| Failure::Input(vec![format!("{}: {error}", out.display())]))?;
    }
    if options.as_json {
        println!("{:#}", json!({ "snaps": lines }));
    } else {
        lines.iter().for_each(|line| println!("{}", line_of(line)));
    }
    Ok(())
}

/// A photo, decoded.
struct Seen<'a> {
    photo: &'a Photo,
    pixels: Pixels,
    depth: Option<Arc<DepthInMm>>,
}

/// The photo's depth map, where it hides what is behind it.
fn depth_of(photo: &Photo) -> Result<Option<Arc<DepthInMm>>, Failure> {
    let depth = photo.depth.as_ref().filter(|depth| depth.occludes);
    let read = depth.map(|depth| {
        let named = |error| Failure::Input(vec![format!("{}: {error}", depth.asset.file_name)]);
        depth.in_mm().map(Arc::new).map_err(named)
    });
    read.transpose()
}

/// The mask that somebody has drawn of an object in a photo.
fn mask_of(scene: &Scene, photo: &Photo, object: ObjectId) -> Result<Option<Mask>, Failure> {
    let mask = scene.masks_of(photo.id).find(|mask| mask.object == Some(object));
    let read = mask.map(|mask| {
        let named = |error| Failure::Input(vec![format!("{}: {error}", mask.asset.file_name)]);
        decode(&mask.asset.bytes).map(|picture| Mask::of_picture(&picture.pixels)).map_err(named)
    });
    read.transpose()
}

/// `None` for a mesh without a surface.
fn snap(
    scene: &Scene,
    seen: &Seen<'_>,
    (object, annotation): (&Object, &Annotation),
    models: &[(ObjectId, Option<Arc<ContourModel>>)],
    reach: SnapReach,
) -> Result<Option<SnapOutcome>, Failure> {
    let Seen { photo, pixels, depth } = seen;
    let model_of =
        |id: ObjectId| models.iter().find(|(known, _)| *known == id).and_then(|(_, model)| model.clone());
    let occluders = scene
        .placed_beside(photo.id, object.id)
        .filter_map(|(other, annotation)| Some((model_of(other.id)?, annotation.camera_from_object)));
    let hints =
        SnapHints { pins: annotation.pins.clone(), occluders: occluders.collect(), depth: depth.clone() };
    let options = SnapOptions { mask: mask_of(scene, photo, object.id)?, reach };
    let start = &annotation.camera_from_object;
    let snap = |model| Snap::with(pixels, &photo.camera, model, start, hints, &options).run();
    Ok(model_of(object.id).map(snap))
}

fn take(session: &mut Session, photo: &Photo, object: &Object, outcome: &SnapOutcome) -> Outcome {
    if outcome.verdict != SnapVerdict::Improved {
        return Ok(());
    }
    let command = Command::SetPose {
        photo: photo.id,
        object: object.id,
        camera_from_object: outcome.camera_from_object,
        source: PoseSource::Snap,
    };
    session
        .apply(command, platform::now_ms())
        .map(drop)
        .map_err(|error| Failure::Input(vec![format!("{}: {error}", photo.name)]))
}

/// Of a pose that was not tried.
fn left(photo: &Photo, object: &Object, why: &str) -> Value {
    json!({ "photo": photo.name, "object": object.name, "verdict": why })
}

fn describe(photo: &Photo, object: &Object, outcome: Option<&SnapOutcome>) -> Value {
    let Some(outcome) = outcome else {
        return left(photo, object, "The mesh has no surface.");
    };
    json!({
        "photo": photo.name,
        "object": object.name,
        "improved": outcome.verdict == SnapVerdict::Improved,
        "verdict": outcome.verdict.to_string(),
        "score_before": outcome.score_before,
        "score_after": outcome.score_after,
        "turned_degrees": outcome.turned_rad.to_degrees(),
        "moved_mm": outcome.moved_mm,
        "camera_from_object": outcome.camera_from_object.to_rows(),
        "covariance": outcome.covariance.map(|covariance| covariance.0),
        "covariance_of": "the left twist (wx wy wz in radians, vx vy vz in mm), true pose = exp(twist) * pose",
    })
}

fn line_of(line: &Value) -> String {
    let text = |key: &str| line[key].as_str().unwrap_or_default().to_owned();
    let number = |key: &str| line[key].as_f64().unwrap_or_default();
    let what = if line["improved"] == true {
        format!(
            "turned {:.1} degrees, moved {:.1} mm, score {:.2} to {:.2}",
            number("turned_degrees"),
            number("moved_mm"),
            number("score_before"),
            number("score_after")
        )
    } else {
        text("verdict")
    };
    format!("{}  {}  {what}", text("photo"), text("object"))
}

fn read_options(mut parser: lexopt::Parser) -> Result<Options, Failure> {
    let mut options = Options {
        paths: Vec::new(),
        out: None,
        photos: Vec::new(),
        mesh_unit: None,
        reach: SnapReach::Near,
        as_json: false,
    };
    while let Some(argument) = parser.next()? {
        match argument {
            lexopt::Arg::Long("out") => options.out = Some(PathBuf::from(parser.value()?)),
            lexopt::Arg::Long("json") => options.as_json = true,
            lexopt::Arg::Long("wide") => options.reach = SnapReach::Wide,
            lexopt::Arg::Long("mesh-unit") => options.mesh_unit = Some(open::mesh_unit(&mut parser)?),
            lexopt::Arg::Long("photo") => {
                options.photos.push(parser.value()?.to_string_lossy().into_owned());
            }
            lexopt::Arg::Value(path) => options.paths.push(path.into()),
            other => return Err(other.unexpected().into()),
        }
    }
    if options.paths.is_empty() {
        return Err(Failure::Usage("snap needs photos, meshes and poses".to_owned()));
    }
    Ok(options)
}
