//! Transforms of an object onto itself, as BOP's `models_info.json` has them.

mod axis;

use glam::{DMat3, DMat4, DQuat, DVec3};

use crate::math::Pose;

pub use axis::{Fold, SymmetryAxis, SymmetryError};

/// The step, in radians of half a turn, in which a continuous symmetry is sampled: 315 rotations of a turn. Source:
/// bop_toolkit's `max_sym_disc_step`.
const CONTINUOUS_STEP: f64 = 0.01;

/// Two transforms that move a point this far from each other, as parts of the turn and of a millimetre, are one.
const SAME: f64 = 1e-6;

/// Which other poses of an object look the same. The identity is always among them and never listed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Symmetries {
    /// `object_from_object`, in millimetres.
    pub discrete: Vec<Pose>,
    pub continuous: Vec<ContinuousSymmetry>,
}

/// Every turn about an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContinuousSymmetry {
    /// Of length 1, in the `object` frame.
    pub axis: DVec3,
    /// A point on the axis, in the `object` frame.
    pub offset_mm: DVec3,
}

impl ContinuousSymmetry {
    /// The turn about the axis by an angle in radians.
    pub fn turn(&self, angle: f64) -> Pose {
        Pose::rotation_about(self.offset_mm, DMat3::from_quat(DQuat::from_axis_angle(self.axis, angle)))
    }
}

impl Symmetries {
    pub fn is_empty(&self) -> bool {
        self.discrete.is_empty() && self.continuous.is_empty()
    }

    /// All transforms that count as the identity, itself first: each discrete one after each turn about each axis.
    ///
    /// Axes are not combined with one another: a set with two is a sphere's, and stands for all rotations only by the turns
    /// about these. Source: bop_toolkit's `get_symmetry_transformations`.
    pub fn expanded(&self) -> Vec<Pose> {
        let discrete: Vec<Pose> =
            std::iter::once(Pose::IDENTITY).chain(self.discrete.iter().copied()).collect();
        if self.continuous.is_empty() {
            return discrete;
        }
        let steps = (std::f64::consts::PI / CONTINUOUS_STEP).ceil() as u32;
        let turns: Vec<Pose> = self
            .continuous
            .iter()
            .flat_map(|symmetry| {
                (0..steps).map(move |step| {
                    symmetry.turn(f64::from(step) / f64::from(steps) * std::f64::consts::TAU)
                })
            })
            .collect();
        discrete.iter().flat_map(|first| turns.iter().map(move |turn| *turn * *first)).collect()
    }

    /// The symmetries of the mesh after a transform of its points: those that are rigid still. A mirror or another unit keeps
    /// all, a stretch across an axis ends the turns about it.
    pub fn of_transformed(&self, new_from_old: &DMat4) -> Self {
        let old_from_new = new_from_old.inverse();
        let carried =
            |symmetry: &Pose| Pose::from_mat4(&(*new_from_old * symmetry.to_mat4() * old_from_new), SAME);
        let discrete = self.discrete.iter().filter_map(carried).collect();
        let continuous = self.continuous.iter().filter_map(|symmetry| {
            // A quarter turn takes an ellipse's long axis to its short one: if that is rigid, every turn is.
            carried(&symmetry.turn(std::f64::consts::FRAC_PI_2))?;
            Some(ContinuousSymmetry {
                axis: new_from_old.transform_vector3(symmetry.axis).try_normalize()?,
                offset_mm: new_from_old.transform_point3(symmetry.offset_mm),
            })
        });
        Self { discrete, continuous: continuous.collect() }
    }

    /// Adds a transform unless it is there already or is the identity.
    pub fn add_discrete(&mut self, symmetry: Pose) {
        let is_same = |other: &Pose| {
            symmetry.angle_to(other) < SAME && symmetry.translation_mm.distance(other.translation_mm) < SAME
        };
        if !is_same(&Pose::IDENTITY) && !self.discrete.iter().any(is_same) {
            self.discrete.push(symmetry);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn half_turn_about_z() -> Pose {
        Pose::rotation_about(DVec3::ZERO, DMat3::from_rotation_z(std::f64::consts::PI))
    }

    #[test]
    fn nothing_expands_to_the_identity() {
        assert_eq!(Symmetries::default().expanded(), [Pose::IDENTITY]);
    }

    #[test]
    fn discrete_and_continuous_are_combined_as_bop_does() {
        let axis = ContinuousSymmetry { axis: DVec3::Z, offset_mm: DVec3::new(10.0, 0.0, 0.0) };
        let flip = Pose::rotation_about(DVec3::ZERO, DMat3::from_rotation_x(std::f64::consts::PI));
        let symmetries = Symmetries { discrete: vec![flip], continuous: vec![axis] };
        let all = symmetries.expanded();
        assert_eq!(all.len(), 2 * 315);
        assert_eq!(all[0], Pose::IDENTITY);
        // Every turn leaves the axis where it is.
        for turn in &all[..315] {
            let moved = turn.transform_point(DVec3::new(10.0, 0.0, 7.0));
            // A product of two rounded rotations of a point 12 mm out.
            assert!(moved.distance(DVec3::new(10.0, 0.0, 7.0)) < 1e-12);
        }
    }

    #[test]
    fn the_same_transform_is_kept_once() {
        let mut symmetries = Symmetries::default();
        symmetries.add_discrete(Pose::IDENTITY);
        symmetries.add_discrete(half_turn_about_z());
        symmetries.add_discrete(half_turn_about_z());
        assert_eq!(symmetries.discrete.len(), 1);
    }

    #[test]
    fn symmetries_follow_the_mesh() {
        let symmetries = Symmetries {
            discrete: vec![half_turn_about_z()],
            continuous: vec![ContinuousSymmetry { axis: DVec3::Z, offset_mm: DVec3::X }],
        };
        let moved = symmetries.of_transformed(&DMat4::from_translation(DVec3::new(0.0, 5.0, 0.0)));
        assert_eq!(moved.continuous[0].offset_mm, DVec3::new(1.0, 5.0, 0.0));
        let on_axis = DVec3::new(0.0, 5.0, 3.0);
        assert!(moved.discrete[0].transform_point(on_axis).distance(on_axis) < 1e-12);

        let in_metres = symmetries.of_transformed(&DMat4::from_scale(DVec3::splat(1000.0)));
        assert_eq!((in_metres.discrete.len(), in_metres.continuous[0].offset_mm.x), (1, 1000.0));
        let mirrored = symmetries.of_transformed(&DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0)));
        assert_eq!((mirrored.discrete.len(), mirrored.continuous[0].offset_mm.x), (1, -1.0));
        // An ellipse: half a turn is left.
        let stretched = symmetries.of_transformed(&DMat4::from_scale(DVec3::new(2.0, 1.0, 1.0)));
        assert_eq!((stretched.discrete.len(), stretched.continuous.len()), (1, 0));
    }
}
