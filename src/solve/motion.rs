//! Small motions of a pose and what they do to a pixel.

use glam::{DMat3, DVec2, DVec3};

use super::linear::{Matrix, congruent, solve};
use crate::math::{Intrinsics, NEAR_MM, Pose, rotation_from_rotation_vector, rotation_vector_from_rotation};

/// Turns the pose by the rotation vector in `step[..3]` about `pivot_camera_mm` and shifts it by `step[3..]`, all in camera
/// axes. A pivot within the object, unlike the camera's centre, keeps turning and shifting apart.
pub fn moved_about(pose: &Pose, pivot_camera_mm: DVec3, step: &[f64; 6]) -> Pose {
    let [rx, ry, rz, x, y, z] = *step;
    let turn = Pose::rotation_about(pivot_camera_mm, rotation_from_rotation_vector(DVec3::new(rx, ry, rz)));
    (turn * *pose).translated(DVec3::new(x, y, z)).renormalized()
}

/// The turn about a point of the object, and the shift of that point, that lead from one pose to another, in camera axes: the
/// step that [`moved_about`] takes with the point in the first pose as its pivot.
pub fn step_between(from: &Pose, to: &Pose, point_mm: DVec3) -> [f64; 6] {
    let turn = rotation_vector_from_rotation(&(to.rotation * from.rotation.transpose()));
    let shift = to.transform_point(point_mm) - from.transform_point(point_mm);
    [turn.x, turn.y, turn.z, shift.x, shift.y, shift.z]
}

/// The pixel of a point and its derivative by the point, one row per pixel axis. `None` for a point that is not before the
/// camera.
pub fn project_with_jacobian(camera: &Intrinsics, point_camera_mm: DVec3) -> Option<(DVec2, [DVec3; 2])> {
    if point_camera_mm.z < NEAR_MM || !point_camera_mm.is_finite() {
        return None;
    }
    let pixel = camera.project(point_camera_mm)?;
    let inverse_z = 1.0 / point_camera_mm.z;
    let (x, y) = (point_camera_mm.x * inverse_z, point_camera_mm.y * inverse_z);
    let x_row = DVec3::new(inverse_z, 0.0, -x * inverse_z);
    let y_row = DVec3::new(0.0, inverse_z, -y * inverse_z);
    let (bent_x, bent_y) = if camera.distortion.is_none() {
        (x_row, y_row)
    } else {
        let [[xx, xy], [yx, yy]] = lens_jacobian(camera, DVec2::new(x, y));
        (x_row * xx + y_row * xy, x_row * yx + y_row * yy)
    };
    pixel.is_finite().then_some((pixel, [bent_x * camera.fx + bent_y * camera.skew, bent_y * camera.fy]))
}

/// By central differences, so that it is always that of the very lens model which [`Intrinsics::project`] uses.
fn lens_jacobian(camera: &Intrinsics, normalized: DVec2) -> [[f64; 2]; 2] {
    const STEP: f64 = 1e-5;
    let slope = |axis: DVec2| {
        let [plus, minus] =
            [1.0, -1.0].map(|sign| camera.distortion.distort(normalized + axis * (sign * STEP)));
        (plus - minus) / (2.0 * STEP)
    };
    let (by_x, by_y) = (slope(DVec2::X), slope(DVec2::Y));
    [[by_x.x, by_y.x], [by_x.y, by_y.y]]
}

/// The row of the normal equations for a quantity with this gradient by the point's place: how it changes with the steps of
/// [`moved_about`]. `arm_mm` is the point seen from the pivot.
pub fn motion_row(arm_mm: DVec3, gradient: DVec3) -> [f64; 6] {
    let turning = arm_mm.cross(gradient);
    [turning.x, turning.y, turning.z, gradient.x, gradient.y, gradient.z]
}

/// The same for a direction, which turns but does not shift, and its gradient.
pub fn turn_row(direction: DVec3, gradient: DVec3) -> [f64; 6] {
    let turning = direction.cross(gradient);
    [turning.x, turning.y, turning.z, 0.0, 0.0, 0.0]
}

/// How sure a pose is: the covariance of the *left* twist ξ = (ω, v), with `true pose = exp(ξ) · pose`: ω in radians about
/// the axes of the camera frame, then v in millimetres. The rotation is about the camera's centre, so ω and v are strongly
/// correlated; [`Self::about`] tells them apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwistCovariance(pub Matrix<6>);

impl TwistCovariance {
    /// From the covariance of steps about a pivot, as [`moved_about`] takes them.
    pub fn from_steps_about(pivot_camera_mm: DVec3, covariance: &Matrix<6>) -> Self {
        Self(congruent(&shifted_pivot(pivot_camera_mm), covariance))
    }

    /// The covariance of (turn about `pivot_camera_mm`, shift of that point), in camera axes, radians and millimetres.
    pub fn about(&self, pivot_camera_mm: DVec3) -> Matrix<6> {
        congruent(&shifted_pivot(-pivot_camera_mm), &self.0)
    }

    /// How far this twist is from none, in standard deviations, squared; `None` for a covariance without an inverse.
    pub fn mahalanobis_squared(&self, twist: &[f64; 6]) -> Option<f64> {
        let weighted = solve(&self.0, twist)?;
        Some(twist.iter().zip(weighted).map(|(a, b)| a * b).sum())
    }
}

/// A turn ω about c with a shift v moves X by ω × (X − c) + v: it is the twist (ω, v + c × ω).
fn shifted_pivot(pivot: DVec3) -> Matrix<6> {
    let mut jacobian = [[0.0; 6]; 6];
    for (i, row) in jacobian.iter_mut().enumerate() {
        row[i] = 1.0;
    }
    let cross = DMat3::from_cols(pivot.cross(DVec3::X), pivot.cross(DVec3::Y), pivot.cross(DVec3::Z));
    for (row, cross_row) in jacobian[3..].iter_mut().zip(cross.transpose().to_cols_array_2d()) {
        row[..3].copy_from_slice(&cross_row);
    }
    jacobian
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Distortion;

    fn camera() -> Intrinsics {
        let distortion = Distortion { k1: -0.12, k2: 0.03, p1: 0.001, p2: -0.002, k3: 0.0 };
        let pinhole = Intrinsics::pinhole(572.4, 573.6, 325.3, 242.0, 640, 480);
        Intrinsics { skew: 0.7, distortion, ..pinhole }
    }

    #[test]
    fn rows_are_the_derivatives_of_moved_pixels() {
        let pose = Pose::exp(DVec3::new(0.4, -0.8, 0.3), DVec3::new(60.0, -40.0, 700.0));
        let (point, pivot) = (DVec3::new(30.0, -20.0, 50.0), DVec3::new(45.0, -30.0, 680.0));
        let seen = pose.transform_point(point);
        let (pixel, jacobian) = project_with_jacobian(&camera(), seen).unwrap();
        for axis in 0..6 {
            let step = 1e-5;
            let mut motion = [0.0; 6];
            motion[axis] = step;
            let moved = moved_about(&pose, pivot, &motion).transform_point(point);
            let slope = (camera().project(moved).unwrap() - pixel) / step;
            for (gradient, slope) in jacobian.into_iter().zip(slope.to_array()) {
                let expected = motion_row(seen - pivot, gradient)[axis];
                // A one-sided difference is off by half the step times the curvature (some 1e3 px/rad²).
                assert!((slope - expected).abs() < 0.02, "{slope} {expected}");
            }
        }
        assert!(project_with_jacobian(&camera(), DVec3::new(0.0, 0.0, -5.0)).is_none());
        assert!(project_with_jacobian(&camera(), DVec3::NAN).is_none());
    }

    #[test]
    fn a_step_leads_from_one_pose_to_the_other() {
        let from = Pose::exp(DVec3::new(0.4, -0.8, 0.3), DVec3::new(60.0, -40.0, 700.0));
        let to = Pose::exp(DVec3::new(0.3, -0.7, 0.5), DVec3::new(50.0, -45.0, 720.0));
        let point_mm = DVec3::new(30.0, -20.0, 50.0);
        let step = step_between(&from, &to, point_mm);
        let moved = moved_about(&from, from.transform_point(point_mm), &step);
        // Numbers of a thousand, of 16 digits.
        assert!(moved.angle_to(&to) < 1e-9 && moved.translation_mm.distance(to.translation_mm) < 1e-9);
        assert_eq!(step_between(&from, &from, point_mm)[3..], [0.0; 3]);
    }

    #[test]
    fn a_covariance_goes_to_the_twist_and_back() {
        let mut covariance = [[0.0; 6]; 6];
        (0..6).for_each(|i| covariance[i][i] = 1.0 + i as f64);
        let pivot = DVec3::new(10.0, -20.0, 800.0);
        let twist = TwistCovariance::from_steps_about(pivot, &covariance);
        let back = twist.about(pivot);
        for (row, expected) in back.iter().zip(&covariance) {
            // Numbers up to 800² · 3 on the way, of 16 digits.
            assert!(row.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-8), "{back:?}");
        }
        // A turn about a pivot on the axis by ω_x moves the camera's centre along y: v = c × ω.
        assert!(twist.0[4][0] > 0.0 && (twist.0[4][0] - 800.0).abs() < 1e-9);
    }
}
