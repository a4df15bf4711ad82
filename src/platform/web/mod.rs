//! The browser tab: the page's script, files, downloads, the address.

mod background;
mod browser_storage;
mod export;
mod file_tree;
mod files;
mod indexed_db;
mod network;
mod pictures;

use std::cell::Cell;
use std::rc::Rc;

use wasm_bindgen::prelude::*;

use super::{SceneId, Storage, UpdateOffer};

pub use background::Background;
pub use browser_storage::{read_stored_preference, write_stored_preference};
pub use export::{ExportFolder, GrowingDownload};
pub use file_tree::{pick_folder, watch_dropped_folders};
pub use files::{download, fetch_example, pick_files};
pub use network::{browser_facts, fetch, go_to, send_request, watch_hidden};
pub use pictures::{png_of_foreign, png_of_svg, show_page};

/// What the boot script offers; see `web/page/boot.js`.
#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(js_namespace = pinposePage, js_name = crashed)]
    fn page_crashed(message: &str);
    #[wasm_bindgen(js_namespace = pinposePage, js_name = applyUpdate)]
    fn page_apply_update();
    #[wasm_bindgen(js_namespace = pinposePage, js_name = createWorker, catch)]
    fn page_create_worker() -> Result<web_sys::Worker, JsValue>;
    #[wasm_bindgen(js_namespace = pinposePage, js_name = claim)]
    fn page_claim(name: &str) -> js_sys::Promise;
    #[wasm_bindgen(thread_local_v2, js_namespace = pinposePage, js_name = buildVersion)]
    static BUILD_VERSION: JsValue;
    #[wasm_bindgen(thread_local_v2, js_namespace = pinposePage, js_name = wasmBytes)]
    static WASM_BYTES: JsValue;
    #[wasm_bindgen(thread_local_v2, js_namespace = pinposePage, js_name = updateReady)]
    static UPDATE_READY_AT_START: JsValue;
}

thread_local! {
    static UPDATE_READY: Cell<bool> = const { Cell::new(false) };
}

/// Milliseconds since 1970, UTC.
pub fn now_ms() -> f64 {
    js_sys::Date::now()
}

/// Milliseconds since the navigation began.
pub fn navigation_ms() -> f64 {
    web_sys::window().and_then(|window| window.performance()).map_or(0.0, |performance| performance.now())
}

pub fn spawn(future: impl Future<Output = ()> + 'static) {
    wasm_bindgen_futures::spawn_local(future);
}

/// The crash screen, with a way back to what is saved.
pub fn report_crash(message: &str) {
    page_crashed(message);
}

/// A panic ends in the crash screen. Call this after the interface has put up its own hook, which stops its event handlers.
pub fn install_panic_hook() {
    let previous = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        previous(info);
        page_crashed(&info.to_string());
    }));
}

/// A parameter of the page's address: `Some("")` for `?name` without a value.
pub fn page_parameter(name: &str) -> Option<String> {
    let search = web_sys::window()?.location().search().ok()?;
    web_sys::UrlSearchParams::new_with_str(&search).ok()?.get(name)
}

pub fn page_version() -> String {
    BUILD_VERSION.with(JsValue::as_string).unwrap_or_else(|| env!("CARGO_PKG_VERSION").to_owned())
}

/// The size of the program as it was compiled, in bytes.
pub fn wasm_bytes() -> f64 {
    WASM_BYTES.with(JsValue::as_f64).unwrap_or(0.0)
}

/// The memory of this thread's wasm, in bytes. It never shrinks, so this is also the most that it ever was.
pub fn memory_bytes() -> f64 {
    let memory = wasm_bindgen::memory().unchecked_into::<js_sys::WebAssembly::Memory>();
    f64::from(memory.buffer().unchecked_into::<js_sys::ArrayBuffer>().byte_length())
}

/// Is a newer page waiting? `wake` of [`watch_for_updates`] is called when that changes.
pub fn update_offer() -> Option<UpdateOffer> {
    UPDATE_READY.get().then_some(UpdateOffer)
}

/// Listens for the boot script's word that a newer page is ready.
pub fn watch_for_updates(wake: impl Fn() + 'static) {
    UPDATE_READY.set(UPDATE_READY_AT_START.with(JsValue::is_truthy));
    let noticed = Closure::<dyn Fn()>::new(move || {
        UPDATE_READY.set(true);
        wake();
    });
    if let Some(window) = web_sys::window() {
        let listener = noticed.as_ref().unchecked_ref();
        window.add_event_listener_with_callback("pinpose-update", listener).ok();
    }
    // It listens as long as the page lives.
    noticed.forget();
}

/// Tells listeners of the page's `pinpose` event, and the page that embeds this one if it named itself by `?embedder=ORIGIN`.
pub fn send_event(kind: &str, text: &str) {
    send(kind, text)
        .unwrap_or_else(|error| log::warn!("the event {kind} was not sent: {}", describe(&error)));
}

fn send(kind: &str, text: &str) -> Result<(), JsValue> {
    let window = web_sys::window().ok_or("the page is gone")?;
    let detail = js_sys::Object::new();
    js_sys::Reflect::set(&detail, &"type".into(), &kind.into())?;
    js_sys::Reflect::set(&detail, &"text".into(), &text.into())?;
    let options = web_sys::CustomEventInit::new();
    options.set_detail(&detail);
    let event = web_sys::CustomEvent::new_with_event_init_dict("pinpose", &options)?;
    window.dispatch_event(&event)?;
    if let (Some(origin), Some(parent)) = (page_parameter("embedder"), window.parent()?)
        && parent != window
    {
        let message = js_sys::Object::new();
        js_sys::Reflect::set(&message, &"pinpose".into(), &detail)?;
        parent.post_message(&message, &origin)?;
    }
    Ok(())
}

/// Lets the newer page take over.
pub fn reload() {
    page_apply_update();
}

/// Where this browser keeps scenes.
pub fn default_storage() -> Rc<dyn Storage> {
    Rc::new(indexed_db::IndexedDb::default())
}

/// An id that no other scene has.
pub fn new_scene_id() -> SceneId {
    // 32 bits by chance, for two tabs within one millisecond.
    let chance = (js_sys::Math::random() * 4_294_967_296.0) as u32;
    SceneId::new(&format!("scene-{:x}-{chance:08x}", now_ms() as u64))
}

/// Calls `leave` when the page is hidden or goes: nothing that takes time may be done then.
pub fn when_left(leave: impl Fn() + 'static) {
    let (Some(window), Some(document)) =
        (web_sys::window(), web_sys::window().and_then(|window| window.document()))
    else {
        return;
    };
    let left = Closure::<dyn Fn(web_sys::Event)>::new(move |event: web_sys::Event| {
        let document = web_sys::window().and_then(|window| window.document());
        if event.type_() == "pagehide" || document.is_some_and(|document| document.hidden()) {
            leave();
        }
    });
    let listener = left.as_ref().unchecked_ref();
    window.add_event_listener_with_callback("pagehide", listener).ok();
    document.add_event_listener_with_callback("visibilitychange", listener).ok();
    // It listens as long as the page lives.
    left.forget();
}

/// The words of an error from the browser.
fn describe(error: &JsValue) -> String {
    match error.dyn_ref::<js_sys::Error>() {
        Some(error) => String::from(error.message()),
        None => error.as_string().unwrap_or_else(|| format!("{error:?}")),
    }
}
