//! What of each object is seen: whole and visible masks, and the counts that BOP's `scene_gt_info` holds.

use glam::DVec2;

use super::{Mask, PixelRegion, RasterImage, RasterItem, rasterize};
use crate::math::Intrinsics;

/// Within this of the measured distance a surface counts as seen: BOP's tolerance for the noise of depth cameras.
pub const VISIBILITY_DELTA_MM: f64 = 15.0;

/// A depth map of the photo, and how far it may be trusted.
#[derive(Debug, Clone, Copy)]
pub struct MeasuredDepth<'a> {
    /// z in millimetres for each of the camera's pixels, row by row; 0 where nothing was measured.
    pub mm: &'a [f32],
    /// A surface that is farther behind the measured one than this, along the ray, is hidden.
    pub delta_mm: f64,
}

/// The pixels of one object in one photo.
#[derive(Debug, Clone, PartialEq)]
pub struct Silhouette {
    /// As if it were alone, within the photo.
    pub whole: Mask,
    /// The part that neither another object nor anything that the depth map knows hides.
    pub visible: Mask,
    /// How many pixels the silhouette has, with those up to one photo's width or height beyond the photo's edges.
    pub whole_count: usize,
    /// The box around those.
    pub whole_box: Option<PixelRegion>,
    /// How many pixels of `whole` have a depth: measured, or without a depth map all of them.
    pub valid_count: usize,
}

impl Silhouette {
    /// The visible part of the whole silhouette, 0 to 1.
    pub fn visible_fraction(&self) -> f64 {
        if self.whole_count == 0 { 0.0 } else { self.visible.count() as f64 / self.whole_count as f64 }
    }
}

/// The silhouettes of objects that are in one photo together, in the order of the items; their numbers play no part.
///
/// Between the objects the nearest surface is the one that is seen, exactly. Against the depth map the rule is BOP's
/// ("bop19"): seen is what is not more than the tolerance behind the measured surface, and whatever was not measured.
pub fn silhouettes(
    camera: &Intrinsics,
    items: &[RasterItem<'_>],
    depth: Option<MeasuredDepth<'_>>,
) -> Vec<Silhouette> {
    let numbered: Vec<RasterItem<'_>> =
        (1..).zip(items).map(|(id, item)| RasterItem { id, ..*item }).collect();
    let together = rasterize(camera, &numbered, PixelRegion::of_camera(camera));
    numbered.iter().map(|item| silhouette(camera, item, &together, depth)).collect()
}

fn silhouette(
    camera: &Intrinsics,
    item: &RasterItem<'_>,
    together: &RasterImage,
    depth: Option<MeasuredDepth<'_>>,
) -> Silhouette {
    let region = region_of(camera, item);
    let alone = rasterize(camera, &[*item], region).mask(item.id);
    let whole_box = alone.bounding_box().map(|found| PixelRegion {
        x0: found.x0 + region.x0,
        y0: found.y0 + region.y0,
        ..found
    });
    let in_alone = |x: u32, y: u32| {
        let (x, y) = (x as i32 - region.x0, y as i32 - region.y0);
        x >= 0 && y >= 0 && alone.get(x as u32, y as u32)
    };
    let (width, height) = (camera.width, camera.height);
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let whole = Mask::from_pixels(width, height, places.clone().map(|(x, y)| in_alone(x, y)));
    let is_visible = |(pixel, (x, y)): (usize, (u32, u32))| {
        together.ids[pixel] == item.id
            && depth.is_none_or(|depth| !is_hidden(camera, depth, pixel, [x, y], together.depth_mm[pixel]))
    };
    let visible = Mask::from_pixels(width, height, places.clone().enumerate().map(is_visible));
    let is_measured =
        |pixel: usize| depth.is_none_or(|depth| depth.mm.get(pixel).is_some_and(|depth_mm| *depth_mm > 0.0));
    let valid_count =
        places.enumerate().filter(|&(pixel, (x, y))| whole.get(x, y) && is_measured(pixel)).count();
    Silhouette { whole_count: alone.count(), whole_box, whole, visible, valid_count }
}

fn is_hidden(
    camera: &Intrinsics,
    depth: MeasuredDepth<'_>,
    pixel: usize,
    [x, y]: [u32; 2],
    surface_mm: f32,
) -> bool {
    let Some(&measured_mm) = depth.mm.get(pixel).filter(|measured| **measured > 0.0) else { return false };
    let behind_mm = f64::from(surface_mm) - f64::from(measured_mm);
    // The ray is no shorter than its z: most pixels are decided without its length.
    behind_mm > 0.0
        && behind_mm * camera.unproject(DVec2::new(f64::from(x), f64::from(y))).length() > depth.delta_mm
}

/// The photo with one more of its size on every side, cut down to where the item can be.
fn region_of(camera: &Intrinsics, item: &RasterItem<'_>) -> PixelRegion {
    let size = DVec2::new(f64::from(camera.width), f64::from(camera.height));
    let (mut min, mut max) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for position in item.mesh.positions_mm() {
        let point_camera_mm = item.camera_from_object.transform_point(position.as_dvec3());
        // Near the plane of the camera a triangle reaches anywhere between its corners.
        let pixel = camera.project(point_camera_mm).filter(|_| point_camera_mm.z >= crate::math::NEAR_MM);
        let Some(pixel) = pixel else {
            (min, max) = (-size, 2.0 * size);
            break;
        };
        (min, max) = (min.min(pixel), max.max(pixel));
    }
    let min = (min.floor() - 1.0).clamp(-size, 2.0 * size);
    let max = (max.ceil() + 2.0).clamp(min, 2.0 * size);
    let extent = max - min;
    PixelRegion { x0: min.x as i32, y0: min.y as i32, width: extent.x as u32, height: extent.y as u32 }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::math::Pose;
    use crate::mesh::test_shapes::cube;

    fn camera() -> Intrinsics {
        Intrinsics::pinhole(100.0, 100.0, 50.0, 40.0, 101, 81)
    }

    /// A cube from −1 to 1 whose front is 10 mm away: 20 pixels wide, its edges between pixels.
    fn at(x: f64, z: f64) -> Pose {
        Pose::from_translation(DVec3::new(x + 0.003, 0.003, z + 1.0))
    }

    #[test]
    fn the_nearer_object_hides_the_farther_one() {
        let mesh = cube();
        let items = [at(0.0, 10.0), at(0.0, 20.0)].map(|camera_from_object| RasterItem {
            mesh: &mesh,
            camera_from_object,
            id: 7,
        });
        let found = silhouettes(&camera(), &items, None);
        assert_eq!(found[0].visible, found[0].whole);
        assert_eq!((found[0].whole.count(), found[0].valid_count), (20 * 20, 400));
        assert_eq!((found[1].whole.count(), found[1].visible.count()), (10 * 10, 0));
        assert_eq!(found[1].visible_fraction(), 0.0);
        // The nearer one ends where the farther one has its middle.
        let half = [RasterItem { camera_from_object: at(-1.0, 10.0), ..items[0] }, items[1]];
        let found = silhouettes(&camera(), &half, None);
        assert_eq!((found[1].whole.count(), found[1].visible.count()), (100, 50));
        assert_eq!(found[1].visible_fraction(), 0.5);
    }

    #[test]
    fn the_depth_map_hides_what_is_behind_it() {
        let mesh = cube();
        let item = [RasterItem { mesh: &mesh, camera_from_object: at(0.0, 10.0), id: 1 }];
        let count = |depth_mm: f32, delta_mm: f64| {
            let depth = vec![depth_mm; 101 * 81];
            let found = &silhouettes(&camera(), &item, Some(MeasuredDepth { mm: &depth, delta_mm }))[0];
            (found.whole.count(), found.visible.count(), found.valid_count)
        };
        assert_eq!(count(0.0, 1.0), (400, 400, 0), "nothing was measured");
        assert_eq!(count(30.0, 1.0), (400, 400, 400), "the wall is behind it");
        assert_eq!(count(8.0, 1.0), (400, 0, 400), "something is before it");
        assert_eq!(count(8.0, 3.0), (400, 400, 400), "by less than the tolerance");
    }

    #[test]
    fn a_silhouette_goes_on_beyond_the_photo() {
        let mesh = cube();
        let item = [RasterItem { mesh: &mesh, camera_from_object: at(5.0, 10.0), id: 1 }];
        let [narrow, wide] =
            [101, 201].map(|width| silhouettes(&Intrinsics { width, ..camera() }, &item, None).remove(0));
        assert_eq!((narrow.whole_count, narrow.whole_box), (wide.whole_count, wide.whole_box));
        assert_eq!(wide.whole.count(), wide.whole_count);
        let around = narrow.whole_box.unwrap();
        assert_eq!(around.x0 + around.width as i32, 111, "the front's right edge is at 110.03");
        assert!(narrow.whole.count() < narrow.whole_count);
    }
}
