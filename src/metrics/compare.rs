//! Two sets of poses of one scene, pose by pose.

use std::collections::{BTreeMap, BTreeSet};

use super::{Model, PoseErrors, VSD_TAUS, View};
use crate::math::Pose;
use crate::scene::{AnnotationState, DepthInMm, Object, ObjectId, Photo, PhotoId, Scene};

/// `camera_from_object` for objects in photos.
pub type PoseSet = BTreeMap<(PhotoId, ObjectId), Pose>;

/// A pose that is in both sets.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedPose {
    pub photo: PhotoId,
    pub object: ObjectId,
    pub diameter_mm: f64,
    pub errors: PoseErrors,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub struct Comparison {
    /// Photo by photo.
    pub poses: Vec<ComparedPose>,
    /// In the truth alone.
    pub missing: Vec<(PhotoId, ObjectId)>,
    /// In the estimates alone.
    pub without_truth: Vec<(PhotoId, ObjectId)>,
    /// Photos whose depth maps play no part, for they cannot be read or are of another size.
    pub unused_depth: BTreeSet<PhotoId>,
}

/// The parts of all true poses that were estimated well enough; what is missing was not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recalls {
    /// AD under a tenth of the diameter.
    pub ad_tenth: f64,
    /// BOP's average recalls, over thresholds of 0.05 to 0.5 (VSD, and for each of its tolerances; MSSD in diameters) and of
    /// 5 to 50 pixels (MSPD).
    pub vsd: f64,
    pub mssd: f64,
    pub mspd: f64,
}

/// The poses that somebody stands for.
pub fn annotated_poses(scene: &Scene) -> PoseSet {
    let stands = |state| matches!(state, AnnotationState::Posed | AnnotationState::Confirmed);
    let annotations = scene.annotations.iter().filter(|(_, annotation)| stands(annotation.state));
    annotations.map(|(key, annotation)| (*key, annotation.camera_from_object)).collect()
}

/// Compares estimates with the truth in the scene's photos, with its cameras, depth maps, meshes and symmetries.
pub fn compare(scene: &Scene, truth: &PoseSet, estimates: &PoseSet) -> Comparison {
    let mut comparison = Comparison::default();
    let models: BTreeMap<ObjectId, Model<'_>> =
        scene.objects.iter().filter_map(|object| Some((object.id, model_of(object)?))).collect();
    let mut depths = LastDepth::default();
    for (&(photo, object), reference) in truth {
        let Some(estimate) = estimates.get(&(photo, object)) else {
            comparison.missing.push((photo, object));
            continue;
        };
        let (Some(found), Some(model)) = (scene.photo(photo), models.get(&object)) else { continue };
        let depth_mm = depths.of(found);
        if depth_mm.is_none() && found.depth.is_some() {
            comparison.unused_depth.insert(photo);
        }
        let view = View { camera: &found.camera, depth_mm };
        let errors = model.errors(estimate, reference, view);
        comparison.poses.push(ComparedPose { photo, object, diameter_mm: model.diameter_mm(), errors });
    }
    comparison.without_truth = estimates.keys().filter(|key| !truth.contains_key(key)).copied().collect();
    comparison
}

fn model_of(object: &Object) -> Option<Model<'_>> {
    Model::new(&object.mesh.mesh, object.symmetries.expanded())
}

/// The depth map of the photo that was asked for last: poses come photo by photo, and maps are large.
#[derive(Default)]
struct LastDepth {
    photo: Option<PhotoId>,
    mm: Option<Vec<f32>>,
}

impl LastDepth {
    fn of(&mut self, photo: &Photo) -> Option<&[f32]> {
        if self.photo != Some(photo.id) {
            let depth = photo.depth.as_ref().and_then(|depth| depth.in_mm().ok());
            let fits =
                |depth: &DepthInMm| (depth.width, depth.height) == (photo.camera.width, photo.camera.height);
            (self.photo, self.mm) = (Some(photo.id), depth.filter(fits).map(|depth| depth.mm));
        }
        self.mm.as_deref()
    }
}

impl Comparison {
    /// `None` where there is no truth.
    pub fn recalls(&self) -> Option<Recalls> {
        let all = self.poses.len() + self.missing.len();
        let mean =
            |score: &dyn Fn(&ComparedPose) -> f64| self.poses.iter().map(score).sum::<f64>() / all as f64;
        (all > 0).then(|| Recalls {
            ad_tenth: mean(&|pose| f64::from(u8::from(pose.errors.ad_mm < 0.1 * pose.diameter_mm))),
            vsd: mean(&|pose| {
                let over_tolerances: f64 =
                    pose.errors.vsd.iter().map(|error| share_passed(*error, 1.0)).sum();
                over_tolerances / VSD_TAUS.len() as f64
            }),
            mssd: mean(&|pose| share_passed(pose.errors.mssd_mm, pose.diameter_mm)),
            // Ten times the pixels of the other errors' steps: 5, 10, … 50.
            mspd: mean(&|pose| pose.errors.mspd_px.map_or(0.0, |error| share_passed(error, 100.0))),
        })
    }
}

/// The part of BOP's ten thresholds, 0.05 to 0.5 times a unit, that an error is under.
fn share_passed(error: f64, unit: f64) -> f64 {
    let passed = VSD_TAUS.iter().filter(|threshold| error < **threshold * unit).count();
    passed as f64 / VSD_TAUS.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_are_passed_from_below() {
        assert_eq!(share_passed(0.0, 1.0), 1.0);
        assert_eq!(share_passed(0.05, 1.0), 0.9);
        assert_eq!(share_passed(24.9, 100.0), 0.6);
        assert_eq!(share_passed(f64::INFINITY, 100.0), 0.0);
        assert_eq!(Comparison::default().recalls(), None);
        let missing = Comparison { missing: vec![(PhotoId(1), ObjectId(2))], ..Comparison::default() };
        assert_eq!(missing.recalls().unwrap().mssd, 0.0);
    }
}
