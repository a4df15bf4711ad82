//! An eye that looks at the scene: the photo's own camera, or a free one.

use glam::{DVec2, DVec3};

use super::drag::Grab;
use crate::math::{Intrinsics, Pose, Ray};
use crate::mesh::Mesh;
use crate::session::with_depth_changed;

/// From the frame of the photo's camera to physical pixels of a viewport, and back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Eye {
    /// Of the eye itself; its `image` frame is not the photo's where the eye is a free one.
    pub camera: Intrinsics,
    pub eye_from_camera: Pose,
    /// Viewport pixels per pixel of the eye's image.
    pub zoom: f64,
    /// Where the eye's pixel (0, 0) is in the viewport.
    pub origin_px: DVec2,
}

impl Eye {
    pub fn image_from_viewport(&self, viewport_pixel: DVec2) -> DVec2 {
        (viewport_pixel - self.origin_px) / self.zoom
    }

    pub fn viewport_from_image(&self, image_pixel: DVec2) -> DVec2 {
        image_pixel * self.zoom + self.origin_px
    }

    /// Where a point of the camera frame is seen; `None` behind the eye.
    pub fn project(&self, point_camera_mm: DVec3) -> Option<DVec2> {
        let pixel = self.camera.project(self.eye_from_camera.transform_point(point_camera_mm))?;
        Some(self.viewport_from_image(pixel))
    }

    /// The view ray of a viewport pixel, in the camera frame.
    pub fn ray(&self, viewport_pixel: DVec2) -> Ray {
        let ray_eye = self.camera.ray(self.image_from_viewport(viewport_pixel));
        ray_eye.transformed(&self.eye_from_camera.inverse())
    }

    /// A direction of the eye's frame in the camera's.
    pub fn camera_from_eye_direction(&self, direction_eye: DVec3) -> DVec3 {
        self.eye_from_camera.rotation.transpose() * direction_eye
    }

    /// How many millimetres are one viewport pixel at a point; `None` behind the eye.
    pub fn mm_per_px(&self, point_camera_mm: DVec3) -> Option<f64> {
        let depth_mm = self.eye_from_camera.transform_point(point_camera_mm).z;
        (depth_mm > 0.0).then(|| depth_mm / (self.camera.focal_px() * self.zoom))
    }

    /// Moves a grabbed object so that the grabbed point is seen at `image_pixel`, as far before the eye as it was.
    pub fn moved_to(&self, grab: &Grab, image_pixel: DVec2) -> Pose {
        let grabbed_eye = self.eye_from_camera.transform_point(grab.point_camera_mm);
        let target_eye = self.camera.unproject(image_pixel) * grabbed_eye.z;
        grab.start.translated(self.camera_from_eye_direction(target_eye - grabbed_eye))
    }

    /// Brings an object nearer to the eye, by pixels of silhouette width, along the view ray of a point.
    pub fn depth_changed(
        &self,
        camera_from_object: &Pose,
        mesh: &Mesh,
        anchor_camera_mm: DVec3,
        silhouette_px: f64,
    ) -> Pose {
        let eye_from_object = self.eye_from_camera * *camera_from_object;
        let anchor_eye = self.eye_from_camera.transform_point(anchor_camera_mm);
        let moved = with_depth_changed(&eye_from_object, &self.camera, mesh, anchor_eye, silhouette_px);
        let offset_eye = moved.translation_mm - eye_from_object.translation_mm;
        camera_from_object.translated(self.camera_from_eye_direction(offset_eye))
    }
}
