//! Where meshes are before the eye, by their bounding spheres: between which depths, and in which part of the target.

use glam::{DVec2, DVec3};

use super::{Item, Picture};
use crate::math::{BoundingSphere, ImageRect, NEAR_MM};

/// An item's bounding sphere in the eye's frame.
pub fn sphere_eye(picture: &Picture, item: &Item) -> BoundingSphere {
    let sphere = item.mesh().sphere();
    BoundingSphere { center: picture.eye_from_object(item).transform_point(sphere.center), ..sphere }
}

/// The nearest and the farthest depth of what is drawn; any will do where nothing is.
pub fn depth_range_mm(picture: &Picture) -> [f64; 2] {
    let spheres = picture.items.iter().map(|item| sphere_eye(picture, item));
    let range = spheres.fold([f64::INFINITY, f64::NEG_INFINITY], |[nearest, farthest], sphere| {
        [nearest.min(sphere.center.z - sphere.radius), farthest.max(sphere.center.z + sphere.radius)]
    });
    let [nearest, farthest] = range.map(|depth_mm| depth_mm.max(NEAR_MM));
    if nearest < farthest && farthest.is_finite() { [nearest, farthest] } else { [NEAR_MM, 2.0 * NEAR_MM] }
}

/// Target pixels that can hold an outline: min x, min y, max x, max y. It is never too small.
pub fn outlined_px(picture: &Picture, size: [u32; 2]) -> [f32; 4] {
    let whole = [0.0, 0.0, size[0] as f32, size[1] as f32];
    // A lens bends a box's sides: then the whole target is searched.
    if !picture.camera.distortion.is_none() {
        return whole;
    }
    let items = picture.items.iter().filter(|_| picture.outlines());
    let ghosts = picture.ghosts.iter().filter(|_| picture.shows_ghosts());
    let mut pixels = Vec::new();
    for item in items.chain(ghosts) {
        let sphere = sphere_eye(picture, item);
        if sphere.center.z - sphere.radius < NEAR_MM {
            return whole;
        }
        pixels.extend(box_corners(&sphere).filter_map(|corner| picture.camera.project(corner)));
    }
    let Some(around) = ImageRect::around(pixels) else { return [0.0; 4] };
    let widths = picture.widths;
    let margin_px = widths.outline_px.max(widths.selected_outline_px).max(widths.ghost_px) + 1.0;
    let scale = DVec2::new(f64::from(size[0]), f64::from(size[1])) / picture.rect.size();
    let min = ((around.min - picture.rect.min) * scale).as_vec2() - margin_px;
    let max = ((around.max - picture.rect.min) * scale).as_vec2() + margin_px;
    [min.x, min.y, max.x, max.y]
}

/// The corners of the box around a sphere: in front of the eye, they project to around what the sphere projects to.
fn box_corners(sphere: &BoundingSphere) -> impl Iterator<Item = DVec3> + use<> {
    let BoundingSphere { center, radius } = *sphere;
    let side = move |bit: u32, corner: u32| if corner & bit == 0 { -radius } else { radius };
    (0..8).map(move |corner| center + DVec3::new(side(1, corner), side(2, corner), side(4, corner)))
}
