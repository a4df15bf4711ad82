//! What is exported bit by bit: into a download whose beginning the browser holds already, or into a folder.

use js_sys::{Array, Uint8Array};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;

use super::describe;
use super::files::offer_blob;

#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(thread_local_v2, js_namespace = pinposePage, js_name = canPickFolder)]
    static CAN_PICK_FOLDER: JsValue;
    #[wasm_bindgen(js_namespace = pinposePage, js_name = pickExportFolder)]
    fn page_pick_export_folder() -> js_sys::Promise;
    #[wasm_bindgen(js_namespace = pinposePage, js_name = writeToFolder)]
    fn page_write_to_folder(folder: &JsValue, path: &str, bytes: &Uint8Array) -> js_sys::Promise;
}

/// A file that grows outside of the program's memory until it is handed over.
#[derive(Debug, Default)]
pub struct GrowingDownload {
    parts: Array,
}

impl GrowingDownload {
    pub fn append(&mut self, bytes: &[u8]) -> Result<(), String> {
        let part = Array::of1(&Uint8Array::from(bytes));
        let blob = web_sys::Blob::new_with_u8_array_sequence(&part).map_err(|error| describe(&error))?;
        self.parts.push(&blob);
        Ok(())
    }

    /// Hands the file to the browser's downloads.
    pub fn finish(self, file_name: &str) -> Result<(), String> {
        let blob = web_sys::Blob::new_with_blob_sequence(&self.parts);
        let offered = blob.and_then(|blob| offer_blob(file_name, &blob));
        offered.map_err(|error| format!("{file_name}: {}", describe(&error)))
    }
}

/// A folder that the user picked.
#[derive(Debug, Clone)]
pub struct ExportFolder {
    handle: JsValue,
}

impl ExportFolder {
    /// Can this browser write into folders?
    pub fn can_be_picked() -> bool {
        CAN_PICK_FOLDER.with(JsValue::is_truthy)
    }

    /// `None`: the user picked none. Must be called soon after a click or a key.
    pub async fn pick() -> Result<Option<Self>, String> {
        let picked = JsFuture::from(page_pick_export_folder()).await;
        let handle = picked.map_err(|error| describe(&error))?;
        Ok((!handle.is_null()).then_some(Self { handle }))
    }

    /// Writes a file; its path has `/` between names, and folders are made.
    pub async fn write(self, path: String, bytes: std::sync::Arc<[u8]>) -> Result<(), String> {
        let written = JsFuture::from(page_write_to_folder(&self.handle, &path, &Uint8Array::from(&*bytes)));
        written.await.map(|_| ()).map_err(|error| format!("{path}: {}", describe(&error)))
    }
}
