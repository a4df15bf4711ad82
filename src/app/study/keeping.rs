//! A participation is kept in this browser as it goes on, so that a reload or a crash loses nothing, and its results stay until
//! somebody removes them.

use std::cell::RefCell;
use std::rc::Rc;

use crate::platform::{self, Journal, SaveTerms, Saved, SceneHeading, SceneId, Storage};
use crate::study::{Participation, results_name};

/// A gesture a moment after another one is written together with it.
const PATIENCE_MS: f64 = 400.0;

/// Without any gesture the clock alone is written so often: a crash loses no more of it.
const CLOCK_MS: f64 = 5000.0;

/// What marks a participation among the scenes of a store; lists of scenes leave it out.
const PREFIX: &str = "study-";

/// Is this a participation, and no scene?
pub fn is_kept_id(id: &SceneId) -> bool {
    id.as_str().starts_with(PREFIX)
}

/// Where one participant's work in one study is kept.
pub fn kept_id(study: &str, participant: &str) -> SceneId {
    // Two ids that differ in what a name cannot have are kept apart by their hash.
    let digest = crate::scene::Sha256::of(format!("{study}\n{participant}").as_bytes()).to_string();
    let short: String = digest.chars().take(12).collect();
    let plain = results_name(study, participant, 0.0);
    let name = plain.rsplit_once('_').map_or(plain.as_str(), |(name, _)| name);
    SceneId::new(&format!("{PREFIX}{name}-{short}"))
}

/// What is kept of a participation; of the store and what was put aside when the page went, the newer one. What cannot be read
/// is none.
pub async fn newest_kept(storage: &dyn Storage, id: &SceneId) -> Option<Saved> {
    let kept = storage.load(id).await.unwrap_or_default();
    let Some(journal) = storage.read_journal(id) else { return kept };
    let stored_ms = kept.as_ref().map_or(0.0, |kept| kept.heading.changed_at_ms);
    match journal.changed_at_ms > stored_ms {
        true => Some(Saved { json: journal.json, ..kept.unwrap_or_default() }),
        false => kept,
    }
}

/// Writes a participation to the store.
pub struct Keeping {
    shared: Option<Rc<RefCell<Shared>>>,
    changed_at_ms: Option<f64>,
    written_at_ms: f64,
}

struct Shared {
    storage: Rc<dyn Storage>,
    id: SceneId,
    is_writing: bool,
    /// What is not in the store yet: put aside at once if the page goes.
    unwritten: Option<Journal>,
    /// It was removed on demand, and stays removed.
    is_forgotten: bool,
}

impl Keeping {
    pub fn new(storage: Rc<dyn Storage>, study: &str, participant: &str) -> Self {
        let id = kept_id(study, participant);
        let shared = Shared { storage, id, is_writing: false, unwritten: None, is_forgotten: false };
        let shared = Rc::new(RefCell::new(shared));
        let leaving = shared.clone();
        platform::when_left(move || {
            let shared = leaving.borrow();
            if let Some(journal) = shared.unwritten.as_ref().filter(|journal| fits(journal)) {
                shared.storage.write_journal(&shared.id, journal);
            }
        });
        Self { shared: Some(shared), changed_at_ms: None, written_at_ms: 0.0 }
    }

    /// For a preview.
    pub fn nowhere() -> Self {
        Self { shared: None, changed_at_ms: None, written_at_ms: 0.0 }
    }

    pub fn is_kept(&self) -> bool {
        self.shared.as_ref().is_some_and(|shared| !shared.borrow().is_forgotten)
    }

    /// Something is different now.
    pub fn changed(&mut self, participation: &Participation, now_ms: f64) {
        self.changed_at_ms.get_or_insert(now_ms);
        if let Some(shared) = &self.shared {
            shared.borrow_mut().unwritten =
                Some(Journal { changed_at_ms: now_ms, json: participation.to_json() });
        }
    }

    /// Once a frame.
    pub fn tick(&mut self, participation: &Participation, now_ms: f64) {
        let runs = participation.trial().is_some_and(crate::study::RunningTrial::is_shown);
        let is_due = self.changed_at_ms.is_some_and(|since_ms| now_ms - since_ms >= PATIENCE_MS)
            || (runs && now_ms - self.written_at_ms >= CLOCK_MS);
        if !is_due {
            return;
        }
        let Some(shared) = &self.shared else { return };
        if shared.borrow().is_writing || shared.borrow().is_forgotten {
            return;
        }
        self.changed_at_ms = None;
        self.written_at_ms = now_ms;
        write(shared.clone(), participation, now_ms);
    }

    /// Removes what is kept.
    pub fn forget(&mut self) {
        let Some(shared) = &self.shared else { return };
        let (storage, id) = {
            let mut shared = shared.borrow_mut();
            shared.is_forgotten = true;
            shared.unwritten = None;
            (shared.storage.clone(), shared.id.clone())
        };
        storage.remove_journal(&id);
        platform::spawn(async move {
            if let Err(problem) = storage.delete(&id).await {
                log::warn!("the kept results stay: {problem}");
            }
        });
    }
}

fn fits(journal: &Journal) -> bool {
    journal.json.len() <= Journal::MAX_BYTES
}

fn write(shared: Rc<RefCell<Shared>>, participation: &Participation, now_ms: f64) {
    let json = participation.to_json();
    let results = &participation.results;
    let name = format!("{}, {}", results.study.title, results.participant.id);
    let heading = SceneHeading { name, changed_at_ms: now_ms, ..SceneHeading::default() };
    let (storage, id) = {
        let mut shared = shared.borrow_mut();
        shared.is_writing = true;
        (shared.storage.clone(), shared.id.clone())
    };
    platform::spawn(async move {
        let saved = Saved { heading, json, ..Saved::default() };
        let written = storage.save(&id, saved, SaveTerms::default()).await;
        let mut shared = shared.borrow_mut();
        shared.is_writing = false;
        match written {
            Ok(_) => {
                let is_older = |journal: &mut Journal| journal.changed_at_ms <= now_ms;
                if shared.unwritten.take_if(is_older).is_some() {
                    shared.storage.remove_journal(&shared.id);
                }
            }
            // The participation goes on: its file is offered at the end.
            Err(problem) => log::warn!("the participation is not kept: {problem}"),
        }
    });
}
