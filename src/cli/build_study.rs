//! `pinpose build-study IN… --out FOLDER`: photographs with true poses as a study with the paper's protocol.

use std::fs;
use std::path::{Path, PathBuf};

use super::{Failure, Outcome, open};
use crate::mesh::MeshUnit;
use crate::study::pack::{Draft, Pack, Role};
use crate::study::paper::paper_study;

struct Options {
    paths: Vec<PathBuf>,
    out: PathBuf,
    id: String,
    title: String,
    mesh_unit: Option<MeshUnit>,
}

pub fn run(parser: lexopt::Parser) -> Outcome {
    let options = read_options(parser)?;
    let session = open::open_session(&options.paths, options.mesh_unit)?;
    for (file, missing) in session.missing_files() {
        eprintln!("pinpose: {file}: left out what is in {}: not among the files", missing.join(", "));
    }
    let scene = session.scene();
    let mut draft = Draft::of_scene(scene, paper_study(&options.id, &options.title));
    let posed: Vec<bool> =
        draft.chosen.iter().map(|chosen| draft.truth_of(scene, chosen).is_some()).collect();
    for (chosen, is_posed) in draft.chosen.iter_mut().zip(posed) {
        chosen.role = if is_posed { Role::Sample } else { Role::None };
    }
    let pack = draft.pack(scene).map_err(|error| Failure::Input(vec![error.to_string()]))?;
    if pack.study.samples.is_empty() {
        return Err(Failure::Input(vec!["there is no object with a true pose in a photo".to_owned()]));
    }
    write(&pack, &options.out)?;
    let [samples, repeats] = [pack.study.samples.len(), pack.study.schedule.repeats as usize];
    println!(
        "{samples} samples, {} trials per participant: {} for a web host, truth.json for you alone",
        samples * repeats,
        options.out.join("study").display()
    );
    Ok(())
}

/// What participants are sent in `study`, and the truth beside it.
fn write(pack: &Pack, out: &Path) -> Outcome {
    let truth = ("truth.json".to_owned(), pack.truth.to_json().into_bytes());
    let files = pack.files.iter().map(|(path, bytes)| (format!("study/{path}"), bytes.to_vec()));
    for (path, bytes) in files.chain([truth]) {
        let path = out.join(path);
        let made = path.parent().map_or(Ok(()), fs::create_dir_all);
        made.and_then(|()| fs::write(&path, bytes))
            .map_err(|error| Failure::Input(vec![format!("{}: {error}", path.display())]))?;
    }
    Ok(())
}

fn read_options(mut parser: lexopt::Parser) -> Result<Options, Failure> {
    let mut out = None;
    let mut options = Options {
        paths: Vec::new(),
        out: PathBuf::new(),
        id: "paper".to_owned(),
        title: "Object poses in photographs".to_owned(),
        mesh_unit: None,
    };
    while let Some(argument) = parser.next()? {
        match argument {
            lexopt::Arg::Long("out") => out = Some(PathBuf::from(parser.value()?)),
            lexopt::Arg::Long("id") => options.id = parser.value()?.to_string_lossy().into_owned(),
            lexopt::Arg::Long("title") => options.title = parser.value()?.to_string_lossy().into_owned(),
            lexopt::Arg::Long("protocol") => {
                let protocol = parser.value()?;
                if protocol != "paper" {
                    let name = protocol.to_string_lossy();
                    return Err(Failure::Usage(format!("\"{name}\" is no protocol: paper is one")));
                }
            }
            lexopt::Arg::Long("mesh-unit") => options.mesh_unit = Some(open::mesh_unit(&mut parser)?),
            lexopt::Arg::Value(path) => options.paths.push(path.into()),
            other => return Err(other.unexpected().into()),
        }
    }
    let (Some(out), false) = (out, options.paths.is_empty()) else {
        return Err(Failure::Usage(
            "build-study needs photos, meshes, true poses and --out FOLDER".to_owned(),
        ));
    };
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if options.id.is_empty() || !options.id.chars().all(is_plain) {
        return Err(Failure::Usage("--id takes letters, digits, - and _".to_owned()));
    }
    options.out = out;
    Ok(options)
}
