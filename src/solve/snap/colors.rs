//! Which colours belong to the object and which to what is around it, by the place along its contour.

use glam::DVec2;

use super::picture::Picture;
use crate::solve::contour::{DepthView, OBJECT_ID};

/// Bins per channel.
const BINS: usize = 16;
const CELLS: usize = BINS * BINS * BINS;
/// The contour is divided into so many sectors about its middle, each with its own histograms: a background varies.
const SECTORS: usize = 12;
/// As many pixels of all sectors together stand behind each sector's own.
const SHARED_PIXELS: f32 = 150.0;
/// No single pixel says more than this: colours that were never seen prove nothing.
const LARGEST_LOG_ODDS: f32 = 2.5;

/// How the pixels around an object were assigned when the histograms were made.
#[derive(Debug, Clone, Copy)]
pub struct Band {
    /// Pixels closer than this to the contour may be on either side of it.
    pub unsure_px: f64,
    /// Pixels farther outside say nothing of what is at the contour.
    pub reach_px: f64,
}

/// The logarithm of how much more likely a colour is on the object than beside it, in each sector.
#[derive(Debug, Clone)]
pub struct ColorModel {
    middle: DVec2,
    log_odds: Vec<f32>,
}

impl ColorModel {
    /// Learns from the pixels on the object and around it, as a pose puts it and the start does, too: what only one of them
    /// says could be an error that confirms itself. `None` where there are too few.
    pub fn learn(picture: &Picture, view: &DepthView, start: &DepthView, band: Band) -> Option<Self> {
        let (ids, first_ids) = (&view.image.ids, &start.image.ids);
        let is_object = |i: usize| ids[i] == OBJECT_ID;
        let count = ids.iter().filter(|&&id| id == OBJECT_ID).count();
        if count < 60 || ids.len() != picture.colors().len() || first_ids.len() != ids.len() {
            return None;
        }
        let to_outside = distances(picture, |i| !is_object(i));
        let to_inside = distances(picture, is_object);
        let middle = middle(picture, is_object);
        let mut counts = Counts::new();
        for (i, color) in picture.colors().iter().enumerate() {
            let is_inside = if to_outside[i] > band.unsure_px as f32 {
                true
            } else if ids[i] == 0
                && to_inside[i] > band.unsure_px as f32
                && to_inside[i] < band.reach_px as f32
            {
                false
            } else {
                continue;
            };
            if (first_ids[i] == OBJECT_ID) != is_inside {
                continue;
            }
            let place = DVec2::new((i % picture.width) as f64, (i / picture.width) as f64);
            counts.add(sector_of(place, middle), is_inside, cell_of(color));
        }
        counts.log_odds().map(|log_odds| Self { middle, log_odds })
    }

    /// From −2.5, surely beside the object, to 2.5.
    pub fn log_odds(&self, color: &[f32; 3], sector: Sector) -> f32 {
        let cell = cell_of(color);
        let [a, b] = sector.neighbors.map(|sector| self.log_odds[sector * CELLS + cell]);
        a + (b - a) * sector.part
    }

    /// Where a place on the contour is among the sectors.
    pub fn sector(&self, place: DVec2) -> Sector {
        let turn = angle(place, self.middle) / std::f64::consts::TAU * SECTORS as f64 - 0.5;
        let first = turn.floor();
        let wrapped = |sector: f64| (sector.rem_euclid(SECTORS as f64) as usize).min(SECTORS - 1);
        Sector { neighbors: [wrapped(first), wrapped(first + 1.0)], part: (turn - first) as f32 }
    }
}

/// A place between two sectors.
#[derive(Debug, Clone, Copy)]
pub struct Sector {
    neighbors: [usize; 2],
    part: f32,
}

fn angle(place: DVec2, middle: DVec2) -> f64 {
    (place - middle).to_angle().rem_euclid(std::f64::consts::TAU)
}

fn sector_of(place: DVec2, middle: DVec2) -> usize {
    ((angle(place, middle) / std::f64::consts::TAU * SECTORS as f64) as usize).min(SECTORS - 1)
}

fn cell_of(color: &[f32; 3]) -> usize {
    let [r, g, b] = color.map(|value| ((value * BINS as f32) as usize).min(BINS - 1));
    (r * BINS + g) * BINS + b
}

fn middle(picture: &Picture, is_object: impl Fn(usize) -> bool) -> DVec2 {
    let (mut sum, mut count) = (DVec2::ZERO, 0.0);
    for i in (0..picture.colors().len()).filter(|&i| is_object(i)) {
        sum += DVec2::new((i % picture.width) as f64, (i / picture.width) as f64);
        count += 1.0;
    }
    sum / f64::max(count, 1.0)
}

/// Histograms inside and outside, one after the other, by sector.
struct Counts {
    cells: [Vec<f32>; 2],
}

impl Counts {
    fn new() -> Self {
        Self { cells: [vec![0.0; SECTORS * CELLS], vec![0.0; SECTORS * CELLS]] }
    }

    fn add(&mut self, sector: usize, is_inside: bool, cell: usize) {
        let cells = &mut self.cells[usize::from(is_inside)];
        cells[sector * CELLS + cell] += 1.0;
        // A neighbour's pixels count half: sectors have no sharp borders.
        for neighbor in [(sector + 1) % SECTORS, (sector + SECTORS - 1) % SECTORS] {
            cells[neighbor * CELLS + cell] += 0.5;
        }
    }

    fn log_odds(mut self) -> Option<Vec<f32>> {
        let shared = self.cells.each_ref().map(|cells| {
            let mut sum = vec![0.0_f32; CELLS];
            for sector in cells.chunks_exact(CELLS) {
                sum.iter_mut().zip(sector).for_each(|(sum, value)| *sum += value);
            }
            let total: f32 = sum.iter().sum();
            (sum, total)
        });
        if shared.iter().any(|(_, total)| *total < 60.0) {
            return None;
        }
        for (cells, (sum, total)) in self.cells.iter_mut().zip(&shared) {
            for sector in cells.chunks_exact_mut(CELLS) {
                sector.iter_mut().zip(sum).for_each(|(value, sum)| *value += SHARED_PIXELS * sum / total);
                blur(sector);
                let total: f32 = sector.iter().sum();
                sector.iter_mut().for_each(|value| *value /= total);
            }
        }
        let [outside, inside] = &self.cells;
        // A colour that is seen on one pixel in two thousand, or less often, is as good as never seen.
        let floor = 5e-4;
        let odds = inside.iter().zip(outside).map(|(inside, outside)| (inside + floor) / (outside + floor));
        Some(odds.map(|odds| odds.ln().clamp(-LARGEST_LOG_ODDS, LARGEST_LOG_ODDS)).collect())
    }
}

/// Spreads each cell over its neighbours (1 2 1 along each channel), so that a few hundred pixels fill a histogram.
fn blur(cells: &mut [f32]) {
    for stride in [1, BINS, BINS * BINS] {
        for line in (0..CELLS).filter(|cell| cell / stride % BINS == 0) {
            let mut before = cells[line];
            for k in 0..BINS {
                let here = cells[line + k * stride];
                let after = cells[line + (k + 1).min(BINS - 1) * stride];
                cells[line + k * stride] = 0.25 * before + 0.5 * here + 0.25 * after;
                before = here;
            }
        }
    }
}

/// How far each pixel is from the nearest one of a set, about: steps of 1 straight and 1.4 slanted (Borgefors, *Distance
/// Transformations in Digital Images*, 1986).
fn distances(picture: &Picture, is_in: impl Fn(usize) -> bool) -> Vec<f32> {
    let (width, height) = (picture.width, picture.height);
    let mut distances: Vec<f32> = (0..width * height).map(|i| if is_in(i) { 0.0 } else { 1e6 }).collect();
    let pixels = || (0..height).flat_map(|y| (0..width).map(move |x| (x as isize, y as isize)));
    let relax = |distances: &mut [f32], (x, y): (isize, isize), steps: [(isize, isize, f32); 4]| {
        let i = y as usize * width + x as usize;
        for (dx, dy, length) in steps {
            let (x, y) = (x + dx, y + dy);
            if x >= 0 && y >= 0 && x < width as isize && y < height as isize {
                distances[i] = distances[i].min(distances[y as usize * width + x as usize] + length);
            }
        }
    };
    let before = [(-1, 0, 1.0), (-1, -1, 1.4), (0, -1, 1.0), (1, -1, 1.4)];
    pixels().for_each(|pixel| relax(&mut distances, pixel, before));
    let backwards: Vec<(isize, isize)> = pixels().collect();
    let after = before.map(|(dx, dy, length)| (-dx, -dy, length));
    backwards.into_iter().rev().for_each(|pixel| relax(&mut distances, pixel, after));
    distances
}
