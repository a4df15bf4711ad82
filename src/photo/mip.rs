//! Smaller copies of a photo, so that a photo zoomed out does not shimmer.

use super::Pixels;

/// The photo at half its size (rounded down, at least one pixel), each pixel the mean of the ones it covers.
pub fn half_size(pixels: &Pixels) -> Pixels {
    let (width, height) = ((pixels.width / 2).max(1), (pixels.height / 2).max(1));
    let stride = pixels.width as usize * 4;
    let row_step = if pixels.height > 1 { stride } else { 0 };
    let column_step = if pixels.width > 1 { 4 } else { 0 };
    let mut rgba = Vec::with_capacity(width as usize * height as usize * 4);
    for y in 0..height as usize {
        for x in 0..width as usize {
            let corner = 2 * y * row_step + 2 * x * column_step;
            for channel in corner..corner + 4 {
                let at = |offset: usize| u32::from(pixels.rgba[channel + offset]);
                let sum = at(0) + at(column_step) + at(row_step) + at(row_step + column_step);
                rgba.push(((sum + 2) / 4) as u8);
            }
        }
    }
    Pixels { width, height, rgba }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halving_averages_and_ends_at_one_pixel() {
        let mut pixels = Pixels { width: 3, height: 2, rgba: vec![0; 24] };
        pixels.rgba[0] = 200;
        let half = half_size(&pixels);
        assert_eq!((half.width, half.height, half.rgba[0]), (1, 1, 50));
        assert_eq!(half_size(&half).rgba.len(), 4);
    }
}
