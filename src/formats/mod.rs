//! Files to data and back. Foreign axes, units and orders end here.
//!
//! Knows nothing of the interface: bytes and names in, [`Parsed`] or one [`FormatError`] out.

mod archive;
mod bop;
mod camera;
mod companions;
pub mod dataset;
mod document;
mod error;
pub mod export;
mod file_key;
mod gather;
mod incoming;
mod json;
mod kind;
mod matching;
mod megapose;
mod npy;
mod own_poses;
mod pins;
mod pose_array;
mod pose_text;
mod sixdpat;
mod vision6d;
mod workspace;
mod yaml;

use std::sync::Arc;

use crate::scene::{MeshAsset, PhotoAsset, Pin, file_stem};

pub use archive::Archive;
pub use camera::{CameraFile, read_camera};
pub use companions::{FileWithCompanions, kept, with_companions};
pub use document::{DOCUMENT_SCHEMA, Document, Keep, ViewSettings, read_document, write_document};
pub use error::FormatError;
pub use file_key::FileKey;
pub use incoming::{Incoming, IncomingCamera, IncomingObject, IncomingPhoto, IncomingPose, PosesAs};
pub use kind::{FileKind, classify};
pub use matching::Outcome;
pub use pins::{positive_number, read_pins, write_pins};
pub use pose_text::{PoseText, read_pose_text, write_pose_text};
pub use workspace::{DOCUMENT_NAME, Workspace, read_workspace, write_workspace, zip_of_files};

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
    /// Pins for the selected object in the photo that is shown.
    Pins(Vec<Pin>),
    Workspace(Workspace),
}

/// Reads the small text files and archives; photos and meshes, which take their time, have functions of their own.
pub fn parse_text_or_archive(file: &NamedFile, kind: FileKind) -> Result<Parsed, FormatError> {
    let (name, bytes) = (file.name.as_str(), &*file.bytes);
    match kind {
        FileKind::Workspace => Ok(Parsed::Workspace(read_workspace(bytes)?)),
        FileKind::Vision6dTruth => Ok(Parsed::Poses(vision6d::read_ground_truth(name, text(bytes)?)?)),
        FileKind::Json => json::parse_json(file),
        FileKind::Npy => parse_array(name, &npy::read_npy(bytes)?),
        FileKind::Yaml => Ok(Parsed::Camera(camera::read_opencv_yaml(name, text(bytes)?)?)),
        FileKind::Csv => parse_csv(name, text(bytes)?).map(Parsed::Poses),
        FileKind::Matrix => parse_array(name, &camera::read_matrix_text(text(bytes)?)?),
        FileKind::Pickle => Err(FormatError::Pickle),
        FileKind::Photo | FileKind::Mesh | FileKind::Unknown => Err(FormatError::Unknown),
    }
}

fn parse_csv(name: &str, text: &str) -> Result<Incoming, FormatError> {
    if own_poses::is_poses_csv(text) {
        return own_poses::read_poses_csv(name, text);
    }
    bop::read_results(name, text)
}

/// A 3×3 is a camera, a 4×4 a pose.
fn parse_array(name: &str, array: &npy::NpyArray) -> Result<Parsed, FormatError> {
    if array.shape == [3, 3] {
        return camera::read_matrix_array(name, array).map(Parsed::Camera);
    }
    pose_array::read_pose_array(name, array).map(Parsed::Poses)
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
        exif_focal: decoded.exif_focal,
    };
    Ok((asset, decoded.pixels))
}

/// A photo's file by its header alone: its pixels are decoded when it is looked at.
pub fn read_photo_header(file: &NamedFile) -> Result<PhotoAsset, FormatError> {
    let header = crate::photo::read_header(&file.bytes)?;
    Ok(PhotoAsset {
        file_name: file.name.clone(),
        sha256: crate::scene::Sha256::of(&file.bytes),
        bytes: file.bytes.clone(),
        width: header.width,
        height: header.height,
        exif_focal: header.exif_focal,
    })
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
    let asset = MeshAsset {
        file_name: file.name.clone(),
        sha256: crate::scene::Sha256::of(&file.bytes),
        bytes: file.bytes.clone(),
        companions: companions::kept(companions),
        mesh: loaded.mesh,
        search_tree: crate::mesh::SearchTree::default(),
        untransformed: None,
        drawn: crate::mesh::DrawnAhead::default(),
    };
    Ok((asset, loaded.warnings))
}
