//! Folders that the browser hands to the page.

use std::collections::BTreeMap;
use std::rc::Rc;

use js_sys::{Array, Function, Reflect, Uint8Array};
use wasm_bindgen::prelude::*;

use super::describe;
use crate::platform::{FileFuture, FileTree, FolderEvent, GoOn};

#[wasm_bindgen(module = "/web/page/folders.js")]
extern "C" {
    #[wasm_bindgen(js_name = watchDroppedFolders)]
    fn page_watch_dropped_folders(tell: &Function);
    #[wasm_bindgen(js_name = pickFolder)]
    fn page_pick_folder(tell: &Function);
    #[wasm_bindgen(js_name = readFile, catch)]
    async fn page_read_file(item: &JsValue) -> Result<JsValue, JsValue>;
}

/// Files by path: what the page reads them by, and their sizes in bytes.
struct BrowserFolder {
    name: String,
    files: BTreeMap<String, (JsValue, u64)>,
}

impl FileTree for BrowserFolder {
    fn name(&self) -> &str {
        &self.name
    }

    fn files(&self) -> Vec<(String, u64)> {
        self.files.iter().map(|(path, (_, bytes))| (path.clone(), *bytes)).collect()
    }

    fn read(&self, path: &str) -> FileFuture {
        let item = self.files.get(path).map(|(item, _)| item.clone());
        Box::pin(async move {
            let item = item.ok_or("it is not there")?;
            let buffer = page_read_file(&item).await.map_err(|error| describe(&error))?;
            Ok(Uint8Array::new(&buffer).to_vec())
        })
    }
}

/// Opens the browser's dialog for a folder. Must be called soon after a click or a key, or the browser ignores it.
pub fn pick_folder(on_event: impl Fn(FolderEvent) -> GoOn + 'static) {
    page_pick_folder(&listener(on_event));
}

/// Hears of folders that are dropped on the page, as long as it lives.
pub fn watch_dropped_folders(on_event: impl Fn(FolderEvent) -> GoOn + 'static) {
    page_watch_dropped_folders(&listener(on_event));
}

fn listener(on_event: impl Fn(FolderEvent) -> GoOn + 'static) -> Function {
    let tell = Closure::<dyn Fn(String, JsValue) -> bool>::new(move |kind: String, value: JsValue| {
        let event = match kind.as_str() {
            "listing" => FolderEvent::Listing(value.as_f64().unwrap_or(0.0) as usize),
            "listed" => FolderEvent::Listed(Rc::new(folder_of(&value))),
            _ => FolderEvent::Failed(describe(&value)),
        };
        on_event(event) == GoOn::Yes
    });
    tell.into_js_value().unchecked_into()
}

fn folder_of(value: &JsValue) -> BrowserFolder {
    let field = |name: &str| Reflect::get(value, &name.into()).unwrap_or(JsValue::UNDEFINED);
    let list = |name: &str| field(name).dyn_into::<Array>().unwrap_or_default();
    let (paths, items, sizes) = (list("paths"), list("items"), list("sizes"));
    let file = |index: u32| {
        let bytes = sizes.get(index).as_f64().unwrap_or(0.0) as u64;
        Some((paths.get(index).as_string()?, (items.get(index), bytes)))
    };
    let files = (0..paths.length()).filter_map(file).collect();
    BrowserFolder { name: field("name").as_string().unwrap_or_default(), files }
}
