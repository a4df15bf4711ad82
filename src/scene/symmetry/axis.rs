//! Symmetries as a person sees them: an axis, and how often the object looks the same in a whole turn about it.

use std::fmt;

use glam::{DMat3, DQuat, DVec3};
use thiserror::Error;

use super::{ContinuousSymmetry, Symmetries};
use crate::math::{BoundingSphere, Pose, sort_short};

/// Turns about one line, after which an object looks the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SymmetryAxis {
    /// Of length 1, in the `object` frame.
    pub axis: DVec3,
    /// A point of the line, in the `object` frame.
    pub through_mm: DVec3,
    pub fold: Fold,
}

/// How often a whole turn looks the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fold {
    /// Twice or more.
    Times(u32),
    /// At every angle.
    Continuous,
}

impl fmt::Display for Fold {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Times(times) => write!(f, "{times}-fold"),
            Self::Continuous => f.write_str("any turn"),
        }
    }
}

/// Why an axis was not added.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum SymmetryError {
    #[error("the axis needs a direction, a finite point, and two turns or more")]
    NoAxis,
    #[error("no object has this symmetry together with those that it has already: remove one of them first")]
    DoNotGoTogether,
}

/// The largest finite group of turns that is not about one axis alone has 60 (a dodecahedron's); this many are those of a
/// prism of 60 sides. More come only of axes that do not go together.
const MOST_TURNS: usize = 120;
/// No two turns of such a group differ by less than 3°; found axes are off by some tenths of a degree.
const SAME_RAD: f64 = 0.035;
/// Of the object's radius: where its middle goes.
const SAME_PART: f64 = 0.04;
/// Lines this near each other are one axis.
const SAME_AXIS_RAD: f64 = 0.05;
/// A part of the way to the axis: what a file's few digits leave of a turn that should not move along its axis.
const SCREW_PART: f64 = 1e-2;

impl SymmetryAxis {
    /// The turn by an angle in radians.
    pub fn turn(&self, angle: f64) -> Pose {
        Pose::rotation_about(self.through_mm, DMat3::from_quat(DQuat::from_axis_angle(self.axis, angle)))
    }

    /// Its turns but for none at all; of a continuous one a third and a half.
    pub fn turns(&self) -> Vec<Pose> {
        match self.fold {
            Fold::Times(times) => (1..times).map(|step| self.turn(angle_of(step, times))).collect(),
            Fold::Continuous => vec![self.turn(angle_of(1, 3)), self.turn(angle_of(1, 2))],
        }
    }

    /// The axis of a turn, and how far in millimetres it moves along it, as a screw does; `None` for no turn at all.
    pub fn of_screw(pose: &Pose) -> Option<(Self, f64)> {
        let (rotation, _) = Pose { translation_mm: DVec3::ZERO, ..*pose }.log();
        let angle = rotation.length();
        let axis = upwards(rotation.try_normalize()?);
        let signed_angle = if axis.dot(rotation) < 0.0 { -angle } else { angle };
        let along = axis.dot(pose.translation_mm);
        let across = pose.translation_mm - axis * along;
        if angle < SAME_RAD {
            return None;
        }
        // The fixed point nearest to the origin: c − R c = t.
        let through_mm = (across + axis.cross(across) / (signed_angle / 2.0).tan()) / 2.0;
        let times = (std::f64::consts::TAU / angle).round().max(2.0) as u32;
        Some((Self { axis, through_mm, fold: Fold::Times(times) }, along))
    }

    /// The axis of a turn about a line; `None` for what is none.
    fn of_turn(pose: &Pose) -> Option<Self> {
        let (axis, along) = Self::of_screw(pose)?;
        (along.abs() < SCREW_PART * (1.0 + pose.translation_mm.length())).then_some(axis)
    }

    /// Both along one line, as far as this object can tell.
    pub fn is_along(&self, other: &Self, around: &BoundingSphere) -> bool {
        let is_parallel = self.axis.cross(other.axis).length() < SAME_AXIS_RAD;
        is_parallel
            && self.foot(around.center).distance(other.foot(around.center)) < SAME_PART * around.radius
    }

    /// Its point nearest to a place.
    fn foot(&self, place: DVec3) -> DVec3 {
        self.through_mm + self.axis * self.axis.dot(place - self.through_mm)
    }

    fn checked(&self) -> Result<Self, SymmetryError> {
        let is_turn = !matches!(self.fold, Fold::Times(0 | 1));
        let is_finite = self.through_mm.is_finite() && self.axis.is_finite();
        let axis = self.axis.try_normalize().filter(|_| is_turn && is_finite).ok_or(SymmetryError::NoAxis)?;
        Ok(Self { axis, ..*self })
    }

    fn of_continuous(symmetry: &ContinuousSymmetry) -> Self {
        Self { axis: symmetry.axis, through_mm: symmetry.offset_mm, fold: Fold::Continuous }
    }
}

fn angle_of(step: u32, times: u32) -> f64 {
    f64::from(step) / f64::from(times.max(1)) * std::f64::consts::TAU
}

/// The one of an axis's two directions whose largest part is positive.
fn upwards(axis: DVec3) -> DVec3 {
    if axis[axis.abs().max_position()] < 0.0 { -axis } else { axis }
}

impl Symmetries {
    /// The axes of all of its turns, continuous ones first, then those with most turns. What is no turn about a line, as a
    /// file may have it, is in none of them.
    pub fn axes(&self, around: &BoundingSphere) -> Vec<SymmetryAxis> {
        let mut axes: Vec<SymmetryAxis> = self.continuous.iter().map(SymmetryAxis::of_continuous).collect();
        for axis in self.discrete.iter().filter_map(SymmetryAxis::of_turn) {
            match axes.iter_mut().find(|known| known.is_along(&axis, around)) {
                // The smallest turn says how many there are.
                Some(known) => known.fold = known.fold.max(axis.fold),
                None => axes.push(axis),
            }
        }
        sort_short(&mut axes, |a, b| b.fold.cmp(&a.fold));
        axes
    }

    /// Is this among the transforms that look the same? Within what a found axis may be off.
    pub fn holds(&self, turn: &Pose, around: &BoundingSphere) -> bool {
        if is_same(turn, &Pose::IDENTITY, around) {
            return true;
        }
        let with_none = std::iter::once(&Pose::IDENTITY).chain(&self.discrete);
        match self.continuous.as_slice() {
            [] => self.discrete.iter().any(|known| is_same(turn, known, around)),
            // A product of any turn about the axis and a discrete one: it takes the axis to where the discrete one does.
            [only] => with_none.into_iter().any(|known| {
                let axis = SymmetryAxis::of_continuous(only);
                same_directed(&moved(&axis, turn), &moved(&axis, known), around)
            }),
            // Two axes that meet: every turn about where they do, which the axes' feet are all near to.
            [first, ..] => {
                let center = SymmetryAxis::of_continuous(first).foot(around.center);
                turn.transform_point(center).distance(center) < SAME_PART * around.radius
            }
        }
    }

    /// Adds an axis and all that follows from it together with those that are there. `around` is the object.
    pub fn add_axis(&mut self, axis: &SymmetryAxis, around: &BoundingSphere) -> Result<(), SymmetryError> {
        let axis = axis.checked()?;
        let mut wider = self.clone();
        if axis.fold == Fold::Continuous {
            if wider.continuous.iter().any(|known| SymmetryAxis::of_continuous(known).is_along(&axis, around))
            {
                return Ok(());
            }
            let known = std::mem::take(&mut wider.discrete);
            wider.continuous.push(ContinuousSymmetry { axis: axis.axis, offset_mm: axis.through_mm });
            wider.check_axes_meet(around)?;
            known.iter().try_for_each(|turn| wider.add_turn(turn, around))?;
        } else {
            axis.turns().iter().try_for_each(|turn| wider.add_turn(turn, around))?;
        }
        *self = wider;
        Ok(())
    }

    /// Takes out every turn about a line. The others stay, also those that it was a product of.
    pub fn remove_axis(&mut self, axis: &SymmetryAxis, around: &BoundingSphere) {
        self.continuous.retain(|known| !SymmetryAxis::of_continuous(known).is_along(axis, around));
        self.discrete
            .retain(|turn| SymmetryAxis::of_turn(turn).is_none_or(|known| !known.is_along(axis, around)));
    }

    fn check_axes_meet(&self, around: &BoundingSphere) -> Result<(), SymmetryError> {
        let mut feet =
            self.continuous.iter().map(|axis| SymmetryAxis::of_continuous(axis).foot(around.center));
        let Some(first) = feet.next() else { return Ok(()) };
        let apart = feet.any(|foot| foot.distance(first) > SAME_PART * around.radius);
        if apart { Err(SymmetryError::DoNotGoTogether) } else { Ok(()) }
    }

    /// One turn more, and its products with those that are there.
    fn add_turn(&mut self, turn: &Pose, around: &BoundingSphere) -> Result<(), SymmetryError> {
        if self.holds(turn, around) {
            return Ok(());
        }
        if let [axis, rest @ ..] = self.continuous.as_slice() {
            // Beside a continuous axis only its two ends can be exchanged: that is one turn, and the others follow.
            let axis = SymmetryAxis::of_continuous(axis);
            if !rest.is_empty() || !moved(&axis, turn).is_along(&axis, around) {
                return Err(SymmetryError::DoNotGoTogether);
            }
            self.discrete.push(*turn);
            return Ok(());
        }
        self.discrete.push(*turn);
        self.close(around)
    }

    /// Adds products until there are no new ones.
    fn close(&mut self, around: &BoundingSphere) -> Result<(), SymmetryError> {
        let mut next = 0;
        while next < self.discrete.len() {
            for other in 0..self.discrete.len() {
                for (a, b) in [(next, other), (other, next)] {
                    let product = (self.discrete[a] * self.discrete[b]).renormalized();
                    if !self.holds(&product, around) {
                        self.discrete.push(product);
                    }
                }
                if self.discrete.len() > MOST_TURNS {
                    return Err(SymmetryError::DoNotGoTogether);
                }
            }
            next += 1;
        }
        Ok(())
    }
}

/// The axis where a turn takes it.
fn moved(axis: &SymmetryAxis, turn: &Pose) -> SymmetryAxis {
    SymmetryAxis {
        axis: turn.rotation * axis.axis,
        through_mm: turn.transform_point(axis.through_mm),
        fold: axis.fold,
    }
}

fn same_directed(a: &SymmetryAxis, b: &SymmetryAxis, around: &BoundingSphere) -> bool {
    a.axis.dot(b.axis) > 0.0 && a.is_along(b, around)
}

fn is_same(a: &Pose, b: &Pose, around: &BoundingSphere) -> bool {
    let apart = a.transform_point(around.center).distance(b.transform_point(around.center));
    a.angle_to(b) < SAME_RAD && apart < SAME_PART * around.radius
}

#[cfg(test)]
mod tests;
