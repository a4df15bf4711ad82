//! A study that was handed out, as a scene and a draft again, so that it can be changed.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::{Chosen, Draft, Role, StudyFiles, TruthFrom};
use crate::math::Pose;
use crate::scene::{
    Annotation, AnnotationState, CameraOrigin, MeshAsset, ObjectId, PhotoAsset, PhotoId, PoseSource,
    Reference, Rgb, Scene, Symmetries, untouched_pose,
};
use crate::study::{Sample, StartPose, Study, StudyError, SymmetriesRecord, Truth};

/// The reference that holds true poses where the annotations are the samples' start poses.
const TRUTH: &str = "Truth";

/// `photos` and `meshes` are by their ids in the study, meshes in the `object` frame. Without `truth` nothing is known of the
/// samples' poses.
pub fn reopened(
    files: &StudyFiles,
    photos: &BTreeMap<String, Arc<PhotoAsset>>,
    meshes: &BTreeMap<String, Arc<MeshAsset>>,
    truth: Option<&Truth>,
) -> Result<(Scene, Draft), StudyError> {
    let study = &files.study;
    if let Some(truth) = truth
        && truth.study != study.id
    {
        let reason = format!("these are the true poses of the study \"{}\"", truth.study);
        return Err(StudyError::at(study.id.clone(), reason));
    }
    let mut opened =
        Reopened { scene: Scene::named(&study.title), places: BTreeMap::new(), truths: BTreeMap::new() };
    let photo_ids = opened.add_photos(study, photos)?;
    let object_ids = opened.add_objects(study, meshes)?;
    let practice = study.practice.iter().map(|practice| {
        let pose = practice.truth.to_pose().ok();
        (&practice.sample, Role::Practice, pose, Some(&practice.symmetries))
    });
    let samples = study.samples.iter().map(|sample| {
        let known = truth.and_then(|truth| truth.sample(&sample.id));
        let pose = known.and_then(|known| known.pose).and_then(|pose| pose.to_pose().ok());
        (sample, Role::Sample, pose, known.map(|known| &known.symmetries))
    });
    for (sample, role, pose, symmetries) in samples.chain(practice) {
        let ids = photo_ids.get(&sample.photo).zip(object_ids.get(&sample.object));
        let (photo, object) =
            ids.ok_or_else(|| StudyError::at(sample.id.clone(), "no such photo or object"))?;
        opened.add(study, sample, (*photo, *object), role, pose);
        opened.set_symmetries(*object, symmetries);
    }
    Ok(opened.finish(files))
}

struct Reopened {
    scene: Scene,
    places: BTreeMap<(PhotoId, ObjectId), (Role, Option<String>)>,
    truths: BTreeMap<(PhotoId, ObjectId), Pose>,
}

impl Reopened {
    fn add_photos(
        &mut self,
        study: &Study,
        photos: &BTreeMap<String, Arc<PhotoAsset>>,
    ) -> Result<BTreeMap<String, PhotoId>, StudyError> {
        let mut ids = BTreeMap::new();
        for photo in &study.photos {
            let missing = || StudyError::at(photo.asset.name.clone(), "this photo is missing");
            let id = self.scene.add_photo(photos.get(&photo.id).ok_or_else(missing)?.clone());
            let camera = photo.camera.to_intrinsics();
            let camera = camera.map_err(|error| StudyError::at(photo.asset.name.clone(), error))?;
            self.scene.set_camera(id, camera, CameraOrigin::File("study.json".to_owned()));
            ids.insert(photo.id.clone(), id);
        }
        Ok(ids)
    }

    fn add_objects(
        &mut self,
        study: &Study,
        meshes: &BTreeMap<String, Arc<MeshAsset>>,
    ) -> Result<BTreeMap<String, ObjectId>, StudyError> {
        let mut ids = BTreeMap::new();
        for object in &study.objects {
            let missing = || StudyError::at(object.name.clone(), "its mesh is missing");
            let id = self.scene.add_object(meshes.get(&object.id).ok_or_else(missing)?.clone());
            if let Some(target) = self.scene.object_mut(id) {
                target.name.clone_from(&object.name);
                target.mesh_from_file = object.mesh_from_file();
                if let Some(color) = object.color.as_deref().and_then(Rgb::from_hex) {
                    target.color = color;
                }
            }
            ids.insert(object.id.clone(), id);
        }
        Ok(ids)
    }

    fn set_symmetries(&mut self, object: ObjectId, known: Option<&SymmetriesRecord>) {
        let known = known.and_then(SymmetriesRecord::to_symmetries).unwrap_or_default();
        if let Some(target) = self.scene.object_mut(object)
            && known != Symmetries::default()
        {
            target.symmetries = known;
        }
    }

    fn add(
        &mut self,
        study: &Study,
        sample: &Sample,
        key: (PhotoId, ObjectId),
        role: Role,
        truth: Option<Pose>,
    ) {
        let start = sample.start.and_then(|start| start.to_pose().ok());
        // Where samples have start poses of their own, these are what was posed in the scene.
        let posed = if study.start_pose == StartPose::Given { start } else { truth };
        let (camera, mesh) = (self.scene.photo(key.0), self.scene.object(key.1));
        let untouched = camera
            .zip(mesh)
            .map(|(photo, object)| untouched_pose(&photo.camera, &object.mesh.mesh))
            .unwrap_or_default();
        let annotation = Annotation::untouched(posed.unwrap_or(untouched), 0.0);
        let annotation = match posed {
            Some(_) => {
                Annotation { state: AnnotationState::Confirmed, source: PoseSource::Manual, ..annotation }
            }
            None => annotation,
        };
        self.scene.annotations.insert(key, annotation);
        self.truths.extend(truth.map(|truth| (key, truth)));
        self.places.insert(key, (role, sample.set.clone()));
    }

    fn finish(mut self, files: &StudyFiles) -> (Scene, Draft) {
        let study = &files.study;
        let mut truth_from = TruthFrom::Annotations;
        if study.start_pose == StartPose::Given {
            let poses = std::mem::take(&mut self.truths);
            self.scene.references.push(Reference { name: TRUTH.to_owned(), visible: false, poses });
            truth_from = TruthFrom::Reference(TRUTH.to_owned());
        }
        let chosen =
            self.places.into_iter().map(|((photo, object), (role, set))| Chosen { photo, object, role, set });
        let pictures = study.texts.pictures.iter();
        let pictures = pictures.filter_map(|asset| Some((asset.name.clone(), files.file(asset)?.bytes)));
        let draft = Draft {
            study: study.clone(),
            chosen: chosen.collect(),
            truth_from,
            pictures: pictures.collect(),
        };
        (self.scene, draft)
    }
}
