//! Errors that are means or maxima over a mesh's vertices.
//!
//! All of them take every vertex of the mesh, also those that no triangle names, as others' tools do.

use glam::{DMat3, DVec2, DVec3, Vec3};

use super::quick::add_mm;
use crate::math::{Intrinsics, Pose};
use crate::mesh::{Mesh, PointTree};

/// ADI, also called ADD-S: the mean distance from each vertex in the reference pose to the nearest vertex in the estimated
/// one. `tree` is of the mesh's vertices in the `object` frame. (Hinterstoisser et al., 2012.)
pub fn adi_mm(estimate: &Pose, reference: &Pose, mesh: &Mesh, tree: &PointTree) -> f64 {
    let positions = mesh.positions_mm();
    let estimated_from_reference = estimate.inverse() * *reference;
    let distance = |position: &Vec3| {
        let position = position.as_dvec3();
        let nearest = tree.nearest(estimated_from_reference.transform_point(position));
        let nearest = positions.get(nearest).map_or(position, |nearest| nearest.as_dvec3());
        // In the `camera` frame, where equal poses give exactly nothing.
        reference.transform_point(position).distance(estimate.transform_point(nearest))
    };
    positions.iter().map(distance).sum::<f64>() / positions.len().max(1) as f64
}

/// AD: ADI for a symmetric object, ADD for any other.
pub fn ad_mm(estimate: &Pose, reference: &Pose, mesh: &Mesh, tree: &PointTree, is_symmetric: bool) -> f64 {
    if is_symmetric {
        adi_mm(estimate, reference, mesh, tree)
    } else {
        add_mm(estimate, reference, mesh, usize::MAX)
    }
}

/// MSSD: the largest distance of equal vertices, at the symmetry where it is smallest. `symmetries` are
/// `object_from_object` and hold the identity; without any the error is infinite.
pub fn mssd_mm(estimate: &Pose, reference: &Pose, mesh: &Mesh, symmetries: &[Pose]) -> f64 {
    let positions = mesh.positions_mm();
    let difference = |symmetry: &Pose| -> (DMat3, DVec3) {
        let reference = *reference * *symmetry;
        (estimate.rotation - reference.rotation, estimate.translation_mm - reference.translation_mm)
    };
    smallest_maximum(positions.len(), symmetries.iter().map(difference), |(rotation, translation), vertex| {
        (*rotation * positions[vertex].as_dvec3() + *translation).length_squared()
    })
    .sqrt()
}

/// MSPD: the largest distance in the picture of equal vertices, at the symmetry where it is smallest, times 640 over the
/// picture's width. `None` where a vertex is not in front of the camera in one of the two poses.
pub fn mspd_px(
    estimate: &Pose,
    reference: &Pose,
    mesh: &Mesh,
    symmetries: &[Pose],
    camera: &Intrinsics,
) -> Option<f64> {
    const WIDTH_OF_THE_UNIT_PX: f64 = 640.0;
    let positions = mesh.positions_mm();
    let estimated = projected(camera, estimate, mesh)?;
    let in_front = |reference: &Pose| {
        positions.iter().all(|position| reference.transform_point(position.as_dvec3()).z > 0.0)
    };
    let references = symmetries.iter().map(|symmetry| *reference * *symmetry).filter(in_front);
    let largest = smallest_maximum(positions.len(), references, |reference, vertex| {
        let point_camera_mm = reference.transform_point(positions[vertex].as_dvec3());
        let pixel = camera.project(point_camera_mm).unwrap_or(DVec2::INFINITY);
        pixel.distance_squared(estimated[vertex])
    })
    .sqrt();
    largest.is_finite().then(|| largest * WIDTH_OF_THE_UNIT_PX / f64::from(camera.width))
}

/// The mean distance in the picture of equal vertices. `None` where one is not in front of the camera in one of the two
/// poses. (Brachmann et al., 2016.)
pub fn projection_error_px(
    estimate: &Pose,
    reference: &Pose,
    mesh: &Mesh,
    camera: &Intrinsics,
) -> Option<f64> {
    let estimated = projected(camera, estimate, mesh)?;
    let expected = projected(camera, reference, mesh)?;
    let sum: f64 = estimated.iter().zip(&expected).map(|(a, b)| a.distance(*b)).sum();
    Some(sum / estimated.len().max(1) as f64)
}

fn projected(camera: &Intrinsics, camera_from_object: &Pose, mesh: &Mesh) -> Option<Vec<DVec2>> {
    let project = |position: &Vec3| camera.project(camera_from_object.transform_point(position.as_dvec3()));
    mesh.positions_mm().iter().map(project).collect()
}

/// The smallest of the candidates' largest errors over all vertices.
///
/// A candidate is given up at the first vertex that is worse than the best candidate's worst. Each one starts with the
/// vertex that decided about the one before: neighbouring symmetries have the same worst vertex.
fn smallest_maximum<T>(
    vertices: usize,
    candidates: impl Iterator<Item = T>,
    error: impl Fn(&T, usize) -> f64,
) -> f64 {
    let mut best = f64::INFINITY;
    let mut decided_by = 0;
    for candidate in candidates {
        let mut largest = 0.0;
        let mut at = decided_by;
        for vertex in std::iter::once(decided_by).chain(0..vertices) {
            let error = error(&candidate, vertex);
            if error > largest {
                (largest, at) = (error, vertex);
                if largest >= best {
                    break;
                }
            }
        }
        decided_by = at;
        best = best.min(largest);
    }
    best
}
