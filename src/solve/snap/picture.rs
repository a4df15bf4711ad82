//! The part of a photo that a snap looks at, at the size at which it looks.

use glam::DVec2;

use crate::math::{ImageRect, Intrinsics};
use crate::photo::{Pixels, half_size};

/// A cut-out of the photo, with the camera that sees just that.
#[derive(Debug, Clone)]
pub struct Picture {
    pub camera: Intrinsics,
    pub width: usize,
    pub height: usize,
    /// Colours in sRGB, 0 to 1, row by row.
    colors: Vec<[f32; 3]>,
    /// The photo's pixel that the cut-out begins with.
    origin: DVec2,
    /// How many pixels of the photo one pixel here is wide.
    pub photo_px: f64,
}

/// Objects larger than this are looked at in a smaller copy of the photo: more pixels cost time and tell no more.
const LARGEST_OBJECT_PX: f64 = 300.0;

impl Picture {
    /// The part of the photo around `object`, a rectangle in its pixels, with room for errors about it. `None` where nothing
    /// of that is in the photo.
    pub fn new(photo: &Pixels, camera: &Intrinsics, object: &ImageRect) -> Option<Self> {
        let size_px = object.size().max_element();
        let margin = DVec2::splat(0.5 * size_px + 25.0);
        let photo_rect = ImageRect::of_photo(photo.width, photo.height);
        let (min, max) =
            ((object.min - margin).max(photo_rect.min), (object.max + margin).min(photo_rect.max));
        if (max - min).min_element() < 8.0 || !min.is_finite() || !max.is_finite() {
            return None;
        }
        let mut cut = cut_out(photo, min, max);
        let mut camera = Intrinsics {
            cx: camera.cx - cut.1.x,
            cy: camera.cy - cut.1.y,
            width: cut.0.width,
            height: cut.0.height,
            ..*camera
        };
        let mut photo_px = 1.0;
        while size_px / photo_px > LARGEST_OBJECT_PX && cut.0.width.min(cut.0.height) > 32 {
            cut.0 = half_size(&cut.0);
            // An odd last row or column was left out by the halving, so the camera is halved by itself, not by the sizes.
            camera = Intrinsics {
                fx: camera.fx / 2.0,
                fy: camera.fy / 2.0,
                skew: camera.skew / 2.0,
                cx: (camera.cx + 0.5) / 2.0 - 0.5,
                cy: (camera.cy + 0.5) / 2.0 - 0.5,
                width: cut.0.width,
                height: cut.0.height,
                ..camera
            };
            photo_px *= 2.0;
        }
        let colors = cut
            .0
            .rgba
            .chunks_exact(4)
            .map(|p| [p[0], p[1], p[2]].map(|value| f32::from(value) / 255.0))
            .collect();
        Some(Self {
            camera,
            width: cut.0.width as usize,
            height: cut.0.height as usize,
            colors,
            origin: cut.1,
            photo_px,
        })
    }

    /// Where a pixel of the photo is here.
    pub fn place_of(&self, photo_pixel: DVec2) -> DVec2 {
        (photo_pixel - self.origin + 0.5) / self.photo_px - 0.5
    }

    pub fn colors(&self) -> &[[f32; 3]] {
        &self.colors
    }

    /// The number of the pixel nearest to a place; `None` outside.
    pub fn index(&self, pixel: DVec2) -> Option<usize> {
        let (x, y) = (pixel.x.round(), pixel.y.round());
        let is_inside = x >= 0.0 && y >= 0.0 && x < self.width as f64 && y < self.height as f64;
        is_inside.then(|| y as usize * self.width + x as usize)
    }

    /// The colour between four pixels; `None` outside of their centres.
    pub fn color(&self, pixel: DVec2) -> Option<[f32; 3]> {
        let corner = pixel.floor();
        let is_inside = corner.x >= 0.0
            && corner.y >= 0.0
            && corner.x + 1.0 < self.width as f64
            && corner.y + 1.0 < self.height as f64;
        if !is_inside {
            return None;
        }
        let [right, down] = (pixel - corner).to_array().map(|part| part as f32);
        let first = corner.y as usize * self.width + corner.x as usize;
        let [a, b] = [self.colors[first], self.colors[first + 1]];
        let [c, d] = [self.colors[first + self.width], self.colors[first + self.width + 1]];
        Some(std::array::from_fn(|k| {
            let above = a[k] + (b[k] - a[k]) * right;
            let below = c[k] + (d[k] - c[k]) * right;
            above + (below - above) * down
        }))
    }
}

/// Whole pixels between two places, and the first of them.
fn cut_out(photo: &Pixels, min: DVec2, max: DVec2) -> (Pixels, DVec2) {
    let clamped = |place: f64, size: u32| place.round().clamp(0.0, f64::from(size - 1)) as usize;
    let (x0, x1) = (clamped(min.x, photo.width), clamped(max.x, photo.width));
    let (y0, y1) = (clamped(min.y, photo.height), clamped(max.y, photo.height));
    let row = |y: usize| {
        let start = (y * photo.width as usize + x0) * 4;
        &photo.rgba[start..start + (x1 - x0 + 1) * 4]
    };
    let rgba = (y0..=y1).flat_map(row).copied().collect();
    let pixels = Pixels { width: (x1 - x0 + 1) as u32, height: (y1 - y0 + 1) as u32, rgba };
    (pixels, DVec2::new(x0 as f64, y0 as f64))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// Red counts columns, green rows.
    fn ramp(width: u32, height: u32) -> Pixels {
        let rgba =
            (0..height).flat_map(|y| (0..width).flat_map(move |x| [x as u8, y as u8, 0, 255])).collect();
        Pixels { width, height, rgba }
    }

    #[test]
    fn a_point_keeps_its_place_in_the_cut_out() {
        let camera = Intrinsics::from_focal(200.0, 250, 200);
        for (size, factor) in [(80.0, 1.0), (700.0, 4.0)] {
            let rect = ImageRect { min: DVec2::splat(60.0), max: DVec2::splat(60.0 + size) };
            let picture = Picture::new(&ramp(250, 200), &camera, &rect).unwrap();
            assert_eq!(picture.photo_px, factor);
            for point in [DVec3::new(-0.05, 0.02, 1.0), DVec3::new(0.1, 0.1, 1.0)] {
                let photo_pixel = camera.project(point).unwrap();
                let [red, green, _] = picture.color(picture.camera.project(point).unwrap()).unwrap();
                // Halving keeps a ramp a ramp; each step rounds to half a grey level.
                assert!((f64::from(red) * 255.0 - photo_pixel.x).abs() < 1.0, "{red} {photo_pixel}");
                assert!((f64::from(green) * 255.0 - photo_pixel.y).abs() < 1.0, "{green} {photo_pixel}");
            }
        }
        let outside = ImageRect { min: DVec2::splat(900.0), max: DVec2::splat(950.0) };
        assert!(Picture::new(&ramp(250, 200), &camera, &outside).is_none());
    }
}
