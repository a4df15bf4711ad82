//! The one error of this room. Who shows it puts the file's name before it.

use thiserror::Error;

use crate::math::{CameraError, PoseError};
use crate::mesh::MeshError;
use crate::photo::PhotoError;

#[derive(Debug, Error)]
pub enum FormatError {
    #[error(
        "not a file this version reads: a photo (PNG, JPEG, WebP, BMP, TIFF), a mesh (PLY, OBJ, STL, glTF, OFF), a camera (JSON, \
         .npy, OpenCV YAML, 3×3 text), poses (PinPose JSON, scene_gt.json, results CSV, .npy, Vision6D, 6D-PAT, MegaPose), a \
         PinPose workspace (zip) or the folder of a data set expected"
    )]
    Unknown,
    #[error(
        "a Python pickle, which could run code when it is opened and is therefore never read: save the camera as JSON \
         (fx, fy, cx, cy, width, height) or its matrix with numpy.save"
    )]
    Pickle,
    #[error("more than {megabytes} MiB of text: no camera and no poses of photos that somebody annotates")]
    TooMuchText { megabytes: usize },
    #[error("the file is empty")]
    Empty,
    #[error("not text: the bytes from {byte} on are not UTF-8")]
    NotText { byte: usize },
    #[error("line {line}, column {column}: {reason}")]
    Json { line: usize, column: usize, reason: String },
    #[error("{place}: {reason}")]
    At { place: String, reason: String },
    #[error(
        "a PinPose file of version {found}; this page reads up to version {supported}: reload the page to update it"
    )]
    Version { found: u64, supported: u64 },
    #[error("the archive is damaged: {0}")]
    Archive(String),
    #[error(transparent)]
    Photo(#[from] PhotoError),
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl FormatError {
    pub fn json(error: serde_json::Error) -> Self {
        let text = error.to_string();
        // serde_json repeats the position at the end of its message.
        let reason = text.split(" at line ").next().unwrap_or(&text).to_owned();
        Self::Json { line: error.line(), column: error.column(), reason }
    }

    pub fn at(place: impl Into<String>, reason: impl ToString) -> Self {
        Self::At { place: place.into(), reason: reason.to_string() }
    }

    pub fn camera(place: impl Into<String>, error: CameraError) -> Self {
        Self::at(place, error)
    }

    pub fn pose(place: impl Into<String>, error: PoseError) -> Self {
        Self::at(place, error)
    }
}
