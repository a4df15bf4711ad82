//! The errors that are cheap enough to be shown while a pose is dragged.

use crate::math::Pose;
use crate::mesh::Mesh;

/// Live numbers average over no more vertices than this; results that are kept use all.
pub const LIVE_VERTICES: usize = 20_000;

/// The errors of an estimated pose against a reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseError {
    pub rotation_rad: f64,
    pub translation_mm: f64,
    /// ADD: the mean distance of the model's vertices under the two poses.
    pub add_mm: f64,
}

impl PoseError {
    /// ADD averages over at most `max_vertices` vertices, evenly through the mesh's list; all of them if it has no more.
    pub fn between(estimate: &Pose, reference: &Pose, mesh: &Mesh, max_vertices: usize) -> Self {
        Self {
            rotation_rad: estimate.angle_to(reference),
            translation_mm: estimate.translation_mm.distance(reference.translation_mm),
            add_mm: add_mm(estimate, reference, mesh, max_vertices),
        }
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
    use glam::DVec3;

    use super::*;
    use crate::mesh::test_shapes;

    #[test]
    fn errors_of_known_motions() {
        let mesh = test_shapes::cube();
        let reference = Pose::exp(DVec3::new(0.1, 0.2, 0.3), DVec3::new(5.0, 6.0, 700.0));
        let none = PoseError::between(&reference, &reference, &mesh, usize::MAX);
        assert_eq!((none.rotation_rad, none.translation_mm, none.add_mm), (0.0, 0.0, 0.0));
        let moved = reference.translated(DVec3::new(0.0, 3.0, 4.0));
        let error = PoseError::between(&moved, &reference, &mesh, usize::MAX);
        assert!((error.add_mm - 5.0).abs() < 1e-12 && (error.translation_mm - 5.0).abs() < 1e-12);
        // Half a turn about z takes each corner of the cube from −1 to 1 across a diagonal of 2√2.
        let turned = reference * Pose::exp(DVec3::Z * std::f64::consts::PI, DVec3::ZERO);
        let error = PoseError::between(&turned, &reference, &mesh, usize::MAX);
        assert!((error.add_mm - 8.0_f64.sqrt()).abs() < 1e-9);
        assert!((error.rotation_rad - std::f64::consts::PI).abs() < 1e-6);
        assert!(PoseError::between(&moved, &reference, &mesh, 3).add_mm - 5.0 < 1e-12);
    }
}
