//! Small pictures of photos.

use super::Pixels;

/// The picture with its longer side at most `most_side`: each pixel is the mean of those that it stands for.
pub fn thumbnail(pixels: &Pixels, most_side: u32) -> Pixels {
    let longer = pixels.width.max(pixels.height);
    if longer <= most_side {
        return pixels.clone();
    }
    let scaled = |side: u32| {
        let side = (u64::from(side) * u64::from(most_side) + u64::from(longer) / 2) / u64::from(longer);
        (side as u32).max(1)
    };
    let (width, height) = (scaled(pixels.width), scaled(pixels.height));
    let mut rgba = Vec::with_capacity(4 * width as usize * height as usize);
    for y in 0..height {
        let rows = span(y, height, pixels.height);
        for x in 0..width {
            rgba.extend(mean(pixels, span(x, width, pixels.width), rows.clone()));
        }
    }
    Pixels { width, height, rgba }
}

/// The pixels of a long side that one of a short side stands for.
fn span(index: u32, short: u32, long: u32) -> std::ops::Range<usize> {
    let edge = |index: u32| (u64::from(index) * u64::from(long) / u64::from(short)) as usize;
    edge(index)..edge(index + 1)
}

fn mean(pixels: &Pixels, columns: std::ops::Range<usize>, rows: std::ops::Range<usize>) -> [u8; 4] {
    let count = (columns.len() * rows.len()).max(1) as u64;
    let mut sums = [0_u64; 4];
    for row in rows {
        let start = 4 * (row * pixels.width as usize + columns.start);
        let line = pixels.rgba.get(start..start + 4 * columns.len()).unwrap_or_default();
        for pixel in line.chunks_exact(4) {
            for (sum, value) in sums.iter_mut().zip(pixel) {
                *sum += u64::from(*value);
            }
        }
    }
    sums.map(|sum| ((sum + count / 2) / count) as u8)
}
