//! Correspondence lines: short lines across the contour, on which the colours tell where the object ends.
//!
//! The posterior of the contour's place on a line, with its smoothed step, is that of Stoiber et al. (*SRT3D: A Sparse
//! Region-Based 3D Object Tracking Approach for the Real World*, 2022).

use super::colors::ColorModel;
use super::picture::Picture;
use super::pull::Pull;
use crate::solve::contour::{ContourPoint, DepthView, EdgeKind, OBJECT_ID};

/// Samples on either side of the contour.
const SAMPLES: usize = 8;
/// The step from object to background is smooth over this many samples, and never quite certain.
const STEP_WIDTH: f64 = 1.3;
const STEP_HEIGHT: f64 = 0.42;
/// Variances below this (in samples²) would be more than colours can tell.
const SMALLEST_VARIANCE: f64 = 0.15;

/// Looks along the normals of all outline points, in samples of `stride_px`.
pub fn search(
    picture: &Picture,
    view: &DepthView,
    colors: &ColorModel,
    points: &[ContourPoint],
    stride_px: usize,
) -> Vec<Pull> {
    let step = smoothed_step();
    let outline = points.iter().filter(|point| point.kind == EdgeKind::Outline);
    outline
        .filter_map(|point| {
            let sides = [-1.0, 1.0].map(|side| {
                let line = Line { picture, view, colors, point, stride_px, side };
                line.likelihoods()
            });
            search_line(point, &sides, stride_px as f64, &step)
        })
        .collect()
}

/// The probability of being on the object, by the distance outwards from its contour in halves of a sample.
fn smoothed_step() -> [f64; 4 * SAMPLES + 1] {
    std::array::from_fn(|k| {
        let distance = (k as f64 - 2.0 * SAMPLES as f64) / 2.0;
        0.5 - STEP_HEIGHT * (distance / (2.0 * STEP_WIDTH)).tanh()
    })
}

fn search_line(
    point: &ContourPoint,
    [inside, outside]: &[Vec<f64>; 2],
    stride_px: f64,
    step: &[f64; 4 * SAMPLES + 1],
) -> Option<Pull> {
    if inside.len() < 2 || outside.len() < 2 {
        return None;
    }
    // Samples are centred at half strides from the contour, counted outwards, in halves.
    let inner = inside.iter().enumerate().map(|(k, &likelihood)| (-2 * k as i32 - 1, likelihood));
    let outer = outside.iter().enumerate().map(|(k, &likelihood)| (2 * k as i32 + 1, likelihood));
    let samples: Vec<(i32, f64)> = inner.chain(outer).collect();
    // As far to one side as to the other: where the colours say nothing, the mean has to be where the contour is.
    let reach = 2 * (inside.len().min(outside.len()) as i32 - 1);
    let on_object = |distance: i32| {
        let last = step.len() as i32 - 1;
        step[(distance + 2 * SAMPLES as i32).clamp(0, last) as usize]
    };
    let (mut total, mut first, mut second) = (0.0, 0.0, 0.0);
    for halves in -reach..=reach {
        let posterior: f64 = samples
            .iter()
            .map(|&(place, likelihood)| {
                1.0 - likelihood + on_object(place - halves) * (2.0 * likelihood - 1.0)
            })
            .product();
        let offset = f64::from(halves) / 2.0;
        total += posterior;
        first += posterior * offset;
        second += posterior * offset * offset;
    }
    // Likelihoods and steps are at least 0.07 from zero and one, so sixteen factors are far from underflow.
    let mean = first / total;
    let variance = (second / total - mean * mean).max(SMALLEST_VARIANCE);
    Some(Pull { point: *point, offset_px: mean * stride_px, variance_px: variance * stride_px * stride_px })
}

/// One side of a correspondence line.
struct Line<'a> {
    picture: &'a Picture,
    view: &'a DepthView,
    colors: &'a ColorModel,
    point: &'a ContourPoint,
    stride_px: usize,
    side: f64,
}

impl Line<'_> {
    /// How likely each sample from the contour on is the object's, until the line meets what is not its own.
    fn likelihoods(&self) -> Vec<f64> {
        let sector = self.colors.sector(self.point.pixel);
        let mut samples = Vec::with_capacity(SAMPLES);
        for sample in 0..SAMPLES {
            let mut sum = 0.0;
            for step in 0..self.stride_px {
                let distance = (sample * self.stride_px + step) as f64 + 0.5;
                let place = self.point.pixel + self.point.normal * (self.side * distance);
                let Some(index) = self.picture.index(place) else { return samples };
                // The contour itself runs through the pixels next to it, so ownership is asked a little farther on.
                let owner = self.view.at(place).map_or(0, |(id, _)| id);
                let is_own = if self.side < 0.0 { owner == OBJECT_ID } else { owner == 0 };
                if !is_own && distance > 2.0 {
                    return samples;
                }
                sum += f64::from(self.colors.log_odds(self.picture, index, sector));
            }
            samples.push(1.0 / (1.0 + (-sum / self.stride_px as f64).exp()));
        }
        samples
    }
}
