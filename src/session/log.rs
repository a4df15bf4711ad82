//! What was done to poses: a line per gesture, to look back at and to go back to.

use std::sync::Arc;

use crate::math::Pose;
use crate::scene::{ObjectId, PhotoId, PoseSource};

/// More lines than this nobody reads; the oldest go.
const MOST_ENTRIES: usize = 5000;

/// A pose as it was after a gesture.
#[derive(Debug, Clone, PartialEq)]
pub struct LogEntry {
    /// Milliseconds since 1970, UTC.
    pub time_ms: f64,
    pub photo: PhotoId,
    pub object: ObjectId,
    /// Names as they were then: what they belonged to may be gone.
    pub photo_name: Arc<str>,
    pub object_name: Arc<str>,
    pub label: &'static str,
    pub source: PoseSource,
    pub camera_from_object: Pose,
    /// Of what was done to many poses at once, in place of whose pose this is: where to look first.
    pub summary: Option<Arc<str>>,
}

/// The lines, oldest first. Clearing hides them, so that undo can bring them back.
#[derive(Debug, Default)]
pub struct Log {
    entries: Vec<LogEntry>,
    /// Entries before this one were cleared.
    pub cleared: usize,
}

impl Log {
    pub fn entries(&self) -> &[LogEntry] {
        self.entries.get(self.cleared..).unwrap_or_default()
    }

    pub fn push(&mut self, entry: LogEntry) {
        if self.entries.len() == MOST_ENTRIES {
            self.entries.remove(0);
            self.cleared = self.cleared.saturating_sub(1);
        }
        self.entries.push(entry);
    }

    /// A burst goes on: its line shows where it is now.
    pub fn replace_last(&mut self, entry: LogEntry) {
        if self.entries.len() > self.cleared {
            self.entries.pop();
        }
        self.push(entry);
    }

    pub fn clear(&mut self) {
        self.cleared = self.entries.len();
    }
}
