//! Lines of boxes, drawn into a photo's pixels.

use glam::DVec2;

use crate::photo::Pixels;
use crate::scene::Rgb;

/// Pairs of corners of a box whose corner `i` has x from bit 0, y from bit 1, z from bit 2.
const EDGES: [[usize; 2]; 12] =
    [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];

/// Draws the 2D box (x, y, width, height: along the outer edge of its pixels) and the 3D box (its corners' pixels, `None`
/// behind the camera) in a colour.
pub(super) fn draw_boxes(
    photo: &mut Pixels,
    color: Rgb,
    box_2d: Option<[i64; 4]>,
    box_3d: &[Option<[f64; 2]>; 8],
) {
    // So that they can be seen in large photos too.
    let width_px = f64::from(photo.width.max(photo.height)) / 640.0;
    let mut line = |from: DVec2, to: DVec2| draw_line(photo, color, from, to, width_px.max(1.0));
    if let Some([x, y, width, height]) = box_2d {
        let low = DVec2::new(x as f64, y as f64) - 0.5;
        let high = low + DVec2::new(width as f64, height as f64);
        let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y), low];
        corners.windows(2).for_each(|pair| line(pair[0], pair[1]));
    }
    for [from, to] in EDGES {
        if let (Some(from), Some(to)) = (box_3d[from], box_3d[to]) {
            line(from.into(), to.into());
        }
    }
}

/// Every pixel whose centre is within half the width of the line; what is outside of the photo is left out.
fn draw_line(photo: &mut Pixels, Rgb([red, green, blue]): Rgb, from: DVec2, to: DVec2, width_px: f64) {
    let reach = width_px / 2.0 + 0.5;
    let last = DVec2::new(f64::from(photo.width) - 1.0, f64::from(photo.height) - 1.0);
    let Some((start, end)) = clip(from, to, DVec2::splat(-reach), last + reach) else { return };
    let direction = end - start;
    let steps = (direction.abs().max_element().ceil() as u32).max(1);
    let half = reach.floor() as i64;
    for step in 0..=steps {
        let middle = (start + direction * (f64::from(step) / f64::from(steps))).round();
        for (dx, dy) in (-half..=half).flat_map(|dy| (-half..=half).map(move |dx| (dx, dy))) {
            let (x, y) = (middle.x as i64 + dx, middle.y as i64 + dy);
            let place = DVec2::new(x as f64, y as f64);
            if place.clamp(DVec2::ZERO, last) == place && distance(place, start, end) <= width_px / 2.0 + 1e-9
            {
                let at = 4 * (y as usize * photo.width as usize + x as usize);
                if let Some(texel) = photo.rgba.get_mut(at..at + 4) {
                    texel.copy_from_slice(&[red, green, blue, 255]);
                }
            }
        }
    }
}

fn distance(place: DVec2, from: DVec2, to: DVec2) -> f64 {
    let direction = to - from;
    let part = if direction == DVec2::ZERO {
        0.0
    } else {
        (place - from).dot(direction) / direction.length_squared()
    };
    place.distance(from + direction * part.clamp(0.0, 1.0))
}

/// The part of a line within a rectangle. (Liang and Barsky, *A new concept and method for line clipping*, 1984.)
fn clip(from: DVec2, to: DVec2, min: DVec2, max: DVec2) -> Option<(DVec2, DVec2)> {
    let direction = to - from;
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        if direction[axis] == 0.0 {
            if from[axis] < min[axis] || from[axis] > max[axis] {
                return None;
            }
            continue;
        }
        let [a, b] = [min, max].map(|side| (side[axis] - from[axis]) / direction[axis]);
        (first, last) = (first.max(a.min(b)), last.min(a.max(b)));
    }
    (first <= last).then_some((from + direction * first, from + direction * last))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn black(width: u32, height: u32) -> Pixels {
        Pixels { width, height, rgba: [0, 0, 0, 255].repeat((width * height) as usize) }
    }

    fn lit(photo: &Pixels) -> Vec<(usize, usize)> {
        let width = photo.width as usize;
        let pixels = photo.rgba.chunks_exact(4).enumerate().filter(|(_, texel)| texel[0] > 0);
        pixels.map(|(pixel, _)| (pixel % width, pixel / width)).collect()
    }

    #[test]
    fn a_line_is_as_wide_as_it_says_and_stays_in_the_photo() {
        let mut photo = black(8, 6);
        draw_line(&mut photo, Rgb([255, 0, 0]), DVec2::new(-50.0, 2.0), DVec2::new(50.0, 2.0), 1.0);
        assert_eq!(lit(&photo), (0..8).map(|x| (x, 2)).collect::<Vec<_>>());
        let mut photo = black(8, 6);
        draw_line(&mut photo, Rgb([255, 0, 0]), DVec2::new(-50.0, 9.0), DVec2::new(50.0, 9.0), 3.0);
        assert_eq!(lit(&photo), []);
        draw_line(&mut photo, Rgb([255, 0, 0]), DVec2::new(3.0, 1.0), DVec2::new(3.0, 4.0), 3.0);
        assert!(
            lit(&photo).contains(&(2, 2)) && lit(&photo).contains(&(4, 2)) && !lit(&photo).contains(&(5, 2))
        );
    }

    #[test]
    fn a_2d_box_runs_around_its_pixels() {
        let mut photo = black(10, 10);
        draw_boxes(&mut photo, Rgb([9, 9, 9]), Some([2, 3, 4, 5]), &[None; 8]);
        let found = lit(&photo);
        assert!(!found.is_empty() && !found.contains(&(4, 5)), "the inside is free");
        assert!(found.iter().all(|(x, y)| (1..=6).contains(x) && (2..=8).contains(y)), "{found:?}");
    }
}
