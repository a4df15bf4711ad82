//! Folders of the file system.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use crate::platform::{FileFuture, FileTree, FolderEvent, GoOn};

/// More is no scene that somebody annotates; whoever lists more is told so by what reads the list.
const MOST_FILES: usize = 1_000_001;
/// Folders in folders; links may lead in circles.
const MOST_DEPTH: usize = 32;

/// A folder whose files were listed when it was opened.
struct Folder {
    path: PathBuf,
    name: String,
    files: Vec<(String, u64)>,
}

impl FileTree for Folder {
    fn name(&self) -> &str {
        &self.name
    }

    fn files(&self) -> Vec<(String, u64)> {
        self.files.clone()
    }

    fn read(&self, path: &str) -> FileFuture {
        let read = std::fs::read(self.path.join(path)).map_err(|error| error.to_string());
        Box::pin(std::future::ready(read))
    }
}

/// Lists a folder. What cannot be listed in it is left out.
pub fn open_folder(path: &Path) -> Result<Rc<dyn FileTree>, String> {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    std::fs::read_dir(path).map_err(|error| format!("{name}: {error}"))?;
    let mut lister = Lister::default();
    lister.list(path, "", 0);
    Ok(Rc::new(Folder { path: path.to_owned(), name, files: lister.files }))
}

/// Asks for a folder.
pub fn pick_folder(on_event: impl Fn(FolderEvent) -> GoOn + 'static) {
    if let Some(path) = rfd::FileDialog::new().set_title("Open folder").pick_folder() {
        on_event(match open_folder(&path) {
            Ok(tree) => FolderEvent::Listed(tree),
            Err(error) => FolderEvent::Failed(error),
        });
    }
}

/// A window gives dropped folders as paths, among the files; see [`open_folder`].
pub fn watch_dropped_folders(_on_event: impl Fn(FolderEvent) -> GoOn + 'static) {}

#[derive(Default)]
struct Lister {
    files: Vec<(String, u64)>,
    /// Folders that links led to.
    linked: BTreeSet<PathBuf>,
}

impl Lister {
    fn list(&mut self, folder: &Path, prefix: &str, depth: usize) {
        let Ok(entries) = std::fs::read_dir(folder) else { return };
        for entry in entries.filter_map(Result::ok) {
            if self.files.len() >= MOST_FILES {
                return;
            }
            // A name that is no Unicode could not be read back by its path.
            let Ok(name) = entry.file_name().into_string() else { continue };
            let path = format!("{prefix}{name}");
            let is_link = entry.file_type().is_ok_and(|kind| kind.is_symlink());
            // Data sets link to files and folders elsewhere on the disk.
            let Ok(metadata) = std::fs::metadata(entry.path()) else { continue };
            if metadata.is_file() {
                self.files.push((path, metadata.len()));
            } else if metadata.is_dir() && depth < MOST_DEPTH && (!is_link || self.is_new_link(&entry.path()))
            {
                self.list(&entry.path(), &format!("{path}/"), depth + 1);
            }
        }
    }

    fn is_new_link(&mut self, path: &Path) -> bool {
        path.canonicalize().is_ok_and(|target| self.linked.insert(target))
    }
}
