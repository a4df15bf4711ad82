//! A rasteriser on the CPU: exact masks and depth maps, and the renderer's reference.
//!
//! It draws what the pinhole camera sees at the centres of whole pixels, without any lighting or anti-aliasing. It knows
//! nothing of the GPU and of scenes: meshes come with their pose and a number.

mod clip;
mod mask;
mod runs;
mod silhouette;
mod triangle;

use glam::Vec3;

use crate::math::{Intrinsics, Pose};
use crate::mesh::Mesh;

pub use mask::Mask;
pub use silhouette::{MeasuredDepth, Silhouette, VISIBILITY_DELTA_MM, silhouettes};
use triangle::ScreenVertex;

/// A mesh to be drawn.
#[derive(Debug, Clone, Copy)]
pub struct RasterItem<'a> {
    pub mesh: &'a Mesh,
    pub camera_from_object: Pose,
    /// What is written into [`RasterImage::ids`]: one or more, for zero is the background.
    pub id: u32,
}

/// A rectangle of whole pixels in the `image` frame. It may reach beyond the photo: the camera sees on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PixelRegion {
    pub x0: i32,
    pub y0: i32,
    pub width: u32,
    pub height: u32,
}

/// What the camera sees within a region, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct RasterImage {
    pub width: u32,
    pub height: u32,
    /// z in the camera frame, in millimetres; 0 where nothing is.
    pub depth_mm: Vec<f32>,
    /// The [`RasterItem::id`] of the nearest surface; 0 where nothing is.
    pub ids: Vec<u32>,
}

impl PixelRegion {
    /// All of the camera's image.
    pub fn of_camera(camera: &Intrinsics) -> Self {
        Self { x0: 0, y0: 0, width: camera.width, height: camera.height }
    }
}

/// Draws the items into one depth map. The nearest surface wins; of surfaces at the same depth, the one drawn first.
///
/// A pixel belongs to the triangle that its centre is in, and a centre on an edge that two triangles share to exactly one
/// of them (the top-left rule), so that meshes have neither gaps nor doubles. Both sides of a triangle are drawn. Vertices
/// are rounded to 1/4096 of a pixel. What is nearer than [`crate::math::NEAR_MM`] is cut off.
///
/// Distortion moves the vertices (as [`Intrinsics::project`] does) and edges stay straight between them, here as in the
/// renderer: a mesh much coarser than the bend of the lens is drawn a little off.
pub fn rasterize(camera: &Intrinsics, items: &[RasterItem<'_>], region: PixelRegion) -> RasterImage {
    let mut image = RasterImage::empty(region);
    for item in items {
        draw(camera, item.mesh, &item.camera_from_object, region, &mut image, |_| item.id);
    }
    image
}

/// One mesh by itself, with [`RasterImage::ids`] that tell its triangles apart: one plus the triangle's number.
pub fn rasterize_triangles(
    camera: &Intrinsics,
    mesh: &Mesh,
    camera_from_object: &Pose,
    region: PixelRegion,
) -> RasterImage {
    let mut image = RasterImage::empty(region);
    draw(camera, mesh, camera_from_object, region, &mut image, |triangle| triangle + 1);
    image
}

/// Draws the mesh over what is there; `id_of` gives what is written for a triangle.
fn draw(
    camera: &Intrinsics,
    mesh: &Mesh,
    camera_from_object: &Pose,
    region: PixelRegion,
    image: &mut RasterImage,
    id_of: impl Fn(u32) -> u32,
) {
    let projector = clip::Projector::new(camera, region);
    let in_camera_mm = |position: &Vec3| camera_from_object.transform_point(position.as_dvec3());
    let positions_mm = mesh.positions_mm();
    let projected: Vec<Option<ScreenVertex>> =
        positions_mm.iter().map(|position| projector.project(in_camera_mm(position))).collect();
    for (number, triangle) in (0..).zip(mesh.triangles()) {
        if let [Some(a), Some(b), Some(c)] = triangle.map(|vertex| projected[vertex as usize]) {
            triangle::fill(image, [a, b, c], id_of(number));
        } else {
            let corners = triangle.map(|vertex| in_camera_mm(&positions_mm[vertex as usize]));
            let [first, rest @ ..] = &projector.clip(corners)[..] else { continue };
            for pair in rest.windows(2) {
                triangle::fill(image, [*first, pair[0], pair[1]], id_of(number));
            }
        }
    }
}

impl RasterImage {
    /// Of a region in which nothing is.
    fn empty(region: PixelRegion) -> Self {
        let pixel_count = region.width as usize * region.height as usize;
        Self {
            width: region.width,
            height: region.height,
            depth_mm: vec![0.0; pixel_count],
            ids: vec![0; pixel_count],
        }
    }

    /// Where the item of this number is the nearest.
    pub fn mask(&self, id: u32) -> Mask {
        Mask::from_pixels(self.width, self.height, self.ids.iter().map(|&found| found == id))
    }
}

#[cfg(test)]
mod tests;
