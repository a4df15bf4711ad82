//! Files to data and back. Foreign axes, units and orders end here.
//!
//! Knows nothing of the interface: bytes and names in, [`Parsed`] or one [`FormatError`] out.

mod camera_json;
mod companions;
mod document;
mod error;
mod incoming;
mod kind;
mod matching;
mod pose_text;
mod vision6d;
mod workspace;

use std::sync::Arc;

use crate::scene::{MeshAsset, PhotoAsset};

pub use camera_json::{CameraFile, read_camera};
pub use companions::{FileWithCompanions, kept, with_companions};
pub use document::{DOCUMENT_SCHEMA, Document, Keep, ViewSettings, read_document, write_document};
pub use error::FormatError;
pub use incoming::{Incoming, IncomingCamera, IncomingObject, IncomingPhoto, IncomingPose, PosesAs};
pub use kind::{FileKind, classify};
pub use matching::{FileKey, Outcome};
pub use pose_text::{PoseText, read_pose_text, write_pose_text};
pub use workspace::{Workspace, read_workspace, write_workspace};

/// A file as it came from a drop, a picker, an archive or the command line.
#[derive(Debug, Clone)]
pub struct NamedFile {
    pub name: String,
    pub bytes: Arc<[u8]>,
}

/// What a file turned out to be.
#[derive(Debug, Clone)]
pub enum Parsed {
    Photo(Arc<PhotoAsset>),
    Mesh(Arc<MeshAsset>),
    Camera(CameraFile),
    Poses(Incoming),
    Workspace(Workspace),
}

/// Reads the small text files and archives; photos and meshes, which take their time, have functions of their own.
pub fn parse_text_or_archive(file: &NamedFile, kind: FileKind) -> Result<Parsed, FormatError> {
    match kind {
        FileKind::Workspace => Ok(Parsed::Workspace(read_workspace(&file.bytes)?)),
        FileKind::Vision6dTruth => {
            Ok(Parsed::Poses(vision6d::read_ground_truth(&file.name, text(&file.bytes)?)?))
        }
        FileKind::Json => parse_json(file),
        FileKind::Photo | FileKind::Mesh | FileKind::Unknown => Err(FormatError::Unknown),
    }
}

fn parse_json(file: &NamedFile) -> Result<Parsed, FormatError> {
    let value: serde_json::Value = serde_json::from_slice(&file.bytes).map_err(FormatError::json)?;
    if value.get("format").is_some() {
        let document = read_document(&file.bytes)?;
        return Ok(Parsed::Poses(Incoming::from_document(&file.name, &document)?));
    }
    camera_json::read_camera(&file.name, &value).map(Parsed::Camera)
}

fn text(bytes: &[u8]) -> Result<&str, FormatError> {
    std::str::from_utf8(bytes).map_err(|error| FormatError::NotText { byte: error.valid_up_to() })
}

/// Decodes a photo's file.
pub fn read_photo(file: &NamedFile) -> Result<(PhotoAsset, crate::photo::Pixels), FormatError> {
    let decoded = crate::photo::decode(&file.bytes)?;
    let asset = PhotoAsset {
        file_name: file.name.clone(),
        sha256: crate::scene::Sha256::of(&file.bytes),
        bytes: file.bytes.clone(),
        width: decoded.pixels.width,
        height: decoded.pixels.height,
        exif_focal_px: decoded.exif_focal_px,
    };
    Ok((asset, decoded.pixels))
}

/// Parses a mesh's file that came alone; the second value is what was odd about it.
pub fn read_mesh(file: &NamedFile) -> Result<(MeshAsset, Vec<String>), FormatError> {
    read_mesh_with(file, &[])
}

/// Parses a mesh's file and takes its textures from those that came with it.
pub fn read_mesh_with(
    file: &NamedFile,
    companions: &[NamedFile],
) -> Result<(MeshAsset, Vec<String>), FormatError> {
    let find = |key: &str| companions::find_among(companions, key);
    let loaded = crate::mesh::load(&file.name, &file.bytes, &find)?;
    let bvh = crate::mesh::Bvh::build(&loaded.mesh);
    let asset = MeshAsset {
        file_name: file.name.clone(),
        sha256: crate::scene::Sha256::of(&file.bytes),
        bytes: file.bytes.clone(),
        companions: companions::kept(companions),
        mesh: loaded.mesh,
        bvh,
    };
    Ok((asset, loaded.warnings))
}
