//! The saved scene in IndexedDB: one transaction a save, so that it is there as a whole or not at all.
//!
//! Database `pinpose` version 1; `documents` holds `{json}` under `current`, `assets` holds `{name, bytes}` under the
//! content's SHA-256. The crash screen reads the same, without this code.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::rc::Rc;
use std::sync::Arc;

use idb::builder::{DatabaseBuilder, ObjectStoreBuilder};
use idb::{Database, Query, TransactionMode};
use js_sys::{Object, Reflect, Uint8Array};
use wasm_bindgen::prelude::*;

use crate::platform::storage::{Saved, SavedAsset, Storage, StorageFuture};

const DOCUMENTS: &str = "documents";
const ASSETS: &str = "assets";
const CURRENT: &str = "current";

#[derive(Default)]
pub struct IndexedDb {
    state: Rc<RefCell<State>>,
}

#[derive(Default)]
struct State {
    database: Option<Rc<Database>>,
    /// The assets that are in the database, to write each once.
    stored: BTreeSet<String>,
}

impl Storage for IndexedDb {
    fn load(&self) -> StorageFuture<Option<Saved>> {
        let state = self.state.clone();
        Box::pin(async move {
            load(&state).await.map_err(|error| format!("the saved scene cannot be read: {error}"))
        })
    }

    fn save(&self, saved: Saved) -> StorageFuture<()> {
        let state = self.state.clone();
        Box::pin(async move {
            save(&state, saved).await.map_err(|error| format!("the scene cannot be saved: {error}"))
        })
    }
}

async fn open(state: &RefCell<State>) -> Result<Rc<Database>, idb::Error> {
    if let Some(database) = &state.borrow().database {
        return Ok(database.clone());
    }
    let database = DatabaseBuilder::new("pinpose")
        .version(1)
        .add_object_store(ObjectStoreBuilder::new(DOCUMENTS))
        .add_object_store(ObjectStoreBuilder::new(ASSETS))
        .build()
        .await?;
    let database = Rc::new(database);
    state.borrow_mut().database = Some(database.clone());
    Ok(database)
}

async fn load(state: &RefCell<State>) -> Result<Option<Saved>, idb::Error> {
    let database = open(state).await?;
    let transaction = database.transaction(&[DOCUMENTS, ASSETS], TransactionMode::ReadOnly)?;
    let document = transaction.object_store(DOCUMENTS)?.get(Query::Key(CURRENT.into()))?.await?;
    let Some(json) = document.and_then(|document| text_field(&document, "json")) else { return Ok(None) };
    let store = transaction.object_store(ASSETS)?;
    let mut assets = Vec::new();
    for key in store.get_all_keys(None, None)?.await? {
        let value = store.get(Query::Key(key.clone()))?.await?;
        if let (Some(key), Some(value)) = (key.as_string(), value) {
            assets.extend(read_asset(key, &value));
        }
    }
    state.borrow_mut().stored = assets.iter().map(|asset| asset.key.clone()).collect();
    Ok(Some(Saved { json, assets }))
}

async fn save(state: &RefCell<State>, saved: Saved) -> Result<(), idb::Error> {
    let database = open(state).await?;
    let stored = state.borrow().stored.clone();
    let needed: BTreeSet<String> = saved.assets.iter().map(|asset| asset.key.clone()).collect();

    let transaction = database.transaction(&[DOCUMENTS, ASSETS], TransactionMode::ReadWrite)?;
    let assets = transaction.object_store(ASSETS)?;
    for asset in saved.assets.iter().filter(|asset| !stored.contains(&asset.key)) {
        let value = object(&[
            ("name", asset.file_name.as_str().into()),
            ("bytes", Uint8Array::from(&*asset.bytes).into()),
        ]);
        assets.put(&value, Some(&asset.key.as_str().into()))?.await?;
    }
    for key in stored.difference(&needed) {
        assets.delete(Query::Key(key.as_str().into()))?.await?;
    }
    let document = object(&[("json", saved.json.as_str().into())]);
    transaction.object_store(DOCUMENTS)?.put(&document, Some(&CURRENT.into()))?.await?;
    transaction.commit()?.await?;
    state.borrow_mut().stored = needed;
    Ok(())
}

fn read_asset(key: String, value: &JsValue) -> Option<SavedAsset> {
    let bytes: Uint8Array = Reflect::get(value, &"bytes".into()).ok()?.dyn_into().ok()?;
    Some(SavedAsset { key, file_name: text_field(value, "name")?, bytes: Arc::from(bytes.to_vec()) })
}

fn text_field(value: &JsValue, name: &str) -> Option<String> {
    Reflect::get(value, &name.into()).ok()?.as_string()
}

fn object(fields: &[(&str, JsValue)]) -> JsValue {
    let object = Object::new();
    for (name, value) in fields {
        // Setting a property of a plain object cannot fail.
        Reflect::set(&object, &(*name).into(), value).ok();
    }
    object.into()
}
