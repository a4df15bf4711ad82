//! A store that lasts as long as the program: for tests, and where there is no other.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use super::storage::{
    Journal, SaveOutcome, SaveTerms, Saved, SavedAsset, SavedCompanion, SceneHeading, SceneId, SceneSummary,
    Storage, StorageFuture, StorageUse, distinct, sort_scenes,
};

#[derive(Debug, Default)]
pub struct MemoryStorage {
    kept: RefCell<Kept>,
    journals: RefCell<BTreeMap<SceneId, Journal>>,
    failure: RefCell<Option<String>>,
    held_elsewhere: RefCell<BTreeSet<SceneId>>,
}

#[derive(Debug, Default)]
struct Kept {
    scenes: BTreeMap<SceneId, Record>,
    /// By content.
    assets: BTreeMap<String, SavedAsset>,
    last_open: Option<SceneId>,
}

#[derive(Debug, Clone)]
struct Record {
    heading: SceneHeading,
    json: String,
    /// Keys and the names that the files have in this scene.
    assets: Vec<(String, String)>,
    /// Of which asset, and as above.
    companions: Vec<(String, (String, String))>,
}

impl Record {
    /// The keys of all files, some more than once.
    fn keys(&self) -> impl Iterator<Item = &String> {
        let companions = self.companions.iter().map(|(_, file)| file);
        self.assets.iter().chain(companions).map(|(key, _)| key)
    }
}

impl MemoryStorage {
    /// From now on saving fails for this reason, or works again.
    pub fn fail_with(&self, reason: Option<&str>) {
        *self.failure.borrow_mut() = reason.map(str::to_owned);
    }

    /// From now on another window has this scene.
    pub fn hold_elsewhere(&self, id: &SceneId) {
        self.held_elsewhere.borrow_mut().insert(id.clone());
    }

    /// The content of this file is stored no more, as when a disk is damaged.
    pub fn lose(&self, file_name: &str) {
        self.kept.borrow_mut().assets.retain(|_, asset| asset.file_name != file_name);
    }

    /// The content of how many files is stored.
    pub fn asset_count(&self) -> usize {
        self.kept.borrow().assets.len()
    }
}

impl Kept {
    fn bytes(&self, record: &Record) -> u64 {
        let keys: BTreeSet<&String> = record.keys().collect();
        let sizes = keys.into_iter().filter_map(|key| self.assets.get(key));
        record.json.len() as u64 + sizes.map(|asset| asset.bytes.len() as u64).sum::<u64>()
    }

    fn list(&self) -> Vec<SceneSummary> {
        let summary = |(id, record): (&SceneId, &Record)| SceneSummary {
            id: id.clone(),
            heading: record.heading.clone(),
            bytes: self.bytes(record),
        };
        let mut scenes: Vec<SceneSummary> = self.scenes.iter().map(summary).collect();
        sort_scenes(&mut scenes);
        scenes
    }

    fn load(&self, id: &SceneId) -> Option<Saved> {
        let record = self.scenes.get(id)?;
        let asset = |(key, file_name): &(String, String)| {
            Some(SavedAsset { file_name: file_name.clone(), ..self.assets.get(key)?.clone() })
        };
        Some(Saved {
            heading: record.heading.clone(),
            json: record.json.clone(),
            assets: record.assets.iter().filter_map(asset).collect(),
            companions: record
                .companions
                .iter()
                .filter_map(|(of, file)| Some(SavedCompanion { of: of.clone(), file: asset(file)? }))
                .collect(),
        })
    }

    fn save(&mut self, id: &SceneId, saved: &Saved, terms: SaveTerms) -> SaveOutcome {
        let stored_ms = self.scenes.get(id).map(|record| record.heading.changed_at_ms);
        if terms.last_seen_ms.is_some() && stored_ms.is_some() && stored_ms != terms.last_seen_ms {
            return SaveOutcome::ChangedElsewhere;
        }
        let named = |asset: &SavedAsset| (asset.key.clone(), asset.file_name.clone());
        let companions = saved.companions.iter();
        let record = Record {
            assets: distinct(&saved.assets).map(named).collect(),
            companions: companions.map(|one| (one.of.clone(), named(&one.file))).collect(),
            heading: saved.heading.clone(),
            json: saved.json.clone(),
        };
        self.scenes.insert(id.clone(), record);
        self.assets.extend(saved.files().map(|file| (file.key.clone(), file.clone())));
        self.remove_unneeded();
        if terms.opens_next {
            self.last_open = Some(id.clone());
        }
        SaveOutcome::Saved
    }

    fn remove_unneeded(&mut self) {
        let needed: BTreeSet<&String> = self.scenes.values().flat_map(Record::keys).collect();
        self.assets.retain(|key, _| needed.contains(key));
    }
}

fn ready<T: 'static>(value: T) -> StorageFuture<T> {
    Box::pin(async { Ok(value) })
}

impl Storage for MemoryStorage {
    fn list(&self) -> StorageFuture<Vec<SceneSummary>> {
        ready(self.kept.borrow().list())
    }

    fn load(&self, id: &SceneId) -> StorageFuture<Option<Saved>> {
        ready(self.kept.borrow().load(id))
    }

    fn save(&self, id: &SceneId, saved: Saved, terms: SaveTerms) -> StorageFuture<SaveOutcome> {
        if let Some(reason) = self.failure.borrow().clone() {
            return Box::pin(async { Err(reason) });
        }
        ready(self.kept.borrow_mut().save(id, &saved, terms))
    }

    fn claim(&self, id: &SceneId) -> StorageFuture<bool> {
        ready(!self.held_elsewhere.borrow().contains(id))
    }

    fn rename(&self, id: &SceneId, name: &str) -> StorageFuture<()> {
        if let Some(record) = self.kept.borrow_mut().scenes.get_mut(id) {
            name.clone_into(&mut record.heading.name);
        }
        ready(())
    }

    fn duplicate(&self, id: &SceneId, copy: &SceneId, name: &str) -> StorageFuture<()> {
        let mut kept = self.kept.borrow_mut();
        if let Some(mut record) = kept.scenes.get(id).cloned() {
            name.clone_into(&mut record.heading.name);
            kept.scenes.insert(copy.clone(), record);
        }
        ready(())
    }

    fn delete(&self, id: &SceneId) -> StorageFuture<()> {
        let mut kept = self.kept.borrow_mut();
        kept.scenes.remove(id);
        kept.remove_unneeded();
        drop(kept);
        self.remove_journal(id);
        ready(())
    }

    fn last_open(&self) -> StorageFuture<Option<SceneId>> {
        ready(self.kept.borrow().last_open.clone())
    }

    fn set_last_open(&self, id: &SceneId) -> StorageFuture<()> {
        self.kept.borrow_mut().last_open = Some(id.clone());
        ready(())
    }

    fn usage(&self) -> StorageFuture<StorageUse> {
        let kept = self.kept.borrow();
        let documents: u64 = kept.scenes.values().map(|record| record.json.len() as u64).sum();
        let assets: u64 = kept.assets.values().map(|asset| asset.bytes.len() as u64).sum();
        ready(StorageUse { used_bytes: documents + assets, quota_bytes: None })
    }

    fn write_journal(&self, id: &SceneId, journal: &Journal) {
        self.journals.borrow_mut().insert(id.clone(), journal.clone());
    }

    fn read_journal(&self, id: &SceneId) -> Option<Journal> {
        self.journals.borrow().get(id).cloned()
    }

    fn remove_journal(&self, id: &SceneId) {
        self.journals.borrow_mut().remove(id);
    }
}
