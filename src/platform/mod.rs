//! The world outside: clock, files, downloads, storage, the page's address, a second thread.
//!
//! A facade with one implementation for the page and one for the desktop, and a store in memory for tests. Imports none
//! of our own rooms.

mod file_tree;
mod memory;
mod network;
mod page_api;
mod preferences;
mod storage;
mod time_zone;

#[cfg(not(target_arch = "wasm32"))]
mod native;
#[cfg(target_arch = "wasm32")]
mod web;

pub use file_tree::{FileFuture, FileTree, FolderEvent, GoOn};
pub use memory::MemoryStorage;
#[cfg(not(target_arch = "wasm32"))]
pub use native::{
    Background, ExportFolder, FolderStorage, GrowingDownload, browser_facts, default_storage, download,
    fetch, fetch_example, go_to, memory_bytes, navigation_ms, new_scene_id, now_ms, open_folder,
    page_parameter, page_version, pick_files, pick_folder, png_of_foreign, png_of_svg, reload, report_crash,
    send_event, send_request, show_page, spawn, update_offer, wasm_bytes, watch_dropped_folders,
    watch_hidden, when_left,
};
pub use network::{BrowserFacts, FetchError, FetchFuture, NetworkFuture, Request};
pub use page_api::{
    Loaded, PageAnswer, PageCall, PageCalls, PageReply, PageState, PageValue, Perf, Picked, Widget,
};
pub use preferences::{keep_preferences_in_memory, read_preference, write_preference};
pub use storage::{
    Journal, Remains, SaveOutcome, SaveTerms, Saved, SavedAsset, SavedCompanion, SceneHeading, SceneId,
    SceneSummary, Storage, StorageFuture, StorageUse,
};
pub use time_zone::utc_offset_minutes;
#[cfg(target_arch = "wasm32")]
pub use web::{
    Background, ExportFolder, GrowingDownload, browser_facts, default_storage, download, fetch,
    fetch_example, go_to, install_panic_hook, memory_bytes, navigation_ms, new_scene_id, now_ms,
    page_parameter, page_version, pick_files, pick_folder, png_of_foreign, png_of_svg, reload, report_crash,
    send_event, send_request, show_page, spawn, update_offer, wasm_bytes, watch_dropped_folders,
    watch_for_updates, watch_hidden, when_left,
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

/// Where the example is, relative to the page.
const EXAMPLE_PATH: &str = "demo/example.zip";

/// Where the example study is, relative to the page.
pub const EXAMPLE_STUDY_PATH: &str = "demo/study.zip";
