//! The point of a surface that is nearest to a place.

use glam::{DVec3, Vec3};

/// A point of a mesh's surface, seen from a place beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// In the frame of the mesh.
    pub point: DVec3,
    pub triangle: u32,
    pub distance_mm: f64,
}

/// No point of the box is nearer than this, squared.
pub(super) fn box_distance_squared(min: Vec3, max: Vec3, place: DVec3) -> f64 {
    place.clamp(min.as_dvec3(), max.as_dvec3()).distance_squared(place)
}

/// The nearest point of a triangle, which may be a line or a point.
pub(super) fn on_triangle([a, b, c]: [DVec3; 3], place: DVec3) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let is_left_of = |from: DVec3, to: DVec3| (to - from).cross(place - from).dot(normal) >= 0.0;
    if normal != DVec3::ZERO && is_left_of(a, b) && is_left_of(b, c) && is_left_of(c, a) {
        return place - normal * (normal.dot(place - a) / normal.length_squared());
    }
    let on_sides = [(a, b), (b, c), (c, a)].map(|(from, to)| on_segment(from, to, place));
    let [first, second, third] = on_sides;
    let nearer =
        |p: DVec3, q: DVec3| if q.distance_squared(place) < p.distance_squared(place) { q } else { p };
    nearer(nearer(first, second), third)
}

fn on_segment(from: DVec3, to: DVec3, place: DVec3) -> DVec3 {
    let along = to - from;
    let length_squared = along.length_squared();
    if length_squared == 0.0 {
        return from;
    }
    from + along * (along.dot(place - from) / length_squared).clamp(0.0, 1.0)
}
