//! Files in and out of the tab.

use js_sys::{Array, Uint8Array};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;

use super::describe;
use crate::platform::{EXAMPLE_PATH, FileBytes};

/// Opens the browser's file dialog for files with these extensions, or for all. Must be called soon after a click or a key, or the browser ignores it.
pub fn pick_files(extensions: &[&str], on_picked: impl FnOnce(Vec<Result<FileBytes, String>>) + 'static) {
    let Some(input) = file_input() else { return };
    let accepted: Vec<String> = extensions.iter().map(|extension| format!(".{extension}")).collect();
    input.set_accept(&accepted.join(","));
    let chosen = input.clone();
    let on_change = Closure::once_into_js(move || {
        wasm_bindgen_futures::spawn_local(async move {
            let mut files = Vec::new();
            let list = chosen.files();
            for index in 0..list.as_ref().map_or(0, web_sys::FileList::length) {
                if let Some(file) = list.as_ref().and_then(|list| list.get(index)) {
                    files.push(read(&file).await);
                }
            }
            on_picked(files);
        });
    });
    input.set_onchange(Some(on_change.unchecked_ref()));
    input.click();
}

fn file_input() -> Option<web_sys::HtmlInputElement> {
    let document = web_sys::window()?.document()?;
    let input: web_sys::HtmlInputElement = document.create_element("input").ok()?.dyn_into().ok()?;
    input.set_type("file");
    input.set_multiple(true);
    Some(input)
}

async fn read(file: &web_sys::File) -> Result<FileBytes, String> {
    let name = file.name();
    match JsFuture::from(file.array_buffer()).await {
        Ok(buffer) => Ok(FileBytes { name, bytes: Uint8Array::new(&buffer).to_vec() }),
        Err(error) => Err(format!("{name}: {}", describe(&error))),
    }
}

/// Hands a file to the browser's downloads.
pub fn download(file_name: &str, bytes: &[u8]) -> Result<(), String> {
    offer_download(file_name, bytes).map_err(|error| format!("{file_name}: {}", describe(&error)))
}

fn offer_download(file_name: &str, bytes: &[u8]) -> Result<(), JsValue> {
    let parts = Array::of1(&Uint8Array::from(bytes));
    let options = web_sys::BlobPropertyBag::new();
    options.set_type(if file_name.ends_with(".json") {
        "application/json"
    } else {
        "application/octet-stream"
    });
    offer_blob(file_name, &web_sys::Blob::new_with_u8_array_sequence_and_options(&parts, &options)?)
}

pub(super) fn offer_blob(file_name: &str, blob: &web_sys::Blob) -> Result<(), JsValue> {
    let url = web_sys::Url::create_object_url_with_blob(blob)?;
    let document = web_sys::window().and_then(|window| window.document()).ok_or("the page is gone")?;
    let link: web_sys::HtmlAnchorElement = document.create_element("a")?.dyn_into()?;
    link.set_href(&url);
    link.set_download(file_name);
    link.click();
    // The browser has taken hold of the content by then; freeing it at once would race with it.
    let free = Closure::once_into_js(move || {
        web_sys::Url::revoke_object_url(&url).ok();
    });
    if let Some(window) = web_sys::window() {
        window.set_timeout_with_callback_and_timeout_and_arguments_0(free.unchecked_ref(), 60_000)?;
    }
    Ok(())
}

/// The example scene is far smaller.
const MOST_EXAMPLE_BYTES: u64 = 64 << 20;

/// Fetches the example scene, which is no part of the page's first load.
pub fn fetch_example(on_done: impl FnOnce(Result<FileBytes, String>) + 'static) {
    wasm_bindgen_futures::spawn_local(async move {
        let fetched = super::fetch(EXAMPLE_PATH, MOST_EXAMPLE_BYTES).await;
        let name = EXAMPLE_PATH.rsplit('/').next().unwrap_or(EXAMPLE_PATH).to_owned();
        let named = |error| format!("{EXAMPLE_PATH} {error}");
        on_done(fetched.map(|bytes| FileBytes { name, bytes }).map_err(named));
    });
}
