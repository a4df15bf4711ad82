//! Snap: from a rough pose to the one that the photo supports best.
//!
//! Colour statistics on either side of the outline pull from afar (after Stoiber et al., *SRT3D*, 2022), edges from near
//! (after Drummond and Cipolla, 2002), and where the background is clear the last steps measure the outline's exact place.
//! Pins pull in the same equations. It is a state machine: each step is short, so that no frame is late.

mod colors;
mod edges;
mod lines;
mod picture;
mod score;

use std::fmt;
use std::sync::Arc;

use glam::DVec3;

use super::TwistCovariance;
use super::contour::{ContourModel, ContourPoint, DepthView, Occluders};
use super::least_squares::NormalEquations;
use super::linear::{inverse, solve};
use super::motion::{motion_row, moved_about, project_with_jacobian};
use super::pins::Pin;
use crate::math::{ImageRect, Intrinsics, NEAR_MM, Pose, rotation_vector_from_rotation};
use crate::photo::Pixels;
use crate::raster::PixelRegion;
use colors::{Band, ColorModel};
use picture::Picture;

pub use score::SnapScore;

/// What else is known of the object in this photo.
#[derive(Debug, Clone, Default)]
pub struct SnapHints {
    /// Pins pull with the weight of a click each.
    pub pins: Vec<Pin>,
    /// Objects that may be before this one, with their poses.
    pub occluders: Vec<(Arc<ContourModel>, Pose)>,
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
    /// Object and background look alike; the start is returned.
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
            Self::NoContrast => "Object and background look too much alike here to snap to.",
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

/// What is looked at in a number of steps.
#[derive(Debug, Clone, Copy)]
struct Stage {
    steps: u32,
    /// Pixels a sample; 0 leaves the regions out.
    stride_px: usize,
    /// How far edges are looked for; 0 leaves them out.
    edge_reach_px: f64,
    coverage: bool,
}

/// From far to near.
const STAGES: [Stage; 5] = [
    Stage { steps: 3, stride_px: 3, edge_reach_px: 0.0, coverage: false },
    Stage { steps: 3, stride_px: 2, edge_reach_px: 0.0, coverage: false },
    Stage { steps: 3, stride_px: 2, edge_reach_px: 0.0, coverage: false },
    Stage { steps: 3, stride_px: 1, edge_reach_px: 4.0, coverage: false },
    Stage { steps: 4, stride_px: 1, edge_reach_px: 3.0, coverage: true },
];
/// Contour points, about; more lie so close that they tell the same.
const POINTS: f64 = 220.0;
/// Beyond these the photo pulled the object to somewhere else: in radians, and as a part of the distance.
const LARGEST_TURN_RAD: f64 = 0.6;
const LARGEST_MOVE: f64 = 0.25;
/// Below this, the outline is hardly better than chance.
const SMALLEST_SCORE: f64 = 0.08;
/// A better score by less than this is chance.
const SMALLEST_GAIN: f64 = 0.01;
/// Errors of neighbouring lines go together (a shadow, an object of the same colour), so each counts as a part of a
/// measurement. Set roughly on the tuning half of the benchmark's photos; no sweep was made.
const LINE_SHARE: f64 = 0.02;
const LINE_SHARE_BESIDE_EDGES: f64 = 0.01;
const EDGE_SHARE: f64 = 0.05;
const COVERAGE_SHARE: f64 = 0.1;
/// How well somebody puts an object by hand, one standard deviation: per axis, of the distance, and in the picture.
const START_TURN_DEG: f64 = 2.0;
const START_DEPTH: f64 = 0.02;
const START_SHIFT_PX: f64 = 10.0;
/// Noise of a click: what a pin pulls with.
const PIN_SIGMA_PX: f64 = 2.0;

/// A refinement in progress.
#[derive(Debug, Clone)]
pub struct Snap {
    model: Arc<ContourModel>,
    pins: Vec<Pin>,
    picture: Option<(Picture, Occluders)>,
    start: Pose,
    pose: Pose,
    colors: Option<ColorModel>,
    /// What the start looks like.
    first_view: Option<DepthView>,
    stage: usize,
    step: u32,
    last: NormalEquations<6>,
    /// Where each stage ended.
    trail: Vec<(Pose, DVec3, NormalEquations<6>)>,
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
        let picture = object_rect(camera, &model, start).and_then(|rect| Picture::new(photo, camera, &rect));
        let others: Vec<(&ContourModel, Pose)> =
            hints.occluders.iter().map(|(model, pose)| (model.as_ref(), *pose)).collect();
        let picture = picture.map(|picture| {
            let occluders =
                Occluders::draw(&picture.camera, &others, PixelRegion::of_camera(&picture.camera));
            (picture, occluders)
        });
        Self {
            model,
            pins: hints.pins,
            picture,
            start: *start,
            pose: *start,
            colors: None,
            first_view: None,
            stage: 0,
            step: 0,
            last: NormalEquations::ZERO,
            trail: Vec::new(),
        }
    }

    /// Works while `go_on` says so, but for one iteration at least.
    pub fn step(&mut self, go_on: &mut dyn FnMut() -> bool) -> Progress {
        loop {
            if let Some(outcome) = self.advance() {
                return Progress::Done(Box::new(outcome));
            }
            if !go_on() {
                let total: u32 = STAGES.iter().map(|stage| stage.steps).sum();
                let done: u32 = STAGES[..self.stage].iter().map(|stage| stage.steps).sum::<u32>() + self.step;
                return Progress::Working(f64::from(done) / f64::from(total));
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
        let Some(stage) = STAGES.get(self.stage).copied() else {
            return Some(self.finish(picture, occluders));
        };
        let look = Look::at(picture, &self.model, occluders, &self.pose);
        if self.step == 0 {
            let first = self.first_view.get_or_insert_with(|| look.view.clone());
            self.colors = ColorModel::learn(picture, &look.view, first, band(&look, stage.stride_px));
        }
        let Some(colors) = &self.colors else { return Some(self.refused(SnapVerdict::OutOfView)) };
        let lines = lines::search(picture, &look.view, colors, &look.points, stage.stride_px);
        if lines.len() < 12 {
            return Some(self.refused(SnapVerdict::OutOfView));
        }
        let edges = if stage.edge_reach_px > 0.0 {
            edges::search(picture, colors, &look.points, stage.edge_reach_px)
        } else {
            Vec::new()
        };
        let exact = if stage.coverage { edges::measure_coverage(picture, &look.points) } else { Vec::new() };
        let line_share = if stage.edge_reach_px > 0.0 { LINE_SHARE_BESIDE_EDGES } else { LINE_SHARE };
        // The lines stay where they are while the pose takes two steps along them.
        for _ in 0..2 {
            let pivot = self.pose.transform_point(self.model.center_mm());
            let mut equations = NormalEquations::ZERO;
            lines::add_lines(
                &mut equations,
                picture,
                &self.pose,
                pivot,
                &lines,
                look.independence * line_share,
            );
            edges::add_edges(
                &mut equations,
                picture,
                &self.pose,
                pivot,
                &edges,
                (stage.edge_reach_px, look.independence * EDGE_SHARE),
            );
            edges::add_edges(
                &mut equations,
                picture,
                &self.pose,
                pivot,
                &exact,
                (2.0, look.independence * COVERAGE_SHARE),
            );
            self.add_pins(&mut equations, picture, pivot);
            self.last = equations.clone();
            self.add_prior(&mut equations, picture);
            let Some(step) = solve(&equations.h, &equations.g.map(|g| -g)) else { break };
            let moved = moved_about(&self.pose, pivot, &step);
            if !is_before_camera(&moved, &self.model) {
                break;
            }
            self.pose = moved;
        }
        self.step += 1;
        if self.step >= stage.steps {
            (self.stage, self.step) = (self.stage + 1, 0);
            let pivot = self.pose.transform_point(self.model.center_mm());
            self.trail.push((self.pose, pivot, self.last.clone()));
        }
        None
    }

    fn add_pins(&self, equations: &mut NormalEquations<6>, picture: &Picture, pivot: DVec3) {
        for pin in self.pins.iter().filter(|pin| pin.enabled) {
            let seen = self.pose.transform_point(pin.point_mm);
            let Some((pixel, jacobian)) = project_with_jacobian(&picture.camera, seen) else { continue };
            let weight = pin.weight * (picture.photo_px / PIN_SIGMA_PX).powi(2);
            let residual = pixel - picture.place_of(pin.pixel);
            for (gradient, residual) in jacobian.into_iter().zip(residual.to_array()) {
                equations.add(&motion_row(seen - pivot, gradient), residual, weight);
            }
        }
    }

    /// The start is where somebody put the object on purpose: what the picture says nothing of stays as it was.
    fn add_prior(&self, equations: &mut NormalEquations<6>, picture: &Picture) {
        let [from, to] = [&self.start, &self.pose].map(|pose| pose.transform_point(self.model.center_mm()));
        let turned = rotation_vector_from_rotation(&(self.pose.rotation * self.start.rotation.transpose()));
        let px_mm = from.z / picture.camera.focal_px() * picture.photo_px.recip();
        let shift = to - from;
        let lateral_mm = START_SHIFT_PX * px_mm;
        let turn_rad = START_TURN_DEG.to_radians();
        let depth_mm = START_DEPTH * from.z;
        let sigmas = [turn_rad, turn_rad, turn_rad, lateral_mm, lateral_mm, depth_mm];
        let residuals = [turned.x, turned.y, turned.z, shift.x, shift.y, shift.z];
        for (i, (residual, sigma)) in residuals.into_iter().zip(sigmas).enumerate() {
            let mut row = [0.0; 6];
            row[i] = 1.0;
            equations.add(&row, residual, 1.0 / (sigma * sigma));
        }
    }

    fn refused(&self, verdict: SnapVerdict) -> SnapOutcome {
        SnapOutcome {
            camera_from_object: self.start,
            verdict,
            score_before: 0.0,
            score_after: 0.0,
            covariance: None,
            turned_rad: 0.0,
            moved_mm: 0.0,
        }
    }

    /// Compares where the stages ended with the start, all with the same eyes: later stages are more exact where the photo is
    /// clear, and led astray where it is not.
    fn finish(&self, picture: &Picture, occluders: &Occluders) -> SnapOutcome {
        let scores = self.scores(picture, occluders);
        let before = scores.first().copied().unwrap_or_default();
        let best = (0..self.trail.len()).max_by(|&a, &b| scores[a + 1].total_cmp(&scores[b + 1]));
        let Some((best, (pose, pivot, equations))) =
            best.and_then(|best| Some((best, self.trail.get(best)?)))
        else {
            return self.refused(SnapVerdict::StartIsBest);
        };
        let after = scores[best + 1];
        let turned_rad = self.start.angle_to(pose);
        let place = |pose: &Pose| pose.transform_point(self.model.center_mm());
        let moved_mm = place(&self.start).distance(place(pose));
        let verdict =
            if turned_rad > LARGEST_TURN_RAD || moved_mm > LARGEST_MOVE * place(&self.start).length() {
                SnapVerdict::TooFar
            } else if after < SMALLEST_SCORE {
                SnapVerdict::NoContrast
            } else if after < before + SMALLEST_GAIN {
                SnapVerdict::StartIsBest
            } else {
                SnapVerdict::Improved
            };
        let kept = SnapOutcome { score_before: before, score_after: before, ..self.refused(verdict) };
        if verdict != SnapVerdict::Improved {
            return kept;
        }
        let covariance = inverse(&equations.h).map(|h| TwistCovariance::from_steps_about(*pivot, &h));
        SnapOutcome {
            camera_from_object: *pose,
            score_after: after,
            covariance,
            turned_rad,
            moved_mm,
            ..kept
        }
    }

    /// Of the start and of each stage's end, under the colours that each of them gives to the object.
    fn scores(&self, picture: &Picture, occluders: &Occluders) -> Vec<f64> {
        let poses = std::iter::once(&self.start).chain(self.trail.iter().map(|(pose, ..)| pose));
        let looks: Vec<Look> = poses.map(|pose| Look::at(picture, &self.model, occluders, pose)).collect();
        // A judge for each pose, which learns from what that pose and the start agree on.
        let Some(first) = looks.first() else { return Vec::new() };
        let judges: Vec<ColorModel> = looks
            .iter()
            .filter_map(|look| ColorModel::learn(picture, &look.view, &first.view, band(look, 1)))
            .collect();
        let score = |look: &Look, judge| score::score(picture, &look.view, judge, &look.points).total();
        let mean =
            |look| judges.iter().map(|judge| score(look, judge)).sum::<f64>() / judges.len().max(1) as f64;
        looks.iter().map(mean).collect()
    }
}

/// What a pose looks like in the picture.
struct Look {
    view: DepthView,
    points: Vec<ContourPoint>,
    size_px: f64,
    /// Points closer than two pixels to each other tell the same: what part of their weight is their own.
    independence: f64,
}

impl Look {
    fn at(picture: &Picture, model: &ContourModel, occluders: &Occluders, pose: &Pose) -> Self {
        let region = PixelRegion::of_camera(&picture.camera);
        let view = DepthView::draw(&picture.camera, model, *pose, occluders, region);
        let distance = pose.transform_point(model.center_mm()).z.max(NEAR_MM);
        let size_px = picture.camera.focal_px() * model.diameter_mm() / distance;
        let spacing_px = (std::f64::consts::PI * size_px / POINTS).max(0.5);
        let points = model.points(&picture.camera, pose, &view, spacing_px);
        Self { view, points, size_px, independence: (spacing_px / 2.0).min(1.0) }
    }
}

/// How far from the contour pixels are taken for what the pose says they are.
fn band(look: &Look, stride_px: usize) -> Band {
    let unsure_px = if stride_px > 1 { (stride_px as f64).min(0.06 * look.size_px) } else { 1.5 };
    Band { unsure_px, reach_px: (0.3 * look.size_px).clamp(12.0, 60.0) }
}

fn is_before_camera(pose: &Pose, model: &ContourModel) -> bool {
    let center = pose.transform_point(model.center_mm());
    center.is_finite() && center.z > 0.5 * model.diameter_mm() + NEAR_MM
}

/// Around the object's box in the photo; `None` where a corner is not before the camera.
fn object_rect(camera: &Intrinsics, model: &ContourModel, pose: &Pose) -> Option<ImageRect> {
    let corners = model.mesh().bounds().corners();
    let pixels: Option<Vec<_>> =
        corners.into_iter().map(|corner| camera.project(pose.transform_point(corner))).collect();
    ImageRect::around(pixels?)
}

#[cfg(test)]
mod tests;
