//! What can be asked of a session, and what it asks in return.

use std::sync::Arc;

use thiserror::Error;

use super::{Batch, CommandId, Opening, Tool};
use crate::formats::{CameraFile, Incoming, PosesAs};
use crate::math::{Intrinsics, Pose};
use crate::scene::{CameraOrigin, ObjectId, PhotoId, PoseSource};

/// One change. Only these change a session.
#[derive(Debug, Clone)]
pub enum Command {
    /// An entry of the command table.
    Run(CommandId),
    /// Files of one drop, read.
    Import(Box<Batch>),
    /// A saved scene in place of this one.
    Open(Box<Opening>),
    Answer(Answer),

    /// What the scene is called; no undo step.
    NameScene(String),
    ShowPhoto(PhotoId),
    Select(Option<ObjectId>),
    SetTool(Tool),
    SetOverlayOpacity(f32),

    SetCamera {
        photo: PhotoId,
        camera: Intrinsics,
        origin: CameraOrigin,
    },
    RemovePhoto(PhotoId),
    RemoveObject(ObjectId),
    SetObjectVisible(ObjectId, bool),
    SetObjectLocked(ObjectId, bool),
    SetReferenceVisible {
        name: Arc<str>,
        visible: bool,
    },
    RemoveReference {
        name: Arc<str>,
    },

    /// Puts an object into a photo at the start pose.
    Place {
        photo: PhotoId,
        object: ObjectId,
    },
    /// Takes an object out of a photo.
    Withdraw {
        photo: PhotoId,
        object: ObjectId,
    },
    SetPose {
        photo: PhotoId,
        object: ObjectId,
        camera_from_object: Pose,
        source: PoseSource,
    },
    /// Small steps of one kind, less than half a second apart, are one undo step.
    Nudge {
        photo: PhotoId,
        object: ObjectId,
        camera_from_object: Pose,
        label: &'static str,
    },
    BeginGesture(&'static str),
    /// A pose within a gesture.
    Drag {
        photo: PhotoId,
        object: ObjectId,
        camera_from_object: Pose,
    },
    EndGesture,
    /// Puts everything back to where the gesture began.
    CancelGesture,
}

/// What only the world outside can do.
#[derive(Debug, Clone, PartialEq)]
pub enum Effect {
    PickFiles,
    LoadExample,
    Download { file_name: String, bytes: Arc<[u8]> },
    ZoomToObject,
    FitPhoto,
    TogglePanels,
    ToggleShortcuts,
    Notify(Notice),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    Info,
    Warning,
    Error,
}

/// One message to the user.
#[derive(Debug, Clone, PartialEq)]
pub struct Notice {
    pub severity: Severity,
    pub text: String,
}

impl Notice {
    pub fn info(text: impl Into<String>) -> Self {
        Self { severity: Severity::Info, text: text.into() }
    }

    pub fn warning(text: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, text: text.into() }
    }

    pub fn error(text: impl Into<String>) -> Self {
        Self { severity: Severity::Error, text: text.into() }
    }
}

/// What the user has to decide before an import goes on.
#[derive(Debug, Clone, PartialEq)]
pub enum Question {
    /// Are these poses to go on from, or to compare with?
    PosesAs(Incoming),
    /// The camera is for an image of another size than the photos'.
    CameraSize { file: CameraFile, photos: Vec<PhotoId> },
}

/// The answer to the question that is open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    UsePosesAs(PosesAs),
    ScaleCamera,
    /// Leave the import out.
    Refuse,
}

/// Why a command was not carried out; nothing has changed then.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CommandError {
    #[error("{0} is not possible now: {1}")]
    NotAvailable(&'static str, &'static str),
    #[error("there is no photo with the id {}", .0.0)]
    NoPhoto(PhotoId),
    #[error("there is no object with the id {}", .0.0)]
    NoObject(ObjectId),
    #[error("{0} is not in this photo")]
    NotInPhoto(String),
    #[error("{0} is locked")]
    Locked(String),
    #[error("{0}")]
    Failed(String),
}
