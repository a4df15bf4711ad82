//! Keeps the scene in storage: within a second of a change, one save at a time, never half a gesture.

use std::cell::RefCell;
use std::rc::Rc;
use std::time::Duration;

use crate::formats::{Keep, write_document};
use crate::platform::{self, Saved, SavedAsset, Storage};
use crate::session::Session;
use crate::ui::Saving;

/// A change is saved when nothing has followed it for so long...
const QUIET_MS: f64 = 250.0;
/// ...or at the latest after so long.
const LATEST_MS: f64 = 800.0;

type Slot<T> = Rc<RefCell<Option<T>>>;

pub struct Autosave {
    storage: Rc<dyn Storage>,
    ctx: egui::Context,
    /// The revision that is in storage.
    saved_revision: u64,
    /// The revision that was last seen, and when it and the first unsaved one came.
    seen_revision: u64,
    changed_at_ms: f64,
    unsaved_since_ms: f64,
    saving: Option<u64>,
    finished: Slot<Result<(), String>>,
    failure: Option<String>,
    restored: Slot<Result<Option<Saved>, String>>,
    restoring: bool,
}

impl Autosave {
    pub fn new(storage: Rc<dyn Storage>, ctx: egui::Context) -> Self {
        Self {
            storage,
            ctx,
            saved_revision: 0,
            seen_revision: 0,
            changed_at_ms: 0.0,
            unsaved_since_ms: 0.0,
            saving: None,
            finished: Rc::default(),
            failure: None,
            restored: Rc::default(),
            restoring: false,
        }
    }

    /// Asks for what was saved.
    pub fn restore(&mut self) {
        self.restoring = true;
        let (load, slot, ctx) = (self.storage.load(), self.restored.clone(), self.ctx.clone());
        platform::spawn(async move {
            let result = load.await;
            *slot.borrow_mut() = Some(result);
            ctx.request_repaint();
        });
    }

    /// What was saved, once it is there.
    pub fn take_restored(&mut self) -> Option<Result<Saved, String>> {
        let result = self.restored.borrow_mut().take()?;
        self.restoring = false;
        result.transpose()
    }

    /// Saves when it is time to.
    pub fn tick(&mut self, ctx: &egui::Context, session: &Session, now_ms: f64) {
        self.take_finished();
        self.notice_changes(session.revision(), now_ms);
        let unsaved = session.revision() != self.saved_revision;
        // While a gesture goes on, the scene is in between; while one save runs, the next waits.
        if !unsaved || self.restoring || self.saving.is_some() || session.gesture_under_way() {
            return;
        }
        let due_ms = (self.changed_at_ms + QUIET_MS).min(self.unsaved_since_ms + LATEST_MS);
        if now_ms >= due_ms {
            self.save(session);
        } else {
            ctx.request_repaint_after(Duration::from_secs_f64((due_ms - now_ms) / 1000.0));
        }
    }

    /// The session is what is in storage: it was just brought back from there.
    pub fn mark_saved(&mut self, session: &Session) {
        self.saved_revision = session.revision();
        self.seen_revision = self.saved_revision;
    }

    pub fn state(&self, session: &Session) -> Saving {
        match &self.failure {
            Some(reason) => Saving::Failed(reason.clone()),
            None if session.revision() == self.saved_revision => Saving::Saved,
            None => Saving::Pending,
        }
    }

    fn notice_changes(&mut self, revision: u64, now_ms: f64) {
        if revision != self.seen_revision {
            if self.seen_revision == self.saved_revision {
                self.unsaved_since_ms = now_ms;
            }
            self.seen_revision = revision;
            self.changed_at_ms = now_ms;
        }
    }

    fn save(&mut self, session: &Session) {
        self.saving = Some(session.revision());
        let save = self.storage.save(saved(session));
        let (slot, ctx) = (self.finished.clone(), self.ctx.clone());
        platform::spawn(async move {
            let result = save.await;
            *slot.borrow_mut() = Some(result);
            ctx.request_repaint();
        });
    }

    fn take_finished(&mut self) {
        let Some(result) = self.finished.borrow_mut().take() else { return };
        if let Some(revision) = self.saving.take() {
            // A failed save is tried again with the next change, not in a loop.
            self.saved_revision = revision;
            self.failure = result.err();
        }
    }
}

fn saved(session: &Session) -> Saved {
    let scene = session.scene();
    let photos = scene.photos.iter().map(|photo| {
        let asset = &photo.asset;
        SavedAsset {
            key: asset.sha256.to_string(),
            file_name: asset.file_name.clone(),
            bytes: asset.bytes.clone(),
        }
    });
    let meshes = scene.objects.iter().map(|object| {
        let asset = &object.mesh;
        SavedAsset {
            key: asset.sha256.to_string(),
            file_name: asset.file_name.clone(),
            bytes: asset.bytes.clone(),
        }
    });
    Saved {
        json: write_document(&session.document(Keep::Everything)),
        assets: photos.chain(meshes).collect(),
    }
}
