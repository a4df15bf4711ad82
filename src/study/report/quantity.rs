//! One number per person: what persons, conditions and groups of persons are compared by.

use super::statistics::mean;
use super::{Analysis, Measure, PairErrors};

/// A person's number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// The mean time of a trial.
    Seconds,
    /// The mean of the best trials' errors.
    Best(Measure),
    /// The mean difference of pairs of repeats, by ADD.
    Repeats,
    TlxRaw,
    Sus,
}

/// Whose numbers: of all conditions, or of one.
pub(super) type ConditionOrAll = Option<usize>;

impl Quantity {
    pub const ALL: [Self; 8] = [
        Self::Seconds,
        Self::Best(Measure::Rotation),
        Self::Best(Measure::Translation),
        Self::Best(Measure::Add),
        Self::Best(Measure::Ad),
        Self::Repeats,
        Self::TlxRaw,
        Self::Sus,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Seconds => "time",
            Self::Best(measure) => measure.name(),
            Self::Repeats => "ADD of repeats",
            Self::TlxRaw => "TLX raw",
            Self::Sus => "SUS",
        }
    }

    pub fn unit(self) -> &'static str {
        match self {
            Self::Seconds => "s",
            Self::Best(measure) => measure.unit(),
            Self::Repeats => "mm",
            Self::TlxRaw | Self::Sus => "",
        }
    }

    /// Of a person; `None` where there is nothing to be averaged.
    pub fn of(self, analysis: &Analysis, person: usize, condition: ConditionOrAll) -> Option<f64> {
        let asked = |found: usize| condition.is_none_or(|wanted| wanted == found);
        let own =
            || analysis.trials.iter().filter(move |row| row.participant == person && asked(row.condition));
        match self {
            Self::Seconds => mean(&own().map(|row| row.seconds).collect::<Vec<_>>()),
            Self::Best(measure) => {
                let best = own().filter(|row| row.is_best);
                mean(&best.map(|row| row.errors.get(measure)).collect::<Vec<_>>())
            }
            Self::Repeats => {
                let own = |row: &&PairErrors| row.participant == person && asked(row.condition);
                let pairs = analysis.pairs.iter().filter(own);
                mean(&pairs.map(|row| row.differences.get(Measure::Add)).collect::<Vec<_>>())
            }
            Self::TlxRaw | Self::Sus => self.of_answers(analysis, person, condition),
        }
    }

    /// A questionnaire about all conditions speaks for one only where it was the person's only one.
    fn of_answers(self, analysis: &Analysis, person: usize, condition: ConditionOrAll) -> Option<f64> {
        let participant = analysis.participants.get(person)?;
        let only = {
            let mut worked = participant.trials.iter().map(|trial| trial.condition);
            let first = worked.next();
            first.filter(|first| worked.all(|other| other == *first))
        };
        let asked = |about: Option<usize>| condition.is_none() || about.or(only) == condition;
        let scores: Vec<f64> = match self {
            Self::Sus => {
                let asked = participant.sus.iter().filter(|answered| asked(answered.condition));
                asked.map(|answered| answered.answers.score()).collect()
            }
            _ => {
                let asked = participant.tlx.iter().filter(|answered| asked(answered.condition));
                asked.filter_map(|answered| answered.answers.raw()).collect()
            }
        };
        mean(&scores)
    }
}
