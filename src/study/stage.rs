//! What a trial is done on: a scene of one photo and one object, and nothing else in it.

use std::sync::Arc;

use super::{Feedback, PracticeSample, Sample, Study, StudyError};
use crate::math::{Intrinsics, Pose};
use crate::mesh::PointTree;
use crate::metrics::PoseError;
use crate::scene::{
    Annotation, AnnotationState, CameraOrigin, MeshAsset, ObjectId, PhotoAsset, PhotoId, PoseSource, Rgb,
    Scene,
};

/// One sample, ready to be worked on.
#[derive(Debug, Clone)]
pub struct Stage {
    pub scene: Scene,
    pub photo: PhotoId,
    pub object: ObjectId,
}

/// The mesh as the study's object has it. `loaded` is the mesh as it is in its file.
pub fn framed_mesh(
    study: &Study,
    object: &str,
    loaded: &Arc<MeshAsset>,
) -> Result<Arc<MeshAsset>, StudyError> {
    let object = study.object(object).ok_or_else(|| StudyError::at(object, "not in the study"))?;
    let place = || object.name.clone();
    loaded
        .with_mesh_from_file(glam::DMat4::IDENTITY, object.mesh_from_file())
        .map_err(|error| StudyError::at(place(), error))
}

/// The camera of a sample's photo.
pub fn camera_of(study: &Study, sample: &Sample) -> Result<Intrinsics, StudyError> {
    let photo = study.photo(&sample.photo).ok_or_else(|| StudyError::at(&sample.id, "has no photo"))?;
    photo.camera.to_intrinsics().map_err(|error| StudyError::at(&photo.id, error))
}

impl Stage {
    pub fn new(
        study: &Study,
        sample: &Sample,
        photo: Arc<PhotoAsset>,
        mesh: Arc<MeshAsset>,
        pose: Pose,
        now_ms: f64,
    ) -> Result<Self, StudyError> {
        let camera = camera_of(study, sample)?;
        if (camera.width, camera.height) != (photo.width, photo.height) {
            let reason = "the camera is for a picture of another size";
            return Err(StudyError::at(photo.file_name.clone(), reason));
        }
        let object = study.object(&sample.object);
        let mut scene = Scene::named(&sample.id);
        let photo = scene.add_photo(photo);
        scene.set_camera(photo, camera, CameraOrigin::File("study.json".to_owned()));
        let id = scene.add_object(mesh);
        if let (Some(target), Some(object)) = (scene.object_mut(id), object) {
            target.name.clone_from(&object.name);
            target.mesh_from_file = object.mesh_from_file();
            if let Some(color) = object.color.as_deref().and_then(Rgb::from_hex) {
                target.color = color;
            }
        }
        let annotation = Annotation {
            state: AnnotationState::Posed,
            source: PoseSource::Manual,
            ..Annotation::untouched(pose, now_ms)
        };
        scene.annotations.insert((photo, id), annotation);
        Ok(Self { scene, photo, object: id })
    }
}

/// What a participant is told of a practice pose.
pub fn feedback(practice: &PracticeSample, pose: &Pose, mesh: &MeshAsset) -> Option<Feedback> {
    let truth = practice.truth.to_pose().ok()?;
    let error = PoseError::between(pose, &truth, &mesh.mesh, usize::MAX);
    let diameter_mm = PointTree::build(mesh.mesh.positions_mm())?.diameter();
    Some(Feedback {
        rotation_deg: error.rotation_rad.to_degrees(),
        translation_mm: error.translation_mm,
        add_mm: error.add_mm,
        is_good: error.add_mm <= practice.good_add_of_diameter * diameter_mm,
    })
}
