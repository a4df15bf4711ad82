//! The part of a photo that a snap looks at, at the size at which it looks.

use std::borrow::Cow;

use glam::DVec2;

use super::palette::Palette;
use crate::math::{ImageRect, Intrinsics};
use crate::photo::{Pixels, half_size};
use crate::raster::Mask;
use crate::scene::DepthInMm;

/// A cut-out of the photo, with the camera that sees just that.
#[derive(Debug, Clone)]
pub struct Picture {
    pub camera: Intrinsics,
    pub width: usize,
    pub height: usize,
    /// Linear light, 0 to 1, row by row.
    light: Vec<[f32; 3]>,
    /// The photo's own values, 0 to 1: in sRGB, as far as the camera kept to that.
    coded: Vec<[f32; 3]>,
    /// Colours in sRGB, 0 to 1, blurred against noise.
    smoothed: Vec<[f32; 3]>,
    /// The same, as numbers of a few colours.
    pub palette: Palette,
    /// How strong and in which direction colours change at each pixel: of length 0 where they do not, near 1 at a clear edge.
    gradients: Vec<[f32; 2]>,
    /// Where somebody has said that the object is, pixel by pixel.
    mask: Option<Vec<bool>>,
    /// The photo's pixel that the cut-out begins with.
    origin: DVec2,
    /// How many pixels of the photo one pixel here is wide.
    pub photo_px: f64,
}

impl Picture {
    /// The part of the photo around `object`, a rectangle in its pixels, with room for errors about it, halved until the
    /// object is not larger than `largest_object_px`. `None` where nothing of that is in the photo. A mask has the photo's
    /// size, or is left out.
    pub fn new(
        photo: &Pixels,
        camera: &Intrinsics,
        object: &ImageRect,
        mask: Option<&Mask>,
        largest_object_px: f64,
    ) -> Option<Self> {
        let size_px = object.size().max_element();
        let margin = DVec2::splat(0.3 * size_px + 20.0);
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
        while size_px / photo_px > largest_object_px && cut.0.width.min(cut.0.height) > 32 {
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
        let light_of: [f32; 256] = std::array::from_fn(|value| linear_light(value as f32 / 255.0));
        let pixels = cut.0.rgba.as_chunks::<4>().0;
        let colors: Vec<[f32; 3]> =
            pixels.iter().map(|&[r, g, b, _]| [r, g, b].map(|value| f32::from(value) / 255.0)).collect();
        let light =
            pixels.iter().map(|&[r, g, b, _]| [r, g, b].map(|value| light_of[usize::from(value)])).collect();
        let (width, height) = (cut.0.width as usize, cut.0.height as usize);
        let mut picture = Self {
            camera,
            width,
            height,
            palette: Palette::new(&colors),
            gradients: gradients(&colors, width, height),
            smoothed: smoothed(&colors, width, height),
            mask: None,
            light,
            coded: colors,
            origin: cut.1,
            photo_px,
        };
        picture.mask = mask
            .filter(|mask| (mask.width(), mask.height()) == (photo.width, photo.height))
            .map(|mask| picture.cut_mask(mask));
        Some(picture)
    }

    fn cut_mask(&self, mask: &Mask) -> Vec<bool> {
        let (width, height) = (self.width as u32, self.height as u32);
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let is_set = |(x, y)| self.photo_pixel(x, y).is_some_and(|[x, y]| mask.get(x, y));
        pixels.map(is_set).collect()
    }

    /// The photo's pixel at the middle of one here; `None` before its first one.
    fn photo_pixel(&self, x: u32, y: u32) -> Option<[u32; 2]> {
        let pixel = DVec2::new(f64::from(x), f64::from(y));
        let place = ((pixel + 0.5) * self.photo_px - 0.5 + self.origin).round();
        (place.min_element() >= 0.0).then_some([place.x as u32, place.y as u32])
    }

    /// The depth that the photo's depth map has at a pixel here; 0 where it has none.
    pub fn measured_mm(&self, depth: &DepthInMm, x: u32, y: u32) -> f32 {
        let at = |[x, y]: [u32; 2]| {
            let index = y as usize * depth.width as usize + x as usize;
            depth.mm.get(index).copied().filter(|_| x < depth.width)
        };
        self.photo_pixel(x, y).and_then(at).unwrap_or(0.0)
    }

    /// Whether the mask says that the object is at this pixel; `None` without a mask.
    pub fn masked(&self, index: usize) -> Option<bool> {
        self.mask.as_ref()?.get(index).copied()
    }

    /// How clear an edge across `normal` there is at a place: 0 to 1. `None` outside.
    pub fn edge(&self, pixel: DVec2, normal: DVec2) -> Option<f32> {
        let [x, y] = self.between(&self.gradients, pixel)?;
        Some((x * normal.x as f32 + y * normal.y as f32).abs())
    }

    /// A pixel's colour, a little blurred; black outside.
    pub fn smooth_color(&self, index: usize) -> [f32; 3] {
        self.smoothed.get(index).copied().unwrap_or_default()
    }

    /// Where a pixel of the photo is here.
    pub fn place_of(&self, photo_pixel: DVec2) -> DVec2 {
        (photo_pixel - self.origin + 0.5) / self.photo_px - 0.5
    }

    /// The number of the pixel nearest to a place; `None` outside.
    pub fn index(&self, pixel: DVec2) -> Option<usize> {
        let (x, y) = (pixel.x + 0.5, pixel.y + 0.5);
        let is_inside = x >= 0.0 && y >= 0.0 && x < self.width as f64 && y < self.height as f64;
        // Cutting off is rounding here, and a single instruction.
        is_inside.then(|| y as usize * self.width + x as usize)
    }

    /// The same at a pixel.
    pub fn edge_at(&self, index: usize, normal: [f32; 2]) -> f32 {
        let [x, y] = self.gradients.get(index).copied().unwrap_or_default();
        (x * normal[0] + y * normal[1]).abs()
    }

    /// The number of each pixel's colour in the palette; with a mask, whether the pixel is in it.
    pub fn labels(&self) -> Cow<'_, [u8]> {
        match &self.mask {
            Some(mask) => mask.iter().map(|&is_object| u8::from(is_object)).collect(),
            None => Cow::Borrowed(&self.palette.labels),
        }
    }

    /// Linear light between four pixels; `None` outside of their centres.
    pub fn light(&self, pixel: DVec2) -> Option<[f32; 3]> {
        self.between(&self.light, pixel)
    }

    /// The photo's own values between four pixels; `None` outside of their centres.
    pub fn coded(&self, pixel: DVec2) -> Option<[f32; 3]> {
        self.between(&self.coded, pixel)
    }

    fn between<const N: usize>(&self, values: &[[f32; N]], pixel: DVec2) -> Option<[f32; N]> {
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
        let [a, b] = [values[first], values[first + 1]];
        let [c, d] = [values[first + self.width], values[first + self.width + 1]];
        Some(std::array::from_fn(|k| {
            let above = a[k] + (b[k] - a[k]) * right;
            let below = c[k] + (d[k] - c[k]) * right;
            above + (below - above) * down
        }))
    }
}

/// From sRGB.
fn linear_light(value: f32) -> f32 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// A picture in which colours change less than this from pixel to pixel has no edges, only noise.
const FAINTEST_USUAL: f32 = 0.01;

/// Of the channel that changes most (Sobel's masks), divided by how much is usual in this picture, so that a clear edge in
/// a dark picture is as good as one in the sun. On either side of an edge they point the same way.
fn gradients(colors: &[[f32; 3]], width: usize, height: usize) -> Vec<[f32; 2]> {
    let mut gradients = vec![[0.0_f32; 2]; width * height];
    for y in 1..height.saturating_sub(1) {
        for x in 1..width.saturating_sub(1) {
            gradients[y * width + x] = strongest_gradient(colors, y * width + x, width);
        }
    }
    let length = |[x, y]: [f32; 2]| x.hypot(y);
    let usual = gradients.iter().map(|&g| length(g)).sum::<f32>() / (gradients.len() as f32).max(1.0);
    let scale = usual.max(FAINTEST_USUAL);
    gradients.iter().map(|&g| g.map(|value| value / (length(g) + scale))).collect()
}

/// Blurred by 1 2 1 along each axis.
fn smoothed(colors: &[[f32; 3]], width: usize, height: usize) -> Vec<[f32; 3]> {
    let along =
        |colors: &[[f32; 3]], stride: usize, place: &dyn Fn(usize) -> (usize, usize)| -> Vec<[f32; 3]> {
            (0..colors.len())
                .map(|i| {
                    let (at, count) = place(i);
                    let before = if at > 0 { i - stride } else { i };
                    let after = if at + 1 < count { i + stride } else { i };
                    std::array::from_fn(|c| {
                        0.25 * colors[before][c] + 0.5 * colors[i][c] + 0.25 * colors[after][c]
                    })
                })
                .collect()
        };
    let across = along(colors, 1, &|i| (i % width, width));
    along(&across, width, &|i| (i / width, height))
}

/// Per pixel, with a sign that does not depend on which side is brighter: edges are lines here, not steps.
fn strongest_gradient(colors: &[[f32; 3]], i: usize, width: usize) -> [f32; 2] {
    let mut best = [0.0_f32; 2];
    let channels =
        (0..3).map(|channel| sobel(|row, column| colors[i + row * width + column - width - 1][channel]));
    for [x, y] in channels {
        if x * x + y * y > best[0] * best[0] + best[1] * best[1] {
            best = [x, y];
        }
    }
    let is_turned = best[0] < 0.0 || (best[0] == 0.0 && best[1] < 0.0);
    best.map(|value| if is_turned { -value } else { value } / 8.0)
}

/// Sobel's two masks on the pixels at rows and columns 0 to 2.
fn sobel(at: impl Fn(usize, usize) -> f32) -> [f32; 2] {
    let x = at(0, 2) + 2.0 * at(1, 2) + at(2, 2) - at(0, 0) - 2.0 * at(1, 0) - at(2, 0);
    let y = at(2, 0) + 2.0 * at(2, 1) + at(2, 2) - at(0, 0) - 2.0 * at(0, 1) - at(0, 2);
    [x, y]
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

    fn srgb(light: f32) -> f64 {
        1.055 * f64::from(light).powf(1.0 / 2.4) - 0.055
    }

    #[test]
    fn a_point_keeps_its_place_in_the_cut_out() {
        let camera = Intrinsics::from_focal(200.0, 250, 200);
        for (size, factor) in [(80.0, 1.0), (700.0, 4.0)] {
            let rect = ImageRect { min: DVec2::splat(60.0), max: DVec2::splat(60.0 + size) };
            let picture = Picture::new(&ramp(250, 200), &camera, &rect, None, 300.0).unwrap();
            assert_eq!(picture.photo_px, factor);
            for point in [DVec3::new(-0.05, 0.02, 1.0), DVec3::new(0.1, 0.1, 1.0)] {
                let photo_pixel = camera.project(point).unwrap();
                let light = picture.light(picture.camera.project(point).unwrap()).unwrap();
                let [red, green, _] = light.map(srgb);
                // Halving keeps a ramp a ramp; each step rounds to half a grey level.
                assert!((red * 255.0 - photo_pixel.x).abs() < 1.0, "{red} {photo_pixel}");
                assert!((green * 255.0 - photo_pixel.y).abs() < 1.0, "{green} {photo_pixel}");
            }
        }
        let outside = ImageRect { min: DVec2::splat(900.0), max: DVec2::splat(950.0) };
        assert!(Picture::new(&ramp(250, 200), &camera, &outside, None, 300.0).is_none());
    }
}
