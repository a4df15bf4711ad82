//! In which direction a pose is least sure, and what measurement would help most.

use glam::{DMat2, DVec2, DVec3};

use super::free_turns::in_lengths;
use super::linear::{Matrix, symmetric_eigen};
use super::motion::{motion_row, moved_about, project_with_jacobian};
use super::{FreeTurns, TwistCovariance};
use crate::math::{Intrinsics, Pose};

/// What kind of motion a pose leaves most open.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weakness {
    Depth,
    Lateral,
    Tilt,
    Roll,
}

/// The motion that a pose leaves most open: of all that are as likely, the one that moves the object's rim farthest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weakest {
    pub kind: Weakness,
    /// One standard deviation: a turn about the object's middle in radians and a shift of it in millimetres, in camera axes.
    pub step: [f64; 6],
    /// The object's middle, which it is about.
    pub center_camera_mm: DVec3,
}

impl Weakest {
    /// The pose so many standard deviations along.
    pub fn moved(&self, camera_from_object: &Pose, sigmas: f64) -> Pose {
        moved_about(camera_from_object, self.center_camera_mm, &self.step.map(|part| part * sigmas))
    }
}

/// Turns count by what they move at `radius_mm` from the middle, `center_mm` of the `object` frame.
pub fn weakest(
    covariance: &TwistCovariance,
    camera_from_object: &Pose,
    center_mm: DVec3,
    radius_mm: f64,
) -> Option<Weakest> {
    let center_camera_mm = camera_from_object.transform_point(center_mm);
    let lengths = in_lengths(&covariance.about(center_camera_mm), radius_mm);
    let (values, vectors) = symmetric_eigen(&lengths);
    let (value, vector) = (values.last()?, vectors.last()?);
    let sigma_mm = value.max(0.0).sqrt();
    let mut step = vector.map(|part| part * sigma_mm);
    step[..3].iter_mut().for_each(|turn| *turn /= radius_mm);
    let ray = center_camera_mm.normalize_or(DVec3::Z);
    let [turn, shift] = [DVec3::from_slice(&vector[..3]), DVec3::from_slice(&vector[3..])];
    let parts = [
        (Weakness::Depth, shift.dot(ray).abs()),
        (Weakness::Lateral, shift.reject_from_normalized(ray).length()),
        (Weakness::Tilt, turn.reject_from_normalized(ray).length()),
        (Weakness::Roll, turn.dot(ray).abs()),
    ];
    let (kind, _) = parts.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    (sigma_mm.is_finite() && sigma_mm > 0.0).then_some(Weakest { kind, step, center_camera_mm })
}

/// Of points in the `object` frame the one where a pin would make the pose surest, and the standard deviation that would
/// then be left of the depth, in millimetres. The measure is the sum of all variances, turns as the lengths of what they
/// move, but for turns that nobody can see. `None` where no point is before the camera.
pub fn most_helpful_point(
    camera: &Intrinsics,
    camera_from_object: &Pose,
    (covariance, free): (&TwistCovariance, &FreeTurns),
    (center_mm, radius_mm): (DVec3, f64),
    click_sigma_px: f64,
    points_mm: impl Iterator<Item = DVec3>,
) -> Option<(DVec3, f64)> {
    let center = camera_from_object.transform_point(center_mm);
    let before = covariance.about(center);
    let ray = center.normalize_or(DVec3::Z);
    let with_pin = |point_mm: DVec3| {
        let after =
            after_pin(&before, camera, camera_from_object.transform_point(point_mm), center, click_sigma_px)?;
        let lengths = free.taken_out_of(&in_lengths(&after, radius_mm));
        let sum: f64 = (0..6).map(|axis| lengths[axis][axis]).sum();
        let along = |row: usize, column: usize| ray[row] * lengths[3 + row][3 + column] * ray[column];
        let depth: f64 = (0..9).map(|entry| along(entry / 3, entry % 3)).sum();
        Some((sum, point_mm, depth.max(0.0).sqrt()))
    };
    let best = points_mm.filter_map(with_pin).min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((best.1, best.2))
}

/// The covariance after one pin more: C − C Jᵀ (J C Jᵀ + σ² I)⁻¹ J C.
fn after_pin(
    before: &Matrix<6>,
    camera: &Intrinsics,
    point_camera_mm: DVec3,
    center_camera_mm: DVec3,
    click_sigma_px: f64,
) -> Option<Matrix<6>> {
    let (_, gradients) = project_with_jacobian(camera, point_camera_mm)?;
    let rows = gradients.map(|gradient| motion_row(point_camera_mm - center_camera_mm, gradient));
    let times = |row: &[f64; 6]| -> [f64; 6] {
        std::array::from_fn(|axis| before[axis].iter().zip(row).map(|(a, b)| a * b).sum())
    };
    let spread = rows.map(|row| times(&row));
    let dot = |a: &[f64; 6], b: &[f64; 6]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let variance = click_sigma_px * click_sigma_px;
    let [xx, xy, yy] = [dot(&rows[0], &spread[0]), dot(&rows[0], &spread[1]), dot(&rows[1], &spread[1])];
    let seen = DMat2::from_cols(DVec2::new(xx + variance, xy), DVec2::new(xy, yy + variance));
    let inverse = seen.inverse();
    let gained = |row: usize, column: usize| {
        let [a, b] = [row, column].map(|axis| DVec2::new(spread[0][axis], spread[1][axis]));
        a.dot(inverse * b)
    };
    let after =
        std::array::from_fn(|row| std::array::from_fn(|column| before[row][column] - gained(row, column)));
    inverse.is_finite().then_some(after)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Symmetries;

    const RADIUS_MM: f64 = 60.0;

    fn pose() -> Pose {
        Pose::from_translation(DVec3::new(0.0, 0.0, 800.0))
    }

    fn covariance(sigmas: [f64; 6]) -> TwistCovariance {
        let steps = std::array::from_fn(|row| {
            std::array::from_fn(|column| if row == column { sigmas[row] * sigmas[row] } else { 0.0 })
        });
        TwistCovariance::from_steps_about(pose().translation_mm, &steps)
    }

    #[test]
    fn the_weakest_direction_has_its_kind_and_its_size() {
        for (axis, sigma, kind) in [
            (5, 7.0, Weakness::Depth),
            (0, 0.1, Weakness::Tilt),
            (2, 0.1, Weakness::Roll),
            (3, 5.0, Weakness::Lateral),
        ] {
            let mut sigmas = [0.01, 0.01, 0.01, 0.5, 0.5, 0.5];
            sigmas[axis] = sigma;
            let found = weakest(&covariance(sigmas), &pose(), DVec3::ZERO, RADIUS_MM).unwrap();
            assert_eq!(found.kind, kind);
            // On the way to the camera's centre and back, numbers of 800² · 1e-2 lose some of 16 digits.
            assert!((found.step[axis].abs() - sigma).abs() < 1e-4, "{found:?}");
        }
        assert_eq!(weakest(&covariance([0.0; 6]), &pose(), DVec3::ZERO, RADIUS_MM), None);
    }

    #[test]
    fn a_pin_at_the_rim_tells_a_roll_and_one_in_the_middle_does_not() {
        let camera = Intrinsics::from_focal(900.0, 640, 480);
        let rolling = covariance([0.005, 0.005, 0.1, 0.3, 0.3, 2.0]);
        let points = [DVec3::ZERO, DVec3::X * 50.0, DVec3::Y * 20.0];
        let best = |points: &[DVec3]| {
            let around = (DVec3::ZERO, RADIUS_MM);
            let free = FreeTurns::of(&Symmetries::default(), &pose(), DVec3::ZERO, RADIUS_MM);
            most_helpful_point(&camera, &pose(), (&rolling, &free), around, 1.5, points.iter().copied())
        };
        let (point, depth_mm) = best(&points).unwrap();
        assert_eq!(point, points[1]);
        assert!(depth_mm <= 2.0);
        assert_eq!(best(&[DVec3::new(0.0, 0.0, -900.0)]), None, "behind the camera");
    }
}
