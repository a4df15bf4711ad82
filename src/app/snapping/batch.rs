//! Snap on all photos: pose after pose, and all that improved taken over at once.

use std::collections::VecDeque;

use super::{Asked, PinPose};
use crate::math::Pose;
use crate::scene::{ObjectId, PhotoId};
use crate::session::{Command, Notice};
use crate::solve::snap::{SnapOutcome, SnapReach, SnapVerdict};

/// Poses that are being snapped one after the other.
pub struct Batch {
    waiting: VecDeque<(PhotoId, ObjectId)>,
    total: usize,
    moved: Vec<(Asked, SnapOutcome)>,
    /// Which stay as they are.
    refused: usize,
}

impl Batch {
    pub fn new(targets: Vec<(PhotoId, ObjectId)>) -> Self {
        let total = targets.len();
        Self { waiting: targets.into(), total, moved: Vec::new(), refused: 0 }
    }

    pub fn text(&self) -> String {
        format!("Snapping {} of {}…", (self.moved.len() + self.refused + 1).min(self.total), self.total)
    }

    /// Where an object of a photo is now: another one's new pose may be before it.
    pub fn moved_to(&self, photo: PhotoId, object: ObjectId) -> Option<Pose> {
        let is_it = |(asked, _): &&(Asked, SnapOutcome)| (asked.photo, asked.object) == (photo, object);
        self.moved.iter().find(is_it).map(|(_, outcome)| outcome.camera_from_object)
    }

    /// One that could not be tried.
    pub fn leave(&mut self) {
        self.refused += 1;
    }

    pub fn take(&mut self, asked: Asked, outcome: &SnapOutcome) {
        if outcome.verdict != SnapVerdict::Improved {
            self.refused += 1;
            return;
        }
        self.moved.push((asked, *outcome));
    }
}

impl PinPose {
    pub(in crate::app) fn start_batch(&mut self, targets: Vec<(PhotoId, ObjectId)>) {
        self.cancel_snap();
        self.snapping.batch = Some(Batch::new(targets));
        self.ctx.request_repaint();
    }

    /// Sends the next one on its way, or ends the batch.
    pub(super) fn go_on_with_batch(&mut self) {
        let Some(batch) = &mut self.snapping.batch else { return };
        while let Some((photo, object)) = batch.waiting.pop_front() {
            if self.session.check_movable((photo, object)).is_err() {
                batch.refused += 1;
                continue;
            }
            self.snapping.asked = self.asked_of(photo, object, SnapReach::Near);
            self.ctx.request_repaint();
            return;
        }
        if let Some(batch) = self.snapping.batch.take() {
            self.end_batch(batch);
        }
    }

    /// Stops what is under way; what is done of a batch stays. False if there is nothing to stop.
    pub(in crate::app) fn cancel_snap(&mut self) -> bool {
        let batch = self.snapping.batch.take();
        let was_busy = self.snapping.cancel() || batch.is_some();
        if let Some(batch) = batch {
            self.end_batch(batch);
        }
        was_busy
    }

    fn end_batch(&mut self, batch: Batch) {
        let moved: Vec<(Asked, SnapOutcome)> =
            batch.moved.into_iter().filter(|(asked, _)| self.still_stands(asked)).collect();
        let mut text = format!("Snapped {} of {} poses", moved.len(), batch.total);
        let stayed = batch.total - moved.len();
        if stayed > 0 {
            text += &format!(", {stayed} stay as they are");
        }
        let worst = moved.iter().min_by(|(_, a), (_, b)| a.score_after.total_cmp(&b.score_after));
        if let Some((asked, outcome)) = worst {
            text += &format!(". {}", self.words_of_worst((outcome.score_after, *asked)));
            let pose_of = |(asked, outcome): &(Asked, SnapOutcome)| {
                ((asked.photo, asked.object), outcome.camera_from_object, outcome.covariance)
            };
            let (snaps, least_sure) = (moved.iter().map(pose_of).collect(), (asked.photo, asked.object));
            self.apply(Command::TakeSnaps { snaps, summary: text.as_str().into(), least_sure });
        }
        self.notify(Notice::info(text));
    }

    /// Where to look first.
    fn words_of_worst(&self, (score, asked): (f64, Asked)) -> String {
        let scene = self.session.scene();
        let photo = scene.photo(asked.photo).map_or("", |photo| &photo.name);
        let object = scene.object(asked.object).map_or("", |object| &object.name);
        format!("Least sure: {object} in {photo}, fit {:.0} %", 100.0 * score)
    }
}
