//! The poses that a pose's pins allow, ranked by what the photo says of them.

use super::Session;
use super::pins::is_same;
use crate::math::{Pose, sort_short};
use crate::scene::{ObjectId, PhotoId};

/// A pose that the pins allow, as it stands among the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RankedFit {
    pub camera_from_object: Pose,
    pub rms_px: f64,
    /// How well the photo supports it, from 0 to 1. `None` until it was looked, and where too little of the object is in it.
    pub score: Option<f64>,
    /// 0 for the present pose, else its number among the others, from 1: it stays while the order changes.
    pub number: usize,
}

/// What a photo says of poses of one object.
#[derive(Debug, Default)]
pub(super) struct FitScores {
    target: Option<(PhotoId, ObjectId)>,
    scores: Vec<(Pose, Option<f64>)>,
}

impl Session {
    /// The selected pose and the others that its pins allow as well: what the photo supports most comes first, and before it
    /// was looked the pins' own order. Empty where there is nothing to choose from.
    pub fn ranked_fits(&self) -> Vec<RankedFit> {
        let (Some((photo, object, annotation)), Some(report)) =
            (self.selected_annotation(), self.pin_report())
        else {
            return Vec::new();
        };
        if report.alternatives.is_empty() {
            return Vec::new();
        }
        let known = self.fit_scores.target == Some((photo, object));
        let scores = if known { self.fit_scores.scores.as_slice() } else { &[] };
        let score_of = |pose: &Pose| scores.iter().find(|(scored, _)| is_same(scored, pose))?.1;
        let present = (annotation.camera_from_object, report.rms_px);
        let others = report.alternatives.iter().map(|other| (other.camera_from_object, other.rms_px));
        let mut fits: Vec<RankedFit> = std::iter::once(present)
            .chain(others)
            .enumerate()
            .map(|(number, (camera_from_object, rms_px))| RankedFit {
                camera_from_object,
                rms_px,
                score: score_of(&camera_from_object),
                number,
            })
            .collect();
        let rank = |fit: &RankedFit| fit.score.unwrap_or(f64::NEG_INFINITY);
        sort_short(&mut fits, |a, b| rank(b).total_cmp(&rank(a)));
        fits
    }

    pub(super) fn note_fit_scores(&mut self, target: (PhotoId, ObjectId), scores: Vec<(Pose, Option<f64>)>) {
        self.fit_scores = FitScores { target: Some(target), scores };
    }
}
