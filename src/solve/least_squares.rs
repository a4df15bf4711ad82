//! Levenberg and Marquardt's method, for any state that a vector of numbers can move.

use super::linear::{Matrix, solve};

/// A sum of squares, linearised: `cost + 2 gᵀδ + δᵀHδ` for a step δ.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalEquations<const N: usize> {
    pub h: Matrix<N>,
    pub g: [f64; N],
    pub cost: f64,
}

impl<const N: usize> NormalEquations<N> {
    pub const ZERO: Self = Self { h: [[0.0; N]; N], g: [0.0; N], cost: 0.0 };

    /// Adds `weight · residual²`; `row` is the residual's derivative.
    pub fn add(&mut self, row: &[f64; N], residual: f64, weight: f64) {
        for ((h_row, g), &value) in self.h.iter_mut().zip(&mut self.g).zip(row) {
            let weighted = weight * value;
            *g += weighted * residual;
            h_row.iter_mut().zip(row).for_each(|(h, &other)| *h += weighted * other);
        }
        self.cost += weight * residual * residual;
    }

    fn damped(&self, damping: f64) -> Matrix<N> {
        let mut h = self.h;
        let largest = (0..N).map(|i| h[i][i]).fold(0.0, f64::max);
        for (i, row) in h.iter_mut().enumerate() {
            // The second part keeps directions of which nothing is known from running away.
            row[i] += damping * (row[i] + 1e-12 * largest);
        }
        h
    }
}

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    pub iterations: u32,
    /// Stop when a step lowers the cost by less than this part of it.
    pub relative_decrease: f64,
    /// A cost that is small enough, whatever the next step would bring.
    pub good_enough: f64,
}

/// Walks from `start` to a local minimum of the cost and returns it with the equations there; never to a higher cost.
///
/// `linearize` gives the equations at a state, or `None` where the state is impossible: such a step is shortened.
/// Source: Marquardt, *An Algorithm for Least-Squares Estimation of Nonlinear Parameters*, 1963, with the damping rule of
/// Nielsen (1999). `None` where `start` itself is impossible.
pub fn levenberg_marquardt<S, const N: usize>(
    start: S,
    limits: Limits,
    mut linearize: impl FnMut(&S) -> Option<NormalEquations<N>>,
    moved: impl Fn(&S, &[f64; N]) -> S,
) -> Option<(S, NormalEquations<N>)> {
    let mut state = start;
    let mut equations = linearize(&state).filter(|equations| equations.cost.is_finite())?;
    let (mut damping, mut growth) = (1e-4, 4.0);
    for _ in 0..limits.iterations {
        if equations.cost <= limits.good_enough {
            break;
        }
        let step = solve(&equations.damped(damping), &equations.g.map(|g| -g));
        let trial = step.and_then(|step| {
            let moved = moved(&state, &step);
            let equations = linearize(&moved)?;
            Some((moved, equations, step))
        });
        match trial {
            Some((next, next_equations, step)) if next_equations.cost < equations.cost => {
                let decrease = equations.cost - next_equations.cost;
                let expected = expected_decrease(&equations, &step);
                let quality = if expected > 0.0 { decrease / expected } else { 1.0 };
                damping *= (1.0 - (2.0 * quality - 1.0).powi(3)).clamp(1.0 / 9.0, 1.0);
                growth = 4.0;
                let has_arrived = decrease < limits.relative_decrease * equations.cost;
                (state, equations) = (next, next_equations);
                if has_arrived {
                    break;
                }
            }
            _ => {
                damping *= growth;
                growth *= 2.0;
                if damping > 1e12 {
                    break;
                }
            }
        }
    }
    Some((state, equations))
}

fn expected_decrease<const N: usize>(equations: &NormalEquations<N>, step: &[f64; N]) -> f64 {
    let linear: f64 = equations.g.iter().zip(step).map(|(g, d)| g * d).sum();
    let quadratic: f64 = equations
        .h
        .iter()
        .zip(step)
        .map(|(row, d)| d * row.iter().zip(step).map(|(h, e)| h * e).sum::<f64>())
        .sum();
    -2.0 * linear - quadratic
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curved_valley_is_followed_to_its_end() {
        // Rosenbrock's function as a sum of two squares: 10 (y − x²) and 1 − x.
        let linearize = |&[x, y]: &[f64; 2]| {
            let mut equations = NormalEquations::ZERO;
            equations.add(&[-20.0 * x, 10.0], 10.0 * (y - x * x), 1.0);
            equations.add(&[-1.0, 0.0], 1.0 - x, 1.0);
            // A wall beside the valley.
            (x < 1.5).then_some(equations)
        };
        let moved = |&[x, y]: &[f64; 2], &[dx, dy]: &[f64; 2]| [x + dx, y + dy];
        let limits = Limits { iterations: 100, relative_decrease: 0.0, good_enough: 1e-24 };
        let (end, equations) = levenberg_marquardt([-1.2, 1.0], limits, linearize, moved).unwrap();
        assert!(equations.cost <= 1e-24, "{}", equations.cost);
        // The cost bounds both residuals by 1e-12.
        assert!((end[0] - 1.0).abs() < 1e-11 && (end[1] - 1.0).abs() < 1e-10, "{end:?}");
        assert!(levenberg_marquardt([2.0, 1.0], limits, linearize, moved).is_none());
    }
}
