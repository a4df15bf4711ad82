//! `pinpose convert IN… OUT`: any files that can be read to any that can be written.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::draw::LazyRenderer;
use super::{Failure, Outcome, open};
use crate::formats::export::{
    CameraAxes, ExportError, ExportJob, ExportOptions, ExportPart, Exported, LengthUnit, OverlayRequest,
    PhotoChoice, PoseDirection, ZipStream,
};
use crate::formats::{Keep, NamedFile, write_workspace};
use crate::mesh::MeshUnit;
use crate::render::ExportKind;
use crate::scene::{Scene, file_stem};
use crate::session::Session;

struct Options {
    paths: Vec<PathBuf>,
    out: PathBuf,
    target: Target,
    /// Names of photos; none is all of them.
    photos: Vec<String>,
    mesh_unit: Option<MeshUnit>,
    export: ExportOptions,
}

/// What OUT is to be.
enum Target {
    Workspace,
    /// The one file of this name in the export.
    File(&'static str),
    Zip,
    Folder,
}

pub fn run(parser: lexopt::Parser) -> Outcome {
    let mut options = read_options(parser)?;
    let session = open::open_session(&options.paths, options.mesh_unit)?;
    for (file, missing) in session.missing_files() {
        eprintln!("pinpose: {file}: left out what is in {}: not among the files", missing.join(", "));
    }
    if !options.photos.is_empty() {
        options.export.photos = PhotoChoice::These(
            options.photos.iter().map(|name| photo_named(session.scene(), name)).collect::<Result<_, _>>()?,
        );
    }
    if let Target::Workspace = options.target {
        let bytes = write_workspace(&session.document(Keep::Everything), session.scene())
            .map_err(|error| Failure::Input(vec![error.to_string()]))?;
        return fs::write(&options.out, bytes).map_err(|error| unwritable(&options.out, &error));
    }
    export(&session, options)
}

fn export(session: &Session, options: Options) -> Outcome {
    let Options { out, target, export, .. } = options;
    let mut job = ExportJob::new(session.scene(), &session.view_settings(), export);
    job.warnings().iter().for_each(|warning| eprintln!("pinpose: {warning}"));
    if job.pose_count() == 0 {
        eprintln!("pinpose: no object has been posed, there are no poses to write");
    }
    let mut problems = Vec::new();
    let mut renderer = LazyRenderer::default();
    let mut made = std::iter::from_fn(|| job.next().map(|made| finished(made, &job, &mut renderer)))
        .filter_map(|file| file.map_err(|problem| problems.push(problem)).ok());
    let written = match target {
        Target::File(name) => {
            made.find(|file| file.name == name).map_or(Ok(()), |file| fs::write(&out, &*file.bytes))
        }
        Target::Zip => write_zip(&out, made),
        Target::Workspace | Target::Folder => made.try_for_each(|file| write_into(&out, &file)),
    };
    written.map_err(|error| unwritable(&out, &error))?;
    if problems.is_empty() { Ok(()) } else { Err(Failure::Input(problems)) }
}

/// The file, drawn if it is one that has to be.
fn finished(
    made: Result<Exported, ExportError>,
    job: &ExportJob,
    renderer: &mut LazyRenderer,
) -> Result<NamedFile, String> {
    let OverlayRequest { photo, path } = match made.map_err(|error| error.to_string())? {
        Exported::File(file) => return Ok(file),
        Exported::Overlay(request) => request,
    };
    let png = renderer.draw(job.scene(), photo, ExportKind::Overlay, None);
    let png = png.map_err(|problem| format!("{path}: {problem}"))?;
    Ok(NamedFile { name: path, bytes: Arc::from(png) })
}

fn write_zip(out: &Path, files: impl Iterator<Item = NamedFile>) -> std::io::Result<()> {
    let mut archive = File::create(out)?;
    let mut stream = ZipStream::new();
    for file in files {
        archive.write_all(&stream.add(&file).map_err(std::io::Error::other)?)?;
    }
    archive.write_all(&stream.finish().map_err(std::io::Error::other)?)
}

/// Names in an export are safe: letters of any script, digits, `-_.`, and slashes between folders that it chose itself.
fn write_into(folder: &Path, file: &NamedFile) -> std::io::Result<()> {
    let path = folder.join(&file.name);
    if let Some(parent) = path.parent() {
        fs::create_dir_all(parent)?;
    }
    fs::write(path, &*file.bytes)
}

fn unwritable(out: &Path, error: &std::io::Error) -> Failure {
    Failure::Input(vec![format!("{}: {error}", out.display())])
}

fn photo_named(scene: &Scene, name: &str) -> Result<crate::scene::PhotoId, Failure> {
    let is_it = |candidate: &str| candidate == name || file_stem(candidate) == name;
    let found = scene.photos.iter().find(|photo| is_it(&photo.name) || is_it(&photo.asset.file_name));
    found
        .map(|photo| photo.id)
        .ok_or_else(|| Failure::Input(vec![format!("there is no photo \"{name}\" among the inputs")]))
}

fn read_options(mut parser: lexopt::Parser) -> Result<Options, Failure> {
    let mut paths: Vec<PathBuf> = Vec::new();
    let mut photos = Vec::new();
    let mut mesh_unit = None;
    let mut parts = BTreeSet::new();
    let mut export = ExportOptions::of([]);
    while let Some(argument) = parser.next()? {
        match argument {
            lexopt::Arg::Value(path) => paths.push(path.into()),
            lexopt::Arg::Long("to") => parts.extend(read_parts(&text(&mut parser)?)?),
            lexopt::Arg::Long("photo") => photos.push(text(&mut parser)?),
            lexopt::Arg::Long("mesh-unit") => mesh_unit = Some(open::mesh_unit(&mut parser)?),
            lexopt::Arg::Long("axes") => {
                export.convention.axes =
                    word(&mut parser, &[("opencv", CameraAxes::OpenCv), ("opengl", CameraAxes::OpenGl)])?;
            }
            lexopt::Arg::Long("unit") => {
                export.convention.unit =
                    word(&mut parser, &[("mm", LengthUnit::Millimetre), ("m", LengthUnit::Metre)])?;
            }
            lexopt::Arg::Long("direction") => {
                let words = [PoseDirection::CameraFromObject, PoseDirection::ObjectFromCamera]
                    .map(|direction| (direction.name(), direction));
                export.convention.direction = word(&mut parser, &words)?;
            }
            lexopt::Arg::Long("all-poses") => export.keep = Keep::Everything,
            other => return Err(other.unexpected().into()),
        }
    }
    let Some(out) = paths.pop().filter(|_| !paths.is_empty()) else {
        return Err(Failure::Usage("convert needs at least one input and an output".to_owned()));
    };
    let (target, parts) = target(&out, parts)?;
    export.parts = parts;
    Ok(Options { paths, out, target, photos, mesh_unit, export })
}

/// What OUT is, from its extension and what was asked for; and what is to be in it.
fn target(out: &Path, parts: BTreeSet<ExportPart>) -> Result<(Target, BTreeSet<ExportPart>), Failure> {
    let extension = out.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let only: Vec<ExportPart> = parts.iter().copied().collect();
    let single = |part| BTreeSet::from([part]);
    match (extension, only.as_slice()) {
        ("zip", []) => Ok((Target::Workspace, parts)),
        ("json", [] | [ExportPart::Document]) => {
            Ok((Target::File("pinpose.json"), single(ExportPart::Document)))
        }
        ("json", [ExportPart::Poses]) => Ok((Target::File("poses.json"), parts)),
        ("csv", [] | [ExportPart::Csv]) => Ok((Target::File("poses.csv"), single(ExportPart::Csv))),
        ("zip", _) => Ok((Target::Zip, parts)),
        (_, []) | ("json" | "csv", _) => Err(Failure::Usage(format!(
            "{}: the output is .json, .csv, .zip (a workspace), or with --to a folder or a .zip",
            out.display()
        ))),
        _ => Ok((Target::Folder, parts)),
    }
}

fn read_parts(list: &str) -> Result<Vec<ExportPart>, Failure> {
    let read = |name: &str| {
        ExportPart::from_name(name).ok_or_else(|| {
            let known = ExportPart::ALL.map(|(_, name, ..)| name).join(", ");
            Failure::Usage(format!("\"{name}\" is nothing that can be written; there is {known}"))
        })
    };
    list.split(',').map(read).collect()
}

fn text(parser: &mut lexopt::Parser) -> Result<String, Failure> {
    Ok(parser.value()?.to_string_lossy().into_owned())
}

fn word<T: Copy>(parser: &mut lexopt::Parser, words: &[(&str, T)]) -> Result<T, Failure> {
    let given = text(parser)?;
    let found = words.iter().find(|(word, _)| *word == given).map(|(_, value)| *value);
    found.ok_or_else(|| {
        let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
        Failure::Usage(format!("\"{given}\" is not one of {}", known.join(", ")))
    })
}
