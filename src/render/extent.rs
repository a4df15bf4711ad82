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

/// How far a mesh's surface may be from where it is, in millimetres: not at all at rest, and while things move as far as
/// the eye does not follow.
pub fn tolerance_mm(picture: &Picture, item: &Item, pixels_per_photo_pixel: f64) -> f64 {
    const MOVING_TOLERANCE_PX: f64 = 4.0;
    if !picture.in_motion {
        return 0.0;
    }
    let sphere = sphere_eye(picture, item);
    let depth_mm = (sphere.center.z - sphere.radius).max(NEAR_MM);
    MOVING_TOLERANCE_PX * depth_mm / (picture.camera.focal_px() * pixels_per_photo_pixel)
}

/// The part of a view that its meshes are drawn for, in target pixels. The rest of the view has photo and background alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    pub corner: [u32; 2],
    pub size: [u32; 2],
}

impl Window {
    /// Windows are so many pixels larger than they need be at most, so that a moving object seldom needs other targets.
    const STEP_PX: u32 = 64;

    pub fn whole(size: [u32; 2]) -> Self {
        Self { corner: [0, 0], size }
    }

    /// A window around what a picture draws; of the size of the targets that are there, where those will do.
    pub fn around(picture: &Picture, target_size: [u32; 2], present: Option<[u32; 2]>) -> Self {
        let [min_x, min_y, max_x, max_y] = drawn_px(picture, target_size);
        // The cast saturates: what is left of the target begins at 0.
        let min = [min_x, min_y].map(|value| value.floor() as u32);
        let max = [max_x, max_y].map(|value| value.ceil() as u32);
        let needed = [0, 1].map(|axis| max[axis].min(target_size[axis]).saturating_sub(min[axis]));
        let rounded = [0, 1]
            .map(|axis| needed[axis].next_multiple_of(Self::STEP_PX).clamp(1, target_size[axis].max(1)));
        let area = |size: [u32; 2]| u64::from(size[0]) * u64::from(size[1]);
        let fits = |size: &[u32; 2]| {
            (0..2).all(|axis| (needed[axis]..=target_size[axis]).contains(&size[axis]))
                && area(*size) <= 3 * area(rounded).max(u64::from(Self::STEP_PX * Self::STEP_PX))
        };
        let size = present.filter(fits).unwrap_or(rounded);
        Self { corner: [0, 1].map(|axis| min[axis].min(target_size[axis] - size[axis])), size }
    }

    /// The part of the `image` frame that fills it.
    pub fn image_rect(&self, picture: &Picture, target_size: [u32; 2]) -> ImageRect {
        let rect = picture.rect;
        let scale = rect.size() / pixels(target_size);
        let min = rect.min + pixels(self.corner) * scale;
        ImageRect { min, max: min + pixels(self.size) * scale }
    }
}

fn pixels(size: [u32; 2]) -> DVec2 {
    DVec2::new(f64::from(size[0]), f64::from(size[1]))
}

/// Target pixels that meshes and outlines can be on: min x, min y, max x, max y. It is never too small.
fn drawn_px(picture: &Picture, size: [u32; 2]) -> [f32; 4] {
    let whole = [0.0, 0.0, size[0] as f32, size[1] as f32];
    // A lens bends a box's sides: then the whole target is searched.
    if !picture.camera.distortion.is_none() {
        return whole;
    }
    let items = picture.items.iter().filter(|_| picture.shows_meshes());
    let ghosts = picture.ghosts.iter().filter(|_| picture.shows_ghosts());
    let mut corners = Vec::new();
    for item in items.chain(ghosts) {
        for corner in bounds_eye(picture, item) {
            if corner.z < NEAR_MM {
                return whole;
            }
            corners.extend(picture.camera.project(corner));
        }
    }
    let Some(around) = ImageRect::around(corners) else { return [0.0; 4] };
    let margin_px = picture.widths.widest_px() + 1.0;
    let scale = pixels(size) / picture.rect.size();
    let min = ((around.min - picture.rect.min) * scale).as_vec2() - margin_px;
    let max = ((around.max - picture.rect.min) * scale).as_vec2() + margin_px;
    [min.x, min.y, max.x, max.y]
}

/// The corners of a mesh's bounds: in front of the eye, they project to around what the mesh projects to.
fn bounds_eye(picture: &Picture, item: &Item) -> impl Iterator<Item = DVec3> + use<> {
    let bounds = item.mesh().bounds();
    let eye_from_object = picture.eye_from_object(item);
    let side = move |bit: u32, corner: u32| if corner & bit == 0 { bounds.min } else { bounds.max };
    (0..8).map(move |corner| {
        let corner = DVec3::new(side(1, corner).x, side(2, corner).y, side(4, corner).z);
        eye_from_object.transform_point(corner)
    })
}
