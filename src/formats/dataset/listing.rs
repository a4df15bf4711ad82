//! What is in a folder or an archive, by name and size.

use std::collections::BTreeMap;
use std::ops::Bound;

use crate::formats::FormatError;

/// More files are no scene that somebody annotates; a training set's splits and scenes can be opened one by one.
const MAX_FILES: usize = 1_000_000;

/// The files of a folder or an archive. Paths have `/` between their names and begin anywhere: at a drive's root, at the
/// dropped folder or inside it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listing {
    name: String,
    /// Sizes in bytes, by path.
    files: BTreeMap<String, u64>,
}

impl Listing {
    /// A listing of these paths and sizes; `name` is the folder's or the archive's. Paths that leave the folder are left out:
    /// no data set has any, and whoever opens one by its path is kept inside.
    pub fn new(name: &str, files: impl IntoIterator<Item = (String, u64)>) -> Result<Self, FormatError> {
        let mut listing = Self { name: name.to_owned(), files: BTreeMap::new() };
        for (path, bytes) in files {
            let path = path.replace('\\', "/");
            let leaves = path.split('/').any(|part| part == "..");
            let is_hidden = path.split('/').any(|part| part == "__MACOSX" || part.starts_with("._"));
            if leaves || is_hidden {
                continue;
            }
            listing.files.insert(path, bytes);
            if listing.files.len() > MAX_FILES {
                return Err(FormatError::at(
                    name,
                    format!("more than {MAX_FILES} files: open a split or a scene of it"),
                ));
            }
        }
        Ok(listing)
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    pub fn len(&self) -> usize {
        self.files.len()
    }

    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// All paths, sorted.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }

    pub fn has(&self, path: &str) -> bool {
        self.files.contains_key(path)
    }

    /// In bytes.
    pub fn size_of(&self, path: &str) -> Option<u64> {
        self.files.get(path).copied()
    }

    /// The path of a file in a folder, if it is there.
    pub(super) fn find(&self, folder: &str, name: &str) -> Option<String> {
        let path = join(folder, name);
        self.has(&path).then_some(path)
    }

    /// The paths below a folder, in subfolders too; "" is all.
    pub(super) fn below<'a>(&'a self, folder: &str) -> impl Iterator<Item = &'a str> {
        let prefix = if folder.is_empty() { String::new() } else { format!("{folder}/") };
        let from = self.files.range::<str, _>((Bound::Included(prefix.as_str()), Bound::Unbounded));
        from.map(|(path, _)| path.as_str()).take_while(move |path| path.starts_with(&prefix))
    }

    /// The names of the files directly in a folder.
    pub(super) fn names_in<'a>(&'a self, folder: &str) -> impl Iterator<Item = &'a str> {
        let skip = if folder.is_empty() { 0 } else { folder.len() + 1 };
        self.below(folder).filter_map(move |path| path.get(skip..)).filter(|name| !name.contains('/'))
    }

    /// The last part of a folder's path; the listing's own name where the path is empty.
    pub(super) fn folder_name<'a>(&'a self, folder: &'a str) -> &'a str {
        if folder.is_empty() { &self.name } else { base_name(folder) }
    }
}

/// The folder that a file or folder is in; "" at the top.
pub(super) fn parent(path: &str) -> &str {
    path.rsplit_once('/').map_or("", |(folder, _)| folder)
}

pub(super) fn base_name(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

pub(super) fn join(folder: &str, name: &str) -> String {
    if folder.is_empty() { name.to_owned() } else { format!("{folder}/{name}") }
}

/// A file's name without its extension, and the extension in lower case.
pub(super) fn stem_and_extension(path: &str) -> (&str, String) {
    let name = base_name(path);
    match name.rsplit_once('.') {
        Some((stem, extension)) => (stem, extension.to_ascii_lowercase()),
        None => (name, String::new()),
    }
}

pub(super) fn is_photo_name(path: &str) -> bool {
    matches!(stem_and_extension(path).1.as_str(), "png" | "jpg" | "jpeg" | "webp" | "bmp" | "tif" | "tiff")
}

pub(super) fn is_mesh_name(path: &str) -> bool {
    matches!(stem_and_extension(path).1.as_str(), "ply" | "obj" | "stl" | "glb" | "gltf" | "off")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listing(paths: &[&str]) -> Listing {
        Listing::new("set", paths.iter().map(|path| ((*path).to_owned(), 1))).unwrap()
    }

    #[test]
    fn folders_are_told_by_their_files() {
        let listing = listing(&[
            "a/b/c.png",
            "a/d.png",
            "ab/e.png",
            "f\\g.png",
            "../secret",
            "a/../x",
            "__MACOSX/a/d.png",
        ]);
        assert_eq!(listing.paths().collect::<Vec<_>>(), ["a/b/c.png", "a/d.png", "ab/e.png", "f/g.png"]);
        assert_eq!(listing.below("a").collect::<Vec<_>>(), ["a/b/c.png", "a/d.png"]);
        assert_eq!(listing.names_in("a").collect::<Vec<_>>(), ["d.png"]);
        assert_eq!(listing.find("a", "d.png").as_deref(), Some("a/d.png"));
        assert_eq!((listing.folder_name("a/b"), listing.folder_name("")), ("b", "set"));
    }

    #[test]
    fn too_many_files_are_refused() {
        let files = (0..=MAX_FILES).map(|index| (index.to_string(), 1));
        assert!(Listing::new("set", files).unwrap_err().to_string().contains("more than 1000000 files"));
    }
}
