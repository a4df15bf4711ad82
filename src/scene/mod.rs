//! What is open together: photos, objects, annotations and references. Plain data; nothing here changes by itself.
//!
//! A [`Scene`] is cheap to clone (files, meshes and photos are shared), so undo keeps whole scenes.

mod annotation;
mod asset;
mod color;
mod depth_map;
mod look;
mod mask;
mod mesh_frame;
mod pin;
mod placement;
mod symmetry;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::DMat4;

use crate::math::{Intrinsics, Pose};
use crate::photo::ExifFocalSource;

pub use annotation::{Annotation, AnnotationState, PoseSource};
pub use asset::{CompanionFile, MeshAsset, PhotoAsset, Sha256};
pub use color::{Rgb, free_object_color, mask_color, object_color, reference_color};
pub use depth_map::{DepthInMm, DepthMap};
pub use look::{Layers, Look, OverlayMode, PhotoAdjustment};
pub use mask::{Mask, MaskId};
pub use mesh_frame::{MeshFrame, MeshFrameError};
pub use pin::Pin;
pub use placement::untouched_pose;
pub use symmetry::{ContinuousSymmetry, Fold, Symmetries, SymmetryAxis, SymmetryError};

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PhotoId(pub u32);

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ObjectId(pub u32);

/// One image with its camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Photo {
    pub id: PhotoId,
    pub name: String,
    pub asset: Arc<PhotoAsset>,
    pub camera: Intrinsics,
    pub camera_origin: CameraOrigin,
    /// The last camera that was neither typed nor set by eye: what a reset goes back to.
    pub given_camera: (Intrinsics, CameraOrigin),
    /// Its pixels are shown; the meshes over it have their own.
    pub visible: bool,
    /// 0 to 1, over the background.
    pub opacity: f32,
    /// Camera and poses stay as they are.
    pub locked: bool,
    pub depth: Option<DepthMap>,
}

/// Where a photo's intrinsics came from; a guess is always shown as one.
#[derive(Debug, Clone, PartialEq)]
pub enum CameraOrigin {
    /// 60° horizontal field of view.
    AssumedFieldOfView,
    /// The focal length in the photo's EXIF data, and what it says of the sensor.
    Exif(ExifFocalSource),
    /// The focal length that fits the pins; one standard deviation of it, as a part of it.
    Pins {
        relative_sigma: f64,
    },
    /// The focal length that somebody set by eye, with the depths that go with it; before that it was this, in pixels along x.
    Slider {
        before_px: f64,
    },
    Typed,
    File(String),
}

impl CameraOrigin {
    pub fn is_guess(&self) -> bool {
        self.focal_sigma().is_some()
    }

    /// How far an estimated focal length may be off, as a part of it: one standard deviation. The depth of what is posed with
    /// it is off by the same part. `None` for one that was measured.
    pub fn focal_sigma(&self) -> Option<f64> {
        match self {
            // Most cameras see between 45° and 80°.
            Self::AssumedFieldOfView => Some(0.2),
            // Whole millimetres at 26, and makers who mean the diagonal.
            Self::Exif(ExifFocalSource::Equivalent) => Some(0.04),
            // A zoom's stated length, and focus breathing.
            Self::Exif(ExifFocalSource::FocalPlane | ExifFocalSource::SensorTable) => Some(0.03),
            Self::Pins { relative_sigma } => Some(*relative_sigma),
            Self::Slider { .. } => Some(0.1),
            Self::Typed | Self::File(_) => None,
        }
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
    /// Objects of one group move together.
    pub link: Option<u32>,
    /// In the `object` frame.
    pub symmetries: Symmetries,
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
    pub masks: Vec<Mask>,
    next_id: u32,
}

/// A file that a scene needs.
#[derive(Debug, Clone, Copy)]
pub struct SceneFile<'a> {
    pub name: &'a str,
    pub sha256: Sha256,
    pub bytes: &'a Arc<[u8]>,
    pub is_image: bool,
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

    /// The other objects of a photo that somebody has placed: what may be before this one. One that still waits where it came
    /// in is nowhere.
    pub fn placed_beside(
        &self,
        photo: PhotoId,
        object: ObjectId,
    ) -> impl Iterator<Item = (&Object, &Annotation)> {
        self.objects_in(photo).filter(move |(other, annotation)| {
            other.id != object && annotation.state != AnnotationState::Untouched
        })
    }

    /// What has been done in a photo: the least of what has been done with its objects; `None` where it has none.
    pub fn photo_state(&self, photo: PhotoId) -> Option<AnnotationState> {
        self.annotations.range(poses_in(photo)).map(|(_, annotation)| annotation.state).min()
    }

    /// The poses of one photo, to be changed.
    pub fn annotations_in_mut(
        &mut self,
        photo: PhotoId,
    ) -> impl Iterator<Item = (ObjectId, &mut Annotation)> {
        self.annotations.range_mut(poses_in(photo)).map(|((_, object), annotation)| (*object, annotation))
    }

    /// Adds a photo with a guessed camera, or finds the one with the same content.
    pub fn add_photo(&mut self, asset: Arc<PhotoAsset>) -> PhotoId {
        if let Some(same) = self.photos.iter().find(|photo| photo.asset.sha256 == asset.sha256) {
            return same.id;
        }
        let id = PhotoId(self.take_id());
        let (camera, camera_origin) = asset.guessed_camera();
        self.photos.push(Photo {
            id,
            name: asset.file_name.clone(),
            asset,
            camera,
            given_camera: (camera, camera_origin.clone()),
            camera_origin,
            visible: true,
            opacity: 1.0,
            locked: false,
            depth: None,
        });
        id
    }

    /// Adds an object that is in no photo yet.
    pub fn add_object(&mut self, mesh: Arc<MeshAsset>) -> ObjectId {
        let id = ObjectId(self.take_id());
        let used = self.objects.iter().map(|object| object.color);
        self.objects.push(Object {
            id,
            name: self.free_object_name(file_stem(&mesh.file_name)),
            color: free_object_color(used),
            mesh,
            mesh_from_file: DMat4::IDENTITY,
            opacity: 0.7,
            visible: true,
            locked: false,
            link: None,
            symmetries: Symmetries::default(),
        });
        id
    }

    /// Another object of the same mesh, in the same places as the first, beside it in the list.
    pub fn duplicate_object(&mut self, id: ObjectId) -> Option<ObjectId> {
        let position = self.objects.iter().position(|object| object.id == id)?;
        let original = self.objects[position].clone();
        let copy = ObjectId(self.take_id());
        let name = self.free_object_name(&original.name);
        let color = free_object_color(self.objects.iter().map(|object| object.color));
        self.objects
            .insert(position + 1, Object { id: copy, name, color, link: None, locked: false, ..original });
        Some(copy)
    }

    pub fn add_mask(&mut self, photo: PhotoId, object: Option<ObjectId>, asset: Arc<PhotoAsset>) -> MaskId {
        let id = MaskId(self.take_id());
        let color = object.and_then(|object| self.object(object)).map_or(mask_color(), |object| object.color);
        let name = asset.file_name.clone();
        self.masks.push(Mask { id, photo, object, name, asset, color, opacity: 0.4, visible: true });
        id
    }

    pub fn mask(&self, id: MaskId) -> Option<&Mask> {
        self.masks.iter().find(|mask| mask.id == id)
    }

    pub fn masks_of(&self, photo: PhotoId) -> impl Iterator<Item = &Mask> {
        self.masks.iter().filter(move |mask| mask.photo == photo)
    }

    /// Every file that the scene needs, each content once.
    pub fn files(&self) -> Vec<SceneFile<'_>> {
        let photos = self.photos.iter().map(|photo| &photo.asset);
        let depths = self.photos.iter().filter_map(|photo| Some(&photo.depth.as_ref()?.asset));
        let masks = self.masks.iter().map(|mask| &mask.asset);
        let images = photos.chain(depths).chain(masks).map(|asset| SceneFile {
            name: &asset.file_name,
            sha256: asset.sha256,
            bytes: &asset.bytes,
            is_image: true,
        });
        let meshes = self.objects.iter().map(|object| SceneFile {
            name: &object.mesh.file_name,
            sha256: object.mesh.sha256,
            bytes: &object.mesh.bytes,
            is_image: false,
        });
        let mut seen = BTreeSet::new();
        images.chain(meshes).filter(|file| seen.insert(file.sha256)).collect()
    }

    /// The objects that move together with one, itself left out.
    pub fn linked_to(&self, id: ObjectId) -> impl Iterator<Item = ObjectId> {
        let link = self.object(id).and_then(|object| object.link);
        let linked = self.objects.iter().filter(move |object| link.is_some() && object.link == link);
        linked.map(|object| object.id).filter(move |linked| *linked != id)
    }

    /// Makes objects move together: one group of them and of whatever they were linked to.
    pub fn link(&mut self, ids: &[ObjectId]) {
        let groups: Vec<u32> =
            ids.iter().filter_map(|id| self.object(*id)).filter_map(|object| object.link).collect();
        let group = self.take_id();
        for object in &mut self.objects {
            if ids.contains(&object.id) || object.link.is_some_and(|link| groups.contains(&link)) {
                object.link = Some(group);
            }
        }
    }

    /// Lets objects move by themselves.
    pub fn unlink(&mut self, ids: &[ObjectId]) {
        for object in self.objects.iter_mut().filter(|object| ids.contains(&object.id)) {
            object.link = None;
        }
        self.dissolve_lone_links();
    }

    /// Who is left alone in a group is in none.
    fn dissolve_lone_links(&mut self) {
        let links: Vec<Option<u32>> = self.objects.iter().map(|object| object.link).collect();
        for object in &mut self.objects {
            let members = links.iter().filter(|link| **link == object.link).count();
            object.link = object.link.filter(|_| members > 1);
        }
    }

    fn free_object_name(&self, wanted: &str) -> String {
        let is_free = |name: &str| self.objects.iter().all(|object| object.name != name);
        if is_free(wanted) {
            return wanted.to_owned();
        }
        let base = wanted.rsplit_once(' ').filter(|(_, number)| number.parse::<u32>().is_ok());
        let base = base.map_or(wanted, |(base, _)| base);
        (2..).map(|number| format!("{base} {number}")).find(|name| is_free(name)).unwrap_or_default()
    }

    pub fn remove_photo(&mut self, id: PhotoId) {
        self.photos.retain(|photo| photo.id != id);
        self.masks.retain(|mask| mask.photo != id);
        self.retain_poses(|(photo, _)| photo != id);
    }

    pub fn remove_object(&mut self, id: ObjectId) {
        self.objects.retain(|object| object.id != id);
        self.dissolve_lone_links();
        for mask in self.masks.iter_mut().filter(|mask| mask.object == Some(id)) {
            mask.object = None;
        }
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
        if !matches!(origin, CameraOrigin::Typed | CameraOrigin::Slider { .. }) {
            photo.given_camera = (camera, origin.clone());
        }
        photo.camera_origin = origin;
        if !changed {
            return;
        }
        for ((_, object), annotation) in self.annotations.range_mut(poses_in(id)) {
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

/// Where a photo's poses are among all.
fn poses_in(photo: PhotoId) -> std::ops::RangeInclusive<(PhotoId, ObjectId)> {
    (photo, ObjectId(0))..=(photo, ObjectId(u32::MAX))
}

/// A file's name without folders and extension.
pub fn file_stem(file_name: &str) -> &str {
    let base = file_name.rsplit(['/', '\\']).next().unwrap_or(file_name);
    base.rsplit_once('.').map_or(base, |(stem, _)| if stem.is_empty() { base } else { stem })
}
