//! Turns that leave all that is seen as it is: about an object's continuous axes of symmetry. They are no error of a pose.

use glam::DVec3;

use super::TwistCovariance;
use super::linear::{Matrix, congruent};
use crate::math::Pose;
use crate::scene::Symmetries;

/// Steps about an object's middle, as [`super::motion::moved_about`] takes them, that nobody can see.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeTurns {
    center_camera_mm: DVec3,
    radius_mm: f64,
    /// Turns as the lengths of what they move at the radius; of length one and across each other.
    directions: Vec<[f64; 6]>,
}

/// Axes nearer to each other than this, as a sine, are one.
const PARALLEL: f64 = 1e-6;

impl FreeTurns {
    /// Of an object with its middle at `center_mm` and of this radius, in its own frame.
    pub fn of(symmetries: &Symmetries, camera_from_object: &Pose, center_mm: DVec3, radius_mm: f64) -> Self {
        let mut free = Self {
            center_camera_mm: camera_from_object.transform_point(center_mm),
            radius_mm: radius_mm.max(f64::MIN_POSITIVE),
            directions: Vec::new(),
        };
        let Some(first) = symmetries.continuous.first() else { return free };
        let is_sphere =
            symmetries.continuous.iter().any(|other| other.axis.cross(first.axis).length() > PARALLEL);
        // Turns about two axes make the turns about all, through where they meet: of a ball that is its middle.
        let axes = if is_sphere { DVec3::AXES.to_vec() } else { vec![first.axis] };
        let along = first.axis.normalize_or_zero();
        let foot_mm = first.offset_mm + along * along.dot(center_mm - first.offset_mm);
        let through_camera_mm = camera_from_object.transform_point(foot_mm);
        for axis in axes {
            free.add(camera_from_object.rotation * axis, through_camera_mm);
        }
        free
    }

    pub fn is_empty(&self) -> bool {
        self.directions.is_empty()
    }

    fn add(&mut self, axis: DVec3, through_camera_mm: DVec3) {
        let shift = axis.cross(self.center_camera_mm - through_camera_mm);
        let turn = axis * self.radius_mm;
        let mut direction = [turn.x, turn.y, turn.z, shift.x, shift.y, shift.z];
        for known in &self.directions {
            let along = dot(&direction, known);
            direction.iter_mut().zip(known).for_each(|(part, known)| *part -= along * known);
        }
        let length = dot(&direction, &direction).sqrt();
        if length > PARALLEL * self.radius_mm {
            self.directions.push(direction.map(|part| part / length));
        }
    }

    /// A covariance of (turn about the middle in lengths, shift of it) without its part along these turns: of all poses that
    /// look the same, the nearest counts.
    pub(super) fn taken_out_of(&self, lengths: &Matrix<6>) -> Matrix<6> {
        if self.is_empty() {
            return *lengths;
        }
        let along = |row: usize, column: usize| -> f64 {
            self.directions.iter().map(|direction| direction[row] * direction[column]).sum()
        };
        let across: Matrix<6> = std::array::from_fn(|row| {
            std::array::from_fn(|column| f64::from(u8::from(row == column)) - along(row, column))
        });
        congruent(&across, lengths)
    }
}

impl TwistCovariance {
    /// Without what turns about axes of symmetry add to it.
    pub fn without(&self, free: &FreeTurns) -> Self {
        if free.is_empty() {
            return *self;
        }
        let lengths = in_lengths(&self.about(free.center_camera_mm), free.radius_mm);
        let across = in_lengths(&free.taken_out_of(&lengths), 1.0 / free.radius_mm);
        Self::from_steps_about(free.center_camera_mm, &across)
    }
}

/// Turns as the lengths of what they move at a radius.
pub(super) fn in_lengths(covariance: &Matrix<6>, radius_mm: f64) -> Matrix<6> {
    let unit = |axis: usize| if axis < 3 { radius_mm } else { 1.0 };
    std::array::from_fn(|row| {
        std::array::from_fn(|column| unit(row) * covariance[row][column] * unit(column))
    })
}

fn dot(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::ContinuousSymmetry;
    use crate::solve::{Uncertainty, Weakness, weakest};

    const RADIUS_MM: f64 = 60.0;
    /// On the way to the camera's centre and back, numbers of 800² · 25 lose some of 16 digits, and a root takes half of them.
    const ROUNDING: f64 = 1e-4;

    fn pose() -> Pose {
        Pose::from_translation(DVec3::new(0.0, 0.0, 800.0))
    }

    /// Turned by 5 rad about the object's y, and a hundredth of that about the others: what pins of a bottle leave.
    fn spinning() -> TwistCovariance {
        let sigmas = [0.02, 5.0, 0.01, 0.4, 0.3, 2.0];
        let steps = std::array::from_fn(|row| {
            std::array::from_fn(|column| if row == column { sigmas[row] * sigmas[row] } else { 0.0 })
        });
        TwistCovariance::from_steps_about(pose().translation_mm, &steps)
    }

    fn about(axes: &[DVec3], offset_mm: DVec3) -> FreeTurns {
        let continuous = axes.iter().map(|&axis| ContinuousSymmetry { axis, offset_mm }).collect();
        let symmetries = Symmetries { discrete: Vec::new(), continuous };
        FreeTurns::of(&symmetries, &pose(), DVec3::ZERO, RADIUS_MM)
    }

    #[test]
    fn a_turn_about_the_axis_is_no_error() {
        let of = |covariance: &TwistCovariance| Uncertainty::of(covariance, &pose(), DVec3::ZERO);
        let kind = |covariance: &TwistCovariance| {
            weakest(covariance, &pose(), DVec3::ZERO, RADIUS_MM).map(|weakest| weakest.kind)
        };
        let plain = of(&spinning());
        assert!((plain.tilt_rad - 5.0).abs() < ROUNDING, "{plain:?}");
        assert_eq!(kind(&spinning()), Some(Weakness::Tilt));

        let round = spinning().without(&about(&[DVec3::Y], DVec3::Y * 9.0));
        let found = of(&round);
        assert!((found.tilt_rad - 0.02).abs() < ROUNDING, "{found:?}");
        for (found, plain) in [
            (found.roll_rad, plain.roll_rad),
            (found.depth_mm, plain.depth_mm),
            (found.lateral_mm, plain.lateral_mm),
        ] {
            assert!((found - plain).abs() < ROUNDING, "{found} instead of {plain}");
        }
        assert_eq!(kind(&round), Some(Weakness::Depth));
        assert_eq!(spinning().without(&about(&[], DVec3::ZERO)), spinning());
    }

    #[test]
    fn of_a_sphere_no_turn_is_an_error() {
        let found = Uncertainty::of(
            &spinning().without(&about(&[DVec3::Y, DVec3::X], DVec3::ZERO)),
            &pose(),
            DVec3::ZERO,
        );
        assert!(found.tilt_rad < ROUNDING && found.roll_rad < ROUNDING, "{found:?}");
        assert!((found.depth_mm - 2.0).abs() < ROUNDING, "{found:?}");
    }

    #[test]
    fn an_axis_beside_the_middle_takes_the_middle_along() {
        // All that is open is the turn about the axis, which moves the middle as well.
        let axis_mm = DVec3::X * 30.0;
        let turn = [0.0, 0.1, 0.0];
        let shift = DVec3::from_array(turn).cross(-axis_mm);
        let step = [turn[0], turn[1], turn[2], shift.x, shift.y, shift.z];
        let steps = std::array::from_fn(|row| std::array::from_fn(|column| step[row] * step[column]));
        let covariance = TwistCovariance::from_steps_about(pose().translation_mm, &steps);
        let found = Uncertainty::of(&covariance.without(&about(&[DVec3::Y], axis_mm)), &pose(), DVec3::ZERO);
        for left in [found.tilt_rad, found.roll_rad, found.depth_mm, found.lateral_mm] {
            assert!(left < ROUNDING, "{found:?}");
        }
    }
}
