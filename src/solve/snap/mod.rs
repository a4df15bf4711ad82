//! Snap: from a rough pose to the one that the photo supports best.
//!
//! Colour statistics on either side of the outline pull from afar (after Stoiber et al., *SRT3D*, 2022), edges from near
//! (after Drummond and Cipolla, 2002), and where the background is clear the last steps measure the outline's exact place.
//! Pins pull in the same equations. It is a state machine: each step is short, so that no frame is late.

mod colors;
mod edges;
mod lines;
mod look;
mod palette;
mod picture;
mod prior;
mod pull;
mod score;
mod stages;

use std::fmt;
use std::sync::Arc;

use super::TwistCovariance;
use super::contour::{ContourModel, Occluders};
use super::least_squares::NormalEquations;
use super::linear::inverse;
use super::pins::Pin;
use crate::math::{Intrinsics, Pose};
use crate::photo::Pixels;
use crate::raster::{Mask, PixelRegion};
use crate::scene::DepthInMm;
use look::{Look, object_rect};
use picture::Picture;
use prior::Prior;
use stages::{Ended, Refinement};

pub use score::SnapScore;

/// What else is known of the object in this photo.
#[derive(Debug, Clone, Default)]
pub struct SnapHints {
    /// Pins pull with the weight of a click each.
    pub pins: Vec<Pin>,
    /// Objects that may be before this one, with their poses.
    pub occluders: Vec<(Arc<ContourModel>, Pose)>,
    /// The photo's depth map, of its size: what is nearer than the whole object is before it.
    pub depth: Option<Arc<DepthInMm>>,
}

/// What a snap does other than usual.
#[derive(Debug, Clone, Default)]
pub struct SnapOptions {
    /// Where in the photo the object is seen, of the photo's size. It takes the place of what colours say.
    pub mask: Option<Mask>,
    pub reach: SnapReach,
}

/// How far off the start may be.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum SnapReach {
    /// By some 10° and a tenth of the object's size: where somebody put it by hand.
    #[default]
    Near,
    /// By some 20° and a fifth of the object's size: more starts are tried, which takes twice as long.
    Wide,
}

/// How a snap ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SnapVerdict {
    /// The pose is better than the start.
    Improved,
    /// Nothing nearby agrees better with the photo; the start is returned.
    StartIsBest,
    /// Too little of the object is in the photo; the start is returned.
    OutOfView,
    /// Object and background look alike, or what was found agrees too little with the photo; the start is returned.
    NoContrast,
    /// What was found is too far from the start to be trusted; the start is returned.
    TooFar,
}

impl fmt::Display for SnapVerdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Improved => "The photo supports this pose better.",
            Self::StartIsBest => "The photo supports no better pose near this one.",
            Self::OutOfView => "Too little of the object is in the photo to snap to.",
            Self::NoContrast => "The photo shows too little of the outline here to be sure of a better pose.",
            Self::TooFar => "The photo pulls the object far away from here; that is not to be trusted. Place it more closely.",
        })
    }
}

/// What a snap found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SnapOutcome {
    pub camera_from_object: Pose,
    pub verdict: SnapVerdict,
    pub score_before: f64,
    pub score_after: f64,
    /// From the last normal equations; `None` where the start was returned.
    pub covariance: Option<TwistCovariance>,
    /// How far the object was turned and its middle was moved.
    pub turned_rad: f64,
    pub moved_mm: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Progress {
    /// The part that is done, 0 to 1.
    Working(f64),
    Done(Box<SnapOutcome>),
}

/// Beyond these the photo pulled the object to somewhere else: in radians, and as a part of the distance.
const LARGEST_TURN_RAD: f64 = 0.6;
const LARGEST_MOVE: f64 = 0.25;
/// Below this, what was found is as likely to be wrong as right: on the tuning half of the benchmark's photos most poses
/// that a snap had made worse scored less, and few of the good ones.
const SMALLEST_SCORE: f64 = 0.3;
/// A better score by less than this is chance.
const SMALLEST_GAIN: f64 = 0.01;

/// A refinement in progress.
#[derive(Debug, Clone)]
pub struct Snap {
    model: Arc<ContourModel>,
    prior: Prior,
    reach: SnapReach,
    picture: Option<(Picture, Occluders)>,
    /// `None` until the start was scored.
    score_before: Option<f64>,
    /// From each of the starts; after the first phase the best are left.
    refinements: Vec<Refinement>,
    current: usize,
    is_fine: bool,
    steps_done: u32,
}

impl Snap {
    /// A snap of the object from `start`; `camera` is the photo's.
    pub fn new(
        photo: &Pixels,
        camera: &Intrinsics,
        model: Arc<ContourModel>,
        start: &Pose,
        hints: SnapHints,
    ) -> Self {
        Self::with(photo, camera, model, start, hints, &SnapOptions::default())
    }

    /// The same, otherwise than usual.
    pub fn with(
        photo: &Pixels,
        camera: &Intrinsics,
        model: Arc<ContourModel>,
        start: &Pose,
        hints: SnapHints,
        options: &SnapOptions,
    ) -> Self {
        let picture = object_rect(camera, &model, start)
            .and_then(|rect| Picture::new(photo, camera, &rect, options.mask.as_ref()));
        let others: Vec<(&ContourModel, Pose)> =
            hints.occluders.iter().map(|(model, pose)| (model.as_ref(), *pose)).collect();
        let picture = picture.map(|picture| {
            let region = PixelRegion::of_camera(&picture.camera);
            let mut occluders = Occluders::draw(&picture.camera, &others, region);
            let fitting =
                |depth: &&Arc<DepthInMm>| (depth.width, depth.height) == (photo.width, photo.height);
            if let Some(depth) = hints.depth.as_ref().filter(fitting) {
                let before_mm = nearest_mm(&model, start);
                occluders.add_measured(region, before_mm, |x, y| picture.measured_mm(depth, x, y));
            }
            (picture, occluders)
        });
        let prior = Prior { start: *start, pins: hints.pins, reach: options.reach };
        let refinements = prior.starts(&model).into_iter().map(Refinement::from).collect();
        Self {
            model,
            prior,
            reach: options.reach,
            picture,
            score_before: None,
            refinements,
            current: 0,
            is_fine: false,
            steps_done: 0,
        }
    }

    /// Works while `go_on` says so, but for one iteration at least.
    pub fn step(&mut self, go_on: &mut dyn FnMut() -> bool) -> Progress {
        loop {
            if let Some(outcome) = self.advance() {
                return Progress::Done(Box::new(outcome));
            }
            self.steps_done += 1;
            if !go_on() {
                let done = f64::from(self.steps_done);
                return Progress::Working(done / f64::from(self.steps_in_all()).max(done));
            }
        }
    }

    /// To the end, however long it takes.
    pub fn run(mut self) -> SnapOutcome {
        loop {
            if let Progress::Done(outcome) = self.step(&mut || true) {
                return *outcome;
            }
        }
    }

    /// One for the start's score, one for its choice of the best.
    fn steps_in_all(&self) -> u32 {
        let coarse = self.prior.starts(&self.model).len() as u32 * stages::steps(self.reach, false);
        let fine = stages::kept(self.reach) as u32 * stages::steps(self.reach, true);
        2 + coarse + fine
    }

    /// One iteration; the outcome after the last.
    fn advance(&mut self) -> Option<SnapOutcome> {
        let Some((picture, occluders)) = self.picture.take() else {
            return Some(self.refused(SnapVerdict::OutOfView));
        };
        let outcome = self.advance_in(&picture, &occluders);
        self.picture = Some((picture, occluders));
        outcome
    }

    fn advance_in(&mut self, picture: &Picture, occluders: &Occluders) -> Option<SnapOutcome> {
        if self.score_before.is_none() {
            let look = Look::at(picture, &self.model, occluders, &self.prior.start);
            self.score_before = Some(look.score(picture).map_or(0.0, |score| score.total()));
            return None;
        }
        if let Some(refinement) = self.refinements.get_mut(self.current) {
            let stages = stages::stages(self.reach, self.is_fine);
            let scene = stages::Scene { picture, occluders, model: &self.model, prior: &self.prior };
            if refinement.advance(&scene, stages) {
                self.current += 1;
            }
            return None;
        }
        if self.is_fine {
            return Some(self.finish());
        }
        self.refinements.retain(|refinement| refinement.best().is_some());
        self.refinements.sort_by(|a, b| b.last_score().total_cmp(&a.last_score()));
        self.refinements.truncate(stages::kept(self.reach));
        self.refinements.iter_mut().for_each(Refinement::rewind);
        (self.is_fine, self.current) = (true, 0);
        None
    }

    fn refused(&self, verdict: SnapVerdict) -> SnapOutcome {
        let score = self.score_before.unwrap_or(0.0);
        SnapOutcome {
            camera_from_object: self.prior.start,
            verdict,
            score_before: score,
            score_after: score,
            covariance: None,
            turned_rad: 0.0,
            moved_mm: 0.0,
        }
    }

    /// Compares where the stages ended with the start: later stages are more exact where the photo is clear, and led astray
    /// where it is not.
    fn finish(&self) -> SnapOutcome {
        let ends = self.refinements.iter().filter_map(Refinement::best);
        let Some(best) = ends.max_by(|a, b| a.score.total_cmp(&b.score)) else {
            return self.refused(SnapVerdict::OutOfView);
        };
        let before = self.score_before.unwrap_or(0.0);
        let start = &self.prior.start;
        let turned_rad = start.angle_to(&best.pose);
        let place = |pose: &Pose| pose.transform_point(self.model.center_mm());
        let moved_mm = place(start).distance(place(&best.pose));
        if turned_rad > LARGEST_TURN_RAD || moved_mm > LARGEST_MOVE * place(start).length() {
            return self.refused(SnapVerdict::TooFar);
        }
        if best.score < SMALLEST_SCORE {
            return self.refused(SnapVerdict::NoContrast);
        }
        if best.score < before + SMALLEST_GAIN {
            return self.refused(SnapVerdict::StartIsBest);
        }
        SnapOutcome {
            camera_from_object: best.pose,
            verdict: SnapVerdict::Improved,
            score_before: before,
            score_after: best.score,
            covariance: covariance(best),
            turned_rad,
            moved_mm,
        }
    }
}

/// What is nearer to the camera than this is not the object, though it be as far off as a start may be.
fn nearest_mm(model: &ContourModel, camera_from_object: &Pose) -> f64 {
    /// Of the object's radius: a tenth of its size.
    const START_ERROR: f64 = 0.2;
    let radius_mm = model.mesh().sphere().radius;
    let center = camera_from_object.transform_point(model.center_mm());
    center.z - (1.0 + START_ERROR) * radius_mm
}

/// Of the normal equations where a stage ended, scaled by how well they are fulfilled.
fn covariance(end: &Ended) -> Option<TwistCovariance> {
    let NormalEquations { h, cost, .. } = &end.equations;
    let scale = COVARIANCE_SCALE * (cost / end.pulls.max(1.0)).max(SMALLEST_RESIDUAL);
    let inverse = inverse(h)?.map(|row| row.map(|value| value * scale));
    Some(TwistCovariance::from_steps_about(end.pivot_camera_mm, &inverse))
}

/// Set on made photos so that half of the truths lie within the covariance's half. Their errors have longer tails than a
/// normal distribution's: the benchmark prints how often the truth is within 68 % and 95 %.
const COVARIANCE_SCALE: f64 = 3.0;
/// Residuals far below their variances are luck.
const SMALLEST_RESIDUAL: f64 = 0.05;

/// How well a photo agrees with a pose as it is; `None` where too little of the object is in it.
pub fn score_of(
    photo: &Pixels,
    camera: &Intrinsics,
    model: Arc<ContourModel>,
    camera_from_object: &Pose,
    hints: SnapHints,
) -> Option<SnapScore> {
    let Snap { model, picture, .. } = Snap::new(photo, camera, model, camera_from_object, hints);
    let (picture, occluders) = picture?;
    Look::at(&picture, &model, &occluders, camera_from_object).score(&picture)
}

#[cfg(test)]
mod tests;
