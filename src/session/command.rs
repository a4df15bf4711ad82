//! What can be asked of a session.

use std::sync::Arc;

use glam::DVec2;
use thiserror::Error;

use super::{
    Answer, Batch, CommandId, DatasetImport, HalfPin, LogEntry, Nudge, NudgeSettings, Opening, Panes, Tool,
};
use crate::math::{Intrinsics, Pose};
use crate::mesh::MeshUnit;
use crate::scene::{
    CameraOrigin, Look, MaskId, MeshFrame, MeshFrameError, ObjectId, PhotoAsset, PhotoId, Pin, PoseSource,
    Rgb, SymmetryAxis,
};
use crate::solve::TwistCovariance;

/// One change. Only these change a session.
#[derive(Debug, Clone)]
pub enum Command {
    /// An entry of the command table.
    Run(CommandId),
    /// Files of one drop, read.
    Import(Box<Batch>),
    /// Masks for the photo that is shown, and for the selected object.
    ImportMasks(Vec<Arc<PhotoAsset>>),
    /// A depth map for the photo that is shown, in place of the one it has.
    ImportDepth(Arc<PhotoAsset>),
    /// A saved scene in place of this one.
    Open(Box<Opening>),
    /// A data set in place of this one.
    OpenDataset(Box<DatasetImport>),
    Answer(Answer),
    /// The unit of the meshes that [`super::Session::unit_question`] asks about.
    AnswerUnit(MeshUnit),
    /// What the scene is called; no undo step.
    RenameScene(String),

    ShowPhoto(PhotoId),
    Select(Option<ObjectId>),
    /// Adds an object to the selection, or takes it out.
    SelectAlso(ObjectId),
    SetTool(Tool),
    SetLook(Look),
    SetPanes(Panes),
    SetNudge(NudgeSettings),

    SetCamera {
        photo: PhotoId,
        camera: Intrinsics,
        origin: CameraOrigin,
    },
    /// A focal length by eye, `fx` in pixels: `fy` goes with it, and each object of the photo moves along the view so that it
    /// keeps its place and its size in the picture. Within a gesture it goes from where that began.
    SetFocal {
        photo: PhotoId,
        fx: f64,
    },
    /// Back to the last camera that was not typed: from a file, else the photo's EXIF data, else the assumed one.
    ResetCamera(PhotoId),
    EditPhoto(PhotoId, PhotoChange),
    EditObject(ObjectId, ObjectChange),
    EditMask(MaskId, MaskChange),
    RemovePhoto(PhotoId),
    RemoveObject(ObjectId),
    RemoveMask(MaskId),
    /// Puts an entry of a list before the one that is at this position now.
    MovePhoto(PhotoId, usize),
    MoveObject(ObjectId, usize),
    MoveMask(MaskId, usize),
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
    /// The selected object's pose, typed or pasted.
    SetPoseFromText(String),
    /// The selected object's pose as a reference has it.
    SetPoseFromReference {
        name: Arc<str>,
    },
    /// The poses that the selected objects have in another photo, in the one that is shown.
    CopyPosesFrom(PhotoId),
    /// So many steps of the selected object.
    Nudge(Nudge, f64),
    /// Small steps of one kind, less than half a second apart, are one undo step.
    Step {
        photo: PhotoId,
        object: ObjectId,
        camera_from_object: Pose,
        label: &'static str,
    },
    /// A new pin; it is the last of the pose's pins. Nothing moves yet.
    AddPin {
        photo: PhotoId,
        object: ObjectId,
        pin: Pin,
    },
    /// Half of a pin: what comes next is its other half. `None`: never mind.
    BeginPin(Option<HalfPin>),
    /// Both halves of a pin: it is added, and the pose follows.
    CompletePin {
        photo: PhotoId,
        object: ObjectId,
        pin: Pin,
    },
    /// Brings a pin's point to a pixel, within a gesture: the pose follows.
    DragPin {
        photo: PhotoId,
        object: ObjectId,
        pin: usize,
        pixel: DVec2,
    },
    /// Changes the selected pose's pins; the pose follows.
    EditPins(PinChange),
    /// How well the photo supports the poses that a pose's pins allow, from 0 to 1; `None` where too little of the object is in
    /// it. Nothing of the scene changes.
    NoteFitScores {
        photo: PhotoId,
        object: ObjectId,
        scores: Vec<(Pose, Option<f64>)>,
    },
    /// The pose that the photo supports best near the present one.
    TakeSnap {
        photo: PhotoId,
        object: ObjectId,
        camera_from_object: Pose,
        /// How sure the snap is of it.
        covariance: Option<Box<TwistCovariance>>,
    },
    /// How sure a snap is of a pose that it found no better one for. Nothing of the scene changes.
    NoteSnap {
        photo: PhotoId,
        object: ObjectId,
        covariance: Option<Box<TwistCovariance>>,
    },
    /// Snaps of several poses, as one step; those that are locked or confirmed by now stay.
    TakeSnaps {
        snaps: Vec<((PhotoId, ObjectId), Pose, Option<TwistCovariance>)>,
        /// For the log, with the pose that is to be looked at first.
        summary: Arc<str>,
        least_sure: (PhotoId, ObjectId),
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
    /// The pose of a line of the log, in its photo.
    ReturnTo(Box<LogEntry>),
}

#[derive(Debug, Clone, PartialEq)]
pub enum PhotoChange {
    Name(String),
    Visible(bool),
    Opacity(f32),
    Locked(bool),
    /// Millimetres a step of the depth map.
    DepthScale(f64),
    /// Whether what is behind the depth map is hidden.
    DepthOccludes(bool),
    WithoutDepth,
}

#[derive(Debug, Clone, PartialEq)]
pub enum ObjectChange {
    Name(String),
    Color(Rgb),
    Opacity(f32),
    Visible(bool),
    Locked(bool),
    MeshFrame(MeshFrame),
    /// The unit of its file's numbers, for all objects of that file.
    MeshUnit(MeshUnit),
    /// Which of its file's axes (0 to 2) points up, for all objects of that file.
    UpAxis(usize),
    /// For all objects of its mesh's file, with all that follows from it.
    AddSymmetry(SymmetryAxis),
    RemoveSymmetry(SymmetryAxis),
}

#[derive(Debug, Clone, PartialEq)]
pub enum MaskChange {
    Name(String),
    Color(Rgb),
    Opacity(f32),
    Visible(bool),
    Object(Option<ObjectId>),
}

#[derive(Debug, Clone, PartialEq)]
pub enum PinChange {
    Enabled(usize, bool),
    Remove(usize),
    /// Another set of pins in place of these.
    Replace(Vec<Pin>),
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
    #[error("there is no mask with the id {}", .0.0)]
    NoMask(MaskId),
    #[error("{0} is not in this photo")]
    NotInPhoto(String),
    #[error("{0} is locked")]
    Locked(String),
    #[error("{0} is confirmed in this photo: reopen it to change its pose")]
    Confirmed(String),
    #[error(transparent)]
    MeshFrame(#[from] MeshFrameError),
    #[error("{0}")]
    Failed(String),
}
