//! A focal length set by eye: the camera comes nearer or goes away so that the picture stays (a dolly zoom).

use super::apply::Applied;
use super::{CommandError, Session};
use crate::math::{Intrinsics, Pose};
use crate::scene::{CameraOrigin, ObjectId, Photo, PhotoId, Scene};

impl Session {
    /// Poses that are locked or confirmed stay; they are marked for a second look as all others are.
    pub(super) fn set_focal(&mut self, id: PhotoId, fx: f64) -> Applied {
        let present = self.scene.photo(id).ok_or(CommandError::NoPhoto(id))?;
        if present.locked {
            return Err(CommandError::Locked(present.name.clone()));
        }
        // From where the gesture began, so that no rounding gathers.
        let origin = self.gesture.as_ref().map_or(&self.scene, |gesture| &gesture.before.scene).clone();
        let before = origin.photo(id).ok_or(CommandError::NoPhoto(id))?;
        let camera = with_focal(&before.camera, fx);
        let camera = camera.checked().map_err(|error| CommandError::Failed(error.to_string()))?;
        let poses = self.poses_that_follow(&origin, before, &camera);
        let before_px = match before.camera_origin {
            CameraOrigin::Slider { before_px } => before_px,
            _ => before.camera.fx,
        };
        let is_alone = self.gesture.is_none();
        if is_alone {
            self.begin_gesture("Focal length");
        }
        self.scene.set_camera(id, camera, CameraOrigin::Slider { before_px });
        for (object, pose) in poses {
            if let Some(annotation) = self.scene.annotations.get_mut(&(id, object)) {
                annotation.camera_from_object = pose;
            }
        }
        self.touched();
        if is_alone {
            self.finish_gesture();
        }
        Ok(Vec::new())
    }

    fn poses_that_follow(
        &self,
        origin: &Scene,
        before: &Photo,
        camera: &Intrinsics,
    ) -> Vec<(ObjectId, Pose)> {
        let in_photo = origin.objects_in(before.id);
        let free = in_photo.filter(|(object, _)| self.check_movable((before.id, object.id)).is_ok());
        let follow = |(object, annotation): (&crate::scene::Object, &crate::scene::Annotation)| {
            let center_mm = object.mesh.mesh.sphere().center;
            let pose = dollied(&annotation.camera_from_object, center_mm, (&before.camera, camera))?;
            Some((object.id, pose))
        };
        free.filter_map(follow).collect()
    }
}

/// The camera with another focal length; its pixels stay as wide as they are high, or not, as they were.
fn with_focal(camera: &Intrinsics, fx: f64) -> Intrinsics {
    let factor = fx / camera.fx;
    Intrinsics { fx, fy: camera.fy * factor, skew: camera.skew * factor, ..*camera }
}

/// The pose that shows the object's middle on the same pixel, and as large: as many times as far as the focal length is longer.
/// `None` where it is not before the camera.
fn dollied(pose: &Pose, center_mm: glam::DVec3, (old, new): (&Intrinsics, &Intrinsics)) -> Option<Pose> {
    let center = pose.transform_point(center_mm);
    // Through the pixel, for a lens that bends does so by the angle to the axis, which is another now.
    let pixel = old.project(center)?;
    let moved = new.unproject(pixel) * (center.z * new.fx / old.fx);
    moved.is_finite().then(|| pose.translated(moved - center))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::math::Distortion;

    #[test]
    fn the_middle_keeps_its_pixel_and_the_object_its_size() {
        let bent = Distortion { k1: -0.2, k2: 0.05, p1: 1e-3, ..Distortion::NONE };
        for distortion in [Distortion::NONE, bent] {
            let old = Intrinsics {
                skew: 2.0,
                distortion,
                ..Intrinsics::pinhole(520.5, 533.25, 301.75, 222.5, 640, 480)
            };
            let new = with_focal(&old, 780.75);
            assert_eq!((new.fx, new.fy, new.skew), (780.75, 533.25 * 1.5, 3.0));
            let center_mm = DVec3::new(3.0, -4.0, 5.0);
            let pose =
                Pose::exp(DVec3::new(0.3, 0.2, -0.4), DVec3::ZERO).translated(DVec3::new(60.0, -40.0, 700.0));
            let moved = dollied(&pose, center_mm, (&old, &new)).unwrap();
            let [before, after] = [&pose, &moved].map(|pose| pose.transform_point(center_mm));
            assert_eq!(moved.rotation, pose.rotation);
            // Rounding, and where the lens's inverse stops.
            assert!((after.z / before.z - 1.5).abs() < 1e-12, "{after}");
            let off = new.project(after).unwrap().distance(old.project(before).unwrap());
            assert!(off < 1e-6, "{off}");
            // Millimetres across stay: that is what keeps the size.
            if distortion.is_none() {
                assert!((after - before).truncate().length() < 1e-9, "{before} {after}");
            }
        }
        let camera = Intrinsics::from_focal(500.0, 640, 480);
        let behind = Pose::from_translation(DVec3::Z * -100.0);
        assert_eq!(dollied(&behind, DVec3::ZERO, (&camera, &with_focal(&camera, 600.0))), None);
    }
}
