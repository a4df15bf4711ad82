//! A pose with its history in three words: what state it is in, where it came from, and when.

use super::Pin;
use crate::math::Pose;

/// From the least that was done to the most.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum AnnotationState {
    /// At the start pose; nobody has moved it.
    Untouched,
    /// Taken over from another photo; nobody has looked at it.
    Carried,
    Posed,
    Confirmed,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoseSource {
    Manual,
    Pins,
    Snap,
    Tracked,
    Imported,
}

/// The pose of one object in one photo.
#[derive(Debug, Clone, PartialEq)]
pub struct Annotation {
    pub camera_from_object: Pose,
    pub state: AnnotationState,
    pub source: PoseSource,
    /// When the pose last changed: milliseconds since 1970, UTC.
    pub changed_at_ms: f64,
    /// The photo's intrinsics changed after the pose was set: it wants a second look.
    pub camera_changed: bool,
    /// How sure the program was that estimated an imported pose, in that program's own terms.
    pub score: Option<f64>,
    /// They stay when the pose is changed by other means.
    pub pins: Vec<Pin>,
}

impl Annotation {
    pub fn untouched(camera_from_object: Pose, changed_at_ms: f64) -> Self {
        Self {
            camera_from_object,
            state: AnnotationState::Untouched,
            source: PoseSource::Manual,
            changed_at_ms,
            camera_changed: false,
            score: None,
            pins: Vec::new(),
        }
    }
}
