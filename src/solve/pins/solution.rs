//! From pins to a pose, its alternatives, and what to think of them.

use glam::{DVec2, DVec3};

use super::super::TwistCovariance;
use super::super::linear::inverse;
use super::advice::{PinAdvice, advise};
use super::misclicks::misclicks;
use super::p3p::p3p;
use super::refine::{Fit, Fitting, Kernel, Prior, middle, residual};
use super::spread::Spread;
use super::sqpnp::{Sighting, sqpnp};
use super::{Pin, PinError, PinOptions, checked};
use crate::math::{Intrinsics, NEAR_MM, Pose, rotation_from_rotation_vector, sort_short};

/// A pose that fits the pins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinPose {
    pub camera_from_object: Pose,
    /// Root mean square distance of the pins in use from their pixels.
    pub rms_px: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct PinSolution {
    pub camera_from_object: Pose,
    /// Over the pins in use.
    pub rms_px: f64,
    /// For every pin, also those out of use: where its point is seen minus where it was clicked. `None` behind the camera.
    pub residuals_px: Vec<Option<DVec2>>,
    /// Numbers of pins that the others contradict. They were left out.
    pub misclicks: Vec<usize>,
    /// Other poses that fit as well, as far as clicks can tell; the best first.
    pub alternatives: Vec<PinPose>,
    pub advice: Vec<PinAdvice>,
    /// How sure the pose is; `None` where the pins alone leave it open and it was held by the pose before.
    pub covariance: Option<TwistCovariance>,
}

/// The pose that brings the pins to their pixels. `current` is the pose before: it decides what pins leave open, and between
/// poses that fit equally well; with three pins or more that are not on a line it is not needed. Every pin in use ends before
/// the camera.
pub fn solve_pins(
    camera: &Intrinsics,
    pins: &[Pin],
    current: Option<&Pose>,
    options: &PinOptions,
) -> Result<PinSolution, PinError> {
    checked(pins)?;
    let mut in_use: Vec<usize> = (0..pins.len()).filter(|&i| pins[i].counts()).collect();
    let mut used: Vec<Pin> = in_use.iter().map(|&i| pins[i]).collect();
    let mut solver = Solver { camera, pins: &used, options };
    let mut minima = if solver.is_open() { Vec::new() } else { solver.minima(current) };
    let mut wrong = Vec::new();
    if minima.first().is_some_and(|best| solver.looks_wrong(best)) {
        wrong = misclicks(camera, &used, options).into_iter().map(|i| in_use[i]).collect();
    }
    if !wrong.is_empty() {
        in_use.retain(|i| !wrong.contains(i));
        used = in_use.iter().map(|&i| pins[i]).collect();
        solver = Solver { camera, pins: &used, options };
        minima = solver.minima(current);
    }
    let (pose, alternatives, covariance) = if minima.is_empty() {
        (solver.held(current)?, Vec::new(), None)
    } else {
        let (best, others) = solver.choose(minima, current);
        let covariance = solver.covariance(&best);
        (best.pose, others, covariance)
    };
    Ok(PinSolution {
        camera_from_object: pose,
        rms_px: solver.rms_px(&pose),
        residuals_px: pins.iter().map(|pin| residual(camera, &pose, pin)).collect(),
        misclicks: wrong,
        advice: advise(&used, alternatives.len() + 1, options),
        alternatives,
        covariance,
    })
}

/// Do these pins leave a pose open, whatever their pixels are? Those that do not count have no say.
pub fn leave_open(pins: &[Pin]) -> bool {
    let points: Vec<DVec3> = pins.iter().filter(|pin| pin.counts()).map(|pin| pin.point_mm).collect();
    points.len() < 3 || Spread::of(&points).is_none_or(|spread| spread.is_collinear())
}

/// Beyond this many standard deviations of a click, misclicks are looked for.
const DOUBTFUL_SIGMAS: f64 = 3.0;
/// Poses whose squared misfit differs by less than this many variances of a click cannot be told apart (3σ).
const INDISTINGUISHABLE: f64 = 9.0;
/// How many clicks' worth of experience stand behind [`PinOptions::click_sigma_px`], beside the residuals themselves.
const PRIOR_RESIDUALS: f64 = 4.0;

struct Solver<'a> {
    camera: &'a Intrinsics,
    pins: &'a [Pin],
    options: &'a PinOptions,
}

impl Solver<'_> {
    fn fitting(&self, kernel: Kernel, prior: Option<Prior>) -> Fitting<'_> {
        let click_sigma_px = self.options.click_sigma_px;
        Fitting { camera: self.camera, pins: self.pins, kernel, prior, click_sigma_px }
    }

    fn points(&self) -> Vec<DVec3> {
        self.pins.iter().map(|pin| pin.point_mm).collect()
    }

    fn is_open(&self) -> bool {
        leave_open(self.pins)
    }

    /// The poses that fit better than any near them, all before the camera, the best first.
    fn minima(&self, current: Option<&Pose>) -> Vec<Fit> {
        let mut starts = self.starts();
        starts.extend(current.copied());
        let fitting = self.fitting(Kernel::Square, None);
        let mut minima: Vec<Fit> = Vec::new();
        for start in starts {
            minima = with_new(minima, fitting.descend(start));
        }
        if let Some(best) = minima.first().cloned() {
            minima = with_new(minima, self.flipped(&best).and_then(|start| fitting.descend(start)));
        }
        // Clicks that are somewhat off, though no mistakes, pull less than in proportion to their square.
        let width = DOUBTFUL_SIGMAS * self.noise_squared(minima.first()).sqrt();
        let robust = self.fitting(Kernel::Huber(width), None);
        let is_rough = |fit: &Fit| {
            self.pins
                .iter()
                .any(|pin| residual(self.camera, &fit.pose, pin).is_none_or(|r| r.length() > width))
        };
        let mut minima: Vec<Fit> = minima
            .into_iter()
            .map(|fit| if is_rough(&fit) { robust.descend(fit.pose).unwrap_or(fit) } else { fit })
            .collect();
        sort_short(&mut minima, |a, b| a.equations.cost.total_cmp(&b.equations.cost));
        minima
    }

    fn starts(&self) -> Vec<Pose> {
        let sightings: Vec<Sighting> = self
            .pins
            .iter()
            .map(|pin| Sighting {
                point_mm: pin.point_mm,
                normalized: self.camera.unproject(pin.pixel).truncate(),
                weight: pin.weight,
            })
            .collect();
        let mut starts = if self.pins.len() > 3 { sqpnp(&sightings) } else { Vec::new() };
        if let Some(triple) = widest_triple(&self.points()) {
            let directions = triple.map(|i| sightings[i].normalized.extend(1.0).normalize());
            starts.extend(p3p(triple.map(|i| self.pins[i].point_mm), directions));
        }
        starts
    }

    /// The pose with the pins' plane tilted the other way: from afar the two look alike (Schweighofer and Pinz, *Robust
    /// Pose Estimation from a Planar Target*, 2006).
    fn flipped(&self, fit: &Fit) -> Option<Pose> {
        let spread = Spread::of(&self.points())?;
        let view = fit.pivot_camera_mm.try_normalize()?;
        let normal = fit.pose.rotation * spread.axes[2];
        let normal = if normal.dot(view) < 0.0 { -normal } else { normal };
        let turn_axis = normal.cross(view).try_normalize()?;
        let turn = rotation_from_rotation_vector(turn_axis * (2.0 * normal.angle_between(view)));
        Some(Pose::rotation_about(fit.pivot_camera_mm, turn) * fit.pose)
    }

    fn looks_wrong(&self, best: &Fit) -> bool {
        let gate = DOUBTFUL_SIGMAS * self.options.click_sigma_px;
        self.pins.iter().any(|pin| residual(self.camera, &best.pose, pin).is_none_or(|r| r.length() > gate))
    }

    /// The variance of a click, from the residuals where there are enough of them.
    fn noise_squared(&self, best: Option<&Fit>) -> f64 {
        let expected = self.options.click_sigma_px.powi(2);
        let Some(best) = best else { return expected };
        let surplus = (2.0 * self.pins.len() as f64 - 6.0).max(0.0);
        (best.equations.cost + PRIOR_RESIDUALS * expected) / (surplus + PRIOR_RESIDUALS)
    }

    /// The pose and its alternatives: of those that fit equally well, the one nearest to the pose before.
    fn choose(&self, minima: Vec<Fit>, current: Option<&Pose>) -> (Fit, Vec<PinPose>) {
        let lowest = minima.iter().map(|fit| fit.equations.cost).fold(f64::INFINITY, f64::min);
        let limit = lowest + INDISTINGUISHABLE * self.noise_squared(minima.first());
        let mut plausible: Vec<Fit> = minima.into_iter().filter(|fit| fit.equations.cost <= limit).collect();
        let nearest = current.and_then(|current| {
            let turns = plausible.iter().map(|fit| fit.pose.angle_to(current));
            turns.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
        });
        let best = plausible.remove(nearest.unwrap_or(0));
        let alternatives = plausible
            .into_iter()
            .map(|fit| PinPose { camera_from_object: fit.pose, rms_px: self.rms_px(&fit.pose) })
            .collect();
        (best, alternatives)
    }

    /// From the normal equations of all pins in use, whatever their kernel's weights, scaled by the residuals.
    fn covariance(&self, best: &Fit) -> Option<TwistCovariance> {
        let fit = self.fitting(Kernel::Square, None).descend_within(best.pose, 0)?;
        let scale = self.noise_squared(Some(&fit));
        let covariance = inverse(&fit.equations.h)?.map(|row| row.map(|value| value * scale));
        Some(TwistCovariance::from_steps_about(fit.pivot_camera_mm, &covariance))
    }

    /// The pose nearest to the one before that brings the pins to their pixels.
    fn held(&self, current: Option<&Pose>) -> Result<Pose, PinError> {
        let pins = self.pins.len();
        let current =
            *current.ok_or(if self.is_open() { PinError::NeedsStart { pins } } else { PinError::NoPose })?;
        let Some(pivot) = middle(self.pins) else { return Ok(current) };
        let start = self.before_camera(&current, pivot);
        // Two pins can be met by place, depth and roll alone; more have something to say about the tilt.
        let tilt_sigma_rad = if pins < 3 { 0.005 } else { 0.3 };
        let prior = Prior::new(start, pivot, tilt_sigma_rad);
        let fit = self.fitting(Kernel::Square, Some(prior)).descend(start).ok_or(PinError::NoPose)?;
        Ok(fit.pose)
    }

    /// The pose itself if every pin is before the camera, else shifted so that they are, on the ray to their pixels.
    fn before_camera(&self, pose: &Pose, pivot: DVec3) -> Pose {
        let is_before = |pin: &Pin| pose.transform_point(pin.point_mm).z >= 2.0 * NEAR_MM;
        if self.pins.iter().all(is_before) {
            return *pose;
        }
        let radius = self.pins.iter().map(|pin| pin.point_mm.distance(pivot)).fold(0.0, f64::max);
        let depth_mm = (4.0 * radius).max(500.0);
        let pixel = self.pins.iter().map(|pin| pin.pixel).sum::<DVec2>() / self.pins.len() as f64;
        let place = self.camera.unproject(pixel) * depth_mm;
        pose.translated(place - pose.transform_point(pivot))
    }

    fn rms_px(&self, pose: &Pose) -> f64 {
        let residuals = self.pins.iter().filter_map(|pin| residual(self.camera, pose, pin));
        let (sum, count) =
            residuals.fold((0.0, 0_u32), |(sum, count), r| (sum + r.length_squared(), count + 1));
        (sum / f64::from(count.max(1))).sqrt()
    }
}

/// Adds a minimum unless it is there already; keeps the lowest cost first.
fn with_new(mut minima: Vec<Fit>, new: Option<Fit>) -> Vec<Fit> {
    if let Some(new) = new
        && minima.iter().all(|other| !is_same_minimum(other, &new))
    {
        let place = minima.partition_point(|other| other.equations.cost <= new.equations.cost);
        minima.insert(place, new);
    }
    minima
}

fn is_same_minimum(a: &Fit, b: &Fit) -> bool {
    let depth_mm = a.pivot_camera_mm.length();
    a.pose.angle_to(&b.pose) < 1e-3 && a.pivot_camera_mm.distance(b.pivot_camera_mm) < 1e-3 * depth_mm
}

/// Three points far from each other: the one farthest from the middle, the one farthest from that, and the one that makes
/// the largest triangle with both.
fn widest_triple(points: &[DVec3]) -> Option<[usize; 3]> {
    let middle = points.iter().sum::<DVec3>() / points.len() as f64;
    let farthest = |measure: &dyn Fn(DVec3) -> f64| {
        (0..points.len()).max_by(|&i, &j| measure(points[i]).total_cmp(&measure(points[j])))
    };
    let first = farthest(&|point| point.distance_squared(middle))?;
    let second = farthest(&|point| point.distance_squared(points[first]))?;
    let side = points[second] - points[first];
    let third = farthest(&|point| (point - points[first]).cross(side).length_squared())?;
    let are_apart = (points[third] - points[first]).cross(side) != DVec3::ZERO;
    (points.len() >= 3 && are_apart).then_some([first, second, third])
}
