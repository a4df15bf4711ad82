//! From the camera frame to the picture's grid: projection, and what has to be cut off before it.

use std::ops::Deref;

use glam::{DVec2, DVec3};

use super::PixelRegion;
use super::triangle::{GRID_PER_PIXEL, ScreenVertex};
use crate::math::{Intrinsics, NEAR_MM};

/// Triangles are cut off this far from the region's first pixel: beyond the largest photo, and near enough for exact
/// integers.
const GUARD_PX: f64 = 65_536.0;
/// No vertex is farther than this. A cut without distortion stays within [`GUARD_PX`]; only a wild polynomial leads out,
/// and there is nothing to be seen there.
const LARGEST_PX: f64 = 2.0 * GUARD_PX;

/// Brings points of the camera frame onto the grid of a region.
pub(super) struct Projector<'a> {
    camera: &'a Intrinsics,
    origin_px: DVec2,
    /// The signed distance of a point to each plane is its dot product with these (x, y, z), plus the last number.
    planes: [(DVec3, f64); 5],
}

impl<'a> Projector<'a> {
    pub fn new(camera: &'a Intrinsics, region: PixelRegion) -> Self {
        let origin_px = DVec2::new(f64::from(region.x0), f64::from(region.y0));
        // x and y of the picture, times z.
        let x = DVec3::new(camera.fx, camera.skew, camera.cx - origin_px.x);
        let y = DVec3::new(0.0, camera.fy, camera.cy - origin_px.y);
        let guard = DVec3::Z * GUARD_PX;
        let planes =
            [(DVec3::Z, -NEAR_MM), (guard - x, 0.0), (guard + x, 0.0), (guard - y, 0.0), (guard + y, 0.0)];
        Self { camera, origin_px, planes }
    }

    /// The point on the grid; `None` where a triangle with this corner has to be clipped.
    pub fn project(&self, point_camera_mm: DVec3) -> Option<ScreenVertex> {
        if point_camera_mm.z < NEAR_MM {
            return None;
        }
        let pixel = self.camera.project(point_camera_mm)? - self.origin_px;
        (pixel.abs().max_element() <= GUARD_PX).then(|| on_grid(pixel, point_camera_mm.z))
    }

    /// The part of a triangle that can be drawn, a convex polygon. (Sutherland and Hodgman, *Reentrant polygon clipping*,
    /// 1974.)
    pub fn clip(&self, corners: [DVec3; 3]) -> Polygon<ScreenVertex> {
        let mut polygon = Polygon::new(DVec3::ZERO);
        for corner in corners {
            polygon.push(corner);
        }
        for (normal, offset) in self.planes {
            polygon = clip_to_plane(&polygon, |point| normal.dot(point) + offset);
        }
        let mut projected = Polygon::new(ScreenVertex::default());
        for &point in polygon.iter() {
            let Some(pixel) = self.camera.project(point) else { continue };
            let pixel = (pixel - self.origin_px).clamp(DVec2::splat(-LARGEST_PX), DVec2::splat(LARGEST_PX));
            projected.push(on_grid(pixel, point.z));
        }
        projected
    }
}

fn on_grid(pixel: DVec2, depth_mm: f64) -> ScreenVertex {
    let grid = (pixel * GRID_PER_PIXEL as f64).round();
    ScreenVertex { x: grid.x as i32, y: grid.y as i32, inverse_depth: 1.0 / depth_mm }
}

fn clip_to_plane(polygon: &Polygon<DVec3>, distance: impl Fn(DVec3) -> f64) -> Polygon<DVec3> {
    let mut clipped = Polygon::new(DVec3::ZERO);
    let Some(&last) = polygon.last() else { return clipped };
    let mut previous = (last, distance(last));
    for &point in polygon.iter() {
        let current = (point, distance(point));
        match (previous.1 >= 0.0, current.1 >= 0.0) {
            (true, false) => clipped.push(crossing(previous, current)),
            (false, true) => clipped.push(crossing(current, previous)),
            _ => {}
        }
        if current.1 >= 0.0 {
            clipped.push(point);
        }
        previous = current;
    }
    clipped
}

/// Where an edge meets the plane. Always reckoned from its inner end, so that the two triangles at an edge get the same
/// point to the last bit.
fn crossing(inside: (DVec3, f64), outside: (DVec3, f64)) -> DVec3 {
    inside.0 + (outside.0 - inside.0) * (inside.1 / (inside.1 - outside.1))
}

/// A triangle cut by five planes has at most eight corners: no allocation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Polygon<T> {
    corners: [T; 8],
    count: usize,
}

impl<T: Copy> Polygon<T> {
    fn new(filler: T) -> Self {
        Self { corners: [filler; 8], count: 0 }
    }

    fn push(&mut self, corner: T) {
        // Rounding may in theory cut off a corner twice; losing a ninth one is harmless.
        if let Some(slot) = self.corners.get_mut(self.count) {
            *slot = corner;
            self.count += 1;
        }
    }
}

impl<T> Deref for Polygon<T> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        &self.corners[..self.count]
    }
}
