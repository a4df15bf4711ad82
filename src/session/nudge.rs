//! Small exact steps of a pose.

use glam::{DMat3, DVec2, DVec3};

use super::depth::with_depth_changed;
use crate::math::{Intrinsics, NEAR_MM, Pose};
use crate::mesh::Mesh;

/// One degree of freedom and a direction along it, as it is seen on screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Nudge {
    Left,
    Right,
    Up,
    Down,
    Nearer,
    Farther,
    /// The top leans away.
    PitchForward,
    PitchBack,
    /// The front turns to the left.
    YawLeft,
    YawRight,
    /// Counter-clockwise on screen.
    RollLeft,
    RollRight,
}

/// Along and about whose axes a nudge goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NudgeFrame {
    #[default]
    Camera,
    Object,
}

/// How far one nudge goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NudgeSettings {
    pub frame: NudgeFrame,
    /// In the photo; for depth, of the silhouette's width.
    pub step_px: f64,
    pub step_degrees: f64,
}

impl Default for NudgeSettings {
    fn default() -> Self {
        Self { frame: NudgeFrame::Camera, step_px: 1.0, step_degrees: 1.0 }
    }
}

impl Nudge {
    pub fn label(self) -> &'static str {
        match self {
            Self::Left | Self::Right | Self::Up | Self::Down => "Nudge",
            Self::Nearer | Self::Farther => "Nudge depth",
            _ => "Nudge rotation",
        }
    }

    /// The pose after `factor` steps. Rotations are about the pivot, a point of the `object` frame; a step to the side in the
    /// camera's frame moves it by exactly that many pixels of the photo, at the depth it has.
    pub fn applied(
        self,
        camera_from_object: &Pose,
        camera: &Intrinsics,
        mesh: &Mesh,
        pivot_mm: DVec3,
        settings: &NudgeSettings,
        factor: f64,
    ) -> Pose {
        let center_camera_mm = camera_from_object.transform_point(pivot_mm);
        let pixels = settings.step_px * factor;
        if let Some(axis) = self.rotation_axis() {
            let angle_rad = settings.step_degrees.to_radians() * factor;
            let axis_camera = match settings.frame {
                NudgeFrame::Camera => axis,
                NudgeFrame::Object => camera_from_object.rotation * axis,
            };
            let rotation = DMat3::from_axis_angle(axis_camera.normalize_or(DVec3::Z), angle_rad);
            return (Pose::rotation_about(center_camera_mm, rotation) * *camera_from_object).renormalized();
        }
        let direction = self.direction();
        if settings.frame == NudgeFrame::Object {
            let mm_per_px = center_camera_mm.z.max(NEAR_MM) / camera.focal_px();
            return camera_from_object
                .translated(camera_from_object.rotation * direction * pixels * mm_per_px);
        }
        if direction.z != 0.0 {
            return with_depth_changed(
                camera_from_object,
                camera,
                mesh,
                center_camera_mm,
                -direction.z * pixels,
            );
        }
        let Some(pixel) = camera.project(center_camera_mm) else { return *camera_from_object };
        let target =
            camera.unproject(pixel + DVec2::new(direction.x, direction.y) * pixels) * center_camera_mm.z;
        camera_from_object.translated(target - center_camera_mm)
    }

    /// OpenCV axes: x right, y down, z away from the viewer.
    fn direction(self) -> DVec3 {
        match self {
            Self::Left => DVec3::NEG_X,
            Self::Right => DVec3::X,
            Self::Up => DVec3::NEG_Y,
            Self::Down => DVec3::Y,
            Self::Nearer => DVec3::NEG_Z,
            Self::Farther => DVec3::Z,
            _ => DVec3::ZERO,
        }
    }

    fn rotation_axis(self) -> Option<DVec3> {
        match self {
            Self::PitchForward => Some(DVec3::NEG_X),
            Self::PitchBack => Some(DVec3::X),
            Self::YawLeft => Some(DVec3::Y),
            Self::YawRight => Some(DVec3::NEG_Y),
            Self::RollLeft => Some(DVec3::NEG_Z),
            Self::RollRight => Some(DVec3::Z),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::test_shapes;

    fn camera() -> Intrinsics {
        Intrinsics::pinhole(570.0, 580.0, 310.0, 250.0, 640, 480)
    }

    fn start() -> Pose {
        Pose::exp(DVec3::new(0.4, -0.2, 1.0), DVec3::new(50.0, -30.0, 900.0))
    }

    fn applied(nudge: Nudge, settings: NudgeSettings, factor: f64) -> (Pose, Mesh) {
        let mesh = test_shapes::sphere(50.0, 8, 8);
        (nudge.applied(&start(), &camera(), &mesh, mesh.sphere().center, &settings, factor), mesh)
    }

    #[test]
    fn a_step_to_the_side_is_a_pixel_at_the_same_depth() {
        for (nudge, step) in [
            (Nudge::Left, DVec2::NEG_X),
            (Nudge::Right, DVec2::X),
            (Nudge::Up, DVec2::NEG_Y),
            (Nudge::Down, DVec2::Y),
        ] {
            let (moved, mesh) = applied(nudge, NudgeSettings::default(), 10.0);
            let center = mesh.sphere().center;
            let before = start().transform_point(center);
            let after = moved.transform_point(center);
            let way = camera().project(after).unwrap() - camera().project(before).unwrap();
            // f64 rounding of numbers below 1e3.
            assert!(way.distance(step * 10.0) < 1e-9, "{nudge:?}: {way}");
            assert!((after.z - before.z).abs() < 1e-9);
        }
    }

    #[test]
    fn rotations_go_the_way_they_are_called_and_keep_the_centre() {
        for (nudge, offset, expected) in [
            (Nudge::PitchForward, DVec3::NEG_Y, DVec3::Z),
            (Nudge::PitchBack, DVec3::NEG_Y, DVec3::NEG_Z),
            (Nudge::YawLeft, DVec3::NEG_Z, DVec3::NEG_X),
            (Nudge::YawRight, DVec3::NEG_Z, DVec3::X),
            (Nudge::RollLeft, DVec3::X, DVec3::NEG_Y),
            (Nudge::RollRight, DVec3::X, DVec3::Y),
        ] {
            let (turned, mesh) = applied(nudge, NudgeSettings::default(), 1.0);
            let center = start().transform_point(mesh.sphere().center);
            assert!(turned.transform_point(mesh.sphere().center).distance(center) < 1e-9);
            assert!((turned.angle_to(&start()).to_degrees() - 1.0).abs() < 1e-9);
            let point_object = start().inverse().transform_point(center + offset * 10.0);
            let way = turned.transform_point(point_object) - (center + offset * 10.0);
            // 10 mm · sin 1° = 0.1745 mm.
            assert!(way.dot(expected) > 0.17, "{nudge:?}: {way}");
        }
    }

    #[test]
    fn in_the_objects_frame_nudges_follow_its_axes() {
        let settings = NudgeSettings { frame: NudgeFrame::Object, ..NudgeSettings::default() };
        let (moved, _) = applied(Nudge::Right, settings, 1.0);
        let way = start().rotation.transpose() * (moved.translation_mm - start().translation_mm);
        assert!(way.x > 1.0 && way.y.abs() < 1e-9 && way.z.abs() < 1e-9, "{way}");
        let (turned, _) = applied(Nudge::RollRight, settings, 1.0);
        let axis = (start().rotation.transpose() * turned.rotation) * DVec3::Z;
        assert!(axis.distance(DVec3::Z) < 1e-9);
    }

    #[test]
    fn nearer_is_wider_by_as_many_pixels() {
        let (nearer, mesh) = applied(Nudge::Nearer, NudgeSettings::default(), 1.0);
        let width = |pose: &Pose| {
            2.0 * camera().focal_px() * mesh.sphere().radius / pose.transform_point(mesh.sphere().center).z
        };
        assert!((width(&nearer) - width(&start()) - 1.0).abs() < 1e-9);
    }
}
