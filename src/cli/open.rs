//! Files and folders from disk into a session, as a drop would do it.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Failure;
use crate::formats::{
    FileKind, FileWithCompanions, NamedFile, Parsed, PosesAs, classify, parse_text_or_archive,
    read_mesh_with, read_photo, with_companions,
};
use crate::session::{Batch, Command, Effect, Opening, Session, Severity};

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

pub fn expand(path: &Path) -> std::io::Result<Vec<PathBuf>> {
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
/// that was named by itself has to be readable.
pub fn open_session(paths: &[PathBuf]) -> Result<Session, Failure> {
    let named: Vec<String> = paths.iter().filter(|path| !path.is_dir()).map(|path| file_name(path)).collect();
    let mut opened = Opened::default();
    for FileWithCompanions { file, companions } in with_companions(read_files(paths)?) {
        if !named.contains(&file.name) && classify(&file.name, &file.bytes) == FileKind::Unknown {
            eprintln!("pinpose: {}: left out, not a kind of file that is read", file.name);
            continue;
        }
        opened.take(&file, &companions, !named.contains(&file.name));
    }
    if !opened.problems.is_empty() {
        return Err(Failure::Input(opened.problems));
    }
    opened.into_session()
}

#[derive(Default)]
struct Opened {
    batch: Batch,
    document: Option<crate::formats::Document>,
    problems: Vec<String>,
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
        Ok(session)
    }
}
