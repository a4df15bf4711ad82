//! A saved scene as files in a folder.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::platform::storage::{Saved, SavedAsset, Storage, StorageFuture};

/// `scene.json` and `assets/KEY_NAME`. The document is renamed into place last, so it never speaks of a file that is not there.
pub struct FolderStorage {
    folder: PathBuf,
}

impl FolderStorage {
    pub fn new(folder: PathBuf) -> Self {
        Self { folder }
    }

    fn assets(&self) -> PathBuf {
        self.folder.join("assets")
    }

    fn read(&self) -> io::Result<Option<Saved>> {
        let json = match fs::read_to_string(self.folder.join("scene.json")) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            other => other?,
        };
        let mut assets = Vec::new();
        for entry in fs::read_dir(self.assets())? {
            let entry = entry?;
            let stored_name = entry.file_name().to_string_lossy().into_owned();
            let Some((key, file_name)) = stored_name.split_once('_') else { continue };
            let bytes = Arc::from(fs::read(entry.path())?);
            assets.push(SavedAsset { key: key.to_owned(), file_name: file_name.to_owned(), bytes });
        }
        Ok(Some(Saved { json, assets }))
    }

    fn write(&self, saved: &Saved) -> io::Result<()> {
        fs::create_dir_all(self.assets())?;
        let mut needed = Vec::new();
        for asset in &saved.assets {
            let path = self.assets().join(format!("{}_{}", asset.key, base_name(&asset.file_name)));
            if !path.exists() {
                write_whole(&path, &asset.bytes)?;
            }
            needed.push(path);
        }
        write_whole(&self.folder.join("scene.json"), saved.json.as_bytes())?;
        for entry in fs::read_dir(self.assets())? {
            let path = entry?.path();
            if !needed.contains(&path) {
                fs::remove_file(path)?;
            }
        }
        Ok(())
    }
}

impl Storage for FolderStorage {
    fn load(&self) -> StorageFuture<Option<Saved>> {
        let result = self.read().map_err(|error| format!("the saved scene cannot be read: {error}"));
        Box::pin(async { result })
    }

    fn save(&self, saved: Saved) -> StorageFuture<()> {
        let result = self.write(&saved).map_err(|error| format!("the scene cannot be saved: {error}"));
        Box::pin(async { result })
    }
}

/// A file is there as a whole or not at all.
fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let unfinished = path.with_extension("unfinished");
    fs::write(&unfinished, bytes)?;
    fs::rename(unfinished, path)
}

fn base_name(file_name: &str) -> &str {
    file_name.rsplit(['/', '\\']).next().unwrap_or(file_name)
}
