//! How sure the selected pose is, and what would make it surer.

use glam::DVec3;

use super::Session;
use crate::math::{Intrinsics, Pose, Ray};
use crate::scene::{Object, ObjectId, PhotoId, PoseSource};
use crate::solve::pins::PinOptions;
use crate::solve::{
    FreeTurns, Tolerances, TwistCovariance, Uncertainty, Weakest, most_helpful_point, weakest,
};

/// Points of the mesh that are thought of as the next pin.
const MOST_CANDIDATES: usize = 300;
/// Of the radius: a point is seen if the ray to it meets the surface no farther than this before it.
const SEEN_PART: f64 = 0.02;

/// How sure a pose is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sureness {
    /// [`PoseSource::Pins`] or [`PoseSource::Snap`].
    pub source: PoseSource,
    pub uncertainty: Uncertainty,
    /// Turns about an axis of symmetry are left out of all this.
    pub leaves_out_turns: bool,
    /// Of the depth's standard deviation what the tolerances alone make: no pin changes that.
    pub by_tolerances_mm: f64,
    /// One standard deviation of a focal length that is estimated, as a part of it. It is a part of all this.
    pub guessed_focal: Option<f64>,
    pub weakest: Option<Weakest>,
    pub helpful_pin: Option<HelpfulPin>,
}

/// A point of the surface where a pin would make the pose surest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HelpfulPin {
    /// From the object's middle, in camera axes, in radii of the object.
    pub way: DVec3,
    /// What would be left of the depth's standard deviation.
    pub depth_mm: f64,
}

/// How sure a snap was, and of what.
#[derive(Debug, Clone, Copy)]
pub(super) struct OfSnap {
    camera_from_object: Pose,
    camera: Intrinsics,
    covariance: TwistCovariance,
}

impl Session {
    /// Keeps how sure a snap is of the present pose, as long as the pose and the camera are these.
    pub(super) fn note_snap(&mut self, target: (PhotoId, ObjectId), covariance: Option<TwistCovariance>) {
        let pose = self.scene.annotation(target.0, target.1).map(|annotation| annotation.camera_from_object);
        let camera = self.scene.photo(target.0).map(|photo| photo.camera);
        match pose.zip(camera).zip(covariance) {
            Some(((camera_from_object, camera), covariance)) => {
                self.snap_covariances.insert(target, OfSnap { camera_from_object, camera, covariance })
            }
            None => self.snap_covariances.remove(&target),
        };
        self.touched();
    }

    /// How sure the selected pose is: by its last snap, else by its pins. `None` where neither gave it.
    pub fn sureness(&self, tolerances: &Tolerances) -> Option<Sureness> {
        let (photo, object, annotation) = self.selected_annotation()?;
        let pose = &annotation.camera_from_object;
        let camera = self.scene.photo(photo)?.camera;
        let is_of_this = |known: &&OfSnap| (&known.camera_from_object, known.camera) == (pose, camera);
        let (source, covariance) = match self.snap_covariances.get(&(photo, object)).filter(is_of_this) {
            Some(known) => (PoseSource::Snap, known.covariance),
            None => {
                let report = self.pin_report().filter(|report| report.is_solved)?;
                (PoseSource::Pins, report.covariance?)
            }
        };
        let (photo, object) = (self.scene.photo(photo)?, self.scene.object(object)?);
        let mut tolerances = *tolerances;
        let guessed_focal = photo.camera_origin.focal_sigma();
        tolerances.focal = tolerances.focal.max(guessed_focal.unwrap_or(0.0));
        let sphere = object.mesh.mesh.sphere();
        let center = pose.transform_point(sphere.center);
        let free = FreeTurns::of(&object.symmetries, pose, sphere.center, sphere.radius);
        let wide = covariance.with_tolerances(&tolerances, center).without(&free);
        let by_tolerances_mm = tolerances.focal.hypot(tolerances.mesh_scale) * center.length();
        let helpful = most_helpful_point(
            &photo.camera,
            pose,
            (&covariance, &free),
            (sphere.center, sphere.radius),
            PinOptions::default().click_sigma_px,
            seen_points(object, pose),
        );
        let way =
            |point: DVec3| pose.rotation * (point - sphere.center) / sphere.radius.max(f64::MIN_POSITIVE);
        Some(Sureness {
            source,
            leaves_out_turns: !free.is_empty(),
            uncertainty: Uncertainty::of(&wide, pose, sphere.center),
            by_tolerances_mm,
            guessed_focal,
            weakest: weakest(&wide, pose, sphere.center, sphere.radius),
            helpful_pin: helpful.map(|(point, depth_mm)| HelpfulPin {
                way: way(point),
                depth_mm: depth_mm.hypot(by_tolerances_mm),
            }),
        })
    }
}

/// Points of the mesh that the camera sees.
fn seen_points<'a>(object: &'a Object, camera_from_object: &Pose) -> impl Iterator<Item = DVec3> + 'a {
    let mesh = &object.mesh.mesh;
    let eye = camera_from_object.inverse().translation_mm;
    let step = mesh.positions_mm().len().div_ceil(MOST_CANDIDATES).max(1);
    let slack_mm = SEEN_PART * mesh.sphere().radius;
    let is_seen = move |point: &DVec3| {
        let Some(direction) = (*point - eye).try_normalize() else { return false };
        let hit = object.mesh.tree().and_then(|tree| tree.cast(mesh, &Ray { origin: eye, direction }));
        // A ray to a corner may just miss it.
        hit.is_none_or(|hit| hit.distance_mm > point.distance(eye) - slack_mm)
    };
    mesh.positions_mm().iter().step_by(step).map(|point| point.as_dvec3()).filter(is_seen)
}
