//! A scene being worked on: what is selected and shown, the history, and the commands that change any of it.
//!
//! Knows nothing of pixels, files on disk or clocks: time is an argument, so that a script replays exactly.

mod apply;
mod availability;
mod command;
mod confirm;
mod dataset;
mod depth;
mod edit;
mod effect;
mod export;
mod fits;
mod focal;
mod history;
mod import;
mod log;
mod mesh_frames;
mod nudge;
mod pins;
mod pose;
mod run;
mod sureness;
mod symmetry;
mod table;
mod view;

use std::collections::{BTreeMap, BTreeSet};

pub use command::{Command, CommandError, MaskChange, ObjectChange, PhotoChange, PinChange};
pub use dataset::DatasetImport;
pub use depth::with_depth_changed;
pub use effect::{Answer, Effect, Notice, Pick, PictureKind, PictureRequest, Question, Severity};
pub use fits::RankedFit;
pub use history::MAX_BYTES as HISTORY_BYTES;
pub use import::{Batch, Opening};
pub use log::LogEntry;
pub use mesh_frames::UnitQuestion;
pub use nudge::{Nudge, NudgeFrame, NudgeSettings};
pub use pins::{HalfPin, PinReport};
pub use sureness::{HelpfulPin, Sureness};
pub use table::{COMMANDS, CommandId, CommandInfo, Menu, Shortcut};
pub use view::{Arrangement, Panes, Tool};

use crate::formats::{Document, Incoming, Keep, PosesAs, ViewSettings};
use crate::scene::{Annotation, Look, ObjectId, Photo, PhotoId, Scene};
use history::{Burst, BurstKey, History, Snapshot};

/// Everything that is open.
#[derive(Debug, Default)]
pub struct Session {
    scene: Scene,
    photo: Option<PhotoId>,
    /// The one that numbers and keys act on.
    selected: Option<ObjectId>,
    also_selected: BTreeSet<ObjectId>,
    look: Look,
    panes: Panes,
    nudge: NudgeSettings,
    tool: Tool,
    half_pin: Option<HalfPin>,
    /// The pose that was snapped last, and the step of the history that did it.
    snapped: Option<((PhotoId, ObjectId), u64)>,
    pin_report: pins::ReportCache,
    fit_scores: fits::FitScores,
    snap_covariances: BTreeMap<(PhotoId, ObjectId), sureness::OfSnap>,
    history: History,
    log: log::Log,
    gesture: Option<Gesture>,
    burst: Option<Burst>,
    questions: Vec<Question>,
    /// Whose unit was guessed and may be wrong.
    unit_questions: Vec<UnitQuestion>,
    /// Poses and cameras whose photos or meshes have not come yet.
    waiting: Vec<Waiting>,
    revision: u64,
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
    /// A scene that was made elsewhere, with nothing done to it yet; its first photo is shown.
    pub fn with_scene(scene: Scene) -> Self {
        let mut session = Self { scene, ..Self::default() };
        session.keep_selection_valid();
        session
    }

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

    pub fn is_selected(&self, object: ObjectId) -> bool {
        self.selected == Some(object) || self.also_selected.contains(&object)
    }

    /// All selected objects, in the order of the list.
    pub fn selection(&self) -> Vec<ObjectId> {
        self.scene.objects.iter().map(|object| object.id).filter(|id| self.is_selected(*id)).collect()
    }

    /// The selected object's pose in the photo that is shown.
    pub fn selected_annotation(&self) -> Option<(PhotoId, ObjectId, &Annotation)> {
        let (photo, object) = (self.photo?, self.selected?);
        Some((photo, object, self.scene.annotation(photo, object)?))
    }

    pub fn look(&self) -> Look {
        self.look
    }

    pub fn panes(&self) -> Panes {
        self.panes
    }

    pub fn nudge_settings(&self) -> NudgeSettings {
        self.nudge
    }

    pub fn tool(&self) -> Tool {
        self.tool
    }

    /// The half of a pin that waits for the other.
    pub fn half_pin(&self) -> Option<HalfPin> {
        self.half_pin
    }

    /// What was done to poses, oldest first.
    pub fn log(&self) -> &[LogEntry] {
        self.log.entries()
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

    /// The session as our own document.
    pub fn document(&self, keep: Keep) -> Document {
        Document::from_scene(&self.scene, &self.view_settings(), keep)
    }

    /// The same without the gesture that is under way.
    pub fn settled_document(&self, keep: Keep) -> Document {
        Document::from_scene(self.settled_scene(), &self.view_settings(), keep)
    }

    /// What is on screen, for a document.
    pub fn view_settings(&self) -> ViewSettings {
        let mut view = ViewSettings::of_look(&self.look);
        view.photo = self.photo.map(|id| id.0);
        view.selected = self.selected.map(|id| id.0);
        view.panes = self.panes.arrangement.name().to_owned();
        view.image_distance_mm = self.panes.image_distance_mm;
        view
    }
}
