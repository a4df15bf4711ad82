//! Undo and redo by snapshots of the whole scene, one per gesture.

use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;

use crate::scene::{ObjectId, PhotoId, Scene};

/// Snapshots share photos and meshes; what is their own is some hundred bytes per pose, photo and object, and a mesh that
/// was mirrored or spaced since. All steps together may take this much; the oldest go first. At ten photos and ten objects
/// it is enough for about five thousand steps.
pub const MAX_BYTES: usize = 128 << 20;

/// What a photo, an object, a pose of a snapshot take, rounded up from their sizes with their names and tree nodes.
const BYTES_PER_PART: usize = 320;

/// Steps of one kind that follow within this time are one.
const BURST_MS: f64 = 500.0;

/// The scene, and what was on screen when it was so.
#[derive(Debug, Clone)]
pub struct Snapshot {
    pub scene: Scene,
    pub photo: Option<PhotoId>,
    pub selected: Option<ObjectId>,
    pub also_selected: BTreeSet<ObjectId>,
    /// How many lines of the log were cleared.
    pub log_cleared: usize,
}

/// What a run of small steps is about: steps of the same are one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BurstKey {
    pub label: &'static str,
    pub photo: Option<PhotoId>,
    /// The object, mask or other thing that changes.
    pub target: u32,
}

/// A run of small steps that may go on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Burst {
    pub key: BurstKey,
    pub last_ms: f64,
}

impl Burst {
    /// Does a step at `now_ms` go on with this run?
    pub fn continues(&self, key: &BurstKey, now_ms: f64) -> bool {
        self.key == *key && now_ms - self.last_ms < BURST_MS
    }
}

#[derive(Debug)]
struct Step {
    label: String,
    /// Counted up, so that no two steps are taken for each other.
    number: u64,
    snapshot: Snapshot,
    bytes: usize,
}

/// What was before, and what was undone.
#[derive(Debug, Default)]
pub struct History {
    undo: VecDeque<Step>,
    redo: Vec<Step>,
    undo_bytes: usize,
    steps_so_far: u64,
}

impl History {
    /// Remembers how things were before a change.
    pub fn push(&mut self, label: impl Into<String>, before: Snapshot) {
        self.redo.clear();
        let bytes = self.bytes_of(&before);
        self.push_step(label.into(), before, bytes);
        while self.undo_bytes > MAX_BYTES && self.undo.len() > 1 {
            self.undo_bytes -= self.undo.pop_front().map_or(0, |step| step.bytes);
        }
    }

    /// The state before the last change, given the present one.
    pub fn undo(&mut self, present: Snapshot) -> Option<Snapshot> {
        let step = self.undo.pop_back()?;
        self.undo_bytes -= step.bytes;
        let Step { label, number, snapshot, bytes } = step;
        self.redo.push(Step { label, number, snapshot: present, bytes });
        Some(snapshot)
    }

    pub fn redo(&mut self, present: Snapshot) -> Option<Snapshot> {
        let step = self.redo.pop()?;
        self.push_step(step.label, present, step.bytes);
        Some(step.snapshot)
    }

    /// Gives all scenes one name.
    pub fn rename_scenes(&mut self, name: &str) {
        for step in self.undo.iter_mut().chain(&mut self.redo) {
            name.clone_into(&mut step.snapshot.scene.name);
        }
    }

    /// Which step undo would take back.
    pub fn newest(&self) -> Option<u64> {
        self.undo.back().map(|step| step.number)
    }

    pub fn undo_label(&self) -> Option<&str> {
        self.undo.back().map(|step| step.label.as_str())
    }

    pub fn redo_label(&self) -> Option<&str> {
        self.redo.last().map(|step| step.label.as_str())
    }

    fn push_step(&mut self, label: String, snapshot: Snapshot, bytes: usize) {
        self.undo_bytes += bytes;
        self.steps_so_far += 1;
        self.undo.push_back(Step { label, number: self.steps_so_far, snapshot, bytes });
    }

    /// What a snapshot keeps alive that the one before it does not.
    fn bytes_of(&self, snapshot: &Snapshot) -> usize {
        let scene = &snapshot.scene;
        let references: usize = scene.references.iter().map(|reference| reference.poses.len() + 1).sum();
        let parts = scene.photos.len()
            + scene.objects.len()
            + scene.masks.len()
            + scene.annotations.len()
            + references
            + 1;
        let before = self.undo.back().map(|step| &step.snapshot.scene);
        let shared = |object: &crate::scene::Object| {
            before
                .and_then(|before| before.object(object.id))
                .is_some_and(|same| Arc::ptr_eq(&same.mesh, &object.mesh))
        };
        let own = scene.objects.iter().filter(|object| !shared(object));
        parts * BYTES_PER_PART + own.map(|object| object.mesh.memory_bytes()).sum::<usize>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn snapshot(references: usize) -> Snapshot {
        let mut scene = Scene::default();
        for index in 0..references {
            scene.references.push(crate::scene::Reference {
                name: index.to_string(),
                visible: true,
                poses: std::collections::BTreeMap::new(),
            });
        }
        Snapshot { scene, photo: None, selected: None, also_selected: BTreeSet::new(), log_cleared: 0 }
    }

    #[test]
    fn the_oldest_steps_go_when_memory_is_full() {
        let mut history = History::default();
        let parts = 10_000;
        for index in 0..100 {
            history.push(index.to_string(), snapshot(parts));
            assert!(history.undo_bytes <= MAX_BYTES);
        }
        assert_eq!(history.undo_label(), Some("99"));
        let mut steps = 0;
        while history.undo(snapshot(0)).is_some() {
            steps += 1;
        }
        assert_eq!(steps, MAX_BYTES / ((parts + 1) * BYTES_PER_PART));
        assert_eq!(history.undo_bytes, 0);
        while history.redo(snapshot(0)).is_some() {}
        assert!(history.undo_bytes <= MAX_BYTES);
    }
}
