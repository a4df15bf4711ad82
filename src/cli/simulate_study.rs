//! `pinpose simulate-study STUDY --participants N`: result files of participants that are a program.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{Failure, Outcome};
use crate::formats::NamedFile;
use crate::mesh::Mesh;
use crate::platform;
use crate::scene::Sha256;
use crate::study::report::mesh_of_study;
use crate::study::simulate::{Simulation, simulate};
use crate::study::{Study, Truth};

/// The participants of the paper.
const PARTICIPANTS: u64 = 11;
/// So many people no study has; more is a slip of the hand.
const MOST_PARTICIPANTS: u64 = 10_000;

struct Options {
    study: PathBuf,
    truth: Option<PathBuf>,
    out: PathBuf,
    participants: u64,
    seed: u64,
}

pub fn run(parser: lexopt::Parser) -> Outcome {
    let options = read_options(parser)?;
    let (folder, json) = find_study(&options.study)?;
    let study = Study::from_json(&json).map_err(|error| at(&options.study, &error))?;
    let truth_path = options.truth.clone().map_or_else(|| find_truth(&folder), Ok)?;
    let truth = Truth::from_json(&read(&truth_path)?).map_err(|error| at(&truth_path, &error))?;
    let meshes = read_meshes(&study, &folder)?;
    let simulation = Simulation {
        participants: options.participants as usize,
        seed: options.seed,
        began_ms: platform::now_ms(),
    };
    let sha256 = Sha256::of(&json).to_string();
    let results =
        simulate(&study, &sha256, &truth, &meshes, simulation).map_err(|error| at(&options.study, &error))?;
    fs::create_dir_all(&options.out).map_err(|error| at(&options.out, &error))?;
    for result in &results {
        let path = options.out.join(format!("{}-{}.json", study.id, result.participant.id));
        fs::write(&path, result.to_json()).map_err(|error| at(&path, &error))?;
    }
    println!("{} simulated participants in {}", results.len(), options.out.display());
    Ok(())
}

fn at(path: &Path, error: &dyn std::fmt::Display) -> Failure {
    Failure::Input(vec![format!("{}: {error}", path.display())])
}

fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    fs::read(path).map_err(|error| at(path, &error))
}

/// The folder of `study.json` and its bytes: the path itself, or in it, or in its folder `study`.
fn find_study(path: &Path) -> Result<(PathBuf, Vec<u8>), Failure> {
    let candidates = [path.to_owned(), path.join("study.json"), path.join("study/study.json")];
    let found = candidates.into_iter().find(|candidate| candidate.is_file());
    let found = found.ok_or_else(|| at(path, &"there is no study.json"))?;
    let folder = found.parent().map_or_else(PathBuf::new, Path::to_owned);
    Ok((folder, read(&found)?))
}

/// Beside `study.json`, or beside its folder, where the truth is kept from participants.
fn find_truth(folder: &Path) -> Result<PathBuf, Failure> {
    let candidates = [folder.join("truth.json"), folder.join("../truth.json")];
    let found = candidates.into_iter().find(|candidate| candidate.is_file());
    found.ok_or_else(|| at(folder, &"there is no truth.json in it or beside it: name it with --truth"))
}

fn read_meshes(study: &Study, folder: &Path) -> Result<BTreeMap<String, Arc<Mesh>>, Failure> {
    let mut meshes = BTreeMap::new();
    for object in &study.objects {
        let mut files = Vec::new();
        for asset in std::iter::once(&object.mesh).chain(&object.companions) {
            // A path out of the folder is nobody's asset.
            if Path::new(&asset.path)
                .components()
                .any(|part| !matches!(part, std::path::Component::Normal(_)))
            {
                return Err(at(folder, &format!("{}: not a path within the study", asset.path)));
            }
            let bytes = read(&folder.join(&asset.path))?;
            files.push(NamedFile { name: asset.name.clone(), bytes: Arc::from(bytes) });
        }
        let Some((file, companions)) = files.split_first() else { continue };
        let mesh = mesh_of_study(file, companions, &object.mesh_from_file)
            .map_err(|error| at(folder, &format!("{}: {error}", object.name)))?;
        meshes.insert(object.id.clone(), Arc::new(mesh));
    }
    Ok(meshes)
}

fn read_options(mut parser: lexopt::Parser) -> Result<Options, Failure> {
    let (mut study, mut out) = (None, None);
    let mut options = Options {
        study: PathBuf::new(),
        truth: None,
        out: PathBuf::new(),
        participants: PARTICIPANTS,
        seed: 1,
    };
    while let Some(argument) = parser.next()? {
        match argument {
            lexopt::Arg::Long("participants") => options.participants = super::whole(&mut parser)?,
            lexopt::Arg::Long("seed") => options.seed = super::whole(&mut parser)?,
            lexopt::Arg::Long("truth") => options.truth = Some(parser.value()?.into()),
            lexopt::Arg::Long("out") => out = Some(PathBuf::from(parser.value()?)),
            lexopt::Arg::Value(path) if study.is_none() => study = Some(PathBuf::from(path)),
            other => return Err(other.unexpected().into()),
        }
    }
    let (Some(study), Some(out)) = (study, out) else {
        return Err(Failure::Usage("simulate-study needs a study and --out FOLDER".to_owned()));
    };
    if !(1..=MOST_PARTICIPANTS).contains(&options.participants) {
        return Err(Failure::Usage(format!("--participants takes 1 to {MOST_PARTICIPANTS}")));
    }
    (options.study, options.out) = (study, out);
    Ok(options)
}
