//! Where an object starts.

use glam::DVec2;

use crate::math::{Intrinsics, Pose};
use crate::mesh::Mesh;

/// The start pose of an object that was just added: R = I, its bounding-box centre on the optical axis, at the distance where
/// its bounding sphere covers a third of the photo's height.
///
/// Where the principal point lies outside the photo, so would the object; the ray through the photo's middle is used then.
pub fn untouched_pose(camera: &Intrinsics, mesh: &Mesh) -> Pose {
    let sphere = mesh.sphere();
    // A sphere of radius r at distance d is seen as a circle of f·r/√(d² − r²) pixels.
    let circle_px = f64::from(camera.height) / 6.0;
    let tangent = circle_px / camera.fy;
    let radius = sphere.radius.max(1e-9);
    let distance = radius * (1.0 + 1.0 / (tangent * tangent)).sqrt();
    let principal_point = DVec2::new(camera.cx, camera.cy);
    let size = DVec2::new(f64::from(camera.width), f64::from(camera.height));
    let inside = principal_point.cmpge(DVec2::ZERO).all() && principal_point.cmplt(size).all();
    let pixel = if inside { principal_point } else { (size - 1.0) / 2.0 };
    let center_camera = camera.unproject(pixel) * distance;
    Pose::from_translation(center_camera - sphere.center)
}
