//! The pose during a drag, from where it began and where the cursor is.

use glam::{DMat3, DQuat, DVec2, DVec3};

use super::eye::Eye;
use crate::math::Pose;

/// The pose at the start of a drag and the surface point that was grabbed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grab {
    pub start: Pose,
    /// In the `camera` frame.
    pub point_camera_mm: DVec3,
}

/// Turns an object about a pivot so that the surface that faces the camera follows the cursor: the two-axis valuator.
///
/// `drag_px` is the way of the cursor and `radius_px` the object's radius on screen, both in the same pixels; one radius
/// is one radian. Source: Chen, Mountford, Sellen, *A Study in Interactive 3-D Rotation*, 1988.
pub fn turned(eye: &Eye, start: &Pose, pivot_camera_mm: DVec3, drag_px: DVec2, radius_px: f64) -> Pose {
    // For a point in front of the pivot, ω × (0, 0, −1) = (−ω_y, ω_x, 0).
    let facing = DVec3::new(drag_px.y, -drag_px.x, 0.0) / radius_px;
    let pivot_eye = eye.eye_from_camera.transform_point(pivot_camera_mm);
    let rotation_vector = eye.camera_from_eye_direction(eye_from_facing(pivot_eye) * facing);
    about(start, pivot_camera_mm, DQuat::from_scaled_axis(rotation_vector))
}

/// Rolls an object about the view ray through a pivot; positive is clockwise on screen.
pub fn rolled(eye: &Eye, start: &Pose, pivot_camera_mm: DVec3, angle_rad: f64) -> Pose {
    let pivot_eye = eye.eye_from_camera.transform_point(pivot_camera_mm);
    let axis = eye.camera_from_eye_direction(pivot_eye.normalize_or(DVec3::Z));
    about(start, pivot_camera_mm, DQuat::from_axis_angle(axis.normalize_or(DVec3::Z), angle_rad))
}

/// Turns an object about a point.
pub fn about(start: &Pose, pivot: DVec3, rotation: DQuat) -> Pose {
    (Pose::rotation_about(pivot, DMat3::from_quat(rotation)) * *start).renormalized()
}

/// The frame whose z axis is the view ray of a point: away from the middle of a wide photo, "to the right" is not the
/// eye's x.
fn eye_from_facing(point_eye_mm: DVec3) -> DQuat {
    DQuat::from_rotation_arc(DVec3::Z, point_eye_mm.normalize_or(DVec3::Z))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::math::Intrinsics;

    const CAMERA: Intrinsics = Intrinsics {
        fx: 570.0,
        fy: 580.0,
        cx: 310.0,
        cy: 250.0,
        skew: 0.0,
        distortion: crate::math::Distortion::NONE,
        width: 640,
        height: 480,
    };

    fn eye() -> Eye {
        Eye { camera: CAMERA, eye_from_camera: Pose::IDENTITY, zoom: 1.0, origin_px: DVec2::ZERO }
    }

    proptest! {
        #[test]
        fn the_grabbed_point_is_where_the_cursor_is(u in 0.0..640.0, v in 0.0..480.0, x in -90.0..90.0) {
            let point_object = DVec3::new(x, 20.0, -30.0);
            let start = Pose::exp(DVec3::new(0.4, -0.2, 1.0), DVec3::new(50.0, -30.0, 900.0));
            let grab = Grab { start, point_camera_mm: start.transform_point(point_object) };
            let moved = eye().moved_to(&grab, DVec2::new(u, v));
            let point_camera = moved.transform_point(point_object);
            // f64 rounding of numbers below 1e3.
            prop_assert!(CAMERA.project(point_camera).unwrap().distance(DVec2::new(u, v)) < 1e-9);
            prop_assert!((point_camera.z - grab.point_camera_mm.z).abs() < 1e-9);
            prop_assert_eq!(moved.rotation, start.rotation);
        }

        #[test]
        fn turning_keeps_the_pivot_and_moves_the_near_side_with_the_cursor(dx in -40.0..40.0, dy in -40.0..40.0) {
            let pivot = DVec3::new(120.0, -60.0, 900.0);
            let start = Pose::from_translation(pivot);
            let turned = turned(&eye(), &start, pivot, DVec2::new(dx, dy), 80.0);
            prop_assert!(turned.transform_point(DVec3::ZERO).distance(pivot) < 1e-9);
            // The surface point nearest to the camera, on the view ray through the pivot.
            let near_point = -pivot.normalize() * 50.0;
            let before = CAMERA.project(start.transform_point(near_point)).unwrap();
            let after = CAMERA.project(turned.transform_point(near_point)).unwrap();
            prop_assert!((after - before).dot(DVec2::new(dx, dy)) >= 0.0);
        }
    }

    #[test]
    fn a_positive_roll_is_clockwise_on_screen() {
        let start = Pose::from_translation(DVec3::new(0.0, 0.0, 800.0));
        let right = DVec3::new(50.0, 0.0, 0.0);
        let rolled = rolled(&eye(), &start, start.translation_mm, 0.1);
        // y points down, so clockwise takes the right side down.
        assert!(rolled.transform_point(right).y > 0.0);
    }
}
