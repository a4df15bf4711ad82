//! Which colours belong to the object and which to what is around it, by the place along its contour.

use glam::DVec2;

use super::palette::COLORS;
use super::picture::Picture;
use crate::solve::contour::{ContourPoint, DepthView, EdgeKind, OBJECT_ID};

/// The contour is divided into so many sectors about its middle, each with its own histograms: a background varies.
const SECTORS: usize = 12;
/// As many pixels of all sectors together stand behind each sector's own.
const SHARED_PIXELS: f32 = 60.0;
/// No single pixel says more than this: colours that were never seen prove nothing.
const LARGEST_LOG_ODDS: f32 = 2.5;
/// Fewer pixels than this on one side teach nothing.
const FEWEST_PIXELS: f32 = 60.0;

/// How the pixels around an object were assigned when the histograms were made.
#[derive(Debug, Clone, Copy)]
pub struct Band {
    /// Pixels closer than this to the contour may be on either side of it.
    pub unsure_px: f64,
    /// Pixels farther from it say nothing of what is at the contour.
    pub reach_px: f64,
}

/// The logarithm of how much more likely a colour is on the object than beside it, in each sector.
#[derive(Debug, Clone)]
pub struct ColorModel {
    middle: DVec2,
    /// By sector, then by the palette's colours.
    log_odds: Vec<[f32; COLORS]>,
}

impl ColorModel {
    /// Learns from the pixels on either side of the outline of a pose, along lines across it. `None` where there are too few.
    pub fn learn(picture: &Picture, view: &DepthView, points: &[ContourPoint], band: Band) -> Option<Self> {
        let outline = || points.iter().filter(|point| point.kind == EdgeKind::Outline);
        let middle =
            outline().map(|point| point.pixel).sum::<DVec2>() / f64::max(outline().count() as f64, 1.0);
        let mut counts = Counts::new();
        for point in outline() {
            let sector = sector_of(point.pixel, middle);
            for side in [-1.0, 1.0] {
                let mut distance = band.unsure_px.max(0.5);
                while distance < band.reach_px {
                    let place = point.pixel + point.normal * (side * distance);
                    let Some(index) = picture.index(place) else { break };
                    let owner = view.at(place).map_or(0, |(id, _)| id);
                    let is_own = owner == if side < 0.0 { OBJECT_ID } else { 0 };
                    if is_own {
                        counts.add(sector, side < 0.0, usize::from(picture.palette.labels[index]));
                    } else if distance > 2.0 {
                        break;
                    }
                    distance += 1.0;
                }
            }
        }
        counts.log_odds(picture).map(|log_odds| Self { middle, log_odds })
    }

    /// From −2.5, surely beside the object, to 2.5.
    pub fn log_odds(&self, picture: &Picture, index: usize, sector: Sector) -> f32 {
        if let Some(is_object) = picture.masked(index) {
            return if is_object { LARGEST_LOG_ODDS } else { -LARGEST_LOG_ODDS };
        }
        let Some(&label) = picture.palette.labels.get(index) else { return 0.0 };
        let [a, b] = sector.neighbors.map(|sector| self.log_odds[sector][usize::from(label) % COLORS]);
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

/// Histograms outside and inside, by sector.
struct Counts {
    sides: [Vec<[f32; COLORS]>; 2],
}

impl Counts {
    fn new() -> Self {
        Self { sides: [vec![[0.0; COLORS]; SECTORS], vec![[0.0; COLORS]; SECTORS]] }
    }

    fn add(&mut self, sector: usize, is_inside: bool, label: usize) {
        let sectors = &mut self.sides[usize::from(is_inside)];
        sectors[sector][label % COLORS] += 1.0;
        // A neighbour's pixels count half: sectors have no sharp borders.
        for neighbor in [(sector + 1) % SECTORS, (sector + SECTORS - 1) % SECTORS] {
            sectors[neighbor][label % COLORS] += 0.5;
        }
    }

    fn log_odds(self, picture: &Picture) -> Option<Vec<[f32; COLORS]>> {
        let mut sides = Vec::with_capacity(2);
        for sectors in &self.sides {
            let mut shared = [0.0_f32; COLORS];
            for sector in sectors {
                shared.iter_mut().zip(sector).for_each(|(sum, value)| *sum += value);
            }
            let total: f32 = shared.iter().sum();
            if total < FEWEST_PIXELS {
                return None;
            }
            shared.iter_mut().for_each(|value| *value *= SHARED_PIXELS / total);
            let mixed = sectors.iter().map(|sector| likelihoods(picture, sector, &shared));
            sides.push(mixed.collect::<Vec<_>>());
        }
        let [outside, inside] = &sides[..] else { return None };
        // A colour that is seen on one pixel in two hundred, or less often, is as good as never seen.
        let floor = 5e-3;
        let odds = |inside: &[f32; COLORS], outside: &[f32; COLORS]| {
            std::array::from_fn(|k| {
                let odds = (inside[k] + floor) / (outside[k] + floor);
                odds.ln().clamp(-LARGEST_LOG_ODDS, LARGEST_LOG_ODDS)
            })
        };
        Some(inside.iter().zip(outside).map(|(inside, outside)| odds(inside, outside)).collect())
    }
}

/// A sector's counts with those of all behind them, spread over colours that are alike, to a sum of one.
fn likelihoods(picture: &Picture, sector: &[f32; COLORS], shared: &[f32; COLORS]) -> [f32; COLORS] {
    let mut spread = [0.0_f32; COLORS];
    for ((own, shared), parts) in sector.iter().zip(shared).zip(&picture.palette.spread) {
        let count = own + shared;
        if count > 0.0 {
            spread.iter_mut().zip(parts).for_each(|(sum, part)| *sum += count * part);
        }
    }
    let total: f32 = spread.iter().sum();
    spread.map(|value| value / total)
}
