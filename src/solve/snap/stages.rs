//! From one start towards the picture, stage by stage.

use glam::DVec3;

use super::SnapReach;
use super::colors::ColorModel;
use super::look::{Density, Look, is_before_camera};
use super::prior::Prior;
use super::pull::{Pull, Trust, add_pulls};
use super::sight::Sight;
use super::surface::add_surface;
use super::{edges, lines};
use crate::math::Pose;
use crate::solve::contour::ContourModel;
use crate::solve::least_squares::NormalEquations;
use crate::solve::linear::solve;
use crate::solve::motion::moved_about;

/// What is looked at in a number of steps.
#[derive(Debug, Clone, Copy)]
pub struct Stage {
    steps: u32,
    /// Pixels a sample of the regions.
    stride_px: usize,
    /// Pixels closer than this to the contour do not teach colours.
    unsure_px: f64,
    /// How far edges are looked for; 0 leaves them out.
    edge_reach_px: f64,
    /// Whether the outline is measured exactly where it is clear.
    coverage: bool,
}

/// Errors of neighbouring lines go together (a shadow, an object of the same colour), so each counts as a part of a
/// measurement. Chosen among a dozen settings on the tuning half of the benchmark's photos.
const LINE_SHARE: f64 = 0.03;
const LINE_SHARE_BESIDE_EDGES: f64 = 0.01;
const EDGE_SHARE: f64 = 0.1;
const COVERAGE_SHARE: f64 = 0.1;
const SURFACE_SHARE: f64 = 0.01;

impl Stage {
    const fn has_edges(&self) -> bool {
        self.edge_reach_px > 0.0
    }
}

const fn regions(steps: u32, stride_px: usize, unsure_px: f64) -> Stage {
    Stage { steps, stride_px, unsure_px, edge_reach_px: 0.0, coverage: false }
}

/// From far to near: the first phase, from every start, and the second, from where the best of them ended.
const NEAR: [&[Stage]; 2] = [
    &[regions(2, 3, 5.0), regions(2, 2, 3.0), regions(2, 2, 2.0)],
    &[
        Stage { steps: 3, stride_px: 1, unsure_px: 1.5, edge_reach_px: 5.0, coverage: false },
        Stage { steps: 5, stride_px: 1, unsure_px: 1.5, edge_reach_px: 3.0, coverage: true },
    ],
];
const WIDE: [&[Stage]; 2] = [
    &[regions(2, 5, 6.0), regions(2, 3, 4.0), regions(1, 2, 2.0)],
    &[
        regions(2, 2, 2.0),
        Stage { steps: 3, stride_px: 1, unsure_px: 1.5, edge_reach_px: 5.0, coverage: false },
        Stage { steps: 5, stride_px: 1, unsure_px: 1.5, edge_reach_px: 3.0, coverage: true },
    ],
];

pub fn stages(reach: SnapReach, is_fine: bool) -> &'static [Stage] {
    let phases = match reach {
        SnapReach::Near => &NEAR,
        SnapReach::Wide => &WIDE,
    };
    phases[usize::from(is_fine)]
}

/// With the score at the end.
pub fn steps(reach: SnapReach, is_fine: bool) -> u32 {
    1 + stages(reach, is_fine).iter().map(|stage| stage.steps).sum::<u32>()
}

/// How many of the places that were found are refined, and how many of those go on to the second phase.
pub fn kept(reach: SnapReach) -> [usize; 2] {
    match reach {
        SnapReach::Near => [2, 1],
        SnapReach::Wide => [3, 2],
    }
}

/// What all refinements look at.
pub struct Scene<'a> {
    pub sight: &'a Sight,
    pub model: &'a ContourModel,
    pub prior: &'a Prior,
}

/// Where a stage ended.
#[derive(Debug, Clone)]
pub struct Ended {
    pub pose: Pose,
    pub score: f64,
    pub evidence: Evidence,
    pub pivot_camera_mm: DVec3,
}

/// What the picture and the pins say, without the start; for small motions about the pivot.
#[derive(Debug, Clone)]
pub struct Evidence {
    pub equations: NormalEquations<6>,
    /// How many measurements stand behind them.
    pub pulls: f64,
    /// The gradient that an outline seen one pixel farther out would add.
    pub outward: [f64; 6],
}

impl Evidence {
    const NONE: Self = Self { equations: NormalEquations::ZERO, pulls: 0.0, outward: [0.0; 6] };
}

/// The way from one start.
#[derive(Debug, Clone)]
pub struct Refinement {
    pose: Pose,
    colors: Option<ColorModel>,
    stage: usize,
    step: u32,
    last: Evidence,
    ends: Vec<Ended>,
}

impl From<Pose> for Refinement {
    fn from(start: Pose) -> Self {
        Self { pose: start, colors: None, stage: 0, step: 0, last: Evidence::NONE, ends: Vec::new() }
    }
}

impl Refinement {
    /// One iteration; whether it was the last.
    pub fn advance(&mut self, scene: &Scene<'_>, stages: &[Stage]) -> bool {
        let is_coarse = stages.get(self.stage).is_some_and(|stage| !stage.has_edges());
        let density = if is_coarse { Density::Coarse } else { Density::Fine };
        let look = Look::at(scene.sight, scene.model, &self.pose, density);
        let Some(stage) = stages.get(self.stage) else {
            self.end(scene, &look);
            return true;
        };
        if self.step == 0 {
            if stage.coverage {
                self.end(scene, &look);
            }
            self.colors = look.colors(&scene.sight.picture, stage.unsure_px);
        }
        if !self.iterate(scene, stage, &look) {
            return true;
        }
        self.step += 1;
        if self.step >= stage.steps {
            (self.stage, self.step) = (self.stage + 1, 0);
        }
        false
    }

    pub fn rewind(&mut self) {
        (self.stage, self.step) = (0, 0);
    }

    pub fn best(&self) -> Option<&Ended> {
        self.ends.iter().max_by(|a, b| a.score.total_cmp(&b.score))
    }

    pub fn last_score(&self) -> f64 {
        self.ends.last().map_or(f64::NEG_INFINITY, |end| end.score)
    }

    fn end(&mut self, scene: &Scene<'_>, look: &Look) {
        let Some(score) = look.score(&scene.sight.picture) else { return };
        let pivot_camera_mm = self.pose.transform_point(scene.model.center_mm());
        let evidence = self.last.clone();
        self.ends.push(Ended { pose: self.pose, score: score.total(), evidence, pivot_camera_mm });
    }

    /// Whether there was enough to see.
    fn iterate(&mut self, scene: &Scene<'_>, stage: &Stage, look: &Look) -> bool {
        let Some(colors) = &self.colors else { return false };
        let lines = lines::search(&scene.sight.picture, &look.view, colors, &look.points, stage.stride_px);
        if lines.len() < 12 {
            return false;
        }
        let mut kinds: Vec<(Vec<Pull>, Trust)> = Vec::with_capacity(3);
        let line_share = if stage.has_edges() { LINE_SHARE_BESIDE_EDGES } else { LINE_SHARE };
        kinds.push((lines, Trust { share: look.independence * line_share, gate_px: f64::INFINITY }));
        if stage.has_edges() {
            let found = edges::search(&scene.sight.picture, colors, &look.points, stage.edge_reach_px);
            let share = look.independence * EDGE_SHARE;
            kinds.push((found, Trust { share, gate_px: stage.edge_reach_px }));
        }
        if stage.coverage {
            let reach_px = if self.step < 2 { 4 } else { 3 };
            let found = edges::measure_coverage(&scene.sight.picture, &look.points, reach_px);
            let gate_px = coverage_gate_px(&found);
            kinds.push((found, Trust { share: look.independence * COVERAGE_SHARE, gate_px }));
        }
        if stage.coverage {
            self.take_step(scene, &kinds, Some(look));
            return true;
        }
        // The lines stay where they are while the pose takes two steps along them.
        for _ in 0..2 {
            if !self.take_step(scene, &kinds, None) {
                break;
            }
        }
        true
    }

    /// Along the pulls, and with `surface` along what that look's inner pixels want.
    fn take_step(&mut self, scene: &Scene<'_>, kinds: &[(Vec<Pull>, Trust)], surface: Option<&Look>) -> bool {
        let center_mm = scene.model.center_mm();
        let pivot = self.pose.transform_point(center_mm);
        let Evidence { mut equations, mut pulls, mut outward } = Evidence::NONE;
        let about = (&self.pose, pivot);
        for (found, trust) in kinds {
            let gradient = add_pulls(&mut equations, &scene.sight.picture, about, found, *trust);
            outward.iter_mut().zip(gradient).for_each(|(sum, value)| *sum += value);
            pulls += trust.share * found.len() as f64;
        }
        if let Some(look) = surface {
            let seen = (look, scene.model);
            pulls += add_surface(&mut equations, &scene.sight.picture, seen, about, SURFACE_SHARE);
        }
        scene.prior.add_pins(&mut equations, &scene.sight.picture, about);
        self.last = Evidence { equations: equations.clone(), pulls, outward };
        scene.prior.add_start(&mut equations, &scene.sight.picture, &self.pose, center_mm);
        let Some(step) = solve(&equations.h, &equations.g.map(|g| -g)) else { return false };
        let moved = moved_about(&self.pose, pivot, &step);
        if !is_before_camera(&moved, scene.model) {
            return false;
        }
        self.pose = moved;
        true
    }
}

/// A few times what is usual among the measurements: near the end half a pixel more than that is another edge.
fn coverage_gate_px(found: &[Pull]) -> f64 {
    let mut offsets: Vec<f64> = found.iter().map(|pull| pull.offset_px.abs()).collect();
    offsets.sort_by(f64::total_cmp);
    offsets.get(offsets.len() / 2).map_or(2.0, |median| (5.0 * median).clamp(0.3, 2.0))
}
