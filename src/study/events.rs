//! What a participant did in a trial, gesture by gesture: enough to watch the trial again.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::PoseRecord;
use crate::math::{Pose, PoseError};

/// One thing that happened. In a file it is a list: `[milliseconds, kind]`, or with the pose that it left behind
/// `[milliseconds, kind, [r11, r12, r13, r21, …, r33, tx, ty, tz]]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// Since the trial was first shown, by the wall clock: pauses and hidden time are in it.
    pub at_ms: u64,
    pub kind: EventKind,
    /// `camera_from_object` after it, where it changed the pose: R row by row, then t in millimetres.
    pub pose: Option<[f64; 12]>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EventKind {
    /// The first complete frame.
    Shown,
    /// Gestures: each is counted.
    Move,
    Rotate,
    Depth,
    Handle,
    Nudge,
    Pin,
    PinRemoved,
    Snap,
    Numbers,
    Undo,
    Redo,
    Reset,
    /// Another tool was taken, another look or view chosen, the view moved.
    Tool,
    Look,
    View,
    /// The clock.
    Paused,
    Resumed,
    Hidden,
    Visible,
    /// The page came back after it was closed, reloaded or had crashed.
    Reopened,
    Confirmed,
    TimedOut,
    /// What none of these is.
    Other,
}

impl EventKind {
    /// Is it something that the participant did to the pose?
    pub fn is_gesture(self) -> bool {
        matches!(
            self,
            Self::Move
                | Self::Rotate
                | Self::Depth
                | Self::Handle
                | Self::Nudge
                | Self::Pin
                | Self::PinRemoved
                | Self::Snap
                | Self::Numbers
                | Self::Undo
                | Self::Redo
                | Self::Reset
                | Self::Other
        )
    }

    /// Its name in files.
    pub fn name(self) -> String {
        // Every variant is a plain string there.
        serde_json::to_value(self).ok().and_then(|name| name.as_str().map(str::to_owned)).unwrap_or_default()
    }
}

impl Event {
    pub fn new(at_ms: u64, kind: EventKind, pose: Option<Pose>) -> Self {
        Self { at_ms, kind, pose: pose.map(flat) }
    }

    /// The pose that it left behind, bit for bit.
    pub fn pose(&self) -> Option<Result<Pose, PoseError>> {
        let [a, b, c, d, e, f, g, h, i, x, y, z] = self.pose?;
        let record = PoseRecord { rotation: [[a, b, c], [d, e, f], [g, h, i]], translation_mm: [x, y, z] };
        Some(record.to_pose())
    }
}

fn flat(pose: Pose) -> [f64; 12] {
    let [[a, b, c], [d, e, f], [g, h, i]] = pose.rotation_rows();
    let [x, y, z] = pose.translation_mm.to_array();
    [a, b, c, d, e, f, g, h, i, x, y, z]
}

impl Serialize for Event {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.pose {
            Some(pose) => (self.at_ms, self.kind, pose).serialize(serializer),
            None => (self.at_ms, self.kind).serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Event {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Listed {
            WithPose(u64, EventKind, [f64; 12]),
            Without(u64, EventKind),
        }
        Ok(match Listed::deserialize(deserializer)? {
            Listed::WithPose(at_ms, kind, pose) => Self { at_ms, kind, pose: Some(pose) },
            Listed::Without(at_ms, kind) => Self { at_ms, kind, pose: None },
        })
    }
}
