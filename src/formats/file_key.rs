//! How foreign files name photos and meshes, and how the scene's are found by such names.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};

use super::Incoming;
use crate::scene::{MeshAsset, Photo, PhotoId, Scene, Sha256, file_stem};

/// How a file of poses names a photo or a mesh.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum FileKey {
    /// Our own files: the content decides, the name is for messages.
    Content { sha256: Sha256, file_name: String },
    /// A file name without its extension.
    Stem(String),
    /// A path, as far as both it and the file's name go: `rgb/000001.png` is `test/000002/rgb/000001.png`.
    Path(String),
    /// BOP's photo: its name is its number, in a folder of its scene. Without a scene, whichever scene is open.
    BopImage { scene: Option<u32>, image: u32 },
    /// BOP's mesh: `obj_000005.ply` is number 5.
    BopObject(u32),
    /// A mesh by its own name or that of the folder it is in.
    Label(String),
    /// The file names nothing. It may be called as the photo or the mesh is; else the scene's `position`-th is meant, if it
    /// has exactly `of`.
    Unnamed { stem: String, position: usize, of: usize },
}

impl FileKey {
    /// The name without folders and extension.
    pub fn stem(&self) -> Cow<'_, str> {
        match self {
            Self::Content { file_name: name, .. } | Self::Path(name) => file_stem(name).into(),
            Self::Stem(name) | Self::Label(name) | Self::Unnamed { stem: name, .. } => name.into(),
            Self::BopImage { image, .. } => format!("{image:06}").into(),
            Self::BopObject(id) => format!("obj_{id:06}").into(),
        }
    }

    /// As a message names it.
    pub fn display(&self) -> String {
        match self {
            Self::Content { file_name, .. } => file_name.clone(),
            Self::Path(path) => base_name(path).to_owned(),
            Self::BopImage { scene: Some(scene), image } => format!("{image:06} of scene {scene:06}"),
            Self::Unnamed { of: 1, .. } => "the one photo or mesh that is meant".to_owned(),
            Self::Unnamed { of, .. } => format!("exactly {of} photos or one mesh"),
            _ => self.stem().into_owned(),
        }
    }

    /// Does this name the photo at a path? What only a scene can tell (content, position) it does not.
    pub(super) fn names_photo_at(&self, path: &str) -> bool {
        match self {
            Self::Stem(stem) => file_stem(path) == stem,
            Self::Path(wanted) => is_same_path(wanted, path),
            Self::BopImage { image, .. } => number_of(file_stem(path)) == Some(*image),
            Self::Content { .. } | Self::BopObject(_) | Self::Label(_) | Self::Unnamed { .. } => false,
        }
    }

    /// Is this the mesh that is named? `is_only_one` says that the scene has no other.
    pub(super) fn names_mesh(&self, mesh: &MeshAsset, is_only_one: bool) -> bool {
        let stem = file_stem(&mesh.file_name);
        match self {
            Self::Content { sha256, .. } => *sha256 == mesh.sha256,
            Self::Stem(wanted) => stem == wanted,
            Self::Path(path) => common_tail(path, &mesh.file_name).is_some(),
            Self::BopImage { .. } => false,
            Self::BopObject(id) => bop_object_id(stem) == Some(*id),
            Self::Label(label) => stem == label || folder_name(&mesh.file_name) == Some(label),
            Self::Unnamed { stem: wanted, .. } => is_only_one || stem == wanted,
        }
    }
}

/// The file's name without folders.
pub(super) fn base_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

/// The folder that a file is directly in.
fn folder_name(path: &str) -> Option<&str> {
    path.rsplit(['/', '\\']).nth(1).filter(|name| !name.is_empty())
}

/// Do two paths agree as far as both go?
pub(super) fn is_same_path(a: &str, b: &str) -> bool {
    common_tail(a, b).is_some()
}

/// How many names at the end of two paths agree, if one of the paths agrees to its beginning.
fn common_tail(a: &str, b: &str) -> Option<usize> {
    let names =
        |path: &'_ str| path.split(['/', '\\']).filter(|name| !name.is_empty() && *name != ".").count();
    let tail = |path| str::rsplit(path, ['/', '\\']).filter(|name| !name.is_empty() && *name != ".");
    let common = tail(a).zip(tail(b)).take_while(|(a, b)| a == b).count();
    (common > 0 && common == names(a).min(names(b))).then_some(common)
}

/// The number in `obj_000005`, `obj_05` or `000005`.
pub(super) fn bop_object_id(stem: &str) -> Option<u32> {
    number_of(stem.strip_prefix("obj_").unwrap_or(stem))
}

/// A name that is a number and nothing else.
pub(super) fn number_of(name: &str) -> Option<u32> {
    let is_number = !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_digit());
    if is_number { name.parse().ok() } else { None }
}

/// The scene that a BOP photo's path tells: the folder above `rgb`, `gray` or a sensor's.
fn bop_scene_of(path: &str) -> Option<u32> {
    let mut names = path.rsplit(['/', '\\']);
    let (folder, scene) = (names.nth(1)?, names.next()?);
    if folder.starts_with("rgb") || folder.starts_with("gray") { number_of(scene) } else { None }
}

/// Finds a scene's photos by the names that an import has for them. A thousand names among a thousand photos take a moment.
pub(super) struct PhotoFinder<'a> {
    photos: &'a [Photo],
    by_hash: HashMap<Sha256, usize>,
    by_stem: HashMap<&'a str, Vec<usize>>,
    by_number: BTreeMap<u32, Vec<usize>>,
    /// The import speaks of several scenes: a photo of which the scene is not known is none of theirs.
    has_several_scenes: bool,
}

impl<'a> PhotoFinder<'a> {
    pub fn new(scene: &'a Scene, incoming: &Incoming) -> Self {
        let mut finder = Self {
            photos: &scene.photos,
            by_hash: HashMap::new(),
            by_stem: HashMap::new(),
            by_number: BTreeMap::new(),
            has_several_scenes: false,
        };
        for (index, photo) in scene.photos.iter().enumerate() {
            let stem = file_stem(&photo.asset.file_name);
            finder.by_hash.entry(photo.asset.sha256).or_insert(index);
            finder.by_stem.entry(stem).or_default().push(index);
            if let Some(number) = number_of(stem) {
                finder.by_number.entry(number).or_default().push(index);
            }
        }
        let mut scenes = incoming.photos.iter().filter_map(|photo| match photo.key {
            FileKey::BopImage { scene, .. } => scene,
            _ => None,
        });
        let first = scenes.next();
        finder.has_several_scenes = scenes.any(|scene| Some(scene) != first);
        finder
    }

    pub fn find(&self, key: &FileKey) -> Option<PhotoId> {
        let with_stem = |stem: &str| self.by_stem.get(stem).map(Vec::as_slice).unwrap_or_default();
        let index = match key {
            FileKey::Content { sha256, .. } => self.by_hash.get(sha256).copied(),
            FileKey::Stem(stem) | FileKey::Label(stem) => with_stem(stem).first().copied(),
            FileKey::Path(path) => {
                let tail = |index: &usize| common_tail(path, &self.photos.get(*index)?.asset.file_name);
                let fitting =
                    with_stem(file_stem(path)).iter().filter_map(|index| Some((tail(index)?, *index)));
                // The first of those that agree most.
                fitting.rev().max_by_key(|(tail, _)| *tail).map(|(_, index)| index)
            }
            FileKey::BopImage { scene, image } => {
                let candidates = self.by_number.get(image)?;
                candidates.iter().copied().find(|index| self.is_of_scene(*index, *scene))
            }
            FileKey::BopObject(_) => None,
            FileKey::Unnamed { stem, position, of } => {
                let called_so = with_stem(stem).first().copied().filter(|_| *of == 1);
                called_so.or_else(|| (self.photos.len() == *of).then_some(*position))
            }
        };
        index.and_then(|index| self.photos.get(index)).map(|photo| photo.id)
    }

    fn is_of_scene(&self, index: usize, wanted: Option<u32>) -> bool {
        let Some(wanted) = wanted else { return true };
        match self.photos.get(index).and_then(|photo| bop_scene_of(&photo.asset.file_name)) {
            Some(scene) => scene == wanted,
            None => !self.has_several_scenes,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_agree_as_far_as_both_go() {
        assert_eq!(common_tail("rgb/000001.png", "test/000002/rgb/000001.png"), Some(2));
        assert_eq!(common_tail("C:\\data\\mug.ply", "mug.ply"), Some(1));
        assert_eq!(common_tail("a/mug.ply", "b/mug.ply"), None);
        assert_eq!(common_tail("./mug.ply", "mug.ply"), Some(1));
        assert_eq!(common_tail("", ""), None);
    }

    #[test]
    fn bop_names_hold_numbers() {
        assert_eq!(bop_object_id("obj_000005"), Some(5));
        assert_eq!(bop_object_id("05"), Some(5));
        assert_eq!(bop_object_id("obj_5b"), None);
        assert_eq!(bop_object_id("obj_99999999999"), None);
        assert_eq!(bop_scene_of("lmo/test/000002/rgb/000764.png"), Some(2));
        assert_eq!(bop_scene_of("000002/gray_left/000764.png"), Some(2));
        assert_eq!(bop_scene_of("rgb/000764.png"), None);
    }
}
