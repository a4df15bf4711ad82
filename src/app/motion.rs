//! Motions that are only shown: an object on the screen leaves its pose for a moment and comes back; nothing changes.

use super::PinPose;
use crate::math::Pose;
use crate::scene::{Fold, ObjectId, PhotoId};
use crate::ui::ShownMotion;

/// A turn by one part takes so long, a whole one of a continuous axis longer.
const TURN_S: f64 = 1.2;
const WHOLE_TURN_S: f64 = 2.4;
/// At its end it stays for a moment, to be compared.
const REST_S: f64 = 0.5;
/// There and back, to either side.
const SWAY_S: f64 = 2.0;
/// Standard deviations to either side.
const SWAY_SIGMAS: f64 = 2.0;

/// What is shown, of which object, since when.
#[derive(Debug, Clone, Copy)]
pub struct Motion {
    photo: PhotoId,
    object: ObjectId,
    shown: ShownMotion,
    began_s: f64,
}

impl Motion {
    /// How long it moves, and how long it then rests.
    fn times_s(&self) -> (f64, f64) {
        match self.shown {
            ShownMotion::Turn(axis) if axis.fold == Fold::Continuous => (WHOLE_TURN_S, REST_S),
            ShownMotion::Turn(_) => (TURN_S, REST_S),
            ShownMotion::Sway(_) => (SWAY_S, 0.0),
        }
    }

    fn is_over(&self, now_s: f64) -> bool {
        let (moving_s, resting_s) = self.times_s();
        now_s - self.began_s > moving_s + resting_s
    }

    /// Of an object that is at `pose`.
    fn pose_at(&self, now_s: f64, pose: &Pose) -> Pose {
        let part = ((now_s - self.began_s) / self.times_s().0).clamp(0.0, 1.0);
        match self.shown {
            ShownMotion::Turn(axis) => {
                let eased = part * part * (3.0 - 2.0 * part);
                let whole = match axis.fold {
                    Fold::Times(times) => std::f64::consts::TAU / f64::from(times.max(1)),
                    Fold::Continuous => std::f64::consts::TAU,
                };
                *pose * axis.turn(eased * whole)
            }
            ShownMotion::Sway(weakest) => {
                weakest.moved(pose, SWAY_SIGMAS * (part * std::f64::consts::TAU).sin())
            }
        }
    }
}

impl PinPose {
    /// Shows the selected object turned about an axis, or swaying as far as its pose is unsure.
    pub(super) fn show_motion(&mut self, shown: ShownMotion) {
        let Some((photo, object, _)) = self.session.selected_annotation() else { return };
        let began_s = self.ctx.input(|input| input.time);
        self.motion = Some(Motion { photo, object, shown, began_s });
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
    use crate::scene::SymmetryAxis;
    use crate::solve::{Weakest, Weakness};

    fn pose() -> Pose {
        Pose::exp(DVec3::new(0.1, 0.4, -0.2), DVec3::new(5.0, 6.0, 700.0))
    }

    fn motion(shown: ShownMotion) -> Motion {
        Motion { photo: PhotoId(1), object: ObjectId(1), shown, began_s: 10.0 }
    }

    fn is_near(a: &Pose, b: &Pose) -> bool {
        // Rounding of some rotations of a point 700 mm away.
        a.angle_to(b) < 1e-7 && a.translation_mm.distance(b.translation_mm) < 1e-9
    }

    #[test]
    fn a_turn_ends_where_the_object_looks_the_same() {
        let axis = |fold| SymmetryAxis { axis: DVec3::Z, through_mm: DVec3::new(3.0, 0.0, 0.0), fold };
        let sixth = axis(Fold::Times(6)).turn(std::f64::consts::TAU / 6.0);
        for (fold, end) in [(Fold::Times(6), sixth), (Fold::Continuous, Pose::IDENTITY)] {
            let motion = motion(ShownMotion::Turn(axis(fold)));
            assert!(is_near(&motion.pose_at(10.0, &pose()), &pose()));
            assert!(is_near(&motion.pose_at(10.0 + WHOLE_TURN_S, &pose()), &(pose() * end)));
            assert!(!motion.is_over(10.0 + TURN_S) && motion.is_over(10.0 + WHOLE_TURN_S + REST_S + 0.1));
        }
    }

    #[test]
    fn a_sway_goes_two_sigmas_to_either_side_and_comes_back() {
        let step = [0.0, 0.0, 0.0, 0.0, 0.0, 3.0];
        let weakest = Weakest { kind: Weakness::Depth, step, center_camera_mm: pose().translation_mm };
        let motion = motion(ShownMotion::Sway(weakest));
        for (quarter, depth_mm) in [(0.0, 0.0), (1.0, 6.0), (2.0, 0.0), (3.0, -6.0), (4.0, 0.0)] {
            let shown = motion.pose_at(10.0 + quarter * SWAY_S / 4.0, &pose());
            assert!(is_near(&shown, &pose().translated(DVec3::Z * depth_mm)), "{quarter}");
        }
        assert!(motion.is_over(10.1 + SWAY_S));
    }
}
