//! Keeps the open scene in storage: within a second of a change, one save at a time, never half a gesture.
//!
//! What is saved is the settled scene, without the gesture under way. When the page is about to go, its document is put
//! aside at once in a journal, so that what is lost is at most that gesture.

use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

use crate::formats::{Document, Keep, ViewSettings, write_document};
use crate::platform::{
    self, Journal, SaveOutcome, SaveTerms, Saved, SavedAsset, SavedCompanion, SceneHeading, SceneId, Storage,
};
use crate::scene::{Scene, SceneFile, Sha256, file_stem};
use crate::session::Session;
use crate::ui::Saving;

/// A change is saved when nothing has followed it for so long...
const QUIET_MS: f64 = 250.0;
/// ...or at the latest after so long.
const LATEST_MS: f64 = 800.0;
/// What could not be stored is tried again after so long: there may be room by then.
const RETRY_MS: f64 = 15_000.0;

pub struct Autosave {
    /// Shared with what is called when the page goes, and with a save that runs.
    keeper: Rc<RefCell<Keeper>>,
    /// When the first change came that is not saved, and the last one.
    unsaved_since_ms: f64,
    changed_at_ms: f64,
}

/// What came of a save that has ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Finished {
    /// `first`: there was nothing under this id before.
    Saved {
        first: bool,
    },
    /// Another window has the scene, or has changed it: nothing was saved.
    ChangedElsewhere,
    Failed(String),
}

struct Keeper {
    storage: Rc<dyn Storage>,
    ctx: egui::Context,
    /// Where the open scene is kept.
    id: SceneId,
    /// The settled scene as it was last seen: sharing photos and meshes, it is cheap to keep.
    seen: Option<Seen>,
    /// The revision that is in storage.
    saved_revision: u64,
    /// The revision that could not be stored, and when that was: it is tried again with the next change, or later.
    failed: Option<(u64, f64)>,
    /// `changed_at_ms` of what is stored under `id`.
    stored_ms: Option<f64>,
    saving: bool,
    /// While a scene is on its way in, nothing is saved.
    held: bool,
    /// Another window writes the scene: a change goes into a copy.
    is_lent: bool,
    /// The next start does not begin with this scene.
    is_trial: bool,
    finished: Option<Finished>,
    failure: Option<String>,
}

struct Seen {
    revision: u64,
    scene: Scene,
    view: ViewSettings,
}

impl Autosave {
    pub fn new(storage: Rc<dyn Storage>, ctx: egui::Context, id: SceneId) -> Self {
        let keeper = Keeper {
            storage,
            ctx,
            id,
            seen: None,
            saved_revision: 0,
            failed: None,
            stored_ms: None,
            saving: false,
            held: false,
            is_lent: false,
            is_trial: false,
            finished: None,
            failure: None,
        };
        let keeper = Rc::new(RefCell::new(keeper));
        let leaving = keeper.clone();
        platform::when_left(move || leave(&leaving));
        Self { keeper, unsaved_since_ms: 0.0, changed_at_ms: 0.0 }
    }

    /// The scene that is open.
    pub fn id(&self) -> SceneId {
        self.keeper.borrow().id.clone()
    }

    /// Looks at the session, and saves when it is time to.
    pub fn tick(&mut self, ctx: &egui::Context, session: &Session, now_ms: f64) {
        self.notice_changes(session, now_ms);
        if !self.keeper.borrow().may_save(now_ms) {
            self.keeper.borrow().wait_to_retry(now_ms);
            return;
        }
        if self.keeper.borrow().is_lent {
            self.keeper.borrow_mut().finished = Some(Finished::ChangedElsewhere);
            ctx.request_repaint();
            return;
        }
        let due_ms = (self.changed_at_ms + QUIET_MS).min(self.unsaved_since_ms + LATEST_MS);
        if now_ms >= due_ms {
            save(&self.keeper);
        } else {
            ctx.request_repaint_after(Duration::from_secs_f64((due_ms - now_ms) / 1000.0));
        }
    }

    /// Saves at once what is not saved yet, after the save that runs.
    pub fn save_now(&mut self, session: &Session, now_ms: f64) {
        self.notice_changes(session, now_ms);
        self.try_again();
        if self.keeper.borrow().may_save(now_ms) && !self.keeper.borrow().is_lent {
            save(&self.keeper);
        }
    }

    /// What could not be saved may find room now.
    pub fn try_again(&mut self) {
        self.keeper.borrow_mut().failed = None;
    }

    /// Is everything that is worth it in storage?
    pub fn is_saved(&self) -> bool {
        self.keeper.borrow().unsaved().is_none()
    }

    /// What came of the last save, once.
    pub fn take_finished(&mut self) -> Option<Finished> {
        self.keeper.borrow_mut().finished.take()
    }

    pub fn is_saving(&self) -> bool {
        self.keeper.borrow().saving
    }

    /// A scene is on its way in: until it is there, nothing is saved.
    pub fn hold(&mut self) {
        self.keeper.borrow_mut().held = true;
    }

    /// From now on the session is kept under this id. `stored_ms` is the `changed_at_ms` of what is stored there; the
    /// session counts as saved.
    pub fn begin(&mut self, id: SceneId, stored_ms: Option<f64>, session: &Session) {
        let mut keeper = self.keeper.borrow_mut();
        keeper.id = id;
        keeper.stored_ms = stored_ms;
        keeper.seen = None;
        keeper.saved_revision = session.settled_revision();
        keeper.failed = None;
        keeper.held = false;
        keeper.is_lent = false;
        keeper.is_trial = false;
        keeper.finished = None;
        keeper.failure = None;
    }

    /// Another window writes this scene. What is changed here has to go into a copy.
    pub fn lend(&mut self) {
        self.keeper.borrow_mut().is_lent = true;
    }

    /// The open scene came by `?example`: the next start does not begin with it.
    pub fn mark_trial(&mut self) {
        self.keeper.borrow_mut().is_trial = true;
    }

    pub fn is_trial(&self) -> bool {
        self.keeper.borrow().is_trial
    }

    /// What is in the session is not what is stored: save it with the next tick.
    pub fn mark_unsaved(&mut self) {
        self.keeper.borrow_mut().saved_revision = u64::MAX;
    }

    pub fn state(&self, session: &Session) -> Saving {
        let keeper = self.keeper.borrow();
        match &keeper.failure {
            Some(reason) => Saving::Failed(reason.clone()),
            None if session.revision() == keeper.saved_revision => Saving::Saved,
            None if keeper.stored_ms.is_none() && session.scene().is_empty() => Saving::Saved,
            None => Saving::Pending,
        }
    }

    fn notice_changes(&mut self, session: &Session, now_ms: f64) {
        let mut keeper = self.keeper.borrow_mut();
        let revision = session.settled_revision();
        let seen = keeper.seen.as_ref().map_or(keeper.saved_revision, |seen| seen.revision);
        if revision == seen {
            return;
        }
        if seen == keeper.saved_revision {
            self.unsaved_since_ms = now_ms;
        }
        self.changed_at_ms = now_ms;
        let scene = session.settled_scene().clone();
        keeper.seen = Some(Seen { revision, scene, view: session.view_settings() });
    }
}

impl Keeper {
    fn unsaved(&self) -> Option<&Seen> {
        // An empty scene that was never stored is nobody's work.
        let is_work = |seen: &&Seen| self.stored_ms.is_some() || !seen.scene.is_empty();
        self.seen.as_ref().filter(|seen| seen.revision != self.saved_revision).filter(is_work)
    }

    fn may_save(&self, now_ms: f64) -> bool {
        let has_just_failed = |seen: &Seen| {
            self.failed
                .is_some_and(|(revision, at_ms)| revision == seen.revision && now_ms < at_ms + RETRY_MS)
        };
        !self.held && !self.saving && self.unsaved().is_some_and(|seen| !has_just_failed(seen))
    }

    fn wait_to_retry(&self, now_ms: f64) {
        if let Some((_, at_ms)) =
            self.failed.filter(|_| !self.held && !self.saving && self.unsaved().is_some())
        {
            let left_ms = (at_ms + RETRY_MS - now_ms).max(0.0);
            self.ctx.request_repaint_after(Duration::from_secs_f64(left_ms / 1000.0));
        }
    }

    fn take_result(&mut self, revision: u64, changed_at_ms: f64, result: Result<SaveOutcome, String>) {
        self.saving = false;
        let failed_before = self.failed.take().map(|(revision, _)| revision);
        let failure_before = self.failure.take();
        let finished = match result {
            Ok(SaveOutcome::Saved) => {
                self.saved_revision = revision;
                let first = self.stored_ms.replace(changed_at_ms).is_none();
                self.storage.remove_journal(&self.id);
                Finished::Saved { first }
            }
            Ok(SaveOutcome::ChangedElsewhere) => {
                self.failed = Some((revision, platform::now_ms()));
                Finished::ChangedElsewhere
            }
            Err(reason) => {
                self.failed = Some((revision, platform::now_ms()));
                self.failure = Some(reason.clone());
                Finished::Failed(reason)
            }
        };
        // What was tried again by itself, in vain, was said before.
        let was_said = failed_before == Some(revision) && failure_before == self.failure;
        self.finished = Some(finished).filter(|_| !was_said);
        self.ctx.request_repaint();
    }
}

/// The page is about to go: its document is put aside at once, and a save is begun, which may or may not come to its end.
fn leave(keeper: &Rc<RefCell<Keeper>>) {
    let keeper_now = keeper.borrow();
    if keeper_now.held || keeper_now.is_lent {
        return;
    }
    let Some(unsaved) = keeper_now.unsaved() else { return };
    let json = write_document(&unsaved.document());
    if json.len() <= Journal::MAX_BYTES {
        let journal = Journal { changed_at_ms: platform::now_ms(), json };
        keeper_now.storage.write_journal(&keeper_now.id, &journal);
    }
    let may_save = keeper_now.may_save(platform::now_ms());
    drop(keeper_now);
    if may_save {
        save(keeper);
    }
}

fn save(keeper: &Rc<RefCell<Keeper>>) {
    let mut keeper_now = keeper.borrow_mut();
    let Some(unsaved) = keeper_now.unsaved() else { return };
    let (revision, changed_at_ms) = (unsaved.revision, platform::now_ms());
    let saved = unsaved.saved(changed_at_ms);
    // A tab that closes right after the first save has to come back to this scene.
    let terms = SaveTerms { last_seen_ms: keeper_now.stored_ms, opens_next: !keeper_now.is_trial };
    let save = keeper_now.storage.save(&keeper_now.id, saved, terms);
    keeper_now.saving = true;
    drop(keeper_now);
    let keeper = keeper.clone();
    platform::spawn(async move {
        let result = save.await;
        keeper.borrow_mut().take_result(revision, changed_at_ms, result);
    });
}

impl Seen {
    fn document(&self) -> Document {
        Document::from_scene(&self.scene, &self.view, Keep::Everything)
    }

    fn saved(&self, changed_at_ms: f64) -> Saved {
        let asset = |file: &SceneFile<'_>| SavedAsset {
            key: file.sha256.to_string(),
            file_name: file.name.to_owned(),
            bytes: file.bytes.clone(),
        };
        let meshes = self.scene.objects.iter().map(|object| &object.mesh);
        let companions = meshes.flat_map(|mesh| {
            mesh.companions.iter().map(|file| SavedCompanion {
                of: mesh.sha256.to_string(),
                file: SavedAsset {
                    key: Sha256::of(&file.bytes).to_string(),
                    file_name: file.file_name.clone(),
                    bytes: file.bytes.clone(),
                },
            })
        });
        Saved {
            companions: companions.collect(),
            heading: heading(&self.scene, changed_at_ms),
            json: write_document(&self.document()),
            assets: self.scene.files().iter().map(asset).collect(),
        }
    }
}

/// What a list of scenes says of this one.
pub fn heading(scene: &Scene, changed_at_ms: f64) -> SceneHeading {
    let photo = scene.photos.first().map(|photo| file_stem(&photo.name));
    let object = scene.objects.first().map(|object| object.name.as_str());
    SceneHeading {
        name: scene.name.clone(),
        subject: photo.or(object).unwrap_or_default().to_owned(),
        changed_at_ms,
        photo_count: scene.photos.len() as u32,
        object_count: scene.objects.len() as u32,
    }
}

#[cfg(test)]
mod tests;
