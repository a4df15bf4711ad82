//! A pose beside the true one, as pictures: photo, annotation in lime, truth in magenta, and where the two silhouettes differ.

use crate::math::{Intrinsics, Pose};
use crate::mesh::Mesh;
use crate::photo::Pixels;
use crate::raster::{Mask, PixelRegion, RasterItem, rasterize};
use crate::scene::{Rgb, object_color, reference_color};

/// How much of the photo an object's colour covers.
const COVER: f64 = 0.5;
/// And where the silhouettes differ.
const COVER_XOR: f64 = 0.9;
/// Free room around the object, as a part of its box.
const MARGIN: f64 = 0.35;

/// Photo, annotation, truth and difference, all of one part of the photo and at most `most_width` pixels wide. `poses` are
/// the annotated and the true `camera_from_object`. `None` where the photo is of another size than its camera.
pub fn comparison(
    photo: &Pixels,
    camera: &Intrinsics,
    mesh: &Mesh,
    poses: [&Pose; 2],
    most_width: u32,
) -> Option<[Pixels; 4]> {
    if (photo.width, photo.height) != (camera.width, camera.height) {
        return None;
    }
    let [annotated, truth] = poses.map(|pose| silhouette(camera, mesh, pose));
    let region = region_around(photo, &[&annotated, &truth]);
    let (lime, magenta) = (object_color(0), reference_color());
    let color = |picture: usize, x: u32, y: u32| {
        let (is_annotated, is_true) = (annotated.get(x, y), truth.get(x, y));
        match (picture, is_annotated, is_true) {
            (1, true, _) => Some((lime, COVER)),
            (2, _, true) => Some((magenta, COVER)),
            (3, true, false) => Some((lime, COVER_XOR)),
            (3, false, true) => Some((magenta, COVER_XOR)),
            (3, true, true) => Some((Rgb([255, 255, 255]), COVER)),
            _ => None,
        }
    };
    let drawn = |picture: usize| cut(photo, region, most_width, &|x, y| color(picture, x, y));
    Some([drawn(0)?, drawn(1)?, drawn(2)?, drawn(3)?])
}

fn silhouette(camera: &Intrinsics, mesh: &Mesh, camera_from_object: &Pose) -> Mask {
    let item = RasterItem { mesh, camera_from_object: *camera_from_object, id: 1 };
    rasterize(camera, &[item], PixelRegion::of_camera(camera)).mask(1)
}

/// A part of the photo in its own proportions around the masks; all of it where they are empty.
fn region_around(photo: &Pixels, masks: &[&Mask]) -> PixelRegion {
    let whole = PixelRegion { x0: 0, y0: 0, width: photo.width, height: photo.height };
    let boxes: Vec<PixelRegion> = masks.iter().filter_map(|mask| mask.bounding_box()).collect();
    let Some(first) = boxes.first() else { return whole };
    let (mut low, mut high) = ([first.x0, first.y0], [first.x0, first.y0]);
    for found in &boxes {
        low = [low[0].min(found.x0), low[1].min(found.y0)];
        high = [high[0].max(found.x0 + found.width as i32), high[1].max(found.y0 + found.height as i32)];
    }
    let part = [0, 1].map(|axis| {
        let side = f64::from(if axis == 0 { photo.width } else { photo.height });
        f64::from(high[axis] - low[axis]) * (1.0 + 2.0 * MARGIN) / side
    });
    let part = part[0].max(part[1]).min(1.0);
    let side = |whole: u32| ((f64::from(whole) * part).round() as u32).clamp(1, whole);
    let (width, height) = (side(photo.width), side(photo.height));
    let start = |axis: usize, side: u32, whole: u32| {
        ((low[axis] + high[axis] - side as i32) / 2).clamp(0, (whole - side) as i32)
    };
    PixelRegion { x0: start(0, width, photo.width), y0: start(1, height, photo.height), width, height }
}

/// The region of the photo with a colour over it, scaled to the size of a picture: pixels of it are the means of the photo's
/// beneath them.
fn cut(
    photo: &Pixels,
    region: PixelRegion,
    most_width: u32,
    color: &dyn Fn(u32, u32) -> Option<(Rgb, f64)>,
) -> Option<Pixels> {
    let width = region.width.clamp(1, most_width);
    let height = (u64::from(width) * u64::from(region.height)).div_ceil(u64::from(region.width.max(1)));
    let height = u32::try_from(height).ok()?.clamp(1, 4 * most_width);
    let mut rgba = Vec::with_capacity(4 * width as usize * height as usize);
    for y in 0..height {
        for x in 0..width {
            let pixel = mean_pixel(photo, region, [x, y], [width, height], color)?;
            rgba.extend(pixel);
        }
    }
    Some(Pixels { width, height, rgba })
}

fn mean_pixel(
    photo: &Pixels,
    region: PixelRegion,
    place: [u32; 2],
    size: [u32; 2],
    color: &dyn Fn(u32, u32) -> Option<(Rgb, f64)>,
) -> Option<[u8; 4]> {
    // The photo's pixels from the place's start to its end, one at least.
    let span = |at: u32, of: u32, length: u32, start: i32| {
        let first = u64::from(at) * u64::from(length) / u64::from(of);
        let last = (u64::from(at + 1) * u64::from(length)).div_ceil(u64::from(of));
        let start = start.unsigned_abs();
        start + first as u32..start + (last.max(first + 1) as u32).min(length)
    };
    let mut sum = [0.0; 3];
    let mut count = 0.0;
    for y in span(place[1], size[1], region.height, region.y0) {
        for x in span(place[0], size[0], region.width, region.x0) {
            let at = 4 * (y as usize * photo.width as usize + x as usize);
            let own = photo.rgba.get(at..at + 3)?;
            let over = color(x, y);
            for (channel, total) in sum.iter_mut().enumerate() {
                let own = f64::from(own[channel]);
                *total +=
                    over.map_or(own, |(Rgb(over), cover)| own + (f64::from(over[channel]) - own) * cover);
            }
            count += 1.0;
        }
    }
    let [r, g, b] = sum.map(|total| (total / f64::max(count, 1.0)).round() as u8);
    Some([r, g, b, 255])
}
