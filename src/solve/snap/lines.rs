//! Correspondence lines: short lines across the contour, on which the colours tell where the object ends.
//!
//! The posterior of the contour's place on a line, with its smoothed step, is that of Stoiber et al. (*SRT3D: A Sparse
//! Region-Based 3D Object Tracking Approach for the Real World*, 2022).

use glam::DVec3;

use super::colors::ColorModel;
use super::picture::Picture;
use crate::math::Pose;
use crate::solve::contour::{ContourPoint, DepthView, EdgeKind, OBJECT_ID};
use crate::solve::least_squares::NormalEquations;
use crate::solve::motion::{motion_row, project_with_jacobian};

/// Samples on either side of the contour.
const SAMPLES: usize = 7;
/// The step from object to background is smooth over this many samples, and never quite certain.
const STEP_WIDTH: f64 = 1.3;
const STEP_HEIGHT: f64 = 0.42;
/// Variances below this (in samples²) would be more than colours can tell.
const SMALLEST_VARIANCE: f64 = 0.15;

/// What a line found: the contour belongs `offset_px` further out.
#[derive(Debug, Clone, Copy)]
pub struct LineResult {
    pub point: ContourPoint,
    pub offset_px: f64,
    pub variance_px: f64,
}

/// Looks along the normals of all outline points, in samples of `stride_px`.
pub fn search(
    picture: &Picture,
    view: &DepthView,
    colors: &ColorModel,
    points: &[ContourPoint],
    stride_px: usize,
) -> Vec<LineResult> {
    let outline = points.iter().filter(|point| point.kind == EdgeKind::Outline);
    outline.filter_map(|point| search_line(picture, view, colors, point, stride_px)).collect()
}

fn search_line(
    picture: &Picture,
    view: &DepthView,
    colors: &ColorModel,
    point: &ContourPoint,
    stride_px: usize,
) -> Option<LineResult> {
    let inside = log_odds_along(picture, view, colors, point, stride_px, -1.0);
    let outside = log_odds_along(picture, view, colors, point, stride_px, 1.0);
    if inside.len() < 2 || outside.len() < 2 {
        return None;
    }
    // Samples are centred at half strides from the contour, counted outwards.
    let samples: Vec<(f64, f64)> = inside
        .iter()
        .enumerate()
        .map(|(k, odds)| (-(k as f64) - 0.5, *odds))
        .chain(outside.iter().enumerate().map(|(k, odds)| (k as f64 + 0.5, *odds)))
        .collect();
    // As far to one side as to the other: where the colours say nothing, the mean has to be where the contour is.
    let reach = inside.len().min(outside.len()) as i32 - 1;
    let log_posterior = |offset: f64| -> f64 {
        samples
            .iter()
            .map(|&(place, odds)| {
                let on_object = 0.5 - STEP_HEIGHT * ((place - offset) / (2.0 * STEP_WIDTH)).tanh();
                let likelihood = 1.0 / (1.0 + (-odds).exp());
                (on_object * likelihood + (1.0 - on_object) * (1.0 - likelihood)).max(1e-6).ln()
            })
            .sum()
    };
    let offsets: Vec<f64> = (-2 * reach..=2 * reach).map(|half| f64::from(half) / 2.0).collect();
    let logs: Vec<f64> = offsets.iter().map(|&offset| log_posterior(offset)).collect();
    let highest = logs.iter().fold(f64::NEG_INFINITY, |max, &log| max.max(log));
    let weights: Vec<f64> = logs.iter().map(|log| (log - highest).exp()).collect();
    let total: f64 = weights.iter().sum();
    let mean = offsets.iter().zip(&weights).map(|(offset, weight)| offset * weight).sum::<f64>() / total;
    let spread =
        offsets.iter().zip(&weights).map(|(offset, weight)| (offset - mean).powi(2) * weight).sum::<f64>();
    let variance = (spread / total).max(SMALLEST_VARIANCE);
    let stride = stride_px as f64;
    Some(LineResult { point: *point, offset_px: mean * stride, variance_px: variance * stride * stride })
}

/// Mean log odds of each sample from the contour on, until the line meets what is not its own.
fn log_odds_along(
    picture: &Picture,
    view: &DepthView,
    colors: &ColorModel,
    point: &ContourPoint,
    stride_px: usize,
    side: f64,
) -> Vec<f64> {
    let sector = colors.sector(point.pixel);
    let mut samples = Vec::with_capacity(SAMPLES);
    for sample in 0..SAMPLES {
        let mut sum = 0.0;
        for step in 0..stride_px {
            let distance = (sample * stride_px + step) as f64 + 0.5;
            let place = point.pixel + point.normal * (side * distance);
            let Some(index) = picture.index(place) else { return samples };
            // The contour itself runs through the pixels next to it, so ownership is asked a little farther on.
            let owner = view.at(place).map_or(0, |(id, _)| id);
            let is_own = if side < 0.0 { owner == OBJECT_ID } else { owner == 0 };
            if !is_own && distance > 2.0 {
                return samples;
            }
            sum += f64::from(colors.log_odds(&picture.colors()[index], sector));
        }
        samples.push(sum / stride_px as f64);
    }
    samples
}

/// Adds the lines to the normal equations, each with the weight that its posterior gives it times `share`.
pub fn add_lines(
    equations: &mut NormalEquations<6>,
    picture: &Picture,
    pose: &Pose,
    pivot_camera_mm: DVec3,
    lines: &[LineResult],
    share: f64,
) {
    for line in lines {
        let seen = pose.transform_point(line.point.point_mm);
        let Some((pixel, [by_x, by_y])) = project_with_jacobian(&picture.camera, seen) else { continue };
        let normal = line.point.normal;
        let gradient = by_x * normal.x + by_y * normal.y;
        let moved_px = (pixel - line.point.pixel).dot(normal);
        equations.add(
            &motion_row(seen - pivot_camera_mm, gradient),
            moved_px - line.offset_px,
            share / line.variance_px,
        );
    }
}
