//! The browser's small storages: what is written at once, what belongs to this tab alone, and how much room there is.

use js_sys::Reflect;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;

use super::describe;
use crate::platform::storage::StorageUse;

const PREFERENCE: &str = "pinpose preference ";

pub fn read(key: &str) -> Option<String> {
    local()?.get_item(key).ok()?
}

/// Where the browser refuses, that is for the log: what is written here is a second copy, or no work.
pub fn write(key: &str, text: &str) {
    if let Some(Err(error)) = local().map(|storage| storage.set_item(key, text)) {
        log::warn!("{key} was not kept: {}", describe(&error));
    }
}

pub fn remove(key: &str) {
    if let Some(Err(error)) = local().map(|storage| storage.remove_item(key)) {
        log::warn!("{key} was not removed: {}", describe(&error));
    }
}

/// Until this tab is closed, across loading the page again.
pub fn read_of_tab(key: &str) -> Option<String> {
    of_tab()?.get_item(&format!("pinpose {key}")).ok()?
}

pub fn write_of_tab(key: &str, text: &str) {
    if let Some(Err(error)) = of_tab().map(|storage| storage.set_item(&format!("pinpose {key}"), text)) {
        log::warn!("{key} was not kept: {}", describe(&error));
    }
}

pub fn read_stored_preference(key: &str) -> Option<String> {
    read(&format!("{PREFERENCE}{key}"))
}

pub fn write_stored_preference(key: &str, value: &str) {
    write(&format!("{PREFERENCE}{key}"), value);
}

pub async fn usage() -> Result<StorageUse, JsValue> {
    let estimate = JsFuture::from(manager()?.estimate()?).await?;
    let number = |name: &str| Reflect::get(&estimate, &name.into()).ok().and_then(|value| value.as_f64());
    Ok(StorageUse {
        used_bytes: number("usage").unwrap_or_default() as u64,
        quota_bytes: number("quota").map(|bytes| bytes as u64),
    })
}

/// Asks the browser not to clear what is stored when it needs room. It decides by itself; some ask the user.
pub async fn ask_to_persist() {
    let asked = async { JsFuture::from(manager()?.persist()?).await };
    if let Err(error) = asked.await {
        log::warn!("the browser may clear the scenes when it needs room: {}", describe(&error));
    }
}

fn manager() -> Result<web_sys::StorageManager, JsValue> {
    let window = web_sys::window().ok_or("the page is gone")?;
    Ok(window.navigator().storage())
}

/// Absent where the user has turned it off.
fn local() -> Option<web_sys::Storage> {
    web_sys::window()?.local_storage().ok()?
}

fn of_tab() -> Option<web_sys::Storage> {
    web_sys::window()?.session_storage().ok()?
}
