//! Scenes as files in a folder.

mod record;

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::platform::storage::{
    Journal, Remains, SaveOutcome, SaveTerms, Saved, SavedAsset, SavedCompanion, SceneId, SceneSummary,
    Storage, StorageFuture, StorageUse, distinct, sort_scenes,
};
use record::{AssetLine, Record};

/// `scenes/ID.scene` (what is said about a scene, and its document), `assets/SHA256` for all scenes, `journals/ID`,
/// `last_open`. A scene is renamed into place as a whole and last, so it never speaks of a file that is not there.
pub struct FolderStorage {
    folder: PathBuf,
    /// The lock of the scene that this program writes; it ends with the program, however that ends.
    claim: RefCell<Option<(SceneId, fs::File)>>,
}

impl FolderStorage {
    pub fn new(folder: PathBuf) -> Self {
        Self { folder, claim: RefCell::default() }
    }

    fn scenes(&self) -> PathBuf {
        self.folder.join("scenes")
    }

    fn assets(&self) -> PathBuf {
        self.folder.join("assets")
    }

    fn scene_path(&self, id: &SceneId) -> PathBuf {
        self.scenes().join(format!("{}.scene", file_name(id.as_str())))
    }

    fn journal_path(&self, id: &SceneId) -> PathBuf {
        self.folder.join("journals").join(file_name(id.as_str()))
    }

    fn claim_now(&self, id: &SceneId) -> io::Result<bool> {
        if self.claim.borrow().as_ref().is_some_and(|(claimed, _)| claimed == id) {
            return Ok(true);
        }
        *self.claim.borrow_mut() = None;
        let folder = self.folder.join("locks");
        fs::create_dir_all(&folder)?;
        let file = fs::File::create(folder.join(file_name(id.as_str())))?;
        match file.try_lock() {
            Ok(()) => {
                *self.claim.borrow_mut() = Some((id.clone(), file));
                Ok(true)
            }
            Err(fs::TryLockError::WouldBlock) => Ok(false),
            Err(fs::TryLockError::Error(error)) => Err(error),
        }
    }

    fn record(&self, id: &SceneId) -> io::Result<Option<Record>> {
        match read_if_there(&self.scene_path(id))? {
            Some(text) => Record::from_text(&text).map(Some),
            None => Ok(None),
        }
    }

    /// Of each scene, or why it cannot be read.
    fn records(&self) -> io::Result<Vec<(SceneId, io::Result<Record>)>> {
        let mut records = Vec::new();
        for path in files_in(&self.scenes())? {
            let id = path.file_stem().unwrap_or_default().to_string_lossy();
            if path.extension().is_some_and(|extension| extension == "scene") {
                let record = fs::read_to_string(&path).and_then(|text| Record::from_text(&text));
                records.push((SceneId::new(&id), record));
            }
        }
        Ok(records)
    }

    fn list_now(&self) -> io::Result<Vec<SceneSummary>> {
        // One that is damaged is listed too: that it cannot be opened is said when it is tried.
        let summary = |(id, record): (SceneId, io::Result<Record>)| {
            let record = record.unwrap_or_else(|_| Record::of_damaged(id.as_str()));
            SceneSummary { id, bytes: record.bytes(), heading: record.heading }
        };
        let mut scenes: Vec<SceneSummary> = self.records()?.into_iter().map(summary).collect();
        sort_scenes(&mut scenes);
        Ok(scenes)
    }

    fn load_now(&self, id: &SceneId) -> io::Result<Option<Saved>> {
        let Some(record) = self.record(id)? else { return Ok(None) };
        let read = |line: AssetLine| {
            let bytes = Arc::from(fs::read(self.assets().join(file_name(&line.key))).ok()?);
            Some(SavedAsset { key: line.key, file_name: line.file_name, bytes })
        };
        let companion = |(of, line)| Some(SavedCompanion { of, file: read(line)? });
        Ok(Some(Saved {
            heading: record.heading,
            json: record.json,
            assets: record.assets.into_iter().filter_map(read).collect(),
            companions: record.companions.into_iter().filter_map(companion).collect(),
        }))
    }

    /// What can be loaded, or the scene's file as it is.
    fn remains_now(&self, id: &SceneId) -> io::Result<Remains> {
        match self.load_now(id) {
            Ok(saved) => Ok(saved.map(Remains::from).unwrap_or_default()),
            Err(_) => {
                let bytes = fs::read(self.scene_path(id))?;
                let text = String::from_utf8_lossy(&bytes).into_owned();
                Ok(Remains { unreadable: vec![("scene.txt".to_owned(), text)], ..Remains::default() })
            }
        }
    }

    fn save_now(&self, id: &SceneId, saved: Saved, terms: SaveTerms) -> io::Result<SaveOutcome> {
        let stored_ms = self.record(id)?.map(|record| record.heading.changed_at_ms);
        if terms.last_seen_ms.is_some() && stored_ms.is_some() && stored_ms != terms.last_seen_ms {
            return Ok(SaveOutcome::ChangedElsewhere);
        }
        for file in saved.files() {
            let path = self.assets().join(file_name(&file.key));
            let stored_bytes = fs::metadata(&path).map(|data| data.len());
            if stored_bytes.ok() != Some(file.bytes.len() as u64) {
                write_whole(&path, &file.bytes)?;
            }
        }
        let line = |file: &SavedAsset| AssetLine {
            key: file.key.clone(),
            bytes: file.bytes.len() as u64,
            file_name: file.file_name.clone(),
        };
        let companions = saved.companions.iter().map(|one| (one.of.clone(), line(&one.file))).collect();
        let assets = distinct(&saved.assets).map(line).collect();
        self.write_record(id, &Record { heading: saved.heading, assets, companions, json: saved.json })?;
        self.remove_unneeded()?;
        if terms.opens_next {
            self.set_last_open_now(id)?;
        }
        Ok(SaveOutcome::Saved)
    }

    fn set_last_open_now(&self, id: &SceneId) -> io::Result<()> {
        write_whole(&self.folder.join("last_open"), id.as_str().as_bytes())
    }

    fn write_record(&self, id: &SceneId, record: &Record) -> io::Result<()> {
        write_whole(&self.scene_path(id), record.to_text().as_bytes())
    }

    fn copy_now(&self, id: &SceneId, copy: &SceneId, name: &str) -> io::Result<()> {
        let Some(mut record) = self.record(id)? else { return Ok(()) };
        name.clone_into(&mut record.heading.name);
        self.write_record(copy, &record)
    }

    fn delete_now(&self, id: &SceneId) -> io::Result<()> {
        remove_if_there(&self.scene_path(id))?;
        remove_if_there(&self.journal_path(id))?;
        remove_if_there(&self.folder.join("locks").join(file_name(id.as_str())))?;
        self.remove_unneeded()
    }

    fn remove_unneeded(&self) -> io::Result<()> {
        let records = self.records()?.into_iter().map(|(_, record)| record);
        // Whose files these are cannot be told while a scene does not say.
        let Ok(records) = records.collect::<io::Result<Vec<Record>>>() else { return Ok(()) };
        let files = records.iter().flat_map(Record::files);
        let needed: BTreeSet<PathBuf> = files.map(|file| self.assets().join(file_name(&file.key))).collect();
        for path in files_in(&self.assets())? {
            if !needed.contains(&path) {
                fs::remove_file(path)?;
            }
        }
        Ok(())
    }

    fn used_bytes(&self) -> io::Result<u64> {
        let mut bytes = 0;
        for folder in [self.scenes(), self.assets()] {
            for path in files_in(&folder)? {
                bytes += fs::metadata(path)?.len();
            }
        }
        Ok(bytes)
    }
}

impl Storage for FolderStorage {
    fn list(&self) -> StorageFuture<Vec<SceneSummary>> {
        done(self.list_now(), "the saved scenes cannot be listed")
    }

    fn load(&self, id: &SceneId) -> StorageFuture<Option<Saved>> {
        done(self.load_now(id), "the saved scene cannot be read")
    }

    fn remains(&self, id: &SceneId) -> StorageFuture<Remains> {
        done(self.remains_now(id), "the saved scene cannot be read")
    }

    fn save(&self, id: &SceneId, saved: Saved, terms: SaveTerms) -> StorageFuture<SaveOutcome> {
        done(self.save_now(id, saved, terms), "the scene cannot be saved")
    }

    fn claim(&self, id: &SceneId) -> StorageFuture<bool> {
        done(self.claim_now(id), "whether another window has the scene is not known")
    }

    fn rename(&self, id: &SceneId, name: &str) -> StorageFuture<()> {
        done(self.copy_now(id, id, name), "the scene cannot be renamed")
    }

    fn duplicate(&self, id: &SceneId, copy: &SceneId, name: &str) -> StorageFuture<()> {
        done(self.copy_now(id, copy, name), "the scene cannot be copied")
    }

    fn delete(&self, id: &SceneId) -> StorageFuture<()> {
        done(self.delete_now(id), "the scene cannot be deleted")
    }

    fn last_open(&self) -> StorageFuture<Option<SceneId>> {
        let text = read_if_there(&self.folder.join("last_open"));
        let id = text.map(|text| text.map(|text| SceneId::new(text.trim())));
        done(id, "the saved scenes cannot be read")
    }

    fn set_last_open(&self, id: &SceneId) -> StorageFuture<()> {
        done(self.set_last_open_now(id), "which scene was open cannot be saved")
    }

    fn usage(&self) -> StorageFuture<StorageUse> {
        let used = self.used_bytes().map(|used_bytes| StorageUse { used_bytes, quota_bytes: None });
        done(used, "the size of the saved scenes is not known")
    }

    fn write_journal(&self, id: &SceneId, journal: &Journal) {
        write_whole(&self.journal_path(id), journal.to_text().as_bytes())
            .unwrap_or_else(|error| log::warn!("the last changes were not put aside: {error}"));
    }

    fn read_journal(&self, id: &SceneId) -> Option<Journal> {
        Journal::from_text(&fs::read_to_string(self.journal_path(id)).ok()?)
    }

    fn remove_journal(&self, id: &SceneId) {
        remove_if_there(&self.journal_path(id))
            .unwrap_or_else(|error| log::warn!("what was put aside is still there: {error}"));
    }
}

/// On the desktop everything is done at once.
fn done<T: 'static>(result: io::Result<T>, what: &str) -> StorageFuture<T> {
    let result = result.map_err(|error| format!("{what}: {error}"));
    Box::pin(async { result })
}

/// A file is there as a whole or not at all.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let unfinished = path.with_extension("unfinished");
    fs::write(&unfinished, bytes)?;
    fs::rename(unfinished, path)
}

pub fn read_if_there(path: &Path) -> io::Result<Option<String>> {
    match fs::read_to_string(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        other => other.map(Some),
    }
}

fn remove_if_there(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        other => other,
    }
}

/// No files where there is no folder yet.
fn files_in(folder: &Path) -> io::Result<Vec<PathBuf>> {
    match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        entries => entries?.map(|entry| Ok(entry?.path())).collect(),
    }
}

/// A name that stays in its folder, whatever it was made of.
pub fn file_name(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' }).collect()
}
