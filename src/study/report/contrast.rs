//! Conditions against one another.

use super::Analysis;
use super::quantity::Quantity;
use super::statistics::{Interval, bootstrap_difference, bootstrap_mean, mean};

/// The difference of two conditions in one quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Contrast {
    pub conditions: [usize; 2],
    pub quantity: Quantity,
    /// First minus second.
    pub difference: f64,
    /// 95 %, by the bootstrap.
    pub interval: Interval,
    /// Persons in each of them.
    pub counts: [usize; 2],
    /// The same persons worked under both, and differences are theirs.
    pub is_paired: bool,
}

/// All pairs of conditions in all quantities.
pub(super) fn contrast_tasks(conditions: usize) -> impl Iterator<Item = ([usize; 2], Quantity)> {
    let pairs =
        (0..conditions).flat_map(move |first| (first + 1..conditions).map(move |second| [first, second]));
    pairs.flat_map(|pair| Quantity::ALL.into_iter().map(move |quantity| (pair, quantity)))
}

/// Where every person worked under both conditions, persons' own differences are averaged and drawn; otherwise persons are
/// drawn within each condition. `None` where there are too few.
pub(super) fn contrast(analysis: &Analysis, conditions: [usize; 2], quantity: Quantity) -> Option<Contrast> {
    let values = conditions.map(|condition| -> Vec<(usize, f64)> {
        let of = |person| Some((person, quantity.of(analysis, person, Some(condition))?));
        (0..analysis.participants.len()).filter_map(of).collect()
    });
    let [first, second] = &values;
    let is_paired = !first.is_empty()
        && first.iter().map(|(person, _)| person).eq(second.iter().map(|(person, _)| person));
    let plain = |values: &[(usize, f64)]| values.iter().map(|(_, value)| *value).collect::<Vec<_>>();
    let seed = analysis.options.seed;
    let (difference, interval) = if is_paired {
        let own: Vec<f64> = first.iter().zip(second).map(|(a, b)| a.1 - b.1).collect();
        (mean(&own)?, bootstrap_mean(&own, seed)?)
    } else {
        bootstrap_difference(&plain(first), &plain(second), seed)?
    };
    let counts = [first.len(), second.len()];
    Some(Contrast { conditions, quantity, difference, interval, counts, is_paired })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pose;
    use crate::study::report::{ReportParticipant, Trial, TrialErrors};

    /// People with one trial of so many seconds under each of some conditions.
    fn analysis(seconds: &[&[(usize, f64)]]) -> Analysis {
        let mut analysis = Analysis::default();
        for (participant, trials) in seconds.iter().enumerate() {
            let trial = |&(condition, seconds): &(usize, f64)| Trial {
                sample: 0,
                condition,
                repeat: 0,
                pose: Pose::IDENTITY,
                seconds,
                timed_out: false,
            };
            let trials: Vec<Trial> = trials.iter().map(trial).collect();
            analysis.trials.extend(trials.iter().map(|trial| TrialErrors {
                participant,
                trial: 0,
                sample: 0,
                condition: trial.condition,
                repeat: 0,
                seconds: trial.seconds,
                errors: crate::study::report::Difference::default(),
                is_best: true,
                is_kept: true,
            }));
            analysis.participants.push(ReportParticipant { trials, ..ReportParticipant::default() });
        }
        analysis
    }

    #[test]
    fn people_are_compared_with_themselves_where_they_can_be() {
        // Everybody is five seconds slower under the second condition, and people differ by a minute.
        let within = analysis(&[&[(0, 30.0), (1, 35.0)], &[(0, 60.0), (1, 65.0)], &[(0, 90.0), (1, 95.0)]]);
        let found = contrast(&within, [0, 1], Quantity::Seconds).unwrap();
        assert!(found.is_paired && found.counts == [3, 3]);
        assert_eq!((found.difference, found.interval), (-5.0, Interval { low: -5.0, high: -5.0 }));
        let between = analysis(&[&[(0, 30.0)], &[(0, 90.0)], &[(1, 35.0)], &[(1, 95.0)], &[(1, 65.0)]]);
        let found = contrast(&between, [0, 1], Quantity::Seconds).unwrap();
        assert!(!found.is_paired && found.counts == [2, 3] && found.difference == -5.0);
        assert!(found.interval.low < -40.0 && found.interval.high > 30.0, "{:?}", found.interval);
        assert_eq!(contrast(&between, [0, 1], Quantity::Sus), None);
        assert_eq!(contrast_tasks(3).count(), 3 * Quantity::ALL.len());
    }
}
