//! Which of the poses that pins allow the photo supports most: one is scored a frame, once the hand has let go.

use std::collections::VecDeque;
use std::sync::Arc;

use glam::DMat4;

use super::PinPose;
use crate::math::{Intrinsics, Pose, sort_short};
use crate::photo::Pixels;
use crate::scene::{ObjectId, PhotoId, Sha256};
use crate::session::{Command, RankedFit};
use crate::solve::contour::ContourModel;
use crate::solve::snap::{SnapHints, score_of};

#[derive(Default)]
pub struct Ghosts {
    /// What the scores are of, or will be.
    asked: Option<Asked>,
    judging: Option<Judging>,
    /// Of the objects in the photo: a pin that was moved changes none of them.
    models: Vec<Model>,
}

/// All that a score depends on.
#[derive(Debug, Clone, PartialEq)]
struct Asked {
    photo: PhotoId,
    object: ObjectId,
    camera: Intrinsics,
    fits: Vec<Pose>,
    /// What may be before the object.
    others: Vec<(ObjectId, Pose)>,
}

struct Judging {
    pixels: Arc<Pixels>,
    model: Arc<ContourModel>,
    hints: SnapHints,
    waiting: VecDeque<Pose>,
    scores: Vec<(Pose, Option<f64>)>,
}

struct Model {
    object: ObjectId,
    /// Which mesh it is made of.
    source: (Sha256, DMat4),
    model: Option<Arc<ContourModel>>,
}

impl PinPose {
    /// Once a frame: where pins allow several poses, the next of them is scored.
    pub(super) fn tick_ghosts(&mut self) {
        // A drag changes them every frame, and a snap is what the user waits for.
        if self.session.gesture_under_way() || self.snapping.is_busy() {
            return;
        }
        let Some(asked) = self.fits_to_rank() else {
            self.ghosts = Ghosts::default();
            return;
        };
        if self.ghosts.asked.as_ref() != Some(&asked) {
            self.ghosts.judging = self.begin_judging(&asked);
            if self.ghosts.judging.is_none() {
                return;
            }
            self.ghosts.asked = Some(asked);
        }
        self.judge_next();
    }

    fn fits_to_rank(&self) -> Option<Asked> {
        let mut fits = self.session.ranked_fits();
        // By number: their ranks change when they are scored.
        sort_short(&mut fits, |a, b| a.number.cmp(&b.number));
        let (photo, object, _) = self.session.selected_annotation().filter(|_| !fits.is_empty())?;
        let scene = self.session.scene();
        let others = scene.placed_beside(photo, object);
        Some(Asked {
            photo,
            object,
            camera: scene.photo(photo)?.camera,
            fits: fits.iter().map(|fit: &RankedFit| fit.camera_from_object).collect(),
            others: others.map(|(other, annotation)| (other.id, annotation.camera_from_object)).collect(),
        })
    }

    /// `None` until photo, depth map and meshes are there.
    fn begin_judging(&mut self, asked: &Asked) -> Option<Judging> {
        let asset = &self.session.scene().photo(asked.photo)?.asset;
        let pixels = self.photos.get(asset.sha256)?;
        let others = asked.others.iter().map(|(object, _)| *object);
        let here: Vec<ObjectId> = std::iter::once(asked.object).chain(others).collect();
        let missing = here.iter().filter(|object| !self.has_solver_mesh(**object)).count();
        if missing > 0 || self.waits_for_depth(asked.photo) {
            return None;
        }
        // What takes a few milliseconds each is made one a frame.
        self.ghosts.models.retain(|model| here.contains(&model.object));
        if here.iter().any(|object| self.make_model(*object)) {
            self.ctx.request_repaint();
            return None;
        }
        let model = self.model_of(asked.object)?;
        let depth = self.depth_for_snap(asked.photo);
        let occluder = |(object, pose): &(ObjectId, Pose)| Some((self.model_of(*object)?, *pose));
        let occluders = asked.others.iter().filter_map(occluder).collect();
        let hints = SnapHints { pins: Vec::new(), occluders, depth };
        let waiting = asked.fits.iter().copied().collect();
        Some(Judging { pixels, model, hints, waiting, scores: Vec::new() })
    }

    fn judge_next(&mut self) {
        let Some(Judging { pixels, model, hints, waiting, scores }) = &mut self.ghosts.judging else {
            return;
        };
        let Some(Asked { photo, object, camera, .. }) = &self.ghosts.asked else { return };
        if let Some(pose) = waiting.pop_front() {
            let score = score_of(pixels, camera, model, &pose, hints);
            scores.push((pose, score.map(|score| score.total())));
        }
        if waiting.is_empty() {
            let (photo, object, scores) = (*photo, *object, std::mem::take(scores));
            self.ghosts.judging = None;
            self.apply(Command::NoteFitScores { photo, object, scores });
        }
        self.ctx.request_repaint();
    }

    /// Makes an object's model unless it is there; whether it was made now.
    fn make_model(&mut self, object: ObjectId) -> bool {
        let Some(source) = self.model_source(object) else { return false };
        let models = &self.ghosts.models;
        if models.iter().any(|model| model.object == object && model.source == source) {
            return false;
        }
        let model = self.contour_model(object);
        self.ghosts.models.retain(|model| model.object != object);
        self.ghosts.models.push(Model { object, source, model });
        true
    }

    fn model_source(&self, object: ObjectId) -> Option<(Sha256, DMat4)> {
        let object = self.session.scene().object(object)?;
        Some((object.mesh.sha256, object.mesh_from_file))
    }

    fn model_of(&self, object: ObjectId) -> Option<Arc<ContourModel>> {
        self.ghosts.models.iter().find(|model| model.object == object)?.model.clone()
    }
}
