//! The errors that are cheap enough to be shown while a pose is dragged.

use glam::{DMat3, DVec3};

use crate::math::Pose;
use crate::mesh::Mesh;
use crate::scene::Symmetries;

/// Live numbers average over no more vertices than this; results that are kept use all.
pub const LIVE_VERTICES: usize = 20_000;

/// The errors of an estimated pose against a reference, or against that one of its symmetric twins that is nearest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseError {
    pub rotation_rad: f64,
    pub translation_mm: f64,
    /// ADD: the mean distance of the model's vertices under the two poses.
    pub add_mm: f64,
}

impl PoseError {
    /// ADD averages over at most `max_vertices` vertices, evenly through the mesh's list; all of them if it has no more.
    pub fn between(
        estimate: &Pose,
        reference: &Pose,
        mesh: &Mesh,
        symmetries: &Symmetries,
        max_vertices: usize,
    ) -> Self {
        let twin = nearest_twin(estimate, reference, mesh, symmetries, max_vertices);
        Self {
            rotation_rad: estimate.angle_to(&twin),
            translation_mm: estimate.translation_mm.distance(twin.translation_mm),
            add_mm: add_mm(estimate, &twin, mesh, max_vertices),
        }
    }
}

/// The reference as it is after the symmetry that brings the vertices nearest, in the mean of squares, to where the estimate
/// has them. About a continuous axis it is the exact turn, not one of BOP's steps, which are a degree apart.
fn nearest_twin(
    estimate: &Pose,
    reference: &Pose,
    mesh: &Mesh,
    symmetries: &Symmetries,
    max_vertices: usize,
) -> Pose {
    if symmetries.is_empty() {
        return *reference;
    }
    let moments = Moments::of(mesh, max_vertices);
    let wanted = reference.inverse() * *estimate;
    let cost = |symmetry: &Pose| moments.mean_square_between(&wanted, symmetry);
    let starts = std::iter::once(&Pose::IDENTITY).chain(&symmetries.discrete);
    let best = starts
        .map(|start| turned_nearest(start, symmetries, &cost))
        .min_by(|a, b| cost(a).total_cmp(&cost(b)))
        .unwrap_or(Pose::IDENTITY);
    *reference * best
}

/// A symmetry and the best turns about the continuous axes after it. Two axes are a sphere's: turns about one and the other in
/// turn go wherever it can be turned to.
fn turned_nearest(start: &Pose, symmetries: &Symmetries, cost: &impl Fn(&Pose) -> f64) -> Pose {
    let rounds = if symmetries.continuous.len() > 1 { 40 } else { 1 };
    let mut symmetry = *start;
    for axis in (0..rounds).flat_map(|_| &symmetries.continuous) {
        // Over a turn the mean square is a + b cos φ + c sin φ: three places tell where it is least.
        let at = |angle: f64| cost(&(axis.turn(angle) * symmetry));
        let [ahead, aside, behind] = [0.0, 0.5, 1.0].map(|half| at(half * std::f64::consts::PI));
        let (by_cosine, by_sine) = ((ahead - behind) / 2.0, aside - (ahead + behind) / 2.0);
        let least = axis.turn((-by_sine).atan2(-by_cosine)) * symmetry;
        // Where a turn makes no difference but for rounding, it stays.
        if cost(&least) < cost(&symmetry) {
            symmetry = least;
        }
    }
    symmetry
}

/// The mean of vertices and of products of their coordinates: enough for the mean square of what two poses make of them.
struct Moments {
    first: DVec3,
    second: DMat3,
}

impl Moments {
    fn of(mesh: &Mesh, max_vertices: usize) -> Self {
        let positions = mesh.positions_mm();
        let step = positions.len().div_ceil(max_vertices.max(1)).max(1);
        let (mut first, mut second, mut count) = (DVec3::ZERO, DMat3::ZERO, 0.0);
        for position in positions.iter().step_by(step).map(|position| position.as_dvec3()) {
            first += position;
            second += DMat3::from_cols(position * position.x, position * position.y, position * position.z);
            count += 1.0;
        }
        let count = f64::max(count, 1.0);
        Self { first: first / count, second: second * (1.0 / count) }
    }

    fn mean_square_between(&self, a: &Pose, b: &Pose) -> f64 {
        let turn = a.rotation - b.rotation;
        let shift = a.translation_mm - b.translation_mm;
        let turned = turn * self.second;
        let columns =
            [(turn.x_axis, turned.x_axis), (turn.y_axis, turned.y_axis), (turn.z_axis, turned.z_axis)];
        let squares: f64 = columns.into_iter().map(|(a, b)| a.dot(b)).sum();
        squares + 2.0 * shift.dot(turn * self.first) + shift.length_squared()
    }
}

/// Source: Hinterstoisser et al., *Model Based Training, Detection and Pose Estimation of Texture-Less 3D Objects*, 2012.
pub(super) fn add_mm(estimate: &Pose, reference: &Pose, mesh: &Mesh, max_vertices: usize) -> f64 {
    let rotation = estimate.rotation - reference.rotation;
    let translation = estimate.translation_mm - reference.translation_mm;
    let positions = mesh.positions_mm();
    let step = positions.len().div_ceil(max_vertices.max(1)).max(1);
    let (mut sum, mut count) = (0.0, 0_u32);
    for position in positions.iter().step_by(step) {
        sum += (rotation * position.as_dvec3() + translation).length();
        count += 1;
    }
    sum / f64::from(count.max(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::test_shapes;
    use crate::scene::ContinuousSymmetry;

    fn plain(estimate: &Pose, reference: &Pose, mesh: &Mesh, max_vertices: usize) -> PoseError {
        PoseError::between(estimate, reference, mesh, &Symmetries::default(), max_vertices)
    }

    #[test]
    fn a_symmetric_twin_is_no_error() {
        let mesh = test_shapes::sphere(40.0, 12, 24);
        let reference = Pose::exp(DVec3::new(0.3, -0.2, 0.5), DVec3::new(15.0, -6.0, 700.0));
        let turn = |axis: DVec3, angle: f64| Pose::exp(axis * angle, DVec3::ZERO);
        let about = |axis: DVec3| ContinuousSymmetry { axis, offset_mm: DVec3::ZERO };
        let flip = turn(DVec3::X, std::f64::consts::PI);
        let tin = Symmetries { discrete: vec![flip], continuous: vec![about(DVec3::Z)] };
        // Between two of BOP's steps, and turned over.
        let twin = reference * flip * turn(DVec3::Z, 1.2345);
        let error = PoseError::between(&twin, &reference, &mesh, &tin, usize::MAX);
        // Rounding of coordinates up to 700 mm; the angle's square is what is least.
        assert!(error.rotation_rad < 1e-7 && error.translation_mm < 1e-9 && error.add_mm < 1e-5, "{error:?}");
        // A tilt is one still: to the nearest twin.
        let tilted = twin * turn(DVec3::Y, 0.1);
        let error = PoseError::between(&tilted, &reference, &mesh, &tin, usize::MAX);
        assert!((error.rotation_rad - 0.1).abs() < 1e-6, "{error:?}");
        let ball = Symmetries {
            discrete: Vec::new(),
            continuous: [DVec3::X, DVec3::Y, DVec3::Z].map(about).to_vec(),
        };
        let turned = reference * Pose::exp(DVec3::new(1.9, -0.4, 0.8), DVec3::ZERO);
        let error = PoseError::between(&turned.translated(DVec3::X), &reference, &mesh, &ball, usize::MAX);
        // What forty rounds about three axes leave.
        assert!(error.rotation_rad < 1e-3 && (error.add_mm - 1.0).abs() < 1e-3, "{error:?}");
    }

    #[test]
    fn errors_of_known_motions() {
        let mesh = test_shapes::cube();
        let reference = Pose::exp(DVec3::new(0.1, 0.2, 0.3), DVec3::new(5.0, 6.0, 700.0));
        let none = plain(&reference, &reference, &mesh, usize::MAX);
        assert_eq!((none.rotation_rad, none.translation_mm, none.add_mm), (0.0, 0.0, 0.0));
        let moved = reference.translated(DVec3::new(0.0, 3.0, 4.0));
        let error = plain(&moved, &reference, &mesh, usize::MAX);
        assert!((error.add_mm - 5.0).abs() < 1e-12 && (error.translation_mm - 5.0).abs() < 1e-12);
        // Half a turn about z takes each corner of the cube from −1 to 1 across a diagonal of 2√2.
        let turned = reference * Pose::exp(DVec3::Z * std::f64::consts::PI, DVec3::ZERO);
        let error = plain(&turned, &reference, &mesh, usize::MAX);
        assert!((error.add_mm - 8.0_f64.sqrt()).abs() < 1e-9);
        assert!((error.rotation_rad - std::f64::consts::PI).abs() < 1e-6);
        assert!(plain(&moved, &reference, &mesh, 3).add_mm - 5.0 < 1e-12);
    }
}
