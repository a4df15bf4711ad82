//! The saved scene in IndexedDB: one transaction a save, so that it is there as a whole or not at all.
//!
//! Database `pinpose` version 1; `documents` holds `{json, assets}` by slot, `assets` holds `{name, bytes}` by the content's
//! SHA-256. The crash screen reads the slot `current`, without this code.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::rc::Rc;
use std::sync::Arc;

use idb::builder::{DatabaseBuilder, ObjectStoreBuilder};
use idb::{Database, Query, TransactionMode};
use js_sys::{Array, Object, Reflect, Uint8Array};
use wasm_bindgen::prelude::*;

use crate::platform::Slot;
use crate::platform::storage::{Saved, SavedAsset, Storage, StorageFuture};

const DOCUMENTS: &str = "documents";
const ASSETS: &str = "assets";

type Connection = Rc<RefCell<Option<Rc<Database>>>>;

pub struct IndexedDb {
    slot: Slot,
    connection: Connection,
}

impl IndexedDb {
    pub fn new(slot: Slot) -> Self {
        Self { slot, connection: Connection::default() }
    }
}

impl Storage for IndexedDb {
    fn load(&self) -> StorageFuture<Option<Saved>> {
        let (slot, connection) = (self.slot, self.connection.clone());
        Box::pin(async move {
            load(&connection, slot).await.map_err(|error| format!("the saved scene cannot be read: {error}"))
        })
    }

    fn save(&self, saved: Saved) -> StorageFuture<()> {
        let (slot, connection) = (self.slot, self.connection.clone());
        Box::pin(async move {
            save(&connection, slot, saved)
                .await
                .map_err(|error| format!("the scene cannot be saved: {error}"))
        })
    }
}

async fn open(connection: &Connection) -> Result<Rc<Database>, idb::Error> {
    if let Some(database) = connection.borrow().as_ref() {
        return Ok(database.clone());
    }
    let database = DatabaseBuilder::new("pinpose")
        .version(1)
        .add_object_store(ObjectStoreBuilder::new(DOCUMENTS))
        .add_object_store(ObjectStoreBuilder::new(ASSETS))
        .build()
        .await?;
    let database = Rc::new(database);
    *connection.borrow_mut() = Some(database.clone());
    Ok(database)
}

async fn load(connection: &Connection, slot: Slot) -> Result<Option<Saved>, idb::Error> {
    let database = open(connection).await?;
    let transaction = database.transaction(&[DOCUMENTS, ASSETS], TransactionMode::ReadOnly)?;
    let document = transaction.object_store(DOCUMENTS)?.get(Query::Key(slot.name().into()))?.await?;
    let Some(document) = document else { return Ok(None) };
    let Some(json) = text_field(&document, "json") else { return Ok(None) };
    let store = transaction.object_store(ASSETS)?;
    let mut assets = Vec::new();
    for key in asset_keys(&document) {
        if let Some(value) = store.get(Query::Key(key.as_str().into()))?.await? {
            assets.extend(read_asset(key, &value));
        }
    }
    Ok(Some(Saved { json, assets }))
}

/// What is stored is looked up within the transaction: another tab may have changed it.
async fn save(connection: &Connection, slot: Slot, saved: Saved) -> Result<(), idb::Error> {
    let database = open(connection).await?;
    let transaction = database.transaction(&[DOCUMENTS, ASSETS], TransactionMode::ReadWrite)?;
    let documents = transaction.object_store(DOCUMENTS)?;
    let assets = transaction.object_store(ASSETS)?;
    let keys = assets.get_all_keys(None, None)?.await?;
    let stored: BTreeSet<String> = keys.iter().filter_map(JsValue::as_string).collect();

    let mut needed: BTreeSet<String> = saved.assets.iter().map(|asset| asset.key.clone()).collect();
    for asset in saved.assets.iter().filter(|asset| !stored.contains(&asset.key)) {
        let bytes = Uint8Array::from(&*asset.bytes);
        let value = object(&[("name", asset.file_name.as_str().into()), ("bytes", bytes.into())]);
        assets.put(&value, Some(&asset.key.as_str().into()))?.await?;
    }
    let list: Array = needed.iter().map(|key| JsValue::from_str(key)).collect();
    let document = object(&[("json", saved.json.as_str().into()), ("assets", list.into())]);
    documents.put(&document, Some(&slot.name().into()))?.await?;

    for document in documents.get_all(None, None)?.await? {
        needed.extend(asset_keys(&document));
    }
    for key in stored.difference(&needed) {
        assets.delete(Query::Key(key.as_str().into()))?.await?;
    }
    transaction.commit()?.await?;
    Ok(())
}

fn asset_keys(document: &JsValue) -> Vec<String> {
    let keys = Reflect::get(document, &"assets".into()).unwrap_or(JsValue::UNDEFINED);
    keys.dyn_into::<Array>()
        .map_or_else(|_| Vec::new(), |keys| keys.iter().filter_map(|key| key.as_string()).collect())
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
