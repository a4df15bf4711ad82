//! The workspace: a zip with `scene.json` (our own document) and every photo and mesh beside it. It opens anywhere.

use std::io::{Cursor, Read, Write};
use std::sync::Arc;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use super::{Document, FormatError, NamedFile, read_document, write_document};
use crate::scene::Scene;

/// Where the document is in the archive.
const DOCUMENT_NAME: &str = "scene.json";

/// All files of an archive together may not unpack to more.
const MAX_UNPACKED_BYTES: u64 = 512 << 20;

/// An opened archive: the document, and the files that it speaks of still as bytes.
#[derive(Debug, Clone)]
pub struct Workspace {
    pub document: Document,
    pub files: Vec<NamedFile>,
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
    }
    Ok(writer.finish().map_err(archive)?.into_inner())
}

/// Unpacks an archive within bounds.
pub fn read_workspace(bytes: &[u8]) -> Result<Workspace, FormatError> {
    let damaged = |error: zip::result::ZipError| FormatError::Archive(error.to_string());
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(damaged)?;
    let mut document = None;
    let mut files = Vec::new();
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
            let base = name.rsplit('/').next().unwrap_or(&name).to_owned();
            files.push(NamedFile { name: base, bytes: Arc::from(content) });
        }
    }
    let document = document.ok_or_else(|| {
        FormatError::at(
            DOCUMENT_NAME,
            "missing; only zips that were saved as a PinPose workspace can be opened",
        )
    })?;
    Ok(Workspace { document, files })
}
