//! Depth: along the view ray of a point that keeps its pixel.

use glam::DVec3;

use crate::math::{Intrinsics, NEAR_MM, Pose};
use crate::mesh::Mesh;

/// Brings an object nearer by so many pixels of silhouette width (negative: takes it farther away), along the view ray of
/// `anchor_camera_mm`, which therefore stays on its pixel.
///
/// The width is that of the bounding sphere, 2·f·r/z: a sphere's does not jump as an object's own does when it turns.
pub fn with_depth_changed(
    camera_from_object: &Pose,
    camera: &Intrinsics,
    mesh: &Mesh,
    anchor_camera_mm: DVec3,
    silhouette_px: f64,
) -> Pose {
    let sphere = mesh.sphere();
    let depth_mm = camera_from_object.transform_point(sphere.center).z;
    let width_px = 2.0 * camera.focal_px() * sphere.radius / depth_mm.max(NEAR_MM);
    // From width w to w + n; never to less than half or more than double in one step.
    let factor = (width_px / (width_px + silhouette_px).max(width_px / 2.0)).clamp(0.5, 2.0);
    let moved = camera_from_object.translated(anchor_camera_mm * (factor - 1.0));
    let nearest_mm = moved.transform_point(sphere.center).z - sphere.radius;
    // An object drawn through the camera could not be grabbed any more.
    if nearest_mm < NEAR_MM && silhouette_px > 0.0 { *camera_from_object } else { moved }
}
