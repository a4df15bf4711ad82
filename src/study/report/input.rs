//! What a report is made of: samples with their truth, and what each participant did. Plain data, whatever files it was in.

use std::sync::Arc;

use crate::math::{Intrinsics, Pose};
use crate::mesh::Mesh;
use crate::scene::Symmetries;

/// Everything a report analyses.
#[derive(Debug, Clone, Default)]
pub struct ReportInput {
    pub title: String,
    /// The names of the sets of samples, which are reported side by side.
    pub sets: Vec<String>,
    pub samples: Vec<ReportSample>,
    pub conditions: Vec<ReportCondition>,
    pub participants: Vec<ReportParticipant>,
    /// What was left out on the way here, and why: one line each, shown on the report.
    pub remarks: Vec<String>,
}

/// One object in one photo.
#[derive(Debug, Clone)]
pub struct ReportSample {
    /// "S0", within its set.
    pub label: String,
    /// Index into [`ReportInput::sets`].
    pub set: usize,
    /// What it shows, for the reader: the photo's and the object's name.
    pub name: String,
    pub mesh: Arc<Mesh>,
    pub symmetries: Symmetries,
    /// The true `camera_from_object`.
    pub truth: Pose,
    /// `None`: it is left out of the pictures.
    pub view: Option<SampleView>,
}

/// The photo of a sample.
#[derive(Debug, Clone)]
pub struct SampleView {
    pub camera: Intrinsics,
    /// The photo's file.
    pub photo: Arc<[u8]>,
}

/// A way of working that a study compares.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReportCondition {
    pub id: String,
    pub title: String,
}

#[derive(Debug, Clone, Default)]
pub struct ReportParticipant {
    /// "L0": its set's letter and a number; "P0" where there are no sets, or where it worked on several.
    pub label: String,
    /// As the result file has it.
    pub id: String,
    /// Made by a program, not by a person.
    pub simulated: bool,
    pub trials: Vec<Trial>,
    /// What was asked before the first trial, and the answer; expertise is one of them.
    pub traits: Vec<(String, String)>,
    pub tlx: Vec<Answered<TlxAnswers>>,
    pub sus: Vec<Answered<SusAnswers>>,
}

/// A questionnaire, and the condition that it was about: an index into [`ReportInput::conditions`], `None` for all of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Answered<T> {
    pub condition: Option<usize>,
    pub answers: T,
}

/// A timed annotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trial {
    /// Index into [`ReportInput::samples`].
    pub sample: usize,
    /// Index into [`ReportInput::conditions`].
    pub condition: usize,
    /// From 0: how often the sample had come before under this condition.
    pub repeat: usize,
    /// `camera_from_object`.
    pub pose: Pose,
    /// From the first drawn frame to the confirmation, without pauses.
    pub seconds: f64,
    /// The time was over before it was confirmed.
    pub timed_out: bool,
}

/// NASA-TLX: mental, physical and temporal demand, performance, effort, frustration; 0 to 20, performance from perfect (0) to
/// failure (20).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TlxAnswers {
    pub ratings: [Option<f64>; 6],
    /// How often each scale was chosen in the 15 comparisons; `None` where they were not made.
    pub weights: Option<[f64; 6]>,
}

/// SUS: ten answers from 1 (strongly disagree) to 5.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SusAnswers {
    pub answers: [Option<f64>; 10],
}

/// The six scales as a figure names them.
pub const TLX_SCALES: [&str; 6] =
    ["Mental demand", "Physical demand", "Temporal demand", "Performance", "Effort", "Frustration"];

/// The top of each scale of NASA-TLX.
pub const TLX_TOP: f64 = 20.0;

/// Where performance stands among the scales.
pub const PERFORMANCE: usize = 3;

impl TlxAnswers {
    /// The unweighted mean of the scales that were answered; `None` where none was.
    pub fn raw(&self) -> Option<f64> {
        let given: Vec<f64> = self.ratings.iter().copied().flatten().collect();
        super::statistics::mean(&given)
    }

    /// Σ w·r / Σ w; `None` without comparisons, or where a scale that counts was not answered.
    pub fn weighted(&self) -> Option<f64> {
        let weights = self.weights?;
        let sum: f64 = weights.iter().sum();
        let products = self.ratings.iter().zip(weights).filter(|(_, weight)| *weight > 0.0);
        let total: Option<f64> = products.map(|(rating, weight)| rating.map(|rating| rating * weight)).sum();
        total.filter(|_| sum > 0.0).map(|total| total / sum)
    }
}

impl SusAnswers {
    /// The ten items with a missing one as 3, the middle.
    fn filled(&self) -> [f64; 10] {
        self.answers.map(|answer| answer.unwrap_or(3.0))
    }

    /// How many were not answered.
    pub fn missing(&self) -> usize {
        self.answers.iter().filter(|answer| answer.is_none()).count()
    }

    /// 0 to 100: odd items count x − 1, even ones 5 − x, times 2.5. (Brooke, *SUS: a quick and dirty usability scale*, 1996.)
    pub fn score(&self) -> f64 {
        self.adjusted().iter().map(|item| item - 1.0).sum::<f64>() * 2.5
    }

    /// The items so that 5 is good: even ones, which are negative statements, as 6 − x.
    pub fn adjusted(&self) -> [f64; 10] {
        let mut items = self.filled();
        items.iter_mut().skip(1).step_by(2).for_each(|item| *item = 6.0 - *item);
        items
    }
}

impl ReportInput {
    /// Whether any of it was made by a program: then every page says so.
    pub fn is_simulated(&self) -> bool {
        self.participants.iter().any(|participant| participant.simulated)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn questionnaires_are_scored_by_their_authors_rules() {
        let tlx = TlxAnswers {
            ratings: [10.0, 4.0, 6.0, 2.0, 12.0, 8.0].map(Some),
            weights: Some([5.0, 0.0, 1.0, 4.0, 3.0, 2.0]),
        };
        assert_eq!(tlx.raw(), Some(7.0));
        assert_eq!(tlx.weighted(), Some((50.0 + 6.0 + 8.0 + 36.0 + 16.0) / 15.0));
        let mut partial = tlx.clone();
        partial.ratings[1] = None;
        assert_eq!(partial.weighted(), tlx.weighted(), "a scale that does not count may be missing");
        partial.ratings[0] = None;
        assert_eq!((partial.weighted(), partial.raw()), (None, Some(7.0)));

        let best = SusAnswers { answers: [5.0, 1.0, 5.0, 1.0, 5.0, 1.0, 5.0, 1.0, 5.0, 1.0].map(Some) };
        assert_eq!((best.score(), best.adjusted(), best.missing()), (100.0, [5.0; 10], 0));
        let none = SusAnswers::default();
        assert_eq!((none.score(), none.missing()), (50.0, 10));
    }
}
