//! Which scene is open, and the others: switching, copying, naming, deleting.
//!
//! What takes the open scene's place waits until that one is saved; if it cannot be saved, it stays open.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use super::PinPose;
use super::autosave::Finished;
use super::start::StartWith;
use crate::interact::Hands;
use crate::platform::{
    self, Remains, Saved, SceneHeading, SceneId, SceneSummary, Storage, StorageFuture, StorageUse,
};
use crate::session::{Command, Notice, Session};
use crate::ui::{Offer, SceneRequest};

mod damaged;
mod leaving;

/// Scenes and what is being done with them.
pub struct Scenes {
    storage: Rc<dyn Storage>,
    ctx: egui::Context,
    list: Vec<SceneSummary>,
    usage: Option<StorageUse>,
    /// The scene that is on its way in, and the `changed_at_ms` of what is stored of it.
    opening: Option<Incoming>,
    /// Waits for the open scene to be saved.
    next: Option<Next>,
    arrived: Rc<RefCell<VecDeque<Arrived>>>,
    /// The user asked to save, and wants to hear that it is done.
    says_saved: bool,
}

/// A scene on its way in.
#[derive(Debug, Clone, Default)]
struct Incoming {
    id: Option<SceneId>,
    stored_ms: f64,
    from_journal: bool,
    is_empty: bool,
}

#[derive(Debug, Clone, PartialEq)]
enum Next {
    Open(SceneId),
    New,
    SaveAs(String),
    Duplicate(SceneId),
    Delete(SceneId),
}

/// What the storage answered.
enum Arrived {
    StartWith(Option<SceneId>),
    Loaded(SceneId, Option<Saved>),
    /// Of which scene; `None` where it is not known which was open last.
    CannotLoad(Option<SceneId>, String),
    /// A scene's title, and what is stored of it.
    Remains(String, Remains),
    Listed(Vec<SceneSummary>),
    Usage(StorageUse),
    /// Whether this window is the one that writes the scene.
    Claimed(SceneId, bool),
    /// A scene was renamed or copied.
    Changed,
    /// A scene was deleted: there may be room again.
    Deleted,
    Problem(String),
}

impl Scenes {
    pub fn new(storage: Rc<dyn Storage>, ctx: &egui::Context) -> Self {
        Self {
            storage,
            ctx: ctx.clone(),
            list: Vec::new(),
            usage: None,
            opening: None,
            next: None,
            arrived: Rc::default(),
            says_saved: false,
        }
    }

    /// The scenes that are stored, the one that was changed last first.
    pub fn list(&self) -> &[SceneSummary] {
        &self.list
    }

    pub fn storage(&self) -> Rc<dyn Storage> {
        self.storage.clone()
    }

    pub fn usage(&self) -> Option<StorageUse> {
        self.usage
    }

    /// A scene is on its way in, or waits for the open one to be saved: what else comes in has to wait.
    pub fn is_switching(&self) -> bool {
        self.opening.is_some() || self.next.is_some()
    }

    pub fn is_opening(&self) -> bool {
        self.opening.is_some()
    }

    /// Asks for the list anew.
    fn refresh(&self) {
        self.when_done(self.storage.list(), Arrived::Listed, Arrived::Problem);
    }

    fn refresh_usage(&self) {
        // Where the browser does not say, nothing is shown.
        self.when_done(self.storage.usage(), Arrived::Usage, |_| Arrived::Changed);
    }

    fn when_done<T: 'static>(
        &self,
        future: StorageFuture<T>,
        done: impl FnOnce(T) -> Arrived + 'static,
        failed: impl FnOnce(String) -> Arrived + 'static,
    ) {
        let (arrived, ctx) = (self.arrived.clone(), self.ctx.clone());
        platform::spawn(async move {
            let result = future.await;
            arrived.borrow_mut().push_back(result.map_or_else(failed, done));
            ctx.request_repaint();
        });
    }

    /// The next start opens this one.
    fn remember(&self, id: &SceneId) {
        self.when_done(self.storage.set_last_open(id), |()| Arrived::Changed, Arrived::Problem);
    }

    /// What a scene is called; the open one's title may be newer than the list.
    fn title(&self, id: &SceneId) -> &str {
        let summary = self.list.iter().find(|summary| summary.id == *id);
        summary.map_or("the scene", |summary| summary.heading.title())
    }

    /// "X copy", "X copy 2", …: what no other scene is called.
    fn name_of_copy(&self, title: &str) -> String {
        let first = format!("{title} copy");
        let names = std::iter::once(first.clone()).chain((2..1000).map(|number| format!("{first} {number}")));
        let is_free = |name: &String| self.list.iter().all(|summary| summary.heading.title() != name);
        names.into_iter().find(is_free).unwrap_or(first)
    }
}

impl PinPose {
    /// Begins with what the program was started for.
    pub(super) fn start_with(&mut self, start: StartWith) {
        self.scenes.refresh();
        match start {
            StartWith::Nothing => {}
            StartWith::Study(link) => self.start_study(link),
            StartWith::Example => {
                self.autosave.mark_trial();
                self.claim_scene();
                self.loading.fetch_example();
            }
            StartWith::LastOpen => {
                self.scenes.opening = Some(Incoming::default());
                self.autosave.hold();
                let last = self.scenes.storage.last_open();
                let failed = |problem| Arrived::CannotLoad(None, problem);
                self.scenes.when_done(last, Arrived::StartWith, failed);
            }
        }
    }

    /// The scenes that are stored, the one that was changed last first.
    pub fn scene_list(&self) -> &[SceneSummary] {
        self.scenes.list()
    }

    /// Opens a scene in place of this one, as a fresh session.
    pub fn open_scene(&mut self, id: SceneId) {
        if id != self.autosave.id() {
            self.after_saving(Next::Open(id));
        }
    }

    /// An empty scene; this one stays in the list.
    pub fn new_scene(&mut self) {
        self.after_saving(Next::New);
    }

    /// Goes on in a copy under a new name. A scene that has no name yet just gets it.
    pub fn save_scene_as(&mut self, name: &str) {
        let name = name.trim();
        if name.is_empty() || self.session.scene().is_empty() {
            return;
        }
        if self.session.scene().name.is_empty() {
            self.apply(Command::RenameScene(name.to_owned()));
            self.save_now();
        } else {
            self.after_saving(Next::SaveAs(name.to_owned()));
        }
    }

    pub fn rename_scene(&mut self, id: &SceneId, name: &str) {
        let name = name.trim();
        if name.is_empty() {
            return;
        }
        if *id == self.autosave.id() {
            self.apply(Command::RenameScene(name.to_owned()));
            self.autosave.save_now(&self.session, platform::now_ms());
        } else {
            let renaming = self.scenes.storage.rename(id, name);
            self.scenes.when_done(renaming, |()| Arrived::Changed, Arrived::Problem);
        }
    }

    pub fn duplicate_scene(&mut self, id: SceneId) {
        self.after_saving(Next::Duplicate(id));
    }

    /// Deletes a scene for good. The interface asks before.
    pub fn delete_scene(&mut self, id: SceneId) {
        self.after_saving(Next::Delete(id));
    }

    /// Shows the list of scenes.
    pub fn show_scenes(&mut self) {
        self.scenes.refresh();
        self.scenes.refresh_usage();
        self.ui_state.scenes_dialog.show();
    }

    /// Saves at once, and says so.
    pub fn save_now(&mut self) {
        self.scenes.says_saved = true;
        self.autosave.save_now(&self.session, platform::now_ms());
    }

    /// Asks for the name of a copy.
    pub fn ask_save_as(&mut self) {
        if self.session.scene().is_empty() {
            self.notify(Notice::info("There is nothing to save yet: the scene is empty"));
            return;
        }
        let title = self.open_title();
        let is_named = !self.session.scene().name.is_empty();
        let name = if is_named { self.scenes.name_of_copy(&title) } else { title };
        self.ui_state.scenes_dialog.ask_name(&name);
    }

    pub(super) fn take_scene_request(&mut self, request: SceneRequest) {
        match request {
            SceneRequest::Show => self.show_scenes(),
            SceneRequest::New => self.new_scene(),
            SceneRequest::Open(id) => self.open_scene(id),
            SceneRequest::Rename(id, name) => self.rename_scene(&id, &name),
            SceneRequest::Duplicate(id) => self.duplicate_scene(id),
            SceneRequest::Delete(id) => self.delete_scene(id),
            SceneRequest::SaveAs(name) => self.save_scene_as(&name),
            SceneRequest::DownloadStored(id) => self.download_stored(&id),
        }
    }

    /// Once a frame: what the storage has answered, and what waited for it.
    pub(super) fn tick_scenes(&mut self) {
        loop {
            let arrived = self.scenes.arrived.borrow_mut().pop_front();
            let Some(arrived) = arrived else { break };
            self.take_arrived(arrived);
        }
        if let Some(finished) = self.autosave.take_finished() {
            self.take_finished_save(finished);
        }
        if self.scenes.says_saved && self.autosave.is_saved() {
            self.scenes.says_saved = false;
            self.notify(Notice::info("Saved in this browser"));
        }
        self.go_on();
    }

    /// The scene that was on its way in is in the session; `is_whole` if all of its files were there and could be read.
    pub(super) fn scene_opened(&mut self, is_whole: bool) {
        let Some(incoming) = self.scenes.opening.take() else { return };
        let has_come = incoming.is_empty || !self.session.scene().is_empty();
        match incoming.id.clone().filter(|_| is_whole && has_come) {
            Some(id) => {
                self.scenes.remember(&id);
                self.autosave.begin(id, Some(incoming.stored_ms), &self.session);
                if incoming.from_journal {
                    self.autosave.mark_unsaved();
                }
            }
            // What is stored stays as it is, for a program that can read it.
            None => {
                if let Some(id) = incoming.id.filter(|_| is_whole && !has_come) {
                    let problem = "This scene cannot be opened. It stays stored as it is".to_owned();
                    self.notify_damaged(id, problem);
                }
                self.autosave.begin(platform::new_scene_id(), None, &self.session);
            }
        }
        self.claim_scene();
    }

    /// One window writes a scene.
    fn claim_scene(&self) {
        let id = self.autosave.id();
        let claiming = self.scenes.storage.claim(&id);
        self.scenes.when_done(claiming, move |is_ours| Arrived::Claimed(id, is_ours), Arrived::Problem);
    }

    fn begin_opening(&mut self, id: SceneId) {
        self.fresh_session();
        self.autosave.hold();
        self.scenes.opening = Some(Incoming::default());
        self.load_scene(id);
    }

    fn load_scene(&mut self, id: SceneId) {
        let loading = self.scenes.storage.load(&id);
        let of = id.clone();
        let failed = move |problem| Arrived::CannotLoad(Some(of), problem);
        self.scenes.when_done(loading, move |saved| Arrived::Loaded(id, saved), failed);
    }

    fn begin_new(&mut self) {
        self.fresh_session();
        self.autosave.begin(platform::new_scene_id(), None, &self.session);
        self.claim_scene();
    }

    fn begin_copy(&mut self, name: String) {
        self.apply(Command::RenameScene(name));
        self.autosave.begin(platform::new_scene_id(), None, &self.session);
        self.autosave.mark_unsaved();
        self.claim_scene();
        self.save_now();
    }

    fn duplicate_stored(&mut self, id: &SceneId) {
        let name = self.scenes.name_of_copy(self.scenes.title(id));
        let copying = self.scenes.storage.duplicate(id, &platform::new_scene_id(), &name);
        self.scenes.when_done(copying, |()| Arrived::Changed, Arrived::Problem);
    }

    fn delete_stored(&mut self, id: &SceneId) {
        if *id == self.autosave.id() {
            self.begin_new();
        }
        let deleting = self.scenes.storage.delete(id);
        self.scenes.when_done(deleting, |()| Arrived::Deleted, Arrived::Problem);
    }

    fn fresh_session(&mut self) {
        self.session = Session::default();
        self.hands = Hands::default();
    }

    fn take_arrived(&mut self, arrived: Arrived) {
        match arrived {
            Arrived::StartWith(Some(id)) => self.load_scene(id),
            Arrived::StartWith(None) => self.scene_opened(false),
            Arrived::Loaded(id, Some(saved)) => self.read_scene(id, saved),
            Arrived::Loaded(id, None) => {
                let title = self.scenes.title(&id).to_owned();
                self.notify(Notice::error(format!("{title} is not stored any more")));
                self.scene_opened(false);
                self.scenes.refresh();
            }
            Arrived::CannotLoad(id, problem) => {
                match id {
                    Some(id) => self.notify_damaged(id, problem),
                    None => self.notify(Notice::error(problem)),
                }
                self.scene_opened(false);
            }
            Arrived::Remains(title, remains) => self.download_remains(&title, remains),
            Arrived::Listed(mut list) => {
                // Participations are kept beside scenes, and are none.
                list.retain(|summary| !super::study::is_kept_id(&summary.id));
                self.scenes.list = list;
            }
            Arrived::Usage(usage) => self.scenes.usage = Some(usage),
            Arrived::Claimed(id, false) if id == self.autosave.id() => self.borrow_scene(),
            Arrived::Claimed(..) => {}
            Arrived::Changed => self.scenes.refresh(),
            Arrived::Deleted => {
                self.scenes.refresh();
                self.scenes.refresh_usage();
                self.autosave.try_again();
            }
            Arrived::Problem(problem) => self.notify(Notice::error(problem)),
        }
    }

    fn read_scene(&mut self, id: SceneId, stored: Saved) {
        let heading = stored.heading.clone();
        let stored_ms = heading.changed_at_ms;
        let journal = self.scenes.storage.read_journal(&id);
        let newer = journal.filter(|journal| journal.changed_at_ms > stored_ms);
        if newer.is_none() {
            self.scenes.storage.remove_journal(&id);
        }
        let with_journal = newer.map(|journal| Saved { json: journal.json, ..stored.clone() });
        // A journal that cannot be read is no better than none.
        let name = &heading.name;
        let from_journal = with_journal.is_some_and(|saved| self.loading.start_saved(saved, name).is_ok());
        let is_empty = heading.photo_count == 0 && heading.object_count == 0;
        self.scenes.opening = Some(Incoming { id: Some(id), stored_ms, from_journal, is_empty });
        if from_journal {
            return;
        }
        if let Err(error) = self.loading.start_saved(stored, name) {
            let text = format!("{} cannot be opened: {error}", heading.title());
            let id = self.scenes.opening.as_ref().and_then(|incoming| incoming.id.clone());
            match id {
                Some(id) => self.notify_damaged(id, text),
                None => self.notify(Notice::error(text)),
            }
            self.scene_opened(false);
        }
    }

    fn take_finished_save(&mut self, finished: Finished) {
        match finished {
            Finished::Saved { first } => {
                self.scenes.refresh();
                if first && !self.autosave.is_trial() {
                    let asking = self.scenes.storage.ask_to_persist();
                    self.scenes.when_done(asking, |()| Arrived::Changed, Arrived::Problem);
                }
            }
            Finished::ChangedElsewhere => self.go_on_in_copy(),
            Finished::Failed(reason) => {
                self.scenes.says_saved = false;
                let reason = reason.trim_end_matches('.');
                let text = format!("Not saved: {reason}. Download the workspace to keep your work");
                self.notify_with_offer(Notice::error(text), Offer::Workspace);
            }
        }
    }

    fn borrow_scene(&mut self) {
        self.autosave.lend();
        let title = self.open_title();
        self.notify(Notice::warning(format!(
            "{title} is open in another window. What you change here goes on in a copy"
        )));
    }

    /// Another window has the same scene: both stay.
    fn go_on_in_copy(&mut self) {
        let name = self.scenes.name_of_copy(&self.open_title());
        self.notify(Notice::warning(format!(
            "This scene is in use in another window. What you do here goes on as \"{name}\""
        )));
        self.begin_copy(name);
    }

    fn open_title(&self) -> String {
        SceneHeading::title(&super::autosave::heading(self.session.scene(), 0.0)).to_owned()
    }
}
