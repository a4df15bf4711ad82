//! What is open together: photos, objects, annotations and references. Plain data; nothing here changes by itself.
//!
//! A [`Scene`] is cheap to clone (files, meshes and photos are shared), so undo keeps whole scenes.

mod annotation;
mod asset;
mod color;
mod look;
mod placement;

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DMat4;

use crate::math::{Intrinsics, Pose};

pub use annotation::{Annotation, AnnotationState, PoseSource};
pub use asset::{CompanionFile, MeshAsset, PhotoAsset, Sha256};
pub use color::{Rgb, object_color, reference_color};
pub use look::{Layers, Look, OverlayMode, PhotoAdjustment};
pub use placement::untouched_pose;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PhotoId(pub u32);

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId(pub u32);

/// One image with its camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Photo {
    pub id: PhotoId,
    pub asset: Arc<PhotoAsset>,
    pub camera: Intrinsics,
    pub camera_origin: CameraOrigin,
}

/// Where a photo's intrinsics came from; a guess is always shown as one.
#[derive(Debug, Clone, PartialEq)]
pub enum CameraOrigin {
    /// 60° horizontal field of view.
    AssumedFieldOfView,
    /// The 35 mm equivalent focal length in the photo's EXIF data.
    Exif,
    Typed,
    File(String),
}

impl CameraOrigin {
    pub fn is_guess(&self) -> bool {
        matches!(self, Self::AssumedFieldOfView | Self::Exif)
    }
}

/// A mesh placed in the scene once; its pose is kept per photo in [`Scene::annotations`].
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    pub id: ObjectId,
    pub name: String,
    /// The mesh in the `object` frame, that is after `mesh_from_file`.
    pub mesh: Arc<MeshAsset>,
    /// Unit, mirror and spacing: from the numbers in the file to the `object` frame.
    pub mesh_from_file: DMat4,
    pub color: Rgb,
    /// 0 to 1.
    pub opacity: f32,
    pub visible: bool,
    pub locked: bool,
}

/// A named, read-only set of poses beside the annotations.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    pub name: String,
    pub visible: bool,
    pub poses: BTreeMap<(PhotoId, ObjectId), Pose>,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    pub name: String,
    pub photos: Vec<Photo>,
    pub objects: Vec<Object>,
    /// An object is in a photo if it has an annotation there.
    pub annotations: BTreeMap<(PhotoId, ObjectId), Annotation>,
    pub references: Vec<Reference>,
    next_id: u32,
}

impl Scene {
    pub fn named(name: &str) -> Self {
        Self { name: name.to_owned(), ..Self::default() }
    }

    pub fn is_empty(&self) -> bool {
        self.photos.is_empty() && self.objects.is_empty()
    }

    pub fn photo(&self, id: PhotoId) -> Option<&Photo> {
        self.photos.iter().find(|photo| photo.id == id)
    }

    pub fn photo_mut(&mut self, id: PhotoId) -> Option<&mut Photo> {
        self.photos.iter_mut().find(|photo| photo.id == id)
    }

    pub fn object(&self, id: ObjectId) -> Option<&Object> {
        self.objects.iter().find(|object| object.id == id)
    }

    pub fn object_mut(&mut self, id: ObjectId) -> Option<&mut Object> {
        self.objects.iter_mut().find(|object| object.id == id)
    }

    pub fn annotation(&self, photo: PhotoId, object: ObjectId) -> Option<&Annotation> {
        self.annotations.get(&(photo, object))
    }

    /// The objects that are in a photo, with their annotations, in the order of [`Self::objects`].
    pub fn objects_in(&self, photo: PhotoId) -> impl Iterator<Item = (&Object, &Annotation)> {
        self.objects.iter().filter_map(move |object| Some((object, self.annotation(photo, object.id)?)))
    }

    /// Adds a photo with a guessed camera, or finds the one with the same content.
    pub fn add_photo(&mut self, asset: Arc<PhotoAsset>) -> PhotoId {
        if let Some(same) = self.photos.iter().find(|photo| photo.asset.sha256 == asset.sha256) {
            return same.id;
        }
        let id = PhotoId(self.take_id());
        let (camera, camera_origin) = asset.guessed_camera();
        self.photos.push(Photo { id, asset, camera, camera_origin });
        id
    }

    /// Adds an object that is in no photo yet.
    pub fn add_object(&mut self, mesh: Arc<MeshAsset>) -> ObjectId {
        let id = ObjectId(self.take_id());
        self.objects.push(Object {
            id,
            name: file_stem(&mesh.file_name).to_owned(),
            color: object_color(self.objects.len()),
            mesh,
            mesh_from_file: DMat4::IDENTITY,
            opacity: 0.7,
            visible: true,
            locked: false,
        });
        id
    }

    pub fn remove_photo(&mut self, id: PhotoId) {
        self.photos.retain(|photo| photo.id != id);
        self.retain_poses(|(photo, _)| photo != id);
    }

    pub fn remove_object(&mut self, id: ObjectId) {
        self.objects.retain(|object| object.id != id);
        self.retain_poses(|(_, object)| object != id);
    }

    /// Puts an object into a photo at the start pose, unless it is there already.
    pub fn place(&mut self, photo: PhotoId, object: ObjectId, time_ms: f64) {
        let (Some(camera), Some(mesh)) =
            (self.photo(photo).map(|photo| photo.camera), self.object(object).map(|object| &object.mesh))
        else {
            return;
        };
        let pose = untouched_pose(&camera, &mesh.mesh);
        self.annotations.entry((photo, object)).or_insert_with(|| Annotation::untouched(pose, time_ms));
    }

    /// Gives a photo another camera. Untouched poses follow it; all others in the photo are marked for a second look.
    pub fn set_camera(&mut self, id: PhotoId, camera: Intrinsics, origin: CameraOrigin) {
        let Some(photo) = self.photo_mut(id) else { return };
        let changed = photo.camera != camera;
        photo.camera = camera;
        photo.camera_origin = origin;
        if !changed {
            return;
        }
        for ((_, object), annotation) in
            self.annotations.range_mut((id, ObjectId(0))..=(id, ObjectId(u32::MAX)))
        {
            if annotation.state != AnnotationState::Untouched {
                annotation.camera_changed = true;
            } else if let Some(object) = self.objects.iter().find(|candidate| candidate.id == *object) {
                annotation.camera_from_object = untouched_pose(&camera, &object.mesh.mesh);
            }
        }
    }

    fn retain_poses(&mut self, keep: impl Fn((PhotoId, ObjectId)) -> bool) {
        self.annotations.retain(|key, _| keep(*key));
        for reference in &mut self.references {
            reference.poses.retain(|key, _| keep(*key));
        }
    }

    fn take_id(&mut self) -> u32 {
        self.next_id += 1;
        self.next_id
    }
}

/// A file's name without folders and extension.
pub fn file_stem(file_name: &str) -> &str {
    let base = file_name.rsplit(['/', '\\']).next().unwrap_or(file_name);
    base.rsplit_once('.').map_or(base, |(stem, _)| if stem.is_empty() { base } else { stem })
}
