//! One ray against boxes and triangles.
//!
//! Triangles are met by Woop's test (Woop, Benthin, Wald, *Watertight Ray/Triangle Intersection*, 2013), so that no ray slips
//! through a shared edge.

use glam::{DVec3, Vec3};

use crate::math::Ray;

/// Where a ray meets a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayHit {
    pub distance_mm: f64,
    pub triangle: u32,
    /// On the surface, in the frame of the mesh.
    pub point: DVec3,
    /// The weights of the triangle's corners at `point`; they sum to one.
    pub barycentric: DVec3,
}

impl RayHit {
    /// Whether this hit goes before that one: by distance, then by the triangle's number.
    pub(super) fn is_nearer_than(&self, other: Option<&Self>) -> bool {
        other.is_none_or(|other| (self.distance_mm, self.triangle) < (other.distance_mm, other.triangle))
    }
}

/// A ray, prepared for many tests.
pub(super) struct RayCaster<'a> {
    ray: &'a Ray,
    inverse_direction: DVec3,
    /// The axes so permuted that the ray runs mostly along the last.
    axes: [usize; 3],
    /// What takes the ray onto that axis.
    shear: DVec3,
}

impl<'a> RayCaster<'a> {
    pub fn new(ray: &'a Ray) -> Self {
        let main_axis = ray.direction.abs().max_position();
        let axes = [(main_axis + 1) % 3, (main_axis + 2) % 3, main_axis];
        let [x, y, z] = axes.map(|axis| ray.direction[axis]);
        Self { ray, inverse_direction: ray.direction.recip(), axes, shear: DVec3::new(x / z, y / z, 1.0 / z) }
    }

    /// The distance at which the ray enters the box, zero from inside.
    pub fn box_entry(&self, min: Vec3, max: Vec3) -> Option<f64> {
        let (mut entry, mut exit) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let to_min = f64::from(min[axis]) - self.ray.origin[axis];
            let to_max = f64::from(max[axis]) - self.ray.origin[axis];
            if self.ray.direction[axis] == 0.0 {
                // Parallel to these sides: 0 × ∞ would be no number.
                if to_min > 0.0 || to_max < 0.0 {
                    return None;
                }
                continue;
            }
            let [to_min, to_max] = [to_min, to_max].map(|offset| offset * self.inverse_direction[axis]);
            entry = entry.max(to_min.min(to_max));
            exit = exit.min(to_min.max(to_max));
        }
        // A few roundings of either distance must not lose a triangle that lies in the box's side.
        (entry <= exit * (1.0 + 1e-12) + f64::MIN_POSITIVE).then_some(entry * (1.0 - 1e-12))
    }

    /// Where the ray meets the triangle, from either side.
    pub fn hit(&self, corners: [DVec3; 3], triangle: u32) -> Option<RayHit> {
        let [a, b, c] = corners.map(|corner| {
            let offset = corner - self.ray.origin;
            let [x, y, z] = self.axes.map(|axis| offset[axis]);
            DVec3::new(x - self.shear.x * z, y - self.shear.y * z, self.shear.z * z)
        });
        let weights = DVec3::new(c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x);
        if weights.min_element() < 0.0 && weights.max_element() > 0.0 {
            return None;
        }
        let barycentric = weights / weights.element_sum();
        let distance_mm = barycentric.dot(DVec3::new(a.z, b.z, c.z));
        if !(distance_mm >= 0.0 && distance_mm.is_finite()) {
            return None;
        }
        let [a, b, c] = corners;
        let point = a * barycentric.x + b * barycentric.y + c * barycentric.z;
        Some(RayHit { distance_mm, triangle, point, barycentric })
    }
}
