//! Finding the photos and meshes that incoming poses speak of, and giving the poses to the scene.

use std::collections::{BTreeMap, BTreeSet};

use super::file_key::PhotoFinder;
use super::incoming::PhotoLook;
use super::{FileKey, Incoming, IncomingCamera, IncomingObject, PosesAs};
use crate::math::Pose;
use crate::scene::{
    Annotation, AnnotationState, CameraOrigin, MeshAsset, ObjectId, Photo, PhotoId, Reference, Scene,
    file_stem,
};

/// What became of an import.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outcome {
    /// How many poses found their photo and their mesh.
    pub applied: usize,
    /// Names of the files that are still needed.
    pub missing: Vec<String>,
    /// Photos that the import gave a camera of another size than theirs: the user decides.
    pub differing_cameras: Vec<(PhotoId, super::CameraFile)>,
    /// What could not be done.
    pub problems: Vec<String>,
    /// The part that waits for files; what was given to the scene is not in it, for the user may change that meanwhile.
    pub rest: Option<Incoming>,
}

impl Incoming {
    /// Gives cameras and poses to the scene as far as their files are in it.
    pub fn apply(&self, scene: &mut Scene, poses_as: PosesAs, now_ms: f64) -> Outcome {
        let mut outcome = Outcome::default();
        let finder = PhotoFinder::new(scene, self);
        let photos: Vec<Option<PhotoId>> = self.photos.iter().map(|photo| finder.find(&photo.key)).collect();
        let objects = self.find_objects(scene);
        self.list_missing(&photos, &objects, &mut outcome);

        for (photo, id) in self.photos.iter().zip(&photos) {
            if let (Some(id), Some(camera)) = (id, &photo.camera) {
                give_camera(scene, *id, camera, &mut outcome);
            }
        }
        match poses_as {
            PosesAs::Annotations => self.apply_annotations(scene, &photos, &objects, now_ms, &mut outcome),
            PosesAs::Reference => self.apply_reference(scene, &photos, &objects, &mut outcome),
        }
        if !outcome.missing.is_empty() {
            outcome.rest = Some(self.without(&photos, &objects, poses_as));
        }
        outcome
    }

    /// What is left once photos and objects that were found have got theirs.
    fn without(&self, photos: &[Option<PhotoId>], objects: &[Option<ObjectId>], poses_as: PosesAs) -> Self {
        let mut rest = self.clone();
        rest.remarks.clear();
        for (object, _) in rest.objects.iter_mut().zip(objects).filter(|(_, id)| id.is_some()) {
            (object.look, object.mesh_from_file, object.symmetries) = (None, None, None);
        }
        for (photo, _) in rest.photos.iter_mut().zip(photos).filter(|(_, id)| id.is_some()) {
            (photo.camera, photo.look) = (None, None);
            // A reference is read-only: giving it again, more complete, takes nothing from anybody.
            if poses_as == PosesAs::Annotations {
                photo.poses.retain(|pose| objects.get(pose.object).is_none_or(Option::is_none));
            }
        }
        rest
    }

    fn apply_annotations(
        &self,
        scene: &mut Scene,
        photos: &[Option<PhotoId>],
        objects: &[Option<ObjectId>],
        now_ms: f64,
        outcome: &mut Outcome,
    ) {
        for (incoming, object) in self.objects.iter().zip(objects) {
            if let Some(object) = object {
                outcome.problems.extend(restore_look(scene, *object, incoming));
            }
        }
        for (photo, id) in self.photos.iter().zip(photos) {
            if let (Some(look), Some(known)) = (&photo.look, id.and_then(|id| scene.photo_mut(id))) {
                restore_photo_look(known, look);
            }
            for pose in &photo.poses {
                let (Some(photo), Some(&Some(object))) = (*id, objects.get(pose.object)) else { continue };
                let annotation = Annotation {
                    camera_from_object: pose.camera_from_object,
                    state: pose.state,
                    source: pose.source,
                    changed_at_ms: pose.changed_at_ms.unwrap_or(now_ms),
                    camera_changed: false,
                    score: pose.score,
                    pins: pose.pins.clone(),
                };
                scene.annotations.insert((photo, object), annotation);
                outcome.applied += 1;
            }
        }
        for reference in &self.references {
            let poses = reference.poses.iter().filter_map(|&(photo, object, pose)| {
                Some((((*photos.get(photo)?)?, (*objects.get(object)?)?), pose))
            });
            add_reference(scene, &reference.name, reference.visible, poses.collect());
        }
    }

    fn apply_reference(
        &self,
        scene: &mut Scene,
        photos: &[Option<PhotoId>],
        objects: &[Option<ObjectId>],
        outcome: &mut Outcome,
    ) {
        let mut frames = Vec::with_capacity(objects.len());
        for (incoming, id) in self.objects.iter().zip(objects) {
            let frame = id.map(|id| take_frame(scene, id, incoming)).transpose();
            frames.push(frame.unwrap_or_else(|problem| {
                outcome.problems.push(problem);
                None
            }));
        }
        let mut poses = BTreeMap::new();
        for (photo, id) in self.photos.iter().zip(photos) {
            for pose in &photo.poses {
                let object = objects.get(pose.object).copied().flatten();
                let frame = frames.get(pose.object).copied().flatten();
                if let (Some(photo), Some(object), Some(theirs_from_ours)) = (*id, object, frame) {
                    poses.insert((photo, object), pose.camera_from_object * theirs_from_ours);
                }
            }
        }
        outcome.applied = poses.len();
        add_reference(scene, file_stem(&self.file_name), true, poses);
    }

    /// The n-th incoming object of a mesh is the scene's n-th object of that mesh; where the scene has the mesh but too few
    /// objects of it, more are made.
    fn find_objects(&self, scene: &mut Scene) -> Vec<Option<ObjectId>> {
        let mut taken: Vec<ObjectId> = Vec::new();
        let first = scene.objects.first().map(|object| object.mesh.sha256);
        let is_only_mesh = scene.objects.iter().all(|object| Some(object.mesh.sha256) == first);
        let mut find = |incoming: &IncomingObject| {
            let matches = |mesh: &MeshAsset| incoming.key.names_mesh(mesh, is_only_mesh);
            let free =
                scene.objects.iter().find(|object| matches(&object.mesh) && !taken.contains(&object.id));
            let id = match free {
                Some(object) => object.id,
                None => {
                    let known = scene.objects.iter().find(|object| matches(&object.mesh))?;
                    let (mesh, mesh_from_file) = (known.mesh.clone(), known.mesh_from_file);
                    let symmetries = known.symmetries.clone();
                    let id = scene.add_object(mesh);
                    let object = scene.object_mut(id)?;
                    (object.mesh_from_file, object.symmetries) = (mesh_from_file, symmetries);
                    id
                }
            };
            taken.push(id);
            Some(id)
        };
        self.objects.iter().map(&mut find).collect()
    }

    fn list_missing(&self, photos: &[Option<PhotoId>], objects: &[Option<ObjectId>], outcome: &mut Outcome) {
        let missing_photos =
            self.photos.iter().zip(photos).filter(|(_, id)| id.is_none()).map(|(photo, _)| &photo.key);
        let missing_objects =
            self.objects.iter().zip(objects).filter(|(_, id)| id.is_none()).map(|(object, _)| &object.key);
        let mut named = BTreeSet::new();
        let names = missing_photos.chain(missing_objects).map(FileKey::display);
        outcome.missing = names.filter(|name| named.insert(name.clone())).collect();
    }
}

fn give_camera(scene: &mut Scene, id: PhotoId, camera: &IncomingCamera, outcome: &mut Outcome) {
    let Some(photo) = scene.photo(id) else { return };
    let (width, height) = (photo.asset.width, photo.asset.height);
    match camera {
        IncomingCamera::Exact(camera, origin) => scene.set_camera(id, *camera, origin.clone()),
        IncomingCamera::File(file) if file.differs_in_size(width, height) => {
            outcome.differing_cameras.push((id, file.clone()));
        }
        IncomingCamera::File(file) => {
            scene.set_camera(id, file.intrinsics(width, height), CameraOrigin::File(file.file_name.clone()));
        }
    }
}

fn restore_photo_look(photo: &mut Photo, look: &PhotoLook) {
    if let Some(name) = &look.name {
        photo.name.clone_from(name);
    }
    photo.visible = look.visible;
    photo.opacity = look.opacity;
    photo.locked = look.locked;
}

/// Gives an object its saved look; what cannot be done is said.
fn restore_look(scene: &mut Scene, id: ObjectId, incoming: &IncomingObject) -> Option<String> {
    let object = scene.object_mut(id)?;
    if let Some(look) = &incoming.look {
        object.name.clone_from(&look.name);
        object.color = look.color;
        object.opacity = look.opacity;
        object.visible = look.visible;
        object.locked = look.locked;
        object.link = look.link;
    }
    if let Some(symmetries) = &incoming.symmetries {
        object.symmetries.clone_from(symmetries);
    }
    let wanted = incoming.mesh_from_file.filter(|wanted| *wanted != object.mesh_from_file)?;
    match object.mesh.with_mesh_from_file(object.mesh_from_file, wanted) {
        Ok(mesh) => {
            object.mesh = mesh;
            object.mesh_from_file = wanted;
            None
        }
        Err(error) => Some(format!("{}: mesh_from_file cannot be applied: {error}", object.name)),
    }
}

/// Two frames of a mesh whose rotation is this far from one are not a turn of each other; products of rounded matrices are
/// nearer by far.
const RIGID_TOLERANCE: f64 = 1e-6;

/// What takes a mesh's frame in the scene to that of a reference's poses. A mesh that has no poses yet takes the reference's
/// frame over; one whose frames differ by more than a turn and a shift cannot have these poses.
fn take_frame(scene: &mut Scene, id: ObjectId, incoming: &IncomingObject) -> Result<Pose, String> {
    let Some(object) = scene.object(id) else { return Ok(Pose::IDENTITY) };
    let present = object.mesh_from_file;
    let Some(wanted) = incoming.mesh_from_file.filter(|wanted| *wanted != present) else {
        return Ok(Pose::IDENTITY);
    };
    if !is_posed(scene, id) {
        let alone = IncomingObject { look: None, ..incoming.clone() };
        return restore_look(scene, id, &alone).map_or(Ok(Pose::IDENTITY), Err);
    }
    Pose::from_mat4(&(wanted * present.inverse()), RIGID_TOLERANCE).ok_or_else(|| {
        format!("{}: left out, its mesh has another size or is mirrored there (mesh_from_file)", object.name)
    })
}

/// Has anybody, or a reference, said where the object is?
fn is_posed(scene: &Scene, id: ObjectId) -> bool {
    let is_touched = |annotation: &Annotation| annotation.state != AnnotationState::Untouched;
    scene.annotations.iter().any(|((_, object), annotation)| *object == id && is_touched(annotation))
        || scene.references.iter().any(|reference| reference.poses.keys().any(|(_, object)| *object == id))
}

/// A reference of the same name is replaced: the file was dropped again.
fn add_reference(scene: &mut Scene, name: &str, visible: bool, poses: BTreeMap<(PhotoId, ObjectId), Pose>) {
    if poses.is_empty() {
        return;
    }
    scene.references.retain(|reference| reference.name != name);
    scene.references.push(Reference { name: name.to_owned(), visible, poses });
}
