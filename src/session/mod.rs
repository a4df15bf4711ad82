//! A scene being worked on: what is selected and shown, the history, and the commands that change any of it.
//!
//! Knows nothing of pixels, files on disk or clocks: time is an argument, so that a script replays exactly.

mod apply;
mod command;
mod history;
mod import;
mod run;
mod table;

pub use command::{Answer, Command, CommandError, Effect, Notice, Question, Severity};
pub use import::{Batch, Opening};
pub use table::{COMMANDS, CommandId, CommandInfo, Menu, Shortcut};

use crate::formats::{Document, Incoming, Keep, PosesAs, ViewSettings};
use crate::scene::{Annotation, ObjectId, Photo, PhotoId, Scene};
use history::{Burst, History, Snapshot};

/// Everything that is open.
#[derive(Debug, Default)]
pub struct Session {
    scene: Scene,
    photo: Option<PhotoId>,
    selected: Option<ObjectId>,
    look: Look,
    tool: Tool,
    history: History,
    gesture: Option<Gesture>,
    burst: Option<Burst>,
    questions: Vec<Question>,
    /// Poses and cameras whose photos or meshes have not come yet.
    waiting: Vec<Waiting>,
    revision: u64,
}

/// How the overlay is shown; no part of undo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// 0 to 1, over all objects.
    pub overlay_opacity: f32,
    pub outline: bool,
}

impl Default for Look {
    fn default() -> Self {
        let ViewSettings { overlay_opacity, outline, .. } = ViewSettings::default();
        Self { overlay_opacity, outline }
    }
}

/// What the left mouse button does to an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tool {
    #[default]
    Move,
    Rotate,
}

/// A drag under way: one undo step once it ends.
#[derive(Debug)]
struct Gesture {
    label: &'static str,
    before: Snapshot,
    /// The revision of `before`.
    revision: u64,
}

#[derive(Debug)]
struct Waiting {
    incoming: Incoming,
    poses_as: PosesAs,
    /// What was still missing when it was last tried.
    missing: Vec<String>,
}

impl Session {
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The photo that is shown.
    pub fn photo(&self) -> Option<&Photo> {
        self.scene.photo(self.photo?)
    }

    pub fn selected(&self) -> Option<ObjectId> {
        self.selected
    }

    /// The selected object's pose in the photo that is shown.
    pub fn selected_annotation(&self) -> Option<(PhotoId, ObjectId, &Annotation)> {
        let (photo, object) = (self.photo?, self.selected?);
        Some((photo, object, self.scene.annotation(photo, object)?))
    }

    pub fn look(&self) -> Look {
        self.look
    }

    pub fn tool(&self) -> Tool {
        self.tool
    }

    pub fn gesture_under_way(&self) -> bool {
        self.gesture.is_some()
    }

    /// The question that waits for the user.
    pub fn question(&self) -> Option<&Question> {
        self.questions.first()
    }

    /// Names of photos and meshes that imported poses still wait for.
    pub fn missing_files(&self) -> impl Iterator<Item = (&str, &[String])> {
        self.waiting.iter().map(|waiting| (waiting.incoming.file_name.as_str(), waiting.missing.as_slice()))
    }

    pub fn undo_label(&self) -> Option<&str> {
        self.history.undo_label()
    }

    pub fn redo_label(&self) -> Option<&str> {
        self.history.redo_label()
    }

    /// Grows with every change that a saved scene would show.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// The scene as it was before the gesture under way: what is worth keeping if that gesture is never ended.
    pub fn settled_scene(&self) -> &Scene {
        self.gesture.as_ref().map_or(&self.scene, |gesture| &gesture.before.scene)
    }

    /// The revision of [`Self::settled_scene`].
    pub fn settled_revision(&self) -> u64 {
        self.gesture.as_ref().map_or(self.revision, |gesture| gesture.revision)
    }

    pub fn settled_document(&self, keep: Keep) -> Document {
        Document::from_scene(self.settled_scene(), &self.view_settings(), keep)
    }

    /// What is on screen, for a document.
    pub fn view_settings(&self) -> ViewSettings {
        ViewSettings {
            photo: self.photo.map(|id| id.0),
            selected: self.selected.map(|id| id.0),
            overlay_opacity: self.look.overlay_opacity,
            outline: self.look.outline,
        }
    }

    /// The session as our own document.
    pub fn document(&self, keep: Keep) -> Document {
        Document::from_scene(&self.scene, &self.view_settings(), keep)
    }
}
