//! Measurements of one kind, and what they are worth together.

use crate::solve::least_squares::NormalEquations;

/// One number that the picture says of a pose.
#[derive(Debug, Clone)]
pub struct Measurement {
    /// In standard deviations, if those were what they are said to be.
    pub residual: f64,
    /// How the residual changes with small motions.
    pub row: [f64; 6],
    /// From 0, something else was measured, to 1.
    pub trust: f64,
    /// What is measured is the outline.
    pub is_outline: bool,
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
    pub fn add_to(&self, equations: &mut NormalEquations<6>) {
        for Measurement { row, residual, trust, .. } in &self.measurements {
            equations.add(row, *residual, self.share * trust);
        }
    }

    /// Lowers the share where a step leaves more unexplained than the measurements' standard deviations allow. Such errors go
    /// together over longer distances, too: one factor of the scatter is for their size, one for that.
    pub fn doubt_what_is_left(&mut self, step: &[f64; 6]) {
        let left = |measurement: &Measurement| {
            let moved: f64 = measurement.row.iter().zip(step).map(|(a, b)| a * b).sum();
            measurement.trust * (measurement.residual + moved).powi(2)
        };
        let mut squares: Vec<f64> =
            self.measurements.iter().filter(|measurement| measurement.trust > 0.0).map(left).collect();
        if squares.len() < FEWEST {
            self.share = 0.0;
            return;
        }
        let middle = squares.len() / 2;
        let median = *squares.select_nth_unstable_by(middle, f64::total_cmp).1;
        self.share /= (median / MEDIAN_OF_CHI_SQUARED).max(1.0).powi(2);
    }
}
