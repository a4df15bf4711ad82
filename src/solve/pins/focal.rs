//! The focal length together with the pose, from six pins or more.

use glam::DVec2;
use thiserror::Error;

use super::super::least_squares::{Limits, NormalEquations, levenberg_marquardt};
use super::super::linear::inverse;
use super::super::motion::{motion_row, moved_about, project_with_jacobian};
use super::misclicks::misclicks;
use super::refine::{Fitting, Kernel, middle, residual};
use super::spread::Spread;
use super::sqpnp::{Sighting, sqpnp};
use super::{Pin, PinError, PinOptions, checked};
use crate::math::{Intrinsics, Pose};

/// A camera of another focal length and a pose that fit the pins together. A focal length that is off by a part makes the
/// distance off by about the same part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FocalSolution {
    /// The camera that was given with fx, fy and the skew scaled alike.
    pub camera: Intrinsics,
    pub camera_from_object: Pose,
    pub rms_px: f64,
    /// One standard deviation of the focal length as a part of it: also that of the distance.
    pub relative_sigma: f64,
}

/// Why there is no focal length.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum FocalError {
    #[error(transparent)]
    Pin(#[from] PinError),
    #[error("{pins} pins are in use, the focal length needs six or more")]
    TooFew { pins: usize },
    #[error("the pins are in one plane: add some well above or below it")]
    Planar,
    #[error(
        "the pins do not tell the focal length from the distance: add some nearer to and farther from the camera"
    )]
    NotDetermined,
}

const FEWEST_PINS: usize = 6;
/// Focal lengths that are tried first, as parts of the longer side of the photo: from fisheye to long telephoto lenses.
const FIRST_GUESSES: [f64; 8] = [0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 3.2, 6.0];
/// Beyond this many standard deviations of a click, misclicks are looked for, among so many of the worst pins.
const DOUBTFUL_SIGMAS: f64 = 3.0;
const MOST_SUSPECTS: usize = 12;
/// A standard deviation beyond this is no measurement.
const LARGEST_SIGMA: f64 = 0.35;

/// Solves for the pose and one factor on fx and fy; principal point, aspect and distortion are taken as given. Misclicks are
/// left out where six pins remain.
pub fn solve_focal(
    camera: &Intrinsics,
    pins: &[Pin],
    options: &PinOptions,
) -> Result<FocalSolution, FocalError> {
    checked(pins)?;
    let mut used: Vec<Pin> = pins.iter().filter(|pin| pin.counts()).copied().collect();
    if used.len() < FEWEST_PINS {
        return Err(FocalError::TooFew { pins: used.len() });
    }
    let points: Vec<_> = used.iter().map(|pin| pin.point_mm).collect();
    if Spread::of(&points).is_none_or(|spread| spread.is_planar() || spread.is_collinear()) {
        return Err(FocalError::Planar);
    }
    let mut best = best_fit(camera, &used, options).ok_or(PinError::NoPose)?;
    let wrong = wrong_pins(camera, &used, &best.0, options);
    let left: Vec<Pin> = without(&used, |number| wrong.contains(&number));
    // Of fewer it cannot be told whether it was a misclick.
    if !wrong.is_empty() && left.len() >= FEWEST_PINS {
        best = best_fit(camera, &left, options).ok_or(PinError::NoPose)?;
        used = left;
    }
    let (state, equations) = best;
    let surplus = 2.0 * used.len() as f64 - 7.0;
    // As many clicks' worth of experience as `solution` counts.
    let variance = (equations.cost + 4.0 * options.click_sigma_px.powi(2)) / (surplus + 4.0);
    let covariance = inverse(&equations.h).ok_or(FocalError::NotDetermined)?;
    let relative_sigma = (covariance[6][6] * variance).sqrt();
    if relative_sigma > LARGEST_SIGMA || !relative_sigma.is_finite() {
        return Err(FocalError::NotDetermined);
    }
    Ok(FocalSolution {
        camera: state.camera(camera),
        camera_from_object: state.pose,
        rms_px: (equations.cost / used.len() as f64).sqrt(),
        relative_sigma,
    })
}

fn without(pins: &[Pin], is_left_out: impl Fn(usize) -> bool) -> Vec<Pin> {
    pins.iter().enumerate().filter(|(number, _)| !is_left_out(*number)).map(|(_, pin)| *pin).collect()
}

fn best_fit(given: &Intrinsics, pins: &[Pin], options: &PinOptions) -> Option<(State, NormalEquations<7>)> {
    let longer_side = f64::from(given.width.max(given.height));
    FIRST_GUESSES
        .iter()
        .filter_map(|guess| refined(given, pins, guess * longer_side / given.focal_px(), options))
        .min_by(|a, b| a.1.cost.total_cmp(&b.1.cost))
}

/// Misclicks, by the camera that fits best when one of the worst pins is left out: a single one can bend a focal length far
/// enough for all others to look wrong.
fn wrong_pins(given: &Intrinsics, pins: &[Pin], fit: &State, options: &PinOptions) -> Vec<usize> {
    let camera = fit.camera(given);
    let off_px = |pin: &Pin| residual(&camera, &fit.pose, pin).map_or(f64::INFINITY, DVec2::length);
    let mut worst: Vec<(f64, usize)> =
        pins.iter().enumerate().map(|(number, pin)| (off_px(pin), number)).collect();
    worst.sort_by(|a, b| b.0.total_cmp(&a.0));
    if worst.first().is_none_or(|(off_px, _)| *off_px < DOUBTFUL_SIGMAS * options.click_sigma_px) {
        return Vec::new();
    }
    let fits = worst
        .into_iter()
        .take(MOST_SUSPECTS)
        .filter_map(|(_, suspect)| best_fit(given, &without(pins, |number| number == suspect), options));
    let best = fits.min_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
    best.map_or_else(Vec::new, |(state, _)| misclicks(&state.camera(given), pins, options))
}

/// A pose and the logarithm of the factor on the focal length: a factor stays positive.
#[derive(Debug, Clone, Copy)]
struct State {
    pose: Pose,
    log_factor: f64,
}

impl State {
    fn camera(&self, given: &Intrinsics) -> Intrinsics {
        let factor = self.log_factor.exp();
        Intrinsics { fx: given.fx * factor, fy: given.fy * factor, skew: given.skew * factor, ..*given }
    }
}

fn refined(
    given: &Intrinsics,
    pins: &[Pin],
    factor: f64,
    options: &PinOptions,
) -> Option<(State, NormalEquations<7>)> {
    let state = |pose| State { pose, log_factor: factor.ln() };
    let camera = state(Pose::IDENTITY).camera(given);
    let sighting = |pin: &Pin| Sighting {
        point_mm: pin.point_mm,
        normalized: camera.unproject(pin.pixel).truncate(),
        weight: pin.weight,
    };
    let sightings: Vec<Sighting> = pins.iter().map(sighting).collect();
    let click_sigma_px = options.click_sigma_px;
    let fitting = Fitting { camera: &camera, pins, kernel: Kernel::Square, prior: None, click_sigma_px };
    let start = sqpnp(&sightings).into_iter().find_map(|pose| fitting.descend_within(pose, 5))?;
    let pivot = middle(pins)?;
    let limits = Limits { iterations: 60, relative_decrease: 1e-10, good_enough: 1e-14 * pins.len() as f64 };
    levenberg_marquardt(
        state(start.pose),
        limits,
        |state| {
            let camera = state.camera(given);
            let middle = state.pose.transform_point(pivot);
            let mut equations = NormalEquations::ZERO;
            for pin in pins {
                let seen = state.pose.transform_point(pin.point_mm);
                let (pixel, jacobian) = project_with_jacobian(&camera, seen)?;
                let residual = pixel - pin.pixel;
                // A larger focal length moves pixels away from the principal point in proportion.
                let by_log_factor = [pixel.x - camera.cx, pixel.y - camera.cy];
                for ((gradient, residual), slope) in
                    jacobian.into_iter().zip(residual.to_array()).zip(by_log_factor)
                {
                    let [a, b, c, d, e, f] = motion_row(seen - middle, gradient);
                    equations.add(&[a, b, c, d, e, f, slope], residual, pin.weight);
                }
            }
            Some(equations)
        },
        |state, step| {
            let [a, b, c, d, e, f, log_step] = *step;
            let middle = state.pose.transform_point(pivot);
            let pose = moved_about(&state.pose, middle, &[a, b, c, d, e, f]);
            State { pose, log_factor: (state.log_factor + log_step).clamp(-5.0, 5.0) }
        },
    )
}
