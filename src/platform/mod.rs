//! The world outside: clock, files, downloads, storage, the page's address, a second thread.
//!
//! A facade with one implementation for the page and one for the desktop, and a store in memory for tests. Imports none
//! of our own rooms.

mod page_api;
mod storage;
mod time_zone;

#[cfg(not(target_arch = "wasm32"))]
mod native;
#[cfg(target_arch = "wasm32")]
mod web;

#[cfg(not(target_arch = "wasm32"))]
pub use native::{
    Background, default_storage, download, fetch_example, navigation_ms, now_ms, page_parameter,
    page_version, pick_files, reload, report_crash, send_event, spawn, update_offer, wasm_bytes,
};
pub use page_api::{
    Loaded, PageAnswer, PageCall, PageCalls, PageReply, PageState, PageValue, Perf, Picked, Widget,
};
pub use storage::{MemoryStorage, Saved, SavedAsset, Storage, StorageFuture};
pub use time_zone::utc_offset_minutes;
#[cfg(target_arch = "wasm32")]
pub use web::{
    Background, default_storage, download, fetch_example, install_panic_hook, navigation_ms, now_ms,
    page_parameter, page_version, pick_files, reload, report_crash, send_event, spawn, update_offer,
    wasm_bytes, watch_for_updates,
};

/// A file that the user picked or dropped.
#[derive(Debug, Clone, PartialEq)]
pub struct FileBytes {
    pub name: String,
    pub bytes: Vec<u8>,
}

/// Wakes the interface when something that it waits for has come.
pub type Wake = std::rc::Rc<dyn Fn()>;

/// A newer page is ready to take over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UpdateOffer;

/// Under which name a scene is kept; the example has its own, so that trying it never touches anybody's work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slot {
    Current,
    Example,
}

impl Slot {
    fn name(self) -> &'static str {
        match self {
            Self::Current => "current",
            Self::Example => "example",
        }
    }
}

/// Where the example is, relative to the page.
const EXAMPLE_PATH: &str = "demo/example.zip";
