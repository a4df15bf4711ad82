//! An axis with round ticks.

/// The range of an axis and where its ticks are.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axis {
    pub low: f64,
    pub high: f64,
    pub ticks: Vec<f64>,
    /// Digits after the point that the ticks need.
    pub decimals: usize,
}

impl Axis {
    /// Round ends around `low` and `high`, with about `ticks` steps of 1, 2 or 5 times a power of ten.
    pub fn around(low: f64, high: f64, ticks: f64) -> Self {
        let (low, high) = if low.is_finite() && high.is_finite() { (low, high) } else { (0.0, 1.0) };
        let high = if high > low { high } else { low + 1.0 };
        let rough = (high - low) / ticks;
        let power = 10_f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power).into_iter().find(|step| *step >= rough);
        let step = step.unwrap_or(10.0 * power);
        let first = (low / step).floor() as i64;
        // A number on a tick needs no further one.
        let last = (high / step - 1e-9).ceil() as i64;
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        let ticks: Vec<f64> = (first..=last).map(|at| at as f64 * step).collect();
        Self { low: first as f64 * step, high: last as f64 * step, ticks, decimals }
    }

    /// Exactly this range, with a tick at every step.
    pub fn fixed(low: f64, high: f64, step: f64) -> Self {
        let count = ((high - low) / step).round().max(1.0) as usize;
        let ticks = (0..=count).map(|at| low + at as f64 * step).collect();
        Self { low, high, ticks, decimals: 0 }
    }

    /// 0 at the low end, 1 at the high one.
    pub fn part(&self, value: f64) -> f64 {
        ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0)
    }

    pub fn label(&self, tick: f64) -> String {
        let decimals = self.decimals;
        // The sign of a printed number is a minus, not a hyphen; zero has none.
        let tick = if tick.abs() < (self.high - self.low) * 1e-9 { 0.0 } else { tick };
        format!("{tick:.decimals$}").replace('-', "−")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_enclose_the_data() {
        let axis = Axis::around(0.0, 43.0, 5.0);
        assert_eq!(axis.ticks, [0.0, 10.0, 20.0, 30.0, 40.0, 50.0]);
        let axis = Axis::around(-0.013, 0.02, 5.0);
        assert!((axis.low + 0.02).abs() < 1e-12 && (axis.high - 0.02).abs() < 1e-12);
        assert_eq!((axis.decimals, axis.label(axis.low).as_str()), (2, "−0.02"));
        assert_eq!(Axis::around(0.0, 50.0, 5.0).high, 50.0);
        for (low, high) in [(3.0, 3.0), (f64::NAN, 1.0), (0.0, f64::INFINITY), (0.0, 1e-300)] {
            let axis = Axis::around(low, high, 5.0);
            assert!(axis.ticks.len() < 20 && axis.part(low).is_finite() | low.is_nan(), "{low} {high}");
        }
        assert_eq!(Axis::fixed(0.0, 20.0, 5.0).ticks.len(), 5);
    }
}
