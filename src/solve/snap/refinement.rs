//! From one place towards the picture, step by step.

use glam::DVec3;

use super::SnapReach;
use super::colors::ColorModel;
use super::look::{Density, Look, is_before_camera};
use super::measurements::{Equations, Kind, motion_in};
use super::prior::Prior;
use super::pull::{self, Pull};
use super::sight::Sight;
use super::{edges, surface};
use crate::math::Pose;
use crate::solve::contour::ContourModel;
use crate::solve::linear::solve;
use crate::solve::motion::moved_about;
use crate::solve::robust::median;

/// What part of an independent measurement each is, see [`Kind`]: set on made photos (another seed than the benchmark's) and
/// on the tuning half of its real ones.
const EDGE_SHARE: f64 = 0.1;
const COVERAGE_SHARE: f64 = 0.1;
const SURFACE_SHARE: f64 = 0.05;
const MASK_SHARE: f64 = 0.1;

/// How far is looked across the contour, at first and then: for edges, and for the exact place of the outline.
const EDGE_REACH_PX: [f64; 2] = [5.0, 3.0];
const COVERAGE_REACH_PX: [usize; 2] = [4, 3];
/// A mask is not mistaken for something else.
const MASK_REACH_PX: f64 = 20.0;
const FIRST_STEPS: u32 = 2;
/// Colours are learnt anew after so many steps, when the contour is nearer to its place.
const STEPS_PER_COLORS: u32 = 3;
/// Pixels closer than this to the contour do not teach colours.
const UNSURE_PX: f64 = 1.5;
/// With fewer points of an outline there is nothing to hold on to.
const FEWEST_POINTS: usize = 12;

/// A step that moves the contour by less is the last.
const SMALLEST_STEP_PX: f64 = 0.02;
/// Steps of a refinement at most.
pub const STEPS: u32 = 8;

/// How many of the places that a search finds are rated, and how many of those are refined.
pub fn kept(reach: SnapReach) -> [usize; 2] {
    match reach {
        SnapReach::Near => [3, 2],
        SnapReach::Wide => [7, 3],
    }
}

/// What all refinements look at.
pub struct Scene<'a> {
    pub sight: &'a Sight,
    pub model: &'a ContourModel,
    pub prior: &'a Prior,
}

/// The way from one place.
#[derive(Debug, Clone)]
pub struct Refinement {
    pub pose: Pose,
    /// Of the pose, once it was rated; far below any other where too little of the object is in the picture.
    pub score: f64,
    /// What the picture and the pins say, without the start; for small motions about the object's middle.
    pub evidence: Option<Equations>,
    colors: Option<ColorModel>,
    step: u32,
}

impl From<Pose> for Refinement {
    fn from(start: Pose) -> Self {
        Self { pose: start, score: f64::NEG_INFINITY, evidence: None, colors: None, step: 0 }
    }
}

impl Refinement {
    pub fn rate(&mut self, scene: &Scene<'_>) {
        let look = Look::at(scene.sight, scene.model, &self.pose, Density::Fine);
        self.score = look.score(&scene.sight.picture).map_or(f64::NEG_INFINITY, |score| score.total());
    }

    /// One iteration; whether it was the last. The end is rated.
    pub fn advance(&mut self, scene: &Scene<'_>) -> bool {
        if self.step >= STEPS || !self.iterate(scene) {
            self.rate(scene);
            return true;
        }
        self.step += 1;
        false
    }

    /// Whether there was enough to see and the pose moved.
    fn iterate(&mut self, scene: &Scene<'_>) -> bool {
        let picture = &scene.sight.picture;
        let look = Look::at(scene.sight, scene.model, &self.pose, Density::Fine);
        if look.points.len() < FEWEST_POINTS {
            return false;
        }
        if self.step.is_multiple_of(STEPS_PER_COLORS) {
            self.colors = look.colors(picture, UNSURE_PX);
        }
        let center_mm = scene.model.center_mm();
        let pivot_camera_mm = self.pose.transform_point(center_mm);
        let Some(mut kinds) = self.look_around(scene, &look, pivot_camera_mm) else { return false };
        let equations = |kinds: &[Kind]| {
            let mut equations = Equations::ZERO;
            kinds.iter().for_each(|kind| kind.add_to(&mut equations));
            Prior::add_shared(&mut equations);
            scene.prior.add_pins(&mut equations, picture, (&self.pose, pivot_camera_mm));
            equations
        };
        let step_of = |mut equations: Equations| {
            scene.prior.add_start(&mut equations, picture, &self.pose, center_mm);
            solve(&equations.h, &equations.g.map(|g| -g))
        };
        // What kinds are worth is known when it is known what a step leaves.
        let Some(first) = step_of(equations(&kinds)) else { return false };
        kinds.iter_mut().for_each(|kind| kind.doubt_what_is_left(&first));
        let equations = equations(&kinds);
        let Some(step) = step_of(equations.clone()) else { return false };
        let motion = motion_in(&step);
        let moved = moved_about(&self.pose, pivot_camera_mm, &motion);
        if !is_before_camera(&moved, scene.model) {
            return false;
        }
        self.pose = moved;
        self.evidence = Some(equations);
        look.motion_px(&motion, pivot_camera_mm.z, picture) > SMALLEST_STEP_PX || self.step < FIRST_STEPS
    }

    /// All that the picture says of the present pose; `None` where colours cannot be told apart.
    fn look_around(&self, scene: &Scene<'_>, look: &Look, pivot_camera_mm: DVec3) -> Option<[Kind; 4]> {
        let picture = &scene.sight.picture;
        let about = (&self.pose, pivot_camera_mm);
        let later = usize::from(self.step >= FIRST_STEPS);
        let edge_reach_px = EDGE_REACH_PX[later];
        let edges = edges::search(picture, self.colors.as_ref()?, &look.points, edge_reach_px);
        let coverage = edges::measure_coverage(picture, &look.points, COVERAGE_REACH_PX[later]);
        let coverage_gate_px = coverage_gate_px(&coverage);
        let mask = edges::follow_mask(picture, &look.points, MASK_REACH_PX);
        let share_of = |share: f64| look.independence * share;
        Some([
            Kind {
                measurements: pull::measurements(picture, about, &edges, edge_reach_px),
                share: share_of(EDGE_SHARE),
            },
            Kind {
                measurements: pull::measurements(picture, about, &coverage, coverage_gate_px),
                share: share_of(COVERAGE_SHARE),
            },
            Kind {
                measurements: pull::measurements(picture, about, &mask, 2.0 * MASK_REACH_PX),
                share: share_of(MASK_SHARE),
            },
            Kind {
                measurements: surface::measurements(picture, (look, scene.model), about),
                share: SURFACE_SHARE,
            },
        ])
    }
}

/// A few times what is usual among the measurements: near the end half a pixel more than that is another edge.
fn coverage_gate_px(found: &[Pull]) -> f64 {
    let usual_px = median(found.iter().map(|pull| pull.offset_px.abs()).collect());
    (5.0 * usual_px).clamp(0.3, 2.0)
}
