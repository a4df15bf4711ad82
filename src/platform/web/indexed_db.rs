//! Scenes in IndexedDB: one transaction a save, so that a scene is there as a whole or not at all.
//!
//! Database `pinpose` version 2. Version 1 had no `scenes`: its two documents get their headings when the database is
//! opened. The crash screen reads `state` and `documents`, without this code.
//!
//! | store | key | value |
//! |---|---|---|
//! | `scenes` | scene id | what the list says of it, and the keys of all its files |
//! | `documents` | scene id | `{json, assets, companions: [{of, key, name}]}` |
//! | `assets` | SHA-256 of the content | `{name, bytes}` |
//! | `state` | `last_open` | a scene id |

mod records;

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use idb::builder::{DatabaseBuilder, ObjectStoreBuilder};
use idb::{Database, ObjectStore, Query, Transaction, TransactionMode};
use js_sys::Reflect;
use wasm_bindgen::prelude::*;

use super::{browser_storage, describe};
use crate::platform::storage::{
    Journal, Remains, SaveOutcome, SaveTerms, Saved, SavedAsset, SavedCompanion, SceneHeading, SceneId,
    SceneSummary, Storage, StorageFuture, StorageUse, distinct, sort_scenes,
};

const SCENES: &str = "scenes";
const DOCUMENTS: &str = "documents";
const ASSETS: &str = "assets";
const STATE: &str = "state";
const ALL: [&str; 4] = [SCENES, DOCUMENTS, ASSETS, STATE];
const LAST_OPEN: &str = "last_open";

/// The only scene that version 1 knew, besides the example.
const ONLY_SCENE_OF_VERSION_1: &str = "current";

type Connection = Rc<RefCell<Option<Rc<Database>>>>;

/// Files that were read or written, with their sizes: what is stored under these keys is known.
type Sound = Rc<RefCell<BTreeMap<String, usize>>>;

#[derive(Default)]
pub struct IndexedDb {
    connection: Connection,
    sound: Sound,
}

impl IndexedDb {
    /// Runs one transaction; its error is told as "what: why".
    fn run<T: 'static>(
        &self,
        what: &'static str,
        mode: TransactionMode,
        work: impl AsyncFnOnce(&Transaction) -> Result<T, idb::Error> + 'static,
    ) -> StorageFuture<T> {
        let connection = self.connection.clone();
        Box::pin(async move {
            let result = async {
                let database = open(&connection).await?;
                let transaction = database.transaction(&ALL, mode)?;
                match work(&transaction).await {
                    Ok(result) => {
                        if mode == TransactionMode::ReadWrite {
                            commit(transaction).await?;
                        }
                        Ok(result)
                    }
                    Err(error) => {
                        // All or nothing. Where the browser has given up already, there is nothing to abort.
                        transaction.abort().ok();
                        Err(error)
                    }
                }
            };
            result.await.map_err(|error| format!("{what}: {}", in_words(&error)))
        })
    }

    fn read<T: 'static>(
        &self,
        what: &'static str,
        work: impl AsyncFnOnce(&Transaction) -> Result<T, idb::Error> + 'static,
    ) -> StorageFuture<T> {
        self.run(what, TransactionMode::ReadOnly, work)
    }

    fn write<T: 'static>(
        &self,
        what: &'static str,
        work: impl AsyncFnOnce(&Transaction) -> Result<T, idb::Error> + 'static,
    ) -> StorageFuture<T> {
        self.run(what, TransactionMode::ReadWrite, work)
    }
}

impl Storage for IndexedDb {
    fn list(&self) -> StorageFuture<Vec<SceneSummary>> {
        self.read("the saved scenes cannot be listed", async |transaction| {
            let store = transaction.object_store(SCENES)?;
            let keys = store.get_all_keys(None, None)?.await?;
            let values = store.get_all(None, None)?.await?;
            let mut scenes: Vec<SceneSummary> =
                keys.iter().zip(&values).filter_map(records::summary).collect();
            sort_scenes(&mut scenes);
            Ok(scenes)
        })
    }

    fn load(&self, id: &SceneId) -> StorageFuture<Option<Saved>> {
        let (id, sound) = (id.clone(), self.sound.clone());
        let loading = self.read("the saved scene cannot be read", async move |transaction| {
            let loaded = load(transaction, &id).await?;
            if let Ok(Some(saved)) = &loaded {
                sound.borrow_mut().extend(saved.files().map(size_by_key));
            }
            Ok(loaded)
        });
        Box::pin(async { loading.await? })
    }

    fn remains(&self, id: &SceneId) -> StorageFuture<Remains> {
        let id = id.clone();
        self.read("the saved scene cannot be read", async move |transaction| remains(transaction, &id).await)
    }

    fn save(&self, id: &SceneId, saved: Saved, terms: SaveTerms) -> StorageFuture<SaveOutcome> {
        if terms.opens_next {
            browser_storage::write_of_tab(LAST_OPEN, id.as_str());
        }
        let (id, sound) = (id.clone(), self.sound.clone());
        let sizes: Vec<(String, usize)> = saved.files().map(size_by_key).collect();
        let known = sound.clone();
        let saving = self.write("the scene cannot be saved", async move |transaction| {
            save(transaction, &id, saved, terms, &known).await
        });
        Box::pin(async move {
            let outcome = saving.await?;
            if outcome == SaveOutcome::Saved {
                sound.borrow_mut().extend(sizes);
            }
            Ok(outcome)
        })
    }

    fn claim(&self, id: &SceneId) -> StorageFuture<bool> {
        let claim = super::page_claim(&format!("pinpose-scene-{}", id.as_str()));
        Box::pin(async move {
            let is_ours = wasm_bindgen_futures::JsFuture::from(claim).await;
            is_ours.map(|is_ours| is_ours.is_truthy()).map_err(|error| describe(&error))
        })
    }

    fn rename(&self, id: &SceneId, name: &str) -> StorageFuture<()> {
        let (id, name) = (id.clone(), name.to_owned());
        self.write("the scene cannot be renamed", async move |transaction| {
            copy_heading(transaction, &id, &id, &name).await
        })
    }

    fn duplicate(&self, id: &SceneId, copy: &SceneId, name: &str) -> StorageFuture<()> {
        let (id, copy, name) = (id.clone(), copy.clone(), name.to_owned());
        self.write("the scene cannot be copied", async move |transaction| {
            let documents = transaction.object_store(DOCUMENTS)?;
            if let Some(document) = documents.get(key(&id))?.await? {
                documents.put(&document, Some(&copy.as_str().into()))?.await?;
            }
            copy_heading(transaction, &id, &copy, &name).await
        })
    }

    fn delete(&self, id: &SceneId) -> StorageFuture<()> {
        self.remove_journal(id);
        let id = id.clone();
        self.write("the scene cannot be deleted", async move |transaction| {
            transaction.object_store(SCENES)?.delete(key(&id))?.await?;
            transaction.object_store(DOCUMENTS)?.delete(key(&id))?.await?;
            remove_unneeded(transaction).await
        })
    }

    /// A tab that is loaded again comes back to its own scene, a new one to the scene that was open last.
    fn last_open(&self) -> StorageFuture<Option<SceneId>> {
        let of_this_tab = browser_storage::read_of_tab(LAST_OPEN);
        self.read("the saved scenes cannot be read", async move |transaction| {
            let scenes = transaction.object_store(SCENES)?;
            let last = transaction.object_store(STATE)?.get(Query::Key(LAST_OPEN.into()))?.await?;
            let last = last.and_then(|id| id.as_string());
            for id in [of_this_tab, last, Some(ONLY_SCENE_OF_VERSION_1.to_owned())].into_iter().flatten() {
                let id = SceneId::new(&id);
                if scenes.get_key(key(&id))?.await?.is_some() {
                    return Ok(Some(id));
                }
            }
            Ok(None)
        })
    }

    fn set_last_open(&self, id: &SceneId) -> StorageFuture<()> {
        browser_storage::write_of_tab(LAST_OPEN, id.as_str());
        let id = id.clone();
        self.write("which scene was open cannot be saved", async move |transaction| {
            set_last_open(transaction, &id).await
        })
    }

    fn usage(&self) -> StorageFuture<StorageUse> {
        Box::pin(async {
            browser_storage::usage()
                .await
                .map_err(|error| format!("the browser does not say how much is stored: {}", describe(&error)))
        })
    }

    fn ask_to_persist(&self) -> StorageFuture<()> {
        Box::pin(async {
            browser_storage::ask_to_persist().await;
            Ok(())
        })
    }

    fn write_journal(&self, id: &SceneId, journal: &Journal) {
        browser_storage::write(&journal_key(id), &journal.to_text());
    }

    fn read_journal(&self, id: &SceneId) -> Option<Journal> {
        Journal::from_text(&browser_storage::read(&journal_key(id))?)
    }

    fn remove_journal(&self, id: &SceneId) {
        browser_storage::remove(&journal_key(id));
    }
}

/// A full disk shows when a transaction is committed: it is aborted then, though every request in it went well.
async fn commit(transaction: Transaction) -> Result<(), idb::Error> {
    let of_browser = JsValue::from(transaction);
    let committing = Transaction::try_from(of_browser.clone())?.commit()?;
    if committing.await?.is_committed() {
        return Ok(());
    }
    let error = Reflect::get(&of_browser, &"error".into()).and_then(JsCast::dyn_into);
    Err(error.map_or(idb::Error::DomExceptionNotFound, idb::Error::DomException))
}

async fn open(connection: &Connection) -> Result<Rc<Database>, idb::Error> {
    if let Some(database) = connection.borrow().as_ref() {
        return Ok(database.clone());
    }
    let mut database = DatabaseBuilder::new("pinpose")
        .version(2)
        .add_object_store(ObjectStoreBuilder::new(SCENES))
        .add_object_store(ObjectStoreBuilder::new(DOCUMENTS))
        .add_object_store(ObjectStoreBuilder::new(ASSETS))
        .add_object_store(ObjectStoreBuilder::new(STATE))
        .build()
        .await?;
    // A newer PinPose in another tab needs the database for itself; the next access here says so.
    let open_one = connection.clone();
    database.on_version_change(move |_| {
        if let Some(database) = open_one.borrow_mut().take() {
            database.close();
        }
    });
    let database = Rc::new(database);
    // What can be read can be opened, also where something else is damaged.
    if let Err(error) = give_headings(&database).await {
        log::warn!("not every saved scene has its heading: {error}");
    }
    *connection.borrow_mut() = Some(database.clone());
    Ok(database)
}

/// Documents of version 1 become scenes, and what lost its heading gets one again.
async fn give_headings(database: &Database) -> Result<(), idb::Error> {
    let transaction = database.transaction(&ALL, TransactionMode::ReadWrite)?;
    let (scenes, documents) = (transaction.object_store(SCENES)?, transaction.object_store(DOCUMENTS)?);
    for id in documents.get_all_keys(None, None)?.await? {
        let heading = scenes.get(Query::Key(id.clone()))?.await?;
        if heading.is_some_and(|heading| records::is_heading(&heading)) {
            continue;
        }
        let Some(document) = documents.get(Query::Key(id.clone()))?.await? else { continue };
        let Some(json) = records::text_field(&document, "json") else { continue };
        let keys = records::file_keys(&document);
        let mut bytes = json.len() as u64;
        for asset in &keys {
            let stored = transaction.object_store(ASSETS)?.get(Query::Key(asset.as_str().into()))?.await?;
            bytes += stored.as_ref().map_or(0, records::asset_bytes);
        }
        let heading = records::heading_of_document(&json, super::now_ms());
        scenes.put(&records::scene(&heading, bytes, &keys), Some(&id))?.await?;
    }
    commit(transaction).await
}

/// The inner error is a sentence: the scene is there, but not in a form that can be opened.
async fn load(transaction: &Transaction, id: &SceneId) -> Result<Result<Option<Saved>, String>, idb::Error> {
    let scene = transaction.object_store(SCENES)?.get(key(id))?.await?;
    let document = transaction.object_store(DOCUMENTS)?.get(key(id))?.await?;
    if scene.is_none() && document.is_none() {
        return Ok(Ok(None));
    }
    let heading = scene.as_ref().map_or_else(SceneHeading::default, records::heading);
    let json = document.as_ref().and_then(|document| records::text_field(document, "json"));
    let (Some(document), Some(json)) = (document, json) else {
        return Ok(Err(format!("{} cannot be opened: its document is damaged", heading.title())));
    };
    let store = transaction.object_store(ASSETS)?;
    let mut assets = Vec::new();
    for asset in records::asset_keys(&document) {
        if let Some(value) = store.get(Query::Key(asset.as_str().into()))?.await? {
            assets.extend(records::read_asset(asset, &value));
        }
    }
    let mut companions = Vec::new();
    for (of, key, file_name) in records::companions(&document) {
        if let Some(value) = store.get(Query::Key(key.as_str().into()))?.await?
            && let Some(file) = records::read_asset(key, &value)
        {
            companions.push(SavedCompanion { of, file: SavedAsset { file_name, ..file } });
        }
    }
    Ok(Ok(Some(Saved { heading, json, assets, companions })))
}

/// Takes each record for what it still is.
async fn remains(transaction: &Transaction, id: &SceneId) -> Result<Remains, idb::Error> {
    let scene = transaction.object_store(SCENES)?.get(key(id))?.await?;
    let document = transaction.object_store(DOCUMENTS)?.get(key(id))?.await?;
    let mut remains = Remains::default();
    let unreadable = |name: &str, value: &JsValue| (format!("{name}.json"), records::as_text(value));
    if let Some(document) = &document {
        remains.json = records::text_field(document, "json");
        if remains.json.is_none() {
            remains.unreadable.push(unreadable("document", document));
        }
    }
    if let Some(scene) = scene.as_ref().filter(|scene| !records::is_heading(scene)) {
        remains.unreadable.push(unreadable("heading", scene));
    }
    let companions = document.as_ref().map(records::companions).unwrap_or_default();
    let mut keys: BTreeSet<String> = scene.iter().chain(&document).flat_map(records::file_keys).collect();
    let store = transaction.object_store(ASSETS)?;
    for (of, asset, file_name) in companions {
        keys.remove(&asset);
        if let Some(value) = store.get(Query::Key(asset.as_str().into()))?.await?
            && let Some(file) = records::read_asset(asset, &value)
        {
            remains.companions.push(SavedCompanion { of, file: SavedAsset { file_name, ..file } });
        }
    }
    for asset in keys {
        let Some(value) = store.get(Query::Key(asset.as_str().into()))?.await? else { continue };
        match records::read_asset(asset.clone(), &value) {
            Some(asset) => remains.assets.push(asset),
            None => remains.unreadable.push(unreadable(&asset, &value)),
        }
    }
    Ok(remains)
}

/// What is stored is looked up within the transaction: another tab may have changed it.
async fn save(
    transaction: &Transaction,
    id: &SceneId,
    saved: Saved,
    terms: SaveTerms,
    sound: &Sound,
) -> Result<SaveOutcome, idb::Error> {
    let scenes = transaction.object_store(SCENES)?;
    let stored_ms = scenes.get(key(id))?.await?.map(|scene| records::heading(&scene).changed_at_ms);
    if terms.last_seen_ms.is_some() && stored_ms.is_some() && stored_ms != terms.last_seen_ms {
        return Ok(SaveOutcome::ChangedElsewhere);
    }
    let assets = transaction.object_store(ASSETS)?;
    let stored = stored_asset_keys(transaction).await?;
    for file in saved.files() {
        // What another tab has stored, or what is not as long as it should be, is looked at.
        let is_known = sound.borrow().get(&file.key) == Some(&file.bytes.len());
        if stored.contains(&file.key) && (is_known || is_stored(&assets, file).await?) {
            continue;
        }
        assets.put(&records::asset(file), Some(&file.key.as_str().into()))?.await?;
    }
    let keys: Vec<String> = distinct(&saved.assets).map(|asset| asset.key.clone()).collect();
    let document = records::document(&saved.json, &keys, &saved.companions);
    transaction.object_store(DOCUMENTS)?.put(&document, Some(&id.as_str().into()))?.await?;
    let needed: Vec<String> = saved.files().map(|file| file.key.clone()).collect();
    let scene = records::scene(&saved.heading, saved.bytes(), &needed);
    scenes.put(&scene, Some(&id.as_str().into()))?.await?;
    remove_unneeded(transaction).await?;
    if terms.opens_next {
        set_last_open(transaction, id).await?;
    }
    Ok(SaveOutcome::Saved)
}

fn size_by_key(file: &SavedAsset) -> (String, usize) {
    (file.key.clone(), file.bytes.len())
}

async fn is_stored(assets: &ObjectStore, file: &SavedAsset) -> Result<bool, idb::Error> {
    let value = assets.get(Query::Key(file.key.as_str().into()))?.await?;
    Ok(value
        .and_then(|value| records::read_asset(file.key.clone(), &value))
        .is_some_and(|it| it.bytes == file.bytes))
}

async fn set_last_open(transaction: &Transaction, id: &SceneId) -> Result<(), idb::Error> {
    let state = transaction.object_store(STATE)?;
    state.put(&id.as_str().into(), Some(&LAST_OPEN.into()))?.await?;
    Ok(())
}

async fn copy_heading(
    transaction: &Transaction,
    id: &SceneId,
    copy: &SceneId,
    name: &str,
) -> Result<(), idb::Error> {
    let scenes = transaction.object_store(SCENES)?;
    let Some(scene) = scenes.get(key(id))?.await? else { return Ok(()) };
    records::set_name(&scene, name);
    scenes.put(&scene, Some(&copy.as_str().into()))?.await?;
    Ok(())
}

async fn remove_unneeded(transaction: &Transaction) -> Result<(), idb::Error> {
    let mut records = transaction.object_store(SCENES)?.get_all(None, None)?.await?;
    let unneeded = |records: &[JsValue], stored: &BTreeSet<String>| -> BTreeSet<String> {
        let needed: BTreeSet<String> = records.iter().flat_map(records::file_keys).collect();
        stored.difference(&needed).cloned().collect()
    };
    let stored = stored_asset_keys(transaction).await?;
    if unneeded(&records, &stored).is_empty() {
        return Ok(());
    }
    // Before anything goes, the documents are asked too: a heading may be damaged.
    records.extend(transaction.object_store(DOCUMENTS)?.get_all(None, None)?.await?);
    if !records.iter().all(records::names_its_files) {
        return Ok(());
    }
    let assets = transaction.object_store(ASSETS)?;
    for key in unneeded(&records, &stored) {
        assets.delete(Query::Key(key.as_str().into()))?.await?;
    }
    Ok(())
}

async fn stored_asset_keys(transaction: &Transaction) -> Result<BTreeSet<String>, idb::Error> {
    let keys = transaction.object_store(ASSETS)?.get_all_keys(None, None)?.await?;
    Ok(keys.iter().filter_map(JsValue::as_string).collect())
}

fn key(id: &SceneId) -> Query {
    Query::Key(id.as_str().into())
}

fn journal_key(id: &SceneId) -> String {
    format!("pinpose journal {}", id.as_str())
}

/// The two failures that a user can do something about, and the others as the browser puts them.
fn in_words(error: &idb::Error) -> String {
    let name = match error {
        idb::Error::DomException(exception) => Reflect::get(exception, &"name".into()).ok(),
        _ => None,
    };
    match name.and_then(|name| name.as_string()).as_deref() {
        Some("VersionError") => "a newer PinPose has stored here. Load this page again to use it".to_owned(),
        Some("QuotaExceededError") => {
            "the browser's storage is full. Delete scenes that are not needed any more".to_owned()
        }
        _ => error.to_string(),
    }
}
