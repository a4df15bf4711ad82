//! What is exported bit by bit: into a file, or into a folder.

use std::path::PathBuf;
use std::sync::Arc;

use super::download;

/// A file that grows until it is saved.
#[derive(Debug, Default)]
pub struct GrowingDownload {
    bytes: Vec<u8>,
}

impl GrowingDownload {
    pub fn append(&mut self, bytes: &[u8]) -> Result<(), String> {
        self.bytes.extend_from_slice(bytes);
        Ok(())
    }

    /// Asks where to save the file, and saves it.
    pub fn finish(self, file_name: &str) -> Result<(), String> {
        download(file_name, &self.bytes)
    }
}

/// A folder that the user picked.
#[derive(Debug, Clone)]
pub struct ExportFolder {
    path: PathBuf,
}

impl ExportFolder {
    pub fn can_be_picked() -> bool {
        true
    }

    /// `None`: the user picked none.
    pub async fn pick() -> Result<Option<Self>, String> {
        let picked = rfd::FileDialog::new().set_title("Export into a folder").pick_folder();
        Ok(picked.map(|path| Self { path }))
    }

    /// Writes a file; its path has `/` between names, and folders are made.
    pub async fn write(self, path: String, bytes: Arc<[u8]>) -> Result<(), String> {
        // Names were made safe where they come from; a path that leaves the folder would still be a crime.
        if path.split('/').any(|name| name == "..") {
            return Err(format!("{path}: it leads out of the folder"));
        }
        super::folder::write_whole(&self.path.join(&path), &bytes).map_err(|error| format!("{path}: {error}"))
    }
}
