//! Finds clicks that are not noise but mistakes: the wrong corner, the wrong side.
//!
//! There are few pins, so every triple is tried instead of random ones (Fischler and Bolles, *Random Sample Consensus*,
//! 1981, without the randomness). A pin is called a misclick only if it is far beyond what its own noise and the
//! uncertainty of a pose from the others explain.

use glam::DVec2;

use super::super::linear::{Matrix, congruent, inverse, solve};
use super::super::motion::{motion_row, project_with_jacobian};
use super::p3p::p3p;
use super::refine::{Fit, Fitting, Kernel, residual};
use super::{Pin, PinOptions};
use crate::math::{Intrinsics, Pose, sort_short};

/// Squared Mahalanobis distance in two dimensions that noise exceeds once in 270,000 pins.
const GATE: f64 = 25.0;
/// More triples than this are thinned out evenly, for the sake of a live solve; ten pins have 120.
const MAX_TRIPLES: usize = 120;
/// Pins that triples are made of: of more, every so many are taken.
const MOST_IN_TRIPLES: usize = 24;
/// Poses from triples that are looked at closely.
const FINALISTS: usize = 4;

/// Which of the pins are misclicks. Of fewer than five, or where more than a third disagree, it cannot be told.
pub fn misclicks(camera: &Intrinsics, pins: &[Pin], options: &PinOptions) -> Vec<usize> {
    if pins.len() < 5 {
        return Vec::new();
    }
    // Wider than noise, for poses from three noisy clicks are rough.
    let rough = Fitting {
        camera,
        pins,
        kernel: Kernel::Tukey(8.0 * options.click_sigma_px),
        prior: None,
        click_sigma_px: options.click_sigma_px,
    };
    let best = finalists(camera, pins, options)
        .into_iter()
        .filter_map(|pose| rough.descend_within(pose, 15))
        .min_by(|a, b| a.equations.cost.total_cmp(&b.equations.cost));
    best.map_or_else(Vec::new, |fit| outside(camera, pins, &fit.pose, options))
}

/// The poses from triples that explain the most pins.
fn finalists(camera: &Intrinsics, pins: &[Pin], options: &PinOptions) -> Vec<Pose> {
    let directions: Vec<_> = pins.iter().map(|pin| camera.unproject(pin.pixel).normalize()).collect();
    let chosen: Vec<usize> = (0..pins.len()).step_by(pins.len().div_ceil(MOST_IN_TRIPLES)).collect();
    let count = chosen.len();
    let triples: Vec<[usize; 3]> = (0..count)
        .flat_map(|a| (a + 1..count).map(move |b| (a, b)))
        .flat_map(|(a, b)| (b + 1..count).map(move |c| [a, b, c]))
        .map(|triple| triple.map(|place| chosen[place]))
        .collect();
    let cap = (10.0 * options.click_sigma_px).powi(2);
    let score = |pose: &Pose| -> f64 {
        pins.iter().map(|pin| residual(camera, pose, pin).map_or(cap, |r| r.length_squared().min(cap))).sum()
    };
    let mut scored: Vec<(f64, Pose)> = triples
        .iter()
        .step_by(triples.len().div_ceil(MAX_TRIPLES))
        .flat_map(|triple| p3p(triple.map(|i| pins[i].point_mm), triple.map(|i| directions[i])))
        .map(|pose| (score(&pose), pose))
        .collect();
    sort_short(&mut scored, |a, b| a.0.total_cmp(&b.0));
    scored.into_iter().take(FINALISTS).map(|(_, pose)| pose).collect()
}

/// The pins that a pose from the other ones does not explain.
fn outside(camera: &Intrinsics, pins: &[Pin], pose: &Pose, options: &PinOptions) -> Vec<usize> {
    let near = 4.0 * options.click_sigma_px;
    let mut is_inside: Vec<bool> =
        pins.iter().map(|pin| residual(camera, pose, pin).is_some_and(|r| r.length() < near)).collect();
    let mut pose = *pose;
    // The pose from a few pins may be rough; who turns out to be explained joins them, and it gets better.
    for _ in 0..pins.len() {
        let inside: Vec<Pin> =
            pins.iter().zip(&is_inside).filter(|(_, inside)| **inside).map(|(p, _)| *p).collect();
        let Some(fit) = plain_fit(camera, &inside, pose, options) else { return Vec::new() };
        pose = fit.pose;
        let Some(covariance) = inverse(&fit.equations.h) else { return Vec::new() };
        let degrees_of_freedom = (2 * inside.len()).saturating_sub(6).max(1) as f64;
        let variance_px2 = options.click_sigma_px.powi(2).max(fit.equations.cost / degrees_of_freedom);
        let covariance = covariance.map(|row| row.map(|value| value * variance_px2));
        let doubts: Vec<f64> =
            pins.iter().map(|pin| doubt(camera, pin, &fit, (&covariance, variance_px2))).collect();
        let joining = (0..pins.len())
            .filter(|&i| !is_inside[i] && doubts[i] < GATE)
            .min_by(|&i, &j| doubts[i].total_cmp(&doubts[j]));
        match joining {
            Some(pin) => is_inside[pin] = true,
            None => break,
        }
    }
    let outside: Vec<usize> = (0..pins.len()).filter(|&i| !is_inside[i]).collect();
    let inside = pins.len() - outside.len();
    if inside >= 4 && 3 * outside.len() <= pins.len() { outside } else { Vec::new() }
}

fn plain_fit(camera: &Intrinsics, pins: &[Pin], start: Pose, options: &PinOptions) -> Option<Fit> {
    let kernel = Kernel::Square;
    let fitting = Fitting { camera, pins, kernel, prior: None, click_sigma_px: options.click_sigma_px };
    (pins.len() >= 4).then(|| fitting.descend(start)).flatten()
}

/// The squared distance of a pin from where a pose without it sees it, in units of what is expected: of the pose's covariance
/// and of the variance of a click.
fn doubt(camera: &Intrinsics, pin: &Pin, fit: &Fit, (covariance, variance_px2): (&Matrix<6>, f64)) -> f64 {
    let seen = fit.pose.transform_point(pin.point_mm);
    let Some((pixel, jacobian)) = project_with_jacobian(camera, seen) else { return f64::INFINITY };
    let rows = jacobian.map(|gradient| motion_row(seen - fit.pivot_camera_mm, gradient));
    let mut expected = congruent(&rows, covariance);
    for (i, row) in expected.iter_mut().enumerate() {
        row[i] += variance_px2 / pin.weight;
    }
    let offset: DVec2 = pixel - pin.pixel;
    solve(&expected, &offset.to_array()).map_or(f64::INFINITY, |[x, y]| offset.dot(DVec2::new(x, y)))
}
