//! Poses and cameras on their way into a scene, with the files they speak of named but not yet found.

use glam::DMat4;

use super::{CameraFile, Document, FileKey, FormatError};
use crate::math::{Intrinsics, Pose};
use crate::scene::{AnnotationState, CameraOrigin, MeshAsset, Pin, PoseSource, Rgb, Symmetries};

/// What an import's poses are to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PosesAs {
    /// The user's own: start poses to go on from, or a saved state to return to.
    Annotations,
    /// A read-only set beside them.
    Reference,
}

/// Everything a file of poses says.
#[derive(Debug, Clone, PartialEq)]
pub struct Incoming {
    pub file_name: String,
    pub photos: Vec<IncomingPhoto>,
    pub objects: Vec<IncomingObject>,
    pub references: Vec<IncomingReference>,
    /// A camera for photos that are still to come.
    pub cameras_to_come: Option<CameraFile>,
    /// What was corrected while reading.
    pub remarks: Vec<String>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct IncomingPhoto {
    pub key: FileKey,
    pub camera: Option<IncomingCamera>,
    /// `None`: as the scene has it.
    pub look: Option<PhotoLook>,
    pub poses: Vec<IncomingPose>,
}

#[derive(Debug, Clone, PartialEq)]
pub enum IncomingCamera {
    /// A foreign camera, which may be of another size than the photo.
    File(CameraFile),
    /// Our own, which says where it came from.
    Exact(Intrinsics, CameraOrigin),
}

#[derive(Debug, Clone, PartialEq)]
pub struct IncomingObject {
    pub key: FileKey,
    /// `None`: as the scene has it.
    pub mesh_from_file: Option<DMat4>,
    /// In the `object` frame; `None`: as the scene has it.
    pub symmetries: Option<Symmetries>,
    pub look: Option<ObjectLook>,
}

/// How an object was shown.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectLook {
    pub name: String,
    pub color: Rgb,
    pub opacity: f32,
    pub visible: bool,
    pub locked: bool,
    pub link: Option<u32>,
}

/// How a photo was shown.
#[derive(Debug, Clone, PartialEq)]
pub struct PhotoLook {
    /// `None`: its file's.
    pub name: Option<String>,
    pub visible: bool,
    pub opacity: f32,
    pub locked: bool,
}

#[derive(Debug, Clone, PartialEq)]
pub struct IncomingPose {
    /// Index into [`Incoming::objects`].
    pub object: usize,
    pub camera_from_object: Pose,
    pub state: AnnotationState,
    pub source: PoseSource,
    /// `None`: now.
    pub changed_at_ms: Option<f64>,
    /// How sure whoever estimated it was.
    pub score: Option<f64>,
    pub pins: Vec<Pin>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct IncomingReference {
    pub name: String,
    pub visible: bool,
    /// Indices into [`Incoming::photos`] and [`Incoming::objects`].
    pub poses: Vec<(usize, usize, Pose)>,
}

impl IncomingPose {
    /// One from a foreign file: somebody estimated or annotated it, when and how is not known.
    pub fn foreign(object: usize, camera_from_object: Pose, score: Option<f64>) -> Self {
        Self {
            object,
            camera_from_object,
            state: AnnotationState::Posed,
            source: PoseSource::Imported,
            changed_at_ms: None,
            score: score.filter(|score| score.is_finite()),
            pins: Vec::new(),
        }
    }
}

impl IncomingObject {
    pub fn named(key: FileKey) -> Self {
        Self { key, mesh_from_file: None, symmetries: None, look: None }
    }
}

impl Incoming {
    pub fn new(file_name: &str) -> Self {
        Self {
            file_name: file_name.to_owned(),
            photos: Vec::new(),
            objects: Vec::new(),
            references: Vec::new(),
            cameras_to_come: None,
            remarks: Vec::new(),
        }
    }

    /// The index of the object with this stem, made where it is new.
    pub fn object_with(&mut self, make: impl FnOnce() -> IncomingObject, stem: &str) -> usize {
        let known = self.objects.iter().position(|object| object.key.stem() == stem);
        known.unwrap_or_else(|| {
            self.objects.push(make());
            self.objects.len() - 1
        })
    }

    /// Does it say how this mesh's file is meant: its unit and its axes?
    pub fn says_frame_of(&self, mesh: &MeshAsset) -> bool {
        self.objects
            .iter()
            .any(|object| object.mesh_from_file.is_some() && object.key.names_mesh(mesh, false))
    }

    pub fn pose_count(&self) -> usize {
        self.photos.iter().map(|photo| photo.poses.len()).sum()
    }

    /// Takes over what one of our own documents says.
    pub fn from_document(file_name: &str, document: &Document) -> Result<Self, FormatError> {
        document.to_incoming(file_name)
    }
}
