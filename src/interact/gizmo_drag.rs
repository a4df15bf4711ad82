//! A handle under the hand: from the way of the cursor to the pose.

use std::f64::consts::{PI, TAU};

use glam::{DQuat, DVec2, DVec3};

use super::gizmo::{Gizmo, Handle};
use super::object_drag::FINE;
use super::{Eye, drag};
use crate::math::Pose;
use crate::scene::{ObjectId, PhotoId};
use crate::session::{Command, Session};

/// A ring that is seen this much from its edge is dragged along its line, not around its centre.
const EDGE_ON: f64 = 0.3;

/// A handle that is held.
#[derive(Debug, Clone, PartialEq)]
pub struct GizmoDrag {
    pub photo: PhotoId,
    pub object: ObjectId,
    pub handle: Handle,
    /// So far: millimetres along the axis or the view ray, or radians.
    pub amount: f64,
    start: Pose,
    pivot: DVec3,
    axis: DVec3,
    /// Where the cursor was taken to be at the start and is now, fine steps counted as such; viewport pixels.
    from_px: DVec2,
    cursor_px: DVec2,
}

impl GizmoDrag {
    pub fn start(session: &Session, eye: &Eye, gizmo: &Gizmo, position: DVec2) -> Option<Self> {
        let handle = gizmo.handle_at(position)?;
        let pivot_eye = eye.eye_from_camera.transform_point(gizmo.pivot_camera_mm);
        let view_ray = eye.camera_from_eye_direction(pivot_eye).normalize_or(DVec3::Z);
        let axis = match handle {
            Handle::Move(axis) | Handle::Turn(axis) => gizmo.axis(axis),
            Handle::Roll | Handle::Depth => view_ray,
        };
        Some(Self {
            photo: gizmo.photo,
            object: gizmo.object,
            handle,
            amount: 0.0,
            start: session.scene().annotation(gizmo.photo, gizmo.object)?.camera_from_object,
            pivot: gizmo.pivot_camera_mm,
            axis,
            from_px: position,
            cursor_px: position,
        })
    }

    pub fn advance(&mut self, way_px: DVec2, fine: bool, session: &Session, eye: &Eye) -> Option<Command> {
        let before = self.cursor_px;
        self.cursor_px += way_px * if fine { FINE } else { 1.0 };
        let pose = match self.handle {
            Handle::Move(_) => {
                self.amount = self.along_axis(eye, self.cursor_px)? - self.along_axis(eye, self.from_px)?;
                self.start.translated(self.axis * self.amount)
            }
            Handle::Turn(_) | Handle::Roll => {
                self.amount += self.turn_between(eye, before, self.cursor_px)?;
                drag::about(&self.start, self.pivot, DQuat::from_axis_angle(self.axis, self.amount))
            }
            Handle::Depth => self.change_depth(session, eye, before)?,
        };
        Some(Command::Drag { photo: self.photo, object: self.object, camera_from_object: pose })
    }

    /// As it is read beside the cursor.
    pub fn read_out(&self) -> String {
        match self.handle {
            Handle::Move(_) | Handle::Depth => format!("{:+.1} mm", self.amount),
            Handle::Turn(_) | Handle::Roll => format!("{:+.1}°", self.amount.to_degrees()),
        }
    }

    /// How far along the axis, from the pivot, the view ray of a pixel comes nearest to it.
    fn along_axis(&self, eye: &Eye, position: DVec2) -> Option<f64> {
        let ray = eye.ray(position);
        let offset = self.pivot - ray.origin;
        let cosine = self.axis.dot(ray.direction);
        let denominator = 1.0 - cosine * cosine;
        let distance = (cosine * ray.direction.dot(offset) - self.axis.dot(offset)) / denominator;
        distance.is_finite().then_some(distance)
    }

    fn turn_between(&self, eye: &Eye, from: DVec2, to: DVec2) -> Option<f64> {
        let to_eye = (eye.eye_from_camera.inverse().translation_mm - self.pivot).normalize_or(DVec3::NEG_Z);
        let facing = self.axis.dot(to_eye);
        if facing.abs() >= EDGE_ON {
            let turn = self.angle_at(eye, to)? - self.angle_at(eye, from)?;
            // Never more than half a turn in one step.
            return Some((turn + PI).rem_euclid(TAU) - PI);
        }
        // Seen from its edge, the ring moves across the axis as the drag goes; its near side is the one that is held.
        let radius_mm = eye.mm_per_px(self.pivot)?;
        let step = self.axis.cross(to_eye).normalize_or_zero() * radius_mm;
        let way_on_screen = eye.project(self.pivot + step)? - eye.project(self.pivot)?;
        let ring_radius_px = self.from_px.distance(eye.project(self.pivot)?).max(60.0);
        Some((to - from).dot(way_on_screen.normalize_or_zero()) / ring_radius_px)
    }

    /// The angle about the axis of the point of the ring's plane under a pixel.
    fn angle_at(&self, eye: &Eye, position: DVec2) -> Option<f64> {
        let ray = eye.ray(position);
        let distance = (self.pivot - ray.origin).dot(self.axis) / ray.direction.dot(self.axis);
        let point = ray.at(distance) - self.pivot;
        let (side, other_side) = self.axis.any_orthonormal_pair();
        let angle = point.dot(other_side).atan2(point.dot(side));
        angle.is_finite().then_some(angle)
    }

    /// Up is nearer: as many pixels wider as the hand goes up.
    fn change_depth(&mut self, session: &Session, eye: &Eye, before_px: DVec2) -> Option<Pose> {
        let scene = session.scene();
        let present = scene.annotation(self.photo, self.object)?.camera_from_object;
        let mesh = &scene.object(self.object)?.mesh.mesh;
        let pivot = present.transform_point(mesh.sphere().center);
        let wider_px = (before_px.y - self.cursor_px.y) / eye.zoom;
        let pose = eye.depth_changed(&present, mesh, pivot, wider_px);
        self.amount = (pose.translation_mm - self.start.translation_mm).dot(self.axis);
        Some(pose)
    }
}
