//! How sure a pose is, in the four numbers that a person thinks in.

use glam::{DMat3, DVec3};

use super::TwistCovariance;
use crate::math::Pose;

/// Standard deviations of a pose, as its camera sees them. Of two directions together it is the worse one's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertainty {
    /// Along the view ray.
    pub depth_mm: f64,
    /// Across it.
    pub lateral_mm: f64,
    /// About an axis across the view ray.
    pub tilt_rad: f64,
    /// About the view ray.
    pub roll_rad: f64,
}

/// How far what is taken as exact may be off, as parts of it: one standard deviation each.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tolerances {
    pub focal: f64,
    pub mesh_scale: f64,
}

impl TwistCovariance {
    /// With what no pixel tells of an object whose middle is at `center_camera_mm`: ΔZ/Z = Δf/f = Δs/s.
    pub fn with_tolerances(&self, tolerances: &Tolerances, center_camera_mm: DVec3) -> Self {
        let along = center_camera_mm * tolerances.focal.hypot(tolerances.mesh_scale);
        let mut about_center = self.about(center_camera_mm);
        for row in 0..3 {
            for column in 0..3 {
                about_center[3 + row][3 + column] += along[row] * along[column];
            }
        }
        Self::from_steps_about(center_camera_mm, &about_center)
    }
}

impl Uncertainty {
    /// Of the object's middle, `center_mm` of the `object` frame, and of the turn about it.
    pub fn of(covariance: &TwistCovariance, camera_from_object: &Pose, center_mm: DVec3) -> Self {
        let center = camera_from_object.transform_point(center_mm);
        let about_center = covariance.about(center);
        let block = |first: usize| {
            let column =
                |j: usize| DVec3::from_array([0, 1, 2].map(|i: usize| about_center[first + i][first + j]));
            DMat3::from_cols(column(0), column(1), column(2))
        };
        let ray = center.normalize_or(DVec3::Z);
        let (tilt_rad, roll_rad) = across_and_along(&block(0), ray);
        let (lateral_mm, depth_mm) = across_and_along(&block(3), ray);
        Self { depth_mm, lateral_mm, tilt_rad, roll_rad }
    }
}

/// Standard deviations: the largest of those across an axis, and that along it.
fn across_and_along(covariance: &DMat3, axis: DVec3) -> (f64, f64) {
    let (x, y) = axis.any_orthonormal_pair();
    let [xx, yy, xy] = [x.dot(*covariance * x), y.dot(*covariance * y), x.dot(*covariance * y)];
    let largest = (xx + yy) / 2.0 + ((xx - yy) / 2.0).hypot(xy);
    (largest.max(0.0).sqrt(), axis.dot(*covariance * axis).max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_widen_the_depth_alone() {
        let center = DVec3::new(0.0, 0.0, 800.0);
        let mut steps = [[0.0; 6]; 6];
        (0..6).for_each(|i| steps[i][i] = 9.0 * if i < 3 { 1e-6 } else { 1.0 });
        let covariance = TwistCovariance::from_steps_about(center, &steps);
        let tolerances = Tolerances { focal: 0.004, mesh_scale: 0.003 };
        let wider = covariance.with_tolerances(&tolerances, center);
        let of = |covariance| Uncertainty::of(covariance, &Pose::from_translation(center), DVec3::ZERO);
        let (before, after) = (of(&covariance), of(&wider));
        // 0.5 % of 800 mm are 4 mm, and 3 and 4 are 5. Rounding of 800² on the way.
        assert!((after.depth_mm - 5.0).abs() < 1e-6, "{after:?}");
        assert!((after.lateral_mm - before.lateral_mm).abs() < 1e-6);
        assert!((after.tilt_rad - before.tilt_rad).abs() < 1e-9);
    }

    #[test]
    fn the_four_numbers_are_those_of_the_directions() {
        let center = DVec3::new(0.0, 0.0, 800.0);
        let mut steps = [[0.0; 6]; 6];
        // Pitch, yaw, roll in radians, then x, y, z in millimetres.
        for (i, sigma) in [0.03, 0.01, 0.005, 0.4, 0.3, 6.0_f64].into_iter().enumerate() {
            steps[i][i] = sigma * sigma;
        }
        let covariance = TwistCovariance::from_steps_about(center, &steps);
        let found = Uncertainty::of(&covariance, &Pose::from_translation(center), DVec3::ZERO);
        let expected = Uncertainty { depth_mm: 6.0, lateral_mm: 0.4, tilt_rad: 0.03, roll_rad: 0.005 };
        for (found, expected) in [
            (found.depth_mm, expected.depth_mm),
            (found.lateral_mm, expected.lateral_mm),
            (found.tilt_rad, expected.tilt_rad),
            (found.roll_rad, expected.roll_rad),
        ] {
            // On the way to the camera's centre and back, numbers of 800² · 1e-3 lose some of 16 digits.
            assert!((found - expected).abs() < 1e-6, "{found} instead of {expected}");
        }
    }
}
