//! Motions that are only shown: an object on the screen leaves its pose for a moment and comes back; nothing changes.

use super::PinPose;
use crate::math::Pose;
use crate::scene::{Fold, ObjectId, PhotoId, SymmetryAxis};

/// A turn by one part takes so long, a whole one of a continuous axis longer.
const TURN_S: f64 = 1.2;
const WHOLE_TURN_S: f64 = 2.4;
/// At its end it stays for a moment, to be compared.
const REST_S: f64 = 0.5;

/// What is shown, of which object, since when.
#[derive(Debug, Clone, Copy)]
pub struct Motion {
    photo: PhotoId,
    object: ObjectId,
    axis: SymmetryAxis,
    began_s: f64,
}

impl Motion {
    fn turning_s(&self) -> f64 {
        if self.axis.fold == Fold::Continuous { WHOLE_TURN_S } else { TURN_S }
    }

    fn is_over(&self, now_s: f64) -> bool {
        now_s - self.began_s > self.turning_s() + REST_S
    }

    /// Of an object that is at `pose`.
    fn pose_at(&self, now_s: f64, pose: &Pose) -> Pose {
        let part = ((now_s - self.began_s) / self.turning_s()).clamp(0.0, 1.0);
        let eased = part * part * (3.0 - 2.0 * part);
        let whole = match self.axis.fold {
            Fold::Times(times) => std::f64::consts::TAU / f64::from(times.max(1)),
            Fold::Continuous => std::f64::consts::TAU,
        };
        *pose * self.axis.turn(eased * whole)
    }
}

impl PinPose {
    /// Shows the selected object turned about an axis.
    pub(super) fn show_turn(&mut self, axis: SymmetryAxis) {
        let Some((photo, object, _)) = self.session.selected_annotation() else { return };
        let began_s = self.ctx.input(|input| input.time);
        self.motion = Some(Motion { photo, object, axis, began_s });
        self.ctx.request_repaint();
    }

    /// Keeps the frames coming while something moves. A gesture ends it: the hand has to see where the object is.
    pub(super) fn tick_motion(&mut self) {
        let Some(motion) = &self.motion else { return };
        let now_s = self.ctx.input(|input| input.time);
        if motion.is_over(now_s) || self.session.gesture_under_way() {
            self.motion = None;
        }
        self.ctx.request_repaint();
    }

    /// Where an object is drawn that is shown in motion, or is on its way to its new pose.
    pub(super) fn drawn_pose(&self, now_s: f64) -> Option<(PhotoId, ObjectId, Pose)> {
        let shown = self.motion.as_ref().and_then(|motion| {
            let annotation = self.session.scene().annotation(motion.photo, motion.object)?;
            Some((motion.photo, motion.object, motion.pose_at(now_s, &annotation.camera_from_object)))
        });
        shown.or_else(|| self.snapping.drawn_pose(now_s))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn a_turn_ends_where_the_object_looks_the_same() {
        let axis = |fold| SymmetryAxis { axis: DVec3::Z, through_mm: DVec3::new(3.0, 0.0, 0.0), fold };
        let pose = Pose::exp(DVec3::new(0.1, 0.4, -0.2), DVec3::new(5.0, 6.0, 700.0));
        for (fold, end) in [
            (Fold::Times(6), axis(Fold::Times(6)).turn(std::f64::consts::TAU / 6.0)),
            (Fold::Continuous, Pose::IDENTITY),
        ] {
            let motion = Motion { photo: PhotoId(1), object: ObjectId(1), axis: axis(fold), began_s: 10.0 };
            assert_eq!(motion.pose_at(10.0, &pose), pose * axis(fold).turn(0.0));
            let shown = motion.pose_at(10.0 + WHOLE_TURN_S, &pose);
            let expected = pose * end;
            // A whole turn is one but for rounding.
            assert!(
                shown.angle_to(&expected) < 1e-7
                    && shown.translation_mm.distance(expected.translation_mm) < 1e-9
            );
            assert!(!motion.is_over(10.0 + TURN_S) && motion.is_over(10.0 + WHOLE_TURN_S + REST_S + 0.1));
        }
    }
}
