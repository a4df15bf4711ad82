//! The workspace: a zip with `scene.json` (our own document) and every photo and mesh beside it. It opens anywhere.
//!
//! Each file has a folder of its own; a mesh shares it with its textures and material libraries.

use std::collections::BTreeMap;
use std::io::{Cursor, Read, Write};
use std::sync::Arc;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use super::{
    Document, FileKind, FileWithCompanions, FormatError, NamedFile, classify, read_document, write_document,
};
use crate::scene::Scene;

/// Where the document is in the archive.
pub const DOCUMENT_NAME: &str = "scene.json";

/// All files of an archive together may not unpack to more...
const MAX_UNPACKED_BYTES: u64 = 512 << 20;
/// ...nor to so many times the archive, which no photos and meshes do, if that is more than what any archive may.
const MAX_RATIO: u64 = 100;
const HARMLESS_BYTES: u64 = 64 << 20;

/// An opened archive: the document, and the files that it speaks of still as bytes.
#[derive(Debug, Clone)]
pub struct Workspace {
    pub document: Document,
    pub files: Vec<FileWithCompanions>,
}

/// Packs a scene with everything it needs.
pub fn write_workspace(document: &Document, scene: &Scene) -> Result<Vec<u8>, FormatError> {
    let archive = |error: zip::result::ZipError| FormatError::Archive(error.to_string());
    let io = |error: std::io::Error| FormatError::Archive(error.to_string());
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let packed = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    // Photos are compressed already.
    let stored = packed.compression_method(CompressionMethod::Stored);

    writer.start_file(DOCUMENT_NAME, packed).map_err(archive)?;
    writer.write_all(write_document(document).as_bytes()).map_err(io)?;
    for file in scene.files() {
        let (folder, options) = if file.is_image { ("photos", stored) } else { ("meshes", packed) };
        // The hash keeps two files of one name apart; the document finds both by it.
        let prefix: String = file.sha256.to_string().chars().take(8).collect();
        let base = file.name.rsplit(['/', '\\']).next().unwrap_or(file.name);
        writer.start_file(format!("{folder}/{prefix}/{base}"), options).map_err(archive)?;
        writer.write_all(file.bytes).map_err(io)?;
        let mesh = scene.objects.iter().map(|object| &object.mesh).find(|mesh| mesh.sha256 == file.sha256);
        for companion in mesh.iter().flat_map(|mesh| &mesh.companions) {
            let base = companion.file_name.rsplit(['/', '\\']).next().unwrap_or_default();
            writer.start_file(format!("{folder}/{prefix}/{base}"), options).map_err(archive)?;
            writer.write_all(&companion.bytes).map_err(io)?;
        }
    }
    Ok(writer.finish().map_err(archive)?.into_inner())
}

/// A zip of files as they are, by their paths.
pub fn zip_of_files(files: &[(String, Arc<[u8]>)]) -> Result<Vec<u8>, FormatError> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    for (path, bytes) in files {
        let started = writer.start_file(path, options);
        started.map_err(|error| FormatError::Archive(error.to_string()))?;
        writer.write_all(bytes).map_err(|error| FormatError::Archive(error.to_string()))?;
    }
    let cursor = writer.finish().map_err(|error| FormatError::Archive(error.to_string()))?;
    Ok(cursor.into_inner())
}

/// Unpacks an archive within bounds.
pub fn read_workspace(bytes: &[u8]) -> Result<Workspace, FormatError> {
    let damaged = |error: zip::result::ZipError| FormatError::Archive(error.to_string());
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(damaged)?;
    let mut document = None;
    let mut files: Vec<(String, NamedFile)> = Vec::new();
    let most = (bytes.len() as u64).saturating_mul(MAX_RATIO).clamp(HARMLESS_BYTES, MAX_UNPACKED_BYTES);
    let mut budget = most;
    for index in 0..archive.len() {
        let entry = archive.by_index(index).map_err(damaged)?;
        if entry.is_dir() {
            continue;
        }
        let name = entry.name().map_err(damaged)?.into_owned();
        let too_much = || FormatError::Archive(format!("it unpacks to more than {} MiB", most >> 20));
        if entry.size() > budget {
            return Err(too_much());
        }
        let mut content = Vec::with_capacity(entry.size() as usize);
        // The declared size may lie; what is read cannot.
        let read = entry.take(budget + 1).read_to_end(&mut content);
        let length = read.map_err(|error| FormatError::Archive(format!("{name}: {error}")))? as u64;
        budget = budget.checked_sub(length).ok_or_else(too_much)?;
        if name == DOCUMENT_NAME {
            document = Some(read_document(&content)?);
        } else {
            let (folder, base) = name.rsplit_once('/').unwrap_or(("", &name));
            files.push((folder.to_owned(), NamedFile { name: base.to_owned(), bytes: Arc::from(content) }));
        }
    }
    let document = document.ok_or_else(|| {
        FormatError::at(
            DOCUMENT_NAME,
            "missing; only zips that were saved as a PinPose workspace can be opened",
        )
    })?;
    Ok(Workspace { document, files: with_folders(files) })
}

/// What is beside a mesh in a folder of its own goes with it.
fn with_folders(files: Vec<(String, NamedFile)>) -> Vec<FileWithCompanions> {
    let is_mesh = |file: &NamedFile| classify(&file.name, &file.bytes) == FileKind::Mesh;
    let mut companions_of: BTreeMap<String, Vec<NamedFile>> = BTreeMap::new();
    for (folder, _) in files.iter().filter(|(folder, file)| folder.starts_with("meshes/") && is_mesh(file)) {
        companions_of.insert(folder.clone(), Vec::new());
    }
    let mut own = Vec::new();
    for (folder, file) in files {
        match companions_of.get_mut(&folder) {
            Some(companions) if !is_mesh(&file) => companions.push(file),
            _ => own.push((folder, file)),
        }
    }
    own.into_iter()
        .map(|(folder, file)| FileWithCompanions {
            companions: if is_mesh(&file) { companions_of.get(&folder).cloned() } else { None }
                .unwrap_or_default(),
            file,
        })
        .collect()
}
