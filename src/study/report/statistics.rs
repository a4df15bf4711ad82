//! What is said of many numbers: means and deviations, boxes, intervals, tests. All rules are those that the report states.

use super::student::{student_cdf, student_quantile};
use crate::metrics::quantile;
use crate::study::Chance;

/// How often a bootstrap draws.
pub const RESAMPLES: usize = 10_000;

/// The mean and the spread of some numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    pub count: usize,
    pub mean: f64,
    /// Of the population, ddof 0, as in the paper.
    pub standard_deviation: f64,
    pub median: f64,
}

impl Spread {
    /// `None` for no numbers.
    pub fn of(values: &[f64]) -> Option<Self> {
        let mean = mean(values)?;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64;
        Some(Self {
            count: values.len(),
            mean,
            standard_deviation: variance.sqrt(),
            median: quantile(&sorted(values), 0.5),
        })
    }
}

/// What a box plot draws.
#[derive(Debug, Clone, PartialEq)]
pub struct BoxStatistics {
    pub count: usize,
    pub mean: f64,
    pub median: f64,
    pub lower_quartile: f64,
    pub upper_quartile: f64,
    /// The least and the largest number within 1.5 interquartile ranges of the box. (Tukey, 1977.)
    pub whiskers: [f64; 2],
    /// What is beyond the whiskers, ascending.
    pub outliers: Vec<f64>,
}

impl BoxStatistics {
    /// `None` for no numbers.
    pub fn of(values: &[f64]) -> Option<Self> {
        const REACH: f64 = 1.5;
        let mean = mean(values)?;
        let sorted = sorted(values);
        let [lower_quartile, median, upper_quartile] = [0.25, 0.5, 0.75].map(|part| quantile(&sorted, part));
        let reach = REACH * (upper_quartile - lower_quartile);
        let (lowest, highest) = (lower_quartile - reach, upper_quartile + reach);
        let is_inside = |value: &f64| (lowest..=highest).contains(value);
        // Where quartiles lie between numbers, all within reach may be inside the box: whiskers never are.
        let low = sorted.iter().copied().find(is_inside).unwrap_or(lower_quartile).min(lower_quartile);
        let high = sorted.iter().rev().copied().find(is_inside).unwrap_or(upper_quartile).max(upper_quartile);
        let outliers = sorted.iter().copied().filter(|value| !is_inside(value)).collect();
        Some(Self {
            count: sorted.len(),
            mean,
            median,
            lower_quartile,
            upper_quartile,
            whiskers: [low, high],
            outliers,
        })
    }
}

/// An interval that holds the true value with a stated confidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    pub low: f64,
    pub high: f64,
}

/// The difference of two groups' means, `first − second`, with its 95 % interval by the percentile bootstrap: each group
/// is drawn anew from its own members, [`RESAMPLES`] times. (Efron and Tibshirani, *An Introduction to the Bootstrap*, 1993.)
///
/// `None` where a group has fewer than two members: nothing is known of its spread.
pub fn bootstrap_difference(first: &[f64], second: &[f64], seed: u64) -> Option<(f64, Interval)> {
    if first.len() < 2 || second.len() < 2 {
        return None;
    }
    let mut chance = Chance::new(seed);
    let mut differences: Vec<f64> =
        (0..RESAMPLES).map(|_| drawn_mean(first, &mut chance) - drawn_mean(second, &mut chance)).collect();
    differences.sort_by(f64::total_cmp);
    let interval = Interval { low: quantile(&differences, 0.025), high: quantile(&differences, 0.975) };
    Some((mean(first)? - mean(second)?, interval))
}

/// The 95 % interval of a mean, by the same bootstrap.
pub fn bootstrap_mean(values: &[f64], seed: u64) -> Option<Interval> {
    if values.len() < 2 {
        return None;
    }
    let mut chance = Chance::new(seed);
    let mut means: Vec<f64> = (0..RESAMPLES).map(|_| drawn_mean(values, &mut chance)).collect();
    means.sort_by(f64::total_cmp);
    Some(Interval { low: quantile(&means, 0.025), high: quantile(&means, 0.975) })
}

fn drawn_mean(values: &[f64], chance: &mut Chance) -> f64 {
    let sum: f64 = (0..values.len()).map(|_| values[chance.below(values.len())]).sum();
    sum / values.len() as f64
}

/// Two one-sided tests of whether a mean lies within a margin about zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Equivalence {
    pub count: usize,
    pub mean: f64,
    /// Of the mean: the sample's deviation, ddof 1, over √n.
    pub standard_error: f64,
    /// Half the width of the range about zero that counts as equal.
    pub margin: f64,
    /// The larger of the two tests' p values.
    pub p: f64,
    /// The mean's 90 % interval: the mean is equivalent at 5 % where this lies within the margin.
    pub interval: Interval,
}

impl Equivalence {
    /// The level of each of the two tests.
    pub const LEVEL: f64 = 0.05;

    /// Tests whether the mean that the values were drawn from lies within ±`margin`, by Student's t. `None` for fewer than
    /// two values. (Schuirmann, *A Comparison of the Two One-Sided Tests Procedure and the Power Approach*, 1987.)
    pub fn within(values: &[f64], margin: f64) -> Option<Self> {
        let (mean, standard_error) = mean_and_error(values)?;
        let freedom = (values.len() - 1) as f64;
        let above_lower = tail((mean + margin) / standard_error, freedom);
        let below_upper = tail((margin - mean) / standard_error, freedom);
        Some(Self::new(values.len(), mean, standard_error, margin, above_lower.max(below_upper)))
    }

    /// Tests only whether the mean lies below the margin: for errors, which have no sign.
    pub fn below(values: &[f64], margin: f64) -> Option<Self> {
        let (mean, standard_error) = mean_and_error(values)?;
        let p = tail((margin - mean) / standard_error, (values.len() - 1) as f64);
        Some(Self::new(values.len(), mean, standard_error, margin, p))
    }

    fn new(count: usize, mean: f64, standard_error: f64, margin: f64, p: f64) -> Self {
        let reach = student_quantile(1.0 - Self::LEVEL, (count - 1) as f64) * standard_error;
        let interval = Interval { low: mean - reach, high: mean + reach };
        Self { count, mean, standard_error, margin, p, interval }
    }

    pub fn is_equivalent(&self) -> bool {
        self.p < Self::LEVEL
    }
}

/// The chance of a t that is larger. Where nothing varies t is infinite, or 0/0 on the margin itself, which is not within.
fn tail(t: f64, freedom: f64) -> f64 {
    if t.is_nan() { 1.0 } else { student_cdf(-t, freedom) }
}

fn mean_and_error(values: &[f64]) -> Option<(f64, f64)> {
    if values.len() < 2 {
        return None;
    }
    let mean = mean(values)?;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    let count = values.len() as f64;
    Some((mean, (squares / (count - 1.0) / count).sqrt()))
}

/// `None` for no numbers.
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

fn sorted(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_times_give_its_means() {
        let linemod = Spread::of(&[148.5, 121.7, 54.34, 101.1, 85.29]).unwrap();
        let handal = Spread::of(&[56.73, 99.32, 154.7, 105.4, 94.84, 71.70]).unwrap();
        // The persons' means are printed with four digits, so their mean is off by up to 0.05 / 2 at the worst; the issue
        // asks for 0.02.
        for (found, paper) in [(linemod, [102.19, 31.93]), (handal, [97.11, 30.74])] {
            assert!(
                (found.mean - paper[0]).abs() < 0.02 && (found.standard_deviation - paper[1]).abs() < 0.02
            );
        }
    }

    #[test]
    fn boxes_are_those_of_tukey() {
        // numpy.percentile([1, 2, 3, 4, 5, 6, 7, 30], [25, 50, 75]) = 2.75, 4.5, 6.25; reach 1.5 · 3.5 = 5.25
        let found = BoxStatistics::of(&[30.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]).unwrap();
        assert_eq!((found.lower_quartile, found.median, found.upper_quartile), (2.75, 4.5, 6.25));
        assert_eq!((found.whiskers, found.outliers), ([1.0, 7.0], vec![30.0]));
        let one = BoxStatistics::of(&[2.0]).unwrap();
        assert_eq!((one.whiskers, one.outliers.len()), ([2.0, 2.0], 0));
        assert_eq!(BoxStatistics::of(&[]), None);
    }

    #[test]
    fn a_bootstrap_knows_a_shift_and_repeats_itself() {
        let first: Vec<f64> = (0..40).map(|at| f64::from(at % 10) + 3.0).collect();
        let second: Vec<f64> = (0..30).map(|at| f64::from(at % 10)).collect();
        let (difference, interval) = bootstrap_difference(&first, &second, 7).unwrap();
        assert!((difference - 3.0).abs() < 1e-12);
        // A normal approximation has 3 ± 1.96 · √(8.25/40 + 8.25/30) = 3 ± 1.36; 10,000 draws know the ends to about 0.03.
        assert!((interval.low - 1.64).abs() < 0.1 && (interval.high - 4.36).abs() < 0.1, "{interval:?}");
        assert_eq!(bootstrap_difference(&first, &second, 7), Some((difference, interval)));
        assert_ne!(bootstrap_difference(&first, &second, 8).unwrap().1, interval);
        assert_eq!(bootstrap_difference(&first, &[1.0], 7), None);
    }

    #[test]
    fn equivalence_is_that_of_the_t_tests() {
        // scipy.stats.ttest_1samp(x, ±1, alternative=…): the mean is 0.2, the standard error √0.05, and both t are
        // 0.8 / 0.2236 = 3.5777 and −5.3666 with 3 degrees of freedom.
        let values = [0.8, 0.0, -0.4, 0.4];
        let found = Equivalence::within(&values, 1.0).unwrap();
        let error = (values.iter().map(|value| (value - 0.2_f64).powi(2)).sum::<f64>() / 3.0 / 4.0).sqrt();
        assert!((found.mean - 0.2).abs() < 1e-15 && (found.standard_error - error).abs() < 1e-15);
        assert!((found.p - student_cdf(-0.8 / error, 3.0)).abs() < 1e-15);
        assert!(found.is_equivalent() && found.interval.low > -1.0 && found.interval.high < 1.0);
        assert!(!Equivalence::within(&values, 0.3).unwrap().is_equivalent());
        assert!(Equivalence::below(&[-50.0, -51.0], 1.0).unwrap().is_equivalent());
        assert!(Equivalence::within(&[0.5, 0.5], 1.0).unwrap().is_equivalent());
        assert!(!Equivalence::within(&[1.0, 1.0], 1.0).unwrap().is_equivalent());
        assert_eq!(Equivalence::within(&[1.0], 1.0), None);
    }
}
