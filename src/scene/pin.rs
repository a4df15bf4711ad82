//! A correspondence between an object and a photo.

use glam::{DMat4, DVec2, DVec3};

/// A point on an object's surface and the pixel where it belongs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pin {
    /// In the `object` frame, in millimetres.
    pub point_mm: DVec3,
    /// In the `image` frame.
    pub pixel: DVec2,
    /// How much it counts; 1 for a click like any other.
    pub weight: f64,
    /// A pin that is switched off keeps its residual but does not pull.
    pub enabled: bool,
}

impl Pin {
    /// A pin that counts.
    pub fn new(point_mm: DVec3, pixel: DVec2) -> Self {
        Self { point_mm, pixel, weight: 1.0, enabled: true }
    }

    pub fn counts(&self) -> bool {
        self.enabled && self.weight > 0.0
    }

    /// The same point after the mesh was mirrored or spaced.
    pub fn of_transformed(&self, new_from_old: &DMat4) -> Self {
        Self { point_mm: new_from_old.transform_point3(self.point_mm), ..*self }
    }
}
