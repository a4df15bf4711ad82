//! Which images of a folder are photos, and which are textures, masks and depth maps: names alone tell.

use std::collections::{BTreeMap, BTreeSet};

use crate::formats::dataset::listing::{
    Listing, base_name, is_mesh_name, is_photo_name, parent, stem_and_extension,
};

/// The images of a listing, sorted out.
#[derive(Debug, Clone, Default)]
pub(super) struct Images {
    pub photos: Vec<String>,
    pub masks: BTreeSet<String>,
    pub depth: BTreeSet<String>,
    /// Masks and depth maps by the names of their photos.
    masks_by_stem: BTreeMap<String, Vec<String>>,
    depth_by_stem: BTreeMap<String, Vec<String>>,
}

pub(super) fn sort_images(listing: &Listing) -> Images {
    // A texture is mostly called as its mesh is.
    let meshes: BTreeSet<String> = listing
        .paths()
        .filter(|path| is_mesh_name(path))
        .map(|path| without_extension(path).to_owned())
        .collect();
    let mut images = Images::default();
    for path in listing.paths().filter(|path| is_photo_name(path)) {
        let stem = stem_and_extension(path).0.to_ascii_lowercase();
        let folder = base_name(parent(path)).to_ascii_lowercase();
        if is_texture_folder(&folder) || meshes.contains(without_extension(path)) {
            continue;
        }
        if folder.starts_with("mask") || folder.starts_with("seg") || has_word(&stem, "mask") {
            images.masks.insert(path.to_owned());
            images.masks_by_stem.entry(without_word(&stem, "mask")).or_default().push(path.to_owned());
        } else if folder.starts_with("depth") || has_word(&stem, "depth") {
            images.depth.insert(path.to_owned());
            images.depth_by_stem.entry(without_word(&stem, "depth")).or_default().push(path.to_owned());
        } else {
            images.photos.push(path.to_owned());
        }
    }
    images
}

impl Images {
    pub fn masks_of(&self, photo: &str) -> impl Iterator<Item = &str> {
        let masks = self.masks_by_stem.get(&stem_and_extension(photo).0.to_ascii_lowercase());
        masks.into_iter().flatten().map(String::as_str)
    }

    /// A photo has one depth map; of two, neither is known to be it.
    pub fn depth_of(&self, photo: &str) -> Option<&str> {
        match self.depth_by_stem.get(&stem_and_extension(photo).0.to_ascii_lowercase()).map(Vec::as_slice) {
            Some([depth]) => Some(depth),
            _ => None,
        }
    }
}

fn is_texture_folder(name: &str) -> bool {
    ["texture", "models", "meshes", "materials"].iter().any(|word| name.starts_with(word))
}

fn without_extension(path: &str) -> &str {
    path.rsplit_once('.').map_or(path, |(stem, _)| stem)
}

/// Is the word at the beginning or the end of a name?
fn has_word(stem: &str, word: &str) -> bool {
    stem.starts_with(word) || stem.ends_with(word)
}

/// What is left of a name without the word: `mask_0001` and `0001-mask` are those of `0001`.
fn without_word(stem: &str, word: &str) -> String {
    let rest = stem.strip_prefix(word).unwrap_or(stem);
    let rest = rest.strip_suffix(word).unwrap_or(rest);
    rest.trim_matches(|c: char| matches!(c, '_' | '-' | '.' | ' ')).to_owned()
}
