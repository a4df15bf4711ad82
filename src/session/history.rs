//! Undo and redo by snapshots of the whole scene, one per gesture.

use crate::scene::{ObjectId, PhotoId, Scene};

/// Snapshots share photos and meshes; what is their own is some hundred bytes per pose. At a thousand poses this many steps
/// stay below about 200 MB, and below one for a usual scene.
const MAX_STEPS: usize = 1000;

/// Steps of one kind that follow within this time are one.
const BURST_MS: f64 = 500.0;

/// The scene, and what was on screen when it was so.
#[derive(Debug, Clone)]
pub struct Snapshot {
    pub scene: Scene,
    pub photo: Option<PhotoId>,
    pub selected: Option<ObjectId>,
}

/// A run of small steps that may go on.
#[derive(Debug, Clone, PartialEq)]
pub struct Burst {
    pub label: &'static str,
    pub photo: PhotoId,
    pub object: ObjectId,
    pub last_ms: f64,
}

impl Burst {
    /// Does `next` go on with this run?
    pub fn continues(&self, next: &Self) -> bool {
        let same = (self.label, self.photo, self.object) == (next.label, next.photo, next.object);
        same && next.last_ms - self.last_ms < BURST_MS
    }
}

#[derive(Debug)]
struct Step {
    label: String,
    snapshot: Snapshot,
}

/// What was before, and what was undone.
#[derive(Debug, Default)]
pub struct History {
    undo: Vec<Step>,
    redo: Vec<Step>,
}

impl History {
    /// Remembers how things were before a change.
    pub fn push(&mut self, label: impl Into<String>, before: Snapshot) {
        self.redo.clear();
        if self.undo.len() == MAX_STEPS {
            self.undo.remove(0);
        }
        self.undo.push(Step { label: label.into(), snapshot: before });
    }

    /// The state before the last change, given the present one.
    pub fn undo(&mut self, present: Snapshot) -> Option<Snapshot> {
        let step = self.undo.pop()?;
        self.redo.push(Step { label: step.label, snapshot: present });
        Some(step.snapshot)
    }

    pub fn redo(&mut self, present: Snapshot) -> Option<Snapshot> {
        let step = self.redo.pop()?;
        self.undo.push(Step { label: step.label, snapshot: present });
        Some(step.snapshot)
    }

    /// Gives all scenes one name.
    pub fn name_scenes(&mut self, name: &str) {
        for step in self.undo.iter_mut().chain(&mut self.redo) {
            name.clone_into(&mut step.snapshot.scene.name);
        }
    }

    pub fn undo_label(&self) -> Option<&str> {
        self.undo.last().map(|step| step.label.as_str())
    }

    pub fn redo_label(&self) -> Option<&str> {
        self.redo.last().map(|step| step.label.as_str())
    }
}
