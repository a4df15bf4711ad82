//! Photos, meshes and files of cameras and poses in a folder, each a file that could have been dropped by itself: Vision6D's
//! studies and workspaces, 6D-PAT's projects, and what people put together.

mod images;

use std::sync::Arc;

use super::listing::{Listing, base_name, is_mesh_name, parent, stem_and_extension};
use super::{
    Choice, Contents, Dataset, DatasetDepth, DatasetKind, DatasetMask, DatasetMesh, DatasetPhoto,
    Layout as AnyLayout, Recognised, counted, meshes,
};
use crate::formats::file_key::is_same_path;
use crate::formats::{
    CameraFile, FileKey, FileKind, FormatError, Incoming, IncomingCamera, NamedFile, Parsed, classify,
    parse_text_or_archive, vision6d,
};
use images::{Images, sort_images};

/// What is larger is no camera and no poses of photos that somebody annotates.
const MAX_TEXT_BYTES: u64 = 16 << 20;
/// More small text files are somebody's labels, one for each photo.
const MOST_TEXTS: usize = 256;
const MOST_MESHES: usize = 1000;

#[derive(Debug, Clone)]
pub(super) struct Layout {
    listing: Arc<Listing>,
    photos: Vec<String>,
    meshes: Vec<String>,
    texts: Vec<String>,
    images: Images,
}

pub(super) fn recognise(listing: &Arc<Listing>) -> Option<Recognised> {
    let meshes: Vec<String> =
        listing.paths().filter(|path| is_mesh_name(path)).take(MOST_MESHES).map(str::to_owned).collect();
    let images = sort_images(listing);
    if images.photos.is_empty() && meshes.is_empty() {
        return None;
    }
    let is_text = |path: &&str| {
        let extension = stem_and_extension(path).1;
        let is_small = listing.size_of(path).is_some_and(|bytes| bytes <= MAX_TEXT_BYTES);
        is_small && matches!(extension.as_str(), "json" | "txt" | "csv" | "yml" | "yaml" | "npy" | "pkl")
    };
    let texts = listing.paths().filter(is_text).take(MOST_TEXTS).map(str::to_owned).collect();
    let size = |path: &String| listing.size_of(path).unwrap_or(0);
    let choice = Choice {
        label: listing.name().to_owned(),
        photos: images.photos.len(),
        bytes: images.photos.iter().map(size).sum(),
    };
    let photos = images.photos.clone();
    let layout = Layout { listing: listing.clone(), photos, meshes, texts, images };
    Recognised::new(DatasetKind::Folder, listing, vec![choice], AnyLayout::Folder(layout))
}

impl Layout {
    pub fn needed(&self) -> Vec<String> {
        self.texts.clone()
    }

    pub fn interpret(&self, contents: &Contents, dataset: &mut Dataset) {
        let mut texts = Texts::default();
        for (path, bytes) in self.texts.iter().filter_map(|path| Some((path, contents.get(path)?))) {
            texts.read(path, bytes, dataset);
        }
        let is_mask = |path: &String| self.images.masks.contains(path) || texts.names_mask(path);
        let photos = self.photos.iter().filter(|path| !is_mask(path));
        dataset.photos = photos.map(|path| self.photo(path, &texts)).collect();
        dataset.meshes = self
            .meshes
            .iter()
            .map(|path| DatasetMesh {
                companions: meshes::companions(&self.listing, path),
                ..DatasetMesh::at(path)
            })
            .collect();
        dataset.found.insert(0, counted(dataset.meshes.len(), "mesh", ""));
        dataset.found.insert(0, counted(dataset.photos.len(), "photo", ""));
        self.describe(&texts, dataset);
        // A file with cameras alone has given them to the photos.
        for poses in texts.poses {
            dataset.take_poses(poses);
        }
        if dataset.poses.is_empty() {
            dataset.missing.push("poses: objects begin untouched".to_owned());
        }
    }

    fn photo(&self, path: &str, texts: &Texts) -> DatasetPhoto {
        let depth =
            self.images.depth_of(path).map(|path| DatasetDepth { path: path.to_owned(), mm_per_unit: 1.0 });
        let of_workspace =
            self.photos.iter().filter(|mask| texts.masks_photo(mask, path)).map(String::as_str);
        let masks = self.images.masks_of(path).chain(of_workspace).map(|path| DatasetMask {
            path: path.to_owned(),
            mesh: None,
            instance: 0,
        });
        DatasetPhoto {
            camera: texts.camera_of(path).cloned(),
            depth,
            masks: masks.collect(),
            path: path.to_owned(),
        }
    }

    fn describe(&self, texts: &Texts, dataset: &mut Dataset) {
        let with_depth = dataset.photos.iter().filter(|photo| photo.depth.is_some()).count();
        if with_depth > 0 {
            dataset.found.push(counted(with_depth, "depth map", ""));
            dataset.guessed.push("depth maps are in millimetres".to_owned());
        }
        let masks: usize = dataset.photos.iter().map(|photo| photo.masks.len()).sum();
        if masks > 0 {
            dataset.found.push(counted(masks, "mask", ""));
        }
        let of_names = self.images.masks.len() + self.images.depth.len();
        let left_over = of_names.saturating_sub(masks + with_depth);
        if left_over > 0 {
            dataset.missing.push(format!("the photos of {}", counted(left_over, "mask or depth map", "")));
        }
        let without_camera = dataset.photos.iter().filter(|photo| photo.camera.is_none()).count();
        if without_camera > 0 && !dataset.photos.is_empty() {
            dataset.missing.push(counted(without_camera, "photo", " without a camera: it will be guessed"));
        }
        let (cameras, by_name) = (texts.cameras.len(), texts.named_cameras().count());
        if cameras > 0 && by_name == 0 && dataset.photos.len() > 1 {
            dataset.guessed.push("a camera's file is for all photos in its folder and below".to_owned());
        }
    }
}

/// What the small files of a folder say.
#[derive(Default)]
struct Texts {
    /// Cameras that name no photo, by the paths of their files.
    cameras: Vec<(String, CameraFile)>,
    poses: Vec<Incoming>,
    /// Paths that a workspace calls masks, each with that of the first photo.
    masks: Vec<(String, Option<String>)>,
}

impl Texts {
    fn read(&mut self, path: &str, bytes: &Arc<[u8]>, dataset: &mut Dataset) {
        let file = NamedFile { name: base_name(path).to_owned(), bytes: bytes.clone() };
        let kind = classify(&file.name, bytes);
        if kind == FileKind::Unknown {
            return;
        }
        if kind == FileKind::Json
            && let Some(workspace) = read_workspace(&file)
        {
            match workspace {
                Ok(workspace) => {
                    dataset.found.push(format!("the Vision6D workspace {path}"));
                    let photo = workspace.images.first();
                    self.masks.extend(workspace.masks.iter().map(|mask| (mask.clone(), photo.cloned())));
                    self.poses.push(workspace.poses);
                }
                Err(error) => dataset.miss_file(path, &error),
            }
            return;
        }
        match parse_text_or_archive(&file, kind) {
            Ok(Parsed::Camera(camera)) => {
                dataset.found.push(format!("the camera {path}"));
                self.cameras.push((path.to_owned(), camera));
            }
            Ok(Parsed::Poses(poses)) => self.poses.push(poses),
            Ok(Parsed::Photo(_) | Parsed::Mesh(_) | Parsed::Workspace(_) | Parsed::Pins(_)) => {}
            Err(error) => dataset.miss_file(path, &error),
        }
    }

    fn names_mask(&self, path: &str) -> bool {
        self.masks.iter().any(|(mask, _)| is_same_path(mask, path))
    }

    /// Does a workspace have this mask for this photo?
    fn masks_photo(&self, mask: &str, photo: &str) -> bool {
        self.masks.iter().any(|(path, of)| {
            is_same_path(path, mask) && of.as_deref().is_some_and(|of| is_same_path(of, photo))
        })
    }

    /// The cameras that come with the name of their photo.
    fn named_cameras(&self) -> impl Iterator<Item = (&FileKey, &CameraFile)> {
        self.poses.iter().flat_map(|poses| &poses.photos).filter_map(|photo| match &photo.camera {
            Some(IncomingCamera::File(camera)) => Some((&photo.key, camera)),
            _ => None,
        })
    }

    /// A photo's own camera, else that of the nearest folder above it, else the only one there is.
    fn camera_of(&self, path: &str) -> Option<&CameraFile> {
        let own = self.named_cameras().find(|(key, _)| key.names_photo_at(path)).map(|(_, camera)| camera);
        let above = |file: &str| {
            let folder = parent(file);
            (folder.is_empty() || path.starts_with(&format!("{folder}/"))).then_some(folder.len())
        };
        let nearest = self.cameras.iter().filter_map(|(file, _)| above(file)).max();
        let mut of_nearest =
            self.cameras.iter().filter(|(file, _)| nearest.is_some() && above(file) == nearest);
        let mut all = self.cameras.iter();
        let first = of_nearest.next();
        // Several cameras in one folder have to agree.
        let is_one = |(_, camera): &(String, CameraFile)| {
            first.is_some_and(|(_, first)| (first.k, first.distortion) == (camera.k, camera.distortion))
        };
        let nearest = first.filter(|_| of_nearest.all(is_one));
        let only = all.next().filter(|_| all.next().is_none());
        own.or_else(|| nearest.or(only).map(|(_, camera)| camera))
    }
}

fn read_workspace(file: &NamedFile) -> Option<Result<vision6d::Vision6dWorkspace, FormatError>> {
    let value: serde_json::Value = serde_json::from_slice(&file.bytes).ok()?;
    vision6d::looks_like_workspace(&value).then(|| vision6d::read_workspace(&file.name, &value))
}

#[cfg(test)]
mod tests;
