//! Rays, for picking.

use glam::DVec3;

use super::Pose;

/// A half-line; `direction` has length one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    pub origin: DVec3,
    pub direction: DVec3,
}

impl Ray {
    /// The point `distance` away from the origin.
    pub fn at(&self, distance: f64) -> DVec3 {
        self.origin + self.direction * distance
    }

    /// The same ray, seen from frame `b`.
    pub fn transformed(&self, b_from_a: &Pose) -> Self {
        Self { origin: b_from_a.transform_point(self.origin), direction: b_from_a.rotation * self.direction }
    }
}
