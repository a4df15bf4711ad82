//! The desktop: dialogs, folders, threads.

mod background;
mod export;
mod file_tree;
mod folder;
mod network;
mod pictures;
mod preferences;

use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::{SystemTime, UNIX_EPOCH};

use super::{EXAMPLE_PATH, FileBytes, SceneId, Storage, UpdateOffer};

pub use background::Background;
pub use export::{ExportFolder, GrowingDownload};
pub use file_tree::{open_folder, pick_folder, watch_dropped_folders};
pub use folder::FolderStorage;
pub use network::{browser_facts, fetch, go_to, send_request, watch_hidden};
pub use pictures::{png_of_svg, show_page};
pub use preferences::{read_stored_preference, write_stored_preference};

/// Milliseconds since 1970, UTC.
pub fn now_ms() -> f64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64() * 1000.0)
}

/// Runs a future to its end: on the desktop, files are there at once.
pub fn spawn(future: impl Future<Output = ()> + 'static) {
    pollster::block_on(future);
}

/// Asks for files and hands over those that can be read; each of the others is an error.
/// Without extensions, all are shown.
pub fn pick_files(extensions: &[&str], on_picked: impl FnOnce(Vec<Result<FileBytes, String>>) + 'static) {
    let mut dialog = rfd::FileDialog::new().set_title("Open files");
    if !extensions.is_empty() {
        dialog = dialog.add_filter("Files of this kind", extensions);
    }
    if let Some(paths) = dialog.pick_files() {
        on_picked(paths.iter().map(|path| read(path)).collect());
    }
}

fn read(path: &Path) -> Result<FileBytes, String> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    match std::fs::read(path) {
        Ok(bytes) => Ok(FileBytes { name, bytes }),
        Err(error) => Err(format!("{name}: {error}")),
    }
}

/// Asks where to save a file, and saves it.
pub fn download(file_name: &str, bytes: &[u8]) -> Result<(), String> {
    match rfd::FileDialog::new().set_file_name(file_name).save_file() {
        Some(path) => std::fs::write(&path, bytes).map_err(|error| format!("{file_name}: {error}")),
        None => Ok(()),
    }
}

/// The example scene, from the folder where the program was built.
pub fn fetch_example(on_done: impl FnOnce(Result<FileBytes, String>) + 'static) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(EXAMPLE_PATH);
    on_done(read(&path));
}

/// A page has parameters; a window has none.
pub fn page_parameter(_name: &str) -> Option<String> {
    None
}

/// A window has no wasm and no navigation.
pub fn wasm_bytes() -> f64 {
    0.0
}

pub fn memory_bytes() -> f64 {
    0.0
}

pub fn navigation_ms() -> f64 {
    0.0
}

/// What the page shows as its crash screen, a window can only write down.
pub fn report_crash(message: &str) {
    log::error!("{message}");
}

/// Nobody listens to a window.
pub fn send_event(_kind: &str, _text: &str) {}

pub fn page_version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}

/// A window is not updated while it is open.
pub fn update_offer() -> Option<UpdateOffer> {
    None
}

pub fn reload() {}

/// Where this user's scenes are kept.
pub fn default_storage() -> Rc<dyn Storage> {
    match data_folder() {
        Some(folder) => Rc::new(FolderStorage::new(folder)),
        None => Rc::new(super::MemoryStorage::default()),
    }
}

/// An id that no other scene has.
pub fn new_scene_id() -> SceneId {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos());
    SceneId::new(&format!("scene-{since:x}"))
}

/// A window says by itself that it is closed; see `eframe::App::on_exit`.
pub fn when_left(_leave: impl Fn() + 'static) {}

/// The folder where this user's programs keep their data.
fn data_folder() -> Option<PathBuf> {
    let home = || std::env::var_os("HOME").map(|home| PathBuf::from(home).join(".local/share"));
    let data = std::env::var_os("XDG_DATA_HOME").map(PathBuf::from).or_else(home);
    data.map(|data| data.join("pinpose"))
}

/// A window has no browser to read pictures for it.
pub async fn png_of_foreign(
    _kind: &str,
    _bytes: &[u8],
    _most_pixels: u64,
) -> Result<Option<Vec<u8>>, String> {
    Ok(None)
}
