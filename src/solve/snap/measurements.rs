//! Measurements of one kind, what they are worth together, and what all of them share.

use crate::solve::least_squares::NormalEquations;
use crate::solve::robust::median;

/// What an iteration solves for: a turn and a shift of the object, then what is [`Shared`].
pub const UNKNOWNS: usize = 8;
pub type Equations = NormalEquations<UNKNOWNS>;

/// What nobody knows and what is the same wherever an outline is seen. Measured places are off by it together, so that no
/// number of them averages it out; solved for with the pose, it cannot pass for depth unnoticed.
#[derive(Debug, Clone, Copy, Default)]
pub struct Shared {
    /// How the camera turned light into the photo's values: 0 by sRGB's curve, 1 not at all. Where a dark object blurs
    /// into a bright background, the one puts the outline farther out than the other.
    pub tone: f64,
    /// How far outside of the mesh's outline the picture has it, in its pixels: a halo, a mesh that is a little too thin.
    pub growth_px: f64,
}

/// A row with these derivatives by the motion and by what is shared.
pub fn row_of(motion: &[f64; 6], shared: Shared) -> [f64; UNKNOWNS] {
    let [a, b, c, d, e, f] = *motion;
    [a, b, c, d, e, f, shared.tone, shared.growth_px]
}

/// The motion in a step of all unknowns.
pub fn motion_in(step: &[f64; UNKNOWNS]) -> [f64; 6] {
    let [motion @ .., _, _] = *step;
    motion
}

/// One number that the picture says of a pose.
#[derive(Debug, Clone)]
pub struct Measurement {
    /// In standard deviations, if those were what they are said to be.
    pub residual: f64,
    /// How the residual changes with the unknowns.
    pub row: [f64; UNKNOWNS],
    /// From 0, something else was measured, to 1.
    pub trust: f64,
}

/// All measurements of one kind.
#[derive(Debug)]
pub struct Kind {
    pub measurements: Vec<Measurement>,
    /// What part of an independent measurement each is at best: errors of neighbours go together (a shadow, a mesh that is
    /// a little too thick).
    pub share: f64,
}

/// With fewer there is nothing to learn from.
const FEWEST: usize = 12;
/// Of one degree of freedom.
const MEDIAN_OF_CHI_SQUARED: f64 = 0.455;

impl Kind {
    pub fn add_to(&self, equations: &mut Equations) {
        for Measurement { row, residual, trust, .. } in &self.measurements {
            equations.add(row, *residual, self.share * trust);
        }
    }

    /// Lowers the share where a step leaves more unexplained than the measurements' standard deviations allow. One factor of
    /// the variance is for the errors' size. They go together over longer distances, too, and most of what scatters so much is
    /// something else: the power is what did best on the benchmark's tuning half (2 to 9 were tried; made photos do not care).
    pub fn doubt_what_is_left(&mut self, step: &[f64; UNKNOWNS]) {
        let left = |measurement: &Measurement| {
            let moved: f64 = measurement.row.iter().zip(step).map(|(a, b)| a * b).sum();
            measurement.trust * (measurement.residual + moved).powi(2)
        };
        let squares: Vec<f64> =
            self.measurements.iter().filter(|measurement| measurement.trust > 0.0).map(left).collect();
        if squares.len() < FEWEST {
            self.share = 0.0;
            return;
        }
        self.share /= (median(squares) / MEDIAN_OF_CHI_SQUARED).max(1.0).powi(4);
    }
}
