//! Files and folders from disk into a session, as a drop would do it.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Failure;
use super::source::Source;
use crate::formats::dataset::Dataset;
use crate::formats::{
    FileKind, FileWithCompanions, NamedFile, Parsed, PosesAs, classify, parse_text_or_archive,
    read_mesh_with, read_photo, read_photo_header, with_companions,
};
use crate::mesh::{MeshUnit, length_text};
use crate::scene::PhotoAsset;
use crate::session::{Batch, Command, Effect, Opening, PhotoChange, Session, Severity};

/// Reads files, and the files directly in folders. What is said on the way goes to stderr.
pub fn read_files(paths: &[PathBuf]) -> Result<Vec<NamedFile>, Failure> {
    let mut files = Vec::new();
    let mut problems = Vec::new();
    for path in paths {
        match expand(path) {
            Ok(found) => {
                for path in found {
                    match fs::read(&path) {
                        Ok(bytes) => {
                            files.push(NamedFile { name: file_name(&path), bytes: Arc::from(bytes) });
                        }
                        Err(error) => problems.push(format!("{}: {error}", path.display())),
                    }
                }
            }
            Err(error) => problems.push(format!("{}: {error}", path.display())),
        }
    }
    if problems.is_empty() { Ok(files) } else { Err(Failure::Input(problems)) }
}

fn expand(path: &Path) -> std::io::Result<Vec<PathBuf>> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let entries: std::io::Result<Vec<_>> = fs::read_dir(path)?.collect();
    let mut files: Vec<PathBuf> =
        entries?.iter().map(fs::DirEntry::path).filter(|path| path.is_file()).collect();
    files.sort();
    Ok(files)
}

pub fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// One file, recognised and read.
pub fn parse(file: &NamedFile, companions: &[NamedFile]) -> Result<(Parsed, Vec<String>), String> {
    if file.bytes.is_empty() {
        return Err(format!("{}: the file is empty", file.name));
    }
    let parsed = match classify(&file.name, &file.bytes) {
        FileKind::Photo => read_photo(file).map(|(asset, _)| (Parsed::Photo(Arc::new(asset)), Vec::new())),
        FileKind::Mesh => read_mesh_with(file, companions)
            .map(|(asset, warnings)| (Parsed::Mesh(Arc::new(asset)), warnings)),
        kind => parse_text_or_archive(file, kind).map(|parsed| (parsed, Vec::new())),
    };
    parsed.map_err(|error| format!("{}: {error}", file.name))
}

/// Opens everything together. Files of a folder that are none of ours (notes, licences) are left out with a word; a file
/// that was named by itself has to be readable. `mesh_unit` is that of meshes whose files do not say theirs and whose size
/// leaves it open.
pub fn open_session(paths: &[PathBuf], mesh_unit: Option<MeshUnit>) -> Result<Session, Failure> {
    let mut opened = Opened::default();
    let mut files = Vec::new();
    for path in paths {
        match Source::open(path) {
            Ok(Some(source)) => opened.take_dataset(path, source),
            Ok(None) => files.push(path.clone()),
            Err(problem) => opened.problems.push(problem),
        }
    }
    let named: Vec<String> = files.iter().filter(|path| !path.is_dir()).map(|path| file_name(path)).collect();
    for FileWithCompanions { file, companions } in with_companions(read_files(&files)?) {
        if !named.contains(&file.name) && classify(&file.name, &file.bytes) == FileKind::Unknown {
            eprintln!("pinpose: {}: left out, not a kind of file that is read", file.name);
            continue;
        }
        opened.take(&file, &companions, !named.contains(&file.name));
    }
    if !opened.problems.is_empty() {
        return Err(Failure::Input(opened.problems));
    }
    let mut session = opened.into_session()?;
    settle_units(&mut session, mesh_unit);
    Ok(session)
}

#[derive(Default)]
struct Opened {
    batch: Batch,
    document: Option<crate::formats::Document>,
    depths: Vec<Depth>,
    problems: Vec<String>,
}

/// A data set's depth map, on its way to its photo.
struct Depth {
    /// The photo's path in the data set, and so its file's name.
    photo: String,
    asset: Arc<PhotoAsset>,
    mm_per_unit: f64,
}

impl Opened {
    fn take(&mut self, file: &NamedFile, companions: &[NamedFile], lenient: bool) {
        match parse(file, companions) {
            Ok((Parsed::Photo(photo), _)) => self.batch.photos.push(photo),
            Ok((Parsed::Mesh(mesh), warnings)) => {
                warnings.iter().for_each(|warning| eprintln!("pinpose: {}: {warning}", file.name));
                self.batch.meshes.push(mesh);
            }
            Ok((Parsed::Camera(camera), _)) => self.batch.cameras.push(camera),
            Ok((Parsed::Poses(poses), _)) => self.batch.poses.push(poses),
            Ok((Parsed::Pins(_), _)) => {
                let name = &file.name;
                self.problems
                    .push(format!("{name}: pins of one photo: solve them with `pinpose pins {name}`"));
            }
            Ok((Parsed::Workspace(workspace), _)) => {
                self.document = Some(workspace.document);
                for FileWithCompanions { file, companions } in workspace.files {
                    self.take(&file, &companions, false);
                }
            }
            Err(problem) if lenient => eprintln!("pinpose: {problem}: left out"),
            Err(problem) => self.problems.push(problem),
        }
    }

    /// The photos, meshes and poses of a data set's one scene.
    fn take_dataset(&mut self, path: &Path, mut source: Source) {
        let at = |text: &str| format!("{}: {text}", path.display());
        if let [_, _, ..] = source.recognised.choices.as_slice() {
            let labels: Vec<&str> =
                source.recognised.choices.iter().take(20).map(|choice| choice.label.as_str()).collect();
            self.problems
                .push(at(&format!("it holds several scenes, name the folder of one: {}", labels.join(", "))));
            return;
        }
        let dataset = match source.interpret(&[0]) {
            Ok(dataset) => dataset,
            Err(problem) => {
                self.problems.push(at(&problem));
                return;
            }
        };
        for line in dataset.guessed.iter().map(|line| format!("guessed: {line}")) {
            eprintln!("pinpose: {}", at(&line));
        }
        for line in dataset.missing.iter().map(|line| format!("missing: {line}")) {
            eprintln!("pinpose: {}", at(&line));
        }
        let setting = dataset.setting();
        self.read_photos(&mut source, &dataset);
        self.read_depths(&mut source, &dataset);
        self.read_meshes(&mut source, &dataset);
        self.batch.poses.push(setting);
        self.batch.poses.extend(dataset.poses);
    }

    fn read_photos(&mut self, source: &mut Source, dataset: &Dataset) {
        for photo in &dataset.photos {
            let read = source.read(&photo.path).and_then(|bytes| {
                let file = NamedFile { name: photo.path.clone(), bytes };
                read_photo_header(&file).map_err(|error| format!("{}: {error}", photo.path))
            });
            match read {
                Ok(asset) => self.batch.photos.push(Arc::new(asset)),
                Err(problem) => eprintln!("pinpose: {problem}: left out"),
            }
        }
    }

    fn read_depths(&mut self, source: &mut Source, dataset: &Dataset) {
        for (photo, depth) in
            dataset.photos.iter().filter_map(|photo| Some((&photo.path, photo.depth.as_ref()?)))
        {
            let read = source.read(&depth.path).and_then(|bytes| {
                let file = NamedFile { name: depth.path.clone(), bytes };
                read_photo_header(&file).map_err(|error| format!("{}: {error}", depth.path))
            });
            match read {
                Ok(asset) => self.depths.push(Depth {
                    photo: photo.clone(),
                    asset: Arc::new(asset),
                    mm_per_unit: depth.mm_per_unit,
                }),
                Err(problem) => eprintln!("pinpose: {problem}: left out"),
            }
        }
    }

    fn read_meshes(&mut self, source: &mut Source, dataset: &Dataset) {
        for mesh in &dataset.meshes {
            let read = source.read(&mesh.path).and_then(|bytes| {
                let file = NamedFile { name: mesh.path.clone(), bytes };
                let mut files = vec![file];
                for path in &mesh.companions {
                    files.extend(source.read(path).ok().map(|bytes| NamedFile { name: path.clone(), bytes }));
                }
                // Which of them it asks for, its content says.
                let own = with_companions(files).into_iter().find(|entry| entry.file.name == mesh.path);
                let own = own.ok_or_else(|| format!("{}: it is no mesh", mesh.path))?;
                read_mesh_with(&own.file, &own.companions).map_err(|error| format!("{}: {error}", mesh.path))
            });
            match read {
                Ok((asset, warnings)) => {
                    warnings.iter().for_each(|warning| eprintln!("pinpose: {}: {warning}", mesh.path));
                    self.batch.meshes.push(Arc::new(asset));
                }
                Err(problem) => eprintln!("pinpose: {problem}: left out"),
            }
        }
    }

    fn into_session(mut self) -> Result<Session, Failure> {
        let mut session = Session::default();
        self.batch.poses_as = Some(PosesAs::Annotations);
        let command = match self.document {
            Some(document) => Command::Open(Box::new(Opening {
                document,
                photos: self.batch.photos,
                meshes: self.batch.meshes,
                restored: true,
            })),
            None => Command::Import(Box::new(self.batch)),
        };
        let effects = session
            .apply(command, crate::platform::now_ms())
            .map_err(|error| Failure::Input(vec![error.to_string()]))?;
        for effect in effects {
            if let Effect::Notify(notice) = effect
                && notice.severity != Severity::Info
            {
                eprintln!("pinpose: {}", notice.text);
            }
        }
        give_depths(&mut session, self.depths);
        Ok(session)
    }
}

/// Nobody is there to be asked: what is taken for granted is said.
fn settle_units(session: &mut Session, wanted: Option<MeshUnit>) {
    while let Some(question) = session.unit_question() {
        let unit = wanted.unwrap_or(question.likely);
        // The question is gone, then.
        let Ok(_) = session.apply(Command::AnswerUnit(unit), crate::platform::now_ms()) else { return };
        if wanted.is_some() {
            continue;
        }
        for object in question.objects.iter().filter_map(|id| session.scene().object(*id)) {
            let side = length_text(object.mesh.mesh.bounds().size().max_element());
            eprintln!(
                "pinpose: {}: it does not say its unit and is taken to be in {unit}, its longest side {side}; --mesh-unit says \
                 otherwise",
                object.mesh.file_name
            );
        }
    }
}

/// The value of `--mesh-unit`.
pub fn mesh_unit(parser: &mut lexopt::Parser) -> Result<MeshUnit, Failure> {
    let symbol = parser.value()?.to_string_lossy().into_owned();
    MeshUnit::from_symbol(&symbol).ok_or_else(|| {
        let known = MeshUnit::ALL.map(MeshUnit::symbol).join(", ");
        Failure::Usage(format!("\"{symbol}\" is not one of {known}"))
    })
}

/// Gives each depth map to its photo; what does not fit is said.
fn give_depths(session: &mut Session, depths: Vec<Depth>) {
    let shown = session.photo().map(|photo| photo.id);
    let now_ms = crate::platform::now_ms();
    for Depth { photo, asset, mm_per_unit } in depths {
        let found = session.scene().photos.iter().find(|candidate| candidate.asset.file_name == photo);
        let Some(id) = found.map(|photo| photo.id) else { continue };
        let scale = Command::EditPhoto(id, PhotoChange::DepthScale(mm_per_unit));
        for command in [Command::ShowPhoto(id), Command::ImportDepth(asset), scale] {
            if let Err(error) = session.apply(command, now_ms) {
                eprintln!("pinpose: {photo}: {error}");
                break;
            }
        }
    }
    if let Some(shown) = shown {
        session.apply(Command::ShowPhoto(shown), now_ms).ok();
    }
}
