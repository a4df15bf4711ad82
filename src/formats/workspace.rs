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
use crate::scene::{Scene, Sha256};

/// Where the document is in the archive.
const DOCUMENT_NAME: &str = "scene.json";

/// All files of an archive together may not unpack to more.
const MAX_UNPACKED_BYTES: u64 = 512 << 20;

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
    let photos = scene.photos.iter().map(|photo| {
        let asset = &photo.asset;
        ("photos", &asset.file_name, asset.sha256, &asset.bytes, stored)
    });
    let meshes = scene.objects.iter().map(|object| {
        let asset = &object.mesh;
        ("meshes", &asset.file_name, asset.sha256, &asset.bytes, packed)
    });
    let mut written: Vec<Sha256> = Vec::new();
    for (folder, name, sha256, bytes, options) in photos.chain(meshes) {
        if written.contains(&sha256) {
            continue;
        }
        written.push(sha256);
        // The hash keeps two files of one name apart; the document finds both by it.
        let prefix: String = sha256.to_string().chars().take(8).collect();
        let base = name.rsplit(['/', '\\']).next().unwrap_or(name);
        writer.start_file(format!("{folder}/{prefix}/{base}"), options).map_err(archive)?;
        writer.write_all(bytes).map_err(io)?;
        let mesh = scene.objects.iter().map(|object| &object.mesh).find(|mesh| mesh.sha256 == sha256);
        for companion in mesh.iter().flat_map(|mesh| &mesh.companions) {
            let base = companion.file_name.rsplit(['/', '\\']).next().unwrap_or_default();
            writer.start_file(format!("{folder}/{prefix}/{base}"), options).map_err(archive)?;
            writer.write_all(&companion.bytes).map_err(io)?;
        }
    }
    Ok(writer.finish().map_err(archive)?.into_inner())
}

/// Unpacks an archive within bounds.
pub fn read_workspace(bytes: &[u8]) -> Result<Workspace, FormatError> {
    let damaged = |error: zip::result::ZipError| FormatError::Archive(error.to_string());
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(damaged)?;
    let mut document = None;
    let mut files: Vec<(String, NamedFile)> = Vec::new();
    let mut budget = MAX_UNPACKED_BYTES;
    for index in 0..archive.len() {
        let entry = archive.by_index(index).map_err(damaged)?;
        if entry.is_dir() {
            continue;
        }
        let name = entry.name().map_err(damaged)?.into_owned();
        let mut content = Vec::new();
        // The declared size may lie; what is read cannot.
        let read = entry.take(budget + 1).read_to_end(&mut content);
        let length = read.map_err(|error| FormatError::Archive(format!("{name}: {error}")))? as u64;
        budget = budget.checked_sub(length).ok_or_else(|| {
            FormatError::Archive(format!("it unpacks to more than {} MiB", MAX_UNPACKED_BYTES >> 20))
        })?;
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
