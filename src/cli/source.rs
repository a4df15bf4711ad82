//! Folders and zips on disk as data sets.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::formats::dataset::{Contents, Dataset, DatasetKind, Listing, Recognised, recognise};
use crate::formats::{Archive, FormatError};

/// A data set nests five deep; what goes deeper is somebody's home.
const DEEPEST: usize = 16;
/// So many folders above a scene may the data set's own be.
const FOLDERS_ABOVE: usize = 2;

/// A data set that can be read.
pub struct Source {
    pub recognised: Recognised,
    files: Files,
}

enum Files {
    /// Paths are relative to this.
    Folder(PathBuf),
    Zip(Box<Archive>),
}

impl Source {
    /// The data set in a folder or a zip; `None` where there is none, or the zip is one that this program saved.
    pub fn open(path: &Path) -> Result<Option<Self>, String> {
        let failed = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        if path.is_dir() {
            return Self::open_folder(path).map_err(|error| failed(&error));
        }
        if path.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("zip")) {
            return Ok(None);
        }
        let bytes = fs::read(path).map_err(|error| failed(&error))?;
        Self::open_zip(path, bytes.into()).map_err(|error| failed(&error))
    }

    fn open_zip(path: &Path, bytes: Arc<[u8]>) -> Result<Option<Self>, FormatError> {
        let mut archive = Archive::open(bytes)?;
        if archive.is_workspace() {
            return Ok(None);
        }
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let listing = Arc::new(archive.listing(&name)?);
        let files = Files::Zip(Box::new(archive));
        Ok(recognise(&listing).map(|recognised| Self { recognised, files }))
    }

    fn open_folder(path: &Path) -> Result<Option<Self>, FormatError> {
        let listing = Arc::new(Listing::new(&name_of(path), files_below(path, path))?);
        let Some(recognised) = recognise(&listing) else { return Ok(None) };
        if recognised.kind == DatasetKind::Bop
            && let Some(above) = data_set_above(path)
        {
            return Self::open_scene(path, &above);
        }
        Ok(Some(Self { recognised, files: Files::Folder(path.to_owned()) }))
    }

    /// A scene's or a split's folder with the meshes of the data set that it is in.
    fn open_scene(path: &Path, above: &Path) -> Result<Option<Self>, FormatError> {
        let mut files = files_below(path, above);
        for entry in fs::read_dir(above).into_iter().flatten().flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.starts_with("models") {
                files.extend(files_below(&entry.path(), above));
            } else if name.starts_with("camera") && name.ends_with(".json") {
                files.push((name, entry.metadata().map_or(0, |metadata| metadata.len())));
            }
        }
        let listing = Arc::new(Listing::new(&name_of(above), files)?);
        let files = Files::Folder(above.to_owned());
        Ok(recognise(&listing).map(|recognised| Self { recognised, files }))
    }

    pub fn read(&mut self, path: &str) -> Result<Arc<[u8]>, String> {
        match &mut self.files {
            Files::Folder(root) => {
                let path = root.join(path);
                fs::read(&path).map(Arc::from).map_err(|error| format!("{}: {error}", path.display()))
            }
            Files::Zip(archive) => archive.read(path).map_err(|error| error.to_string()),
        }
    }

    /// What some of its parts hold. A small file that cannot be read is missed.
    pub fn interpret(&mut self, chosen: &[usize]) -> Result<Dataset, String> {
        let mut contents = Contents::new();
        for path in self.recognised.needed(chosen) {
            if let Ok(bytes) = self.read(&path) {
                contents.insert(path, bytes);
            }
        }
        self.recognised.interpret(chosen, &contents).map_err(|error| error.to_string())
    }
}

fn name_of(folder: &Path) -> String {
    let whole = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    whole.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The folder of the data set that a scene's folder is in, if its meshes are not in the folder itself.
fn data_set_above(path: &Path) -> Option<PathBuf> {
    let has_models = |folder: &Path| {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        entries
            .into_iter()
            .any(|entry| entry.file_name().to_string_lossy().starts_with("models") && entry.path().is_dir())
    };
    let whole = path.canonicalize().ok()?;
    if has_models(&whole) {
        return None;
    }
    whole.ancestors().skip(1).take(FOLDERS_ABOVE).find(|folder| has_models(folder)).map(Path::to_owned)
}

/// All files below a folder with their sizes, by their paths relative to `root`. What cannot be read is left out.
fn files_below(folder: &Path, root: &Path) -> Vec<(String, u64)> {
    let mut files = Vec::new();
    // Links may lead round in a circle.
    let mut seen = HashSet::new();
    let mut folders = vec![(folder.canonicalize().unwrap_or_else(|_| folder.to_owned()), 0)];
    let root = root.canonicalize().unwrap_or_else(|_| root.to_owned());
    while let Some((folder, depth)) = folders.pop() {
        if depth > DEEPEST || !seen.insert(folder.canonicalize().unwrap_or_else(|_| folder.clone())) {
            continue;
        }
        for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
            let path = entry.path();
            let Ok(metadata) = fs::metadata(&path) else { continue };
            if metadata.is_dir() {
                folders.push((path, depth + 1));
            } else if let Ok(relative) = path.strip_prefix(&root) {
                let parts: Vec<_> =
                    relative.components().map(|part| part.as_os_str().to_string_lossy()).collect();
                files.push((parts.join("/"), metadata.len()));
            }
        }
    }
    files
}
