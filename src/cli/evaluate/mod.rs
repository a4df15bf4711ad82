//! `pinpose evaluate --truth T POSES…`: how far poses are from the truth, in all of the field's errors.

mod poses;
mod report;

use std::path::PathBuf;

use super::{Failure, Outcome, open};
use crate::formats::{Incoming, PosesAs};
use crate::mesh::MeshUnit;
use crate::metrics::{PoseSet, annotated_poses, compare};
use crate::scene::Scene;

#[derive(Clone, Copy)]
enum Style {
    Text,
    Json,
    Csv,
}

struct Options {
    truth: Vec<PathBuf>,
    poses: Vec<PathBuf>,
    mesh_unit: Option<MeshUnit>,
    style: Style,
}

pub fn run(parser: lexopt::Parser) -> Outcome {
    let Options { mut truth, poses, mesh_unit, style } = read_options(parser)?;
    let estimates = poses::read_poses(&poses)?;
    // Photos and meshes may lie with either side; they are the same.
    truth.extend(estimates.other_files);
    let session = open::open_session(&truth, mesh_unit)?;
    for (file, missing) in session.missing_files() {
        eprintln!("pinpose: {file}: left out what is in {}: not among the files", missing.join(", "));
    }
    let scene = session.scene();
    let expected = annotated_poses(scene);
    if expected.is_empty() {
        return Err(Failure::Input(vec![
            "the truth holds no pose whose photo and mesh are given too".to_owned(),
        ]));
    }
    let found = matched(scene, &estimates.poses);
    let comparison = compare(scene, &expected, &found);
    if comparison.poses.is_empty() {
        return Err(Failure::Input(vec!["no pose has its photo and object in the truth".to_owned()]));
    }
    for photo in comparison.unused_depth.iter().filter_map(|id| scene.photo(*id)) {
        eprintln!(
            "pinpose: {}: its depth map is not used: it cannot be read or has another size",
            photo.name
        );
    }
    match style {
        Style::Text => print!("{}", report::text(scene, &comparison)),
        Style::Json => println!("{}", report::json(scene, &comparison)),
        Style::Csv => print!("{}", report::csv(scene, &comparison)),
    }
    Ok(())
}

fn read_options(mut parser: lexopt::Parser) -> Result<Options, Failure> {
    let mut options = Options { truth: Vec::new(), poses: Vec::new(), mesh_unit: None, style: Style::Text };
    while let Some(argument) = parser.next()? {
        match argument {
            lexopt::Arg::Long("truth") => options.truth.push(parser.value()?.into()),
            lexopt::Arg::Long("mesh-unit") => options.mesh_unit = Some(open::mesh_unit(&mut parser)?),
            lexopt::Arg::Long("json") => options.style = Style::Json,
            lexopt::Arg::Long("csv") => options.style = Style::Csv,
            lexopt::Arg::Value(path) => options.poses.push(path.into()),
            other => return Err(other.unexpected().into()),
        }
    }
    if options.truth.is_empty() || options.poses.is_empty() {
        return Err(Failure::Usage("evaluate needs --truth T and poses".to_owned()));
    }
    Ok(options)
}

/// The poses by the truth's photos and objects, found by content or by name as an import finds them.
fn matched(scene: &Scene, files: &[Incoming]) -> PoseSet {
    let mut found = PoseSet::new();
    for incoming in files {
        // An import may change cameras and looks: the truth's stay as they are.
        let mut scratch = scene.clone();
        scratch.references.clear();
        let outcome = incoming.apply(&mut scratch, PosesAs::Reference, 0.0);
        for name in &outcome.missing {
            eprintln!("pinpose: {}: {name} is not among the truth's files", incoming.file_name);
        }
        if outcome.applied > 0 {
            found.extend(scratch.references.pop().into_iter().flat_map(|reference| reference.poses));
        }
    }
    found
}
