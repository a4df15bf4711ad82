//! A picture of one bit per pixel.

use super::PixelRegion;
use crate::photo::Pixels;

/// A bitmap, row by row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mask {
    width: u32,
    height: u32,
    /// Bit `i % 64` of word `i / 64` is pixel `i`; the bits behind the last pixel are zero.
    words: Vec<u64>,
}

impl Mask {
    /// The mask of these pixels, row by row; pixels that the iterator does not reach are not set.
    pub fn from_pixels(width: u32, height: u32, pixels: impl IntoIterator<Item = bool>) -> Self {
        let pixel_count = width as usize * height as usize;
        let mut words = vec![0_u64; pixel_count.div_ceil(64)];
        for (pixel, is_set) in pixels.into_iter().take(pixel_count).enumerate() {
            words[pixel / 64] |= u64::from(is_set) << (pixel % 64);
        }
        Self { width, height, words }
    }

    /// A mask that was drawn as a picture: what is neither black nor transparent is in it.
    pub fn of_picture(picture: &Pixels) -> Self {
        let is_set = |pixel: &[u8]| pixel[3] > 0 && pixel[..3] != [0, 0, 0];
        Self::from_pixels(picture.width, picture.height, picture.rgba.chunks_exact(4).map(is_set))
    }

    pub fn width(&self) -> u32 {
        self.width
    }

    pub fn height(&self) -> u32 {
        self.height
    }

    /// Whether the pixel is set; outside of the mask none is.
    pub fn get(&self, x: u32, y: u32) -> bool {
        let pixel = y as usize * self.width as usize + x as usize;
        x < self.width && y < self.height && self.words[pixel / 64] >> (pixel % 64) & 1 == 1
    }

    /// How many pixels are set.
    pub fn count(&self) -> usize {
        count_ones(self.words.iter().copied())
    }

    /// The smallest rectangle around the set pixels, in pixels of this mask; `None` where none is set.
    pub fn bounding_box(&self) -> Option<PixelRegion> {
        let row_has = |y: &u32| (0..self.width).any(|x| self.get(x, *y));
        let top = (0..self.height).find(row_has)?;
        let bottom = (top..self.height).rev().find(row_has)?;
        let column_has = |x: &u32| (top..=bottom).any(|y| self.get(*x, y));
        let left = (0..self.width).find(column_has)?;
        let right = (left..self.width).rev().find(column_has)?;
        Some(PixelRegion {
            x0: left as i32,
            y0: top as i32,
            width: right - left + 1,
            height: bottom - top + 1,
        })
    }

    /// Intersection over union: 1 for equal masks, also for two empty ones. `None` for masks of different sizes.
    pub fn iou(&self, other: &Self) -> Option<f64> {
        if (self.width, self.height) != (other.width, other.height) {
            return None;
        }
        let pairs = || self.words.iter().zip(&other.words);
        let union = count_ones(pairs().map(|(a, b)| a | b));
        let intersection = count_ones(pairs().map(|(a, b)| a & b));
        Some(if union == 0 { 1.0 } else { intersection as f64 / union as f64 })
    }
}

fn count_ones(words: impl Iterator<Item = u64>) -> usize {
    words.map(|word| word.count_ones() as usize).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle(x0: u32, y0: u32, x1: u32, y1: u32) -> Mask {
        let pixels = (0..30).flat_map(|y| (0..70).map(move |x| (x, y)));
        Mask::from_pixels(70, 30, pixels.map(|(x, y)| (x0..x1).contains(&x) && (y0..y1).contains(&y)))
    }

    #[test]
    fn counts_boxes_and_overlaps() {
        let mask = rectangle(60, 4, 70, 9);
        assert_eq!(mask.count(), 50);
        assert_eq!(mask.bounding_box(), Some(PixelRegion { x0: 60, y0: 4, width: 10, height: 5 }));
        assert!(mask.get(69, 8) && !mask.get(70, 8) && !mask.get(59, 8));
        assert_eq!(mask.iou(&rectangle(65, 4, 70, 14)), Some(25.0 / 75.0));
        let empty = rectangle(0, 0, 0, 0);
        assert_eq!((empty.bounding_box(), empty.iou(&empty), empty.iou(&mask)), (None, Some(1.0), Some(0.0)));
        assert_eq!(mask.iou(&Mask::from_pixels(7, 3, [])), None);
    }
}
