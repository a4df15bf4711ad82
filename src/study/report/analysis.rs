//! What a report knows: every comparison that was made, and which of them count.

use crate::math::sort_short;
use std::collections::BTreeMap;

use super::measure::{Difference, Measure};
use super::{Contrast, ReportCondition, ReportParticipant, ReportSample};

/// The part of the results that the paper keeps.
const KEPT_PART: [usize; 2] = [9, 10];

/// All differences of a study's results, from which tables and figures are made.
#[derive(Debug, Clone, Default)]
pub struct Analysis {
    pub title: String,
    /// Some of it was made by a program.
    pub simulated: bool,
    /// What was left out, and why.
    pub remarks: Vec<String>,
    pub sets: Vec<String>,
    pub samples: Vec<ReportSample>,
    pub conditions: Vec<ReportCondition>,
    pub participants: Vec<ReportParticipant>,
    /// The largest distance of two vertices, sample by sample.
    pub diameters_mm: Vec<f64>,
    pub trials: Vec<TrialErrors>,
    pub pairs: Vec<PairErrors>,
    pub agreement: Vec<AgreementErrors>,
    /// Empty where there is only one condition.
    pub contrasts: Vec<Contrast>,
    pub options: ReportOptions,
}

/// What the reader of a report decides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReportOptions {
    /// A mean offset within this is no difference, in per cent of the object's diameter. A tenth is what the field takes as
    /// "correct" for ADD (Hinterstoisser et al., 2012).
    pub margin_percent: f64,
    /// And of a rotation, in degrees: the field's "5 degrees" (Shotton et al., 2013).
    pub margin_deg: f64,
    /// Of the bootstrap.
    pub seed: u64,
}

impl Default for ReportOptions {
    fn default() -> Self {
        Self { margin_percent: 10.0, margin_deg: 5.0, seed: 1 }
    }
}

/// A trial against the truth.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialErrors {
    /// Index into [`Analysis::participants`].
    pub participant: usize,
    /// Index into the participant's trials.
    pub trial: usize,
    pub sample: usize,
    pub condition: usize,
    pub repeat: usize,
    pub seconds: f64,
    pub errors: Difference,
    /// The participant's trial of this sample, under this condition, with the lowest ADD: what the inter-personal analysis
    /// takes.
    pub is_best: bool,
    /// Best, and among the 90 % of its set's best trials with the lowest ADD.
    pub is_kept: bool,
}

/// Two trials of one sample by one participant under one condition.
#[derive(Debug, Clone, PartialEq)]
pub struct PairErrors {
    pub participant: usize,
    pub sample: usize,
    pub condition: usize,
    /// The earlier one first.
    pub repeats: [usize; 2],
    pub differences: Difference,
    /// Among the 90 % of the participant's pairs of this set with the lowest ADD.
    pub is_kept: bool,
}

/// The best trials of one sample by two participants under one condition.
#[derive(Debug, Clone, PartialEq)]
pub struct AgreementErrors {
    pub sample: usize,
    pub condition: usize,
    pub participants: [usize; 2],
    pub differences: Difference,
}

/// Which rows a number is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rows {
    All,
    /// The paper's best 90 %.
    Best90,
}

impl Rows {
    pub const BOTH: [Self; 2] = [Self::Best90, Self::All];

    pub fn label(self) -> &'static str {
        match self {
            Self::All => "100 %",
            Self::Best90 => "best 90 %",
        }
    }

    fn admits(self, is_kept: bool) -> bool {
        self == Self::All || is_kept
    }
}

impl Analysis {
    /// The set that a sample belongs to.
    pub fn set_of(&self, sample: usize) -> Option<usize> {
        self.samples.get(sample).map(|sample| sample.set)
    }

    /// The inter-personal rows of a set.
    pub fn best_of_set(&self, set: usize, rows: Rows) -> impl Iterator<Item = &TrialErrors> {
        let is_in = move |row: &&TrialErrors| row.is_best && self.set_of(row.sample) == Some(set);
        self.trials.iter().filter(is_in).filter(move |row| rows.admits(row.is_kept))
    }

    /// The intra-personal rows of a participant in a set.
    pub fn pairs_of(&self, participant: usize, set: usize, rows: Rows) -> impl Iterator<Item = &PairErrors> {
        let is_in =
            move |row: &&PairErrors| row.participant == participant && self.set_of(row.sample) == Some(set);
        self.pairs.iter().filter(is_in).filter(move |row| rows.admits(row.is_kept))
    }

    /// The seconds of a participant's trials of a set.
    pub fn seconds_of(&self, participant: usize, set: usize) -> Vec<f64> {
        let is_in =
            |row: &&TrialErrors| row.participant == participant && self.set_of(row.sample) == Some(set);
        self.trials.iter().filter(is_in).map(|row| row.seconds).collect()
    }

    /// The indices of those who worked on a set.
    pub fn members(&self, set: usize) -> Vec<usize> {
        let is_in = |participant: &usize| {
            self.trials
                .iter()
                .any(|row| row.participant == *participant && self.set_of(row.sample) == Some(set))
        };
        (0..self.participants.len()).filter(is_in).collect()
    }

    /// The samples of a set, with their indices.
    pub fn samples_of(&self, set: usize) -> impl Iterator<Item = (usize, &ReportSample)> {
        self.samples.iter().enumerate().filter(move |(_, sample)| sample.set == set)
    }

    pub fn label_of(&self, participant: usize) -> &str {
        self.participants.get(participant).map_or("", |participant| &participant.label)
    }

    /// Finds the best trial of each participant, sample and condition. Of equal ones the first counts.
    pub(super) fn select_best(&mut self) {
        let mut best: BTreeMap<[usize; 3], (f64, usize)> = BTreeMap::new();
        for (at, row) in self.trials.iter().enumerate() {
            let add_mm = row.errors.get(Measure::Add);
            let place =
                best.entry([row.participant, row.sample, row.condition]).or_insert((f64::INFINITY, at));
            if add_mm < place.0 {
                *place = (add_mm, at);
            }
        }
        for (_, at) in best.into_values() {
            self.trials[at].is_best = true;
        }
    }

    /// Marks the rows that the paper keeps.
    pub(super) fn select_kept(&mut self) {
        for set in 0..self.sets.len() {
            let is_candidate =
                |row: &TrialErrors| row.is_best && self.samples.get(row.sample).map(|s| s.set) == Some(set);
            for at in lowest(&self.trials, is_candidate, |row| row.errors.get(Measure::Add)) {
                self.trials[at].is_kept = true;
            }
            for participant in 0..self.participants.len() {
                let is_candidate = |row: &PairErrors| {
                    row.participant == participant && self.samples.get(row.sample).map(|s| s.set) == Some(set)
                };
                for at in lowest(&self.pairs, is_candidate, |row| row.differences.get(Measure::Add)) {
                    self.pairs[at].is_kept = true;
                }
            }
        }
    }
}

/// The indices of the floor(0.9 n) candidates with the lowest numbers; of equal ones the first.
fn lowest<T>(rows: &[T], is_candidate: impl Fn(&T) -> bool, number: impl Fn(&T) -> f64) -> Vec<usize> {
    let mut candidates: Vec<(f64, usize)> = (rows.iter().enumerate())
        .filter(|(_, row)| is_candidate(row))
        .map(|(at, row)| (number(row), at))
        .collect();
    sort_short(&mut candidates, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let [part, whole] = KEPT_PART;
    candidates.truncate(candidates.len() * part / whole);
    candidates.into_iter().map(|(_, at)| at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_tenths_are_rounded_down() {
        let kept = |rows: &[f64]| lowest(rows, |_| true, |row| *row);
        assert_eq!(kept(&[0.0; 30]).len(), 27);
        assert_eq!(kept(&[0.0; 50]).len(), 45);
        assert_eq!(kept(&[9.0, 8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0]), [8, 7, 6, 5, 4, 3, 2, 1]);
        assert_eq!(kept(&[1.0]).len(), 0);
        assert_eq!(kept(&[1.0, 1.0]), [0]);
        assert_eq!(lowest(&[1.0, 2.0, 0.5, 0.1], |row| *row > 0.3, |row| *row), [2, 0]);
    }
}
