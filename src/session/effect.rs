//! What a session asks of the world outside and of its user.

use std::sync::Arc;

use crate::formats::{CameraFile, Incoming, PosesAs};
use crate::scene::{ObjectId, PhotoId};
use crate::solve::snap::SnapReach;

/// What only the world outside can do.
#[derive(Debug, Clone, PartialEq)]
pub enum Effect {
    PickFiles(Pick),
    PickFolder,
    LoadExample,
    Download {
        file_name: String,
        bytes: Arc<[u8]>,
    },
    /// A picture at the photo's resolution, to be drawn and downloaded.
    ExportPicture(PictureRequest),
    CopyText(String),
    /// Refine this pose to its photo.
    Snap {
        photo: PhotoId,
        object: ObjectId,
        reach: SnapReach,
    },
    /// Refine these poses to their photos.
    SnapAll(Vec<(PhotoId, ObjectId)>),
    /// Look for the symmetries of an object's mesh.
    FindSymmetries(ObjectId),
    /// The clipboard can be read in answer to a key alone; else the user is given a field to paste into.
    AskForPose,
    AskForExport,
    BuildStudy,
    /// A study that was exported, to be changed.
    PickStudy,
    /// The example study, as its participants see it.
    ShowExampleStudy,
    /// Results that are kept here.
    ShowKeptResults,
    /// A report of results, from their files.
    ShowStudyReport,
    /// A study and a participant's results, to be watched.
    PickResults,
    NewScene,
    ShowScenes,
    SaveNow,
    AskSaveAs,
    ZoomToObject,
    FitPhoto,
    ResetSceneView,
    TogglePanels,
    ToggleShortcuts,
    TogglePalette,
    ToggleTheme,
    RenameSelected,
    Notify(Notice),
}

/// What a file picker is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pick {
    Anything,
    Photos,
    Meshes,
    Masks,
    DepthMap,
    Cameras,
    Poses,
    Workspace,
}

/// What an exported picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PictureKind {
    Overlay,
    Mask,
    VisibleMask,
    Depth,
}

#[derive(Debug, Clone, PartialEq)]
pub struct PictureRequest {
    pub kind: PictureKind,
    pub photo: PhotoId,
    /// For masks.
    pub object: Option<ObjectId>,
    pub file_name: String,
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
    /// Are these poses to go on from, or to compare with? One choice for all files of a drop.
    PosesAs(Vec<Incoming>),
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
