//! The picture of a practice pose beside the true one.

use super::{Participating, State};
use crate::app::PinPose;
use crate::math::{Intrinsics, Pose};
use crate::scene::{MeshAsset, PhotoAsset};
use crate::study::comparison::comparison;
use crate::study::{Step, camera_of};
use crate::ui::study::FEEDBACK_PICTURES;
use std::sync::Arc;

/// As wide as the screen's column has room for, in pixels of a fine screen.
const MOST_WIDTH: u32 = 420;

/// What the picture is made of.
struct Compared {
    photo: Arc<PhotoAsset>,
    mesh: Arc<MeshAsset>,
    camera: Intrinsics,
    /// The participant's and the true one.
    poses: [Pose; 2],
}

impl PinPose {
    /// Draws it when a practice pose has just been confirmed; its photo is still at hand then.
    pub(super) fn draw_feedback(&mut self) {
        let Some(study) = &mut self.study else { return };
        let State::Running(running) = &mut study.state else { return };
        if !std::mem::take(&mut running.shows_new_feedback) {
            return;
        }
        study.pictures.forget(&FEEDBACK_PICTURES);
        let Some(compared) = study.compared() else { return };
        let Some(pixels) = self.photos.get(compared.photo.sha256) else { return };
        let mesh = &compared.mesh.mesh;
        let drawn = comparison(&pixels, &compared.camera, mesh, compared.poses.each_ref(), MOST_WIDTH);
        for (name, picture) in FEEDBACK_PICTURES.iter().zip(drawn.into_iter().flatten().skip(1)) {
            study.pictures.insert(&study.ctx, name, &picture);
        }
    }
}

impl Participating {
    fn compared(&self) -> Option<Compared> {
        let State::Running(running) = &self.state else { return None };
        let Step::Practice(index) = running.step() else { return None };
        let study = &running.ready.files.study;
        let practice = study.practice.get(index)?;
        let last = running.participation.results.practice.last()?;
        Some(Compared {
            photo: running.ready.photos.get(&practice.sample.photo)?.clone(),
            mesh: running.ready.meshes.get(&practice.sample.object)?.clone(),
            camera: camera_of(study, &practice.sample).ok()?,
            poses: [last.trial.final_pose.to_pose().ok()?, practice.truth.to_pose().ok()?],
        })
    }
}
