//! Handles over the selected object: where they are on screen, which one is under the cursor.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::Eye;
use crate::math::Pose;
use crate::scene::{ObjectId, PhotoId};
use crate::session::{NudgeFrame, Session};

pub use super::gizmo_drag::GizmoDrag;

/// Sizes in points, whatever the zoom.
const ARROW_FROM: f64 = 14.0;
const ARROW_TO: f64 = 66.0;
const ARROW_HEAD: f64 = 10.0;
const RING_RADIUS: f64 = 82.0;
const ROLL_RADIUS: f64 = 100.0;
const KNOB_RADIUS: f64 = 6.5;
/// How near to a handle is on it; a finger's tip would cover the rest.
const TOLERANCE: f64 = 7.0;
/// An arrow that points at the eye is too short to be dragged along.
const SHORTEST_ARROW: f64 = 20.0;

const RING_STEPS: usize = 64;

/// Where the depth's knob is on the outer ring, in turns from three o'clock, counter-clockwise.
const KNOB_TURN: f64 = 0.125;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    pub fn direction(self) -> DVec3 {
        DVec3::AXES[self as usize]
    }
}

/// One of the handles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Handle {
    Move(Axis),
    Turn(Axis),
    /// About the view ray.
    Roll,
    /// Along the view ray.
    Depth,
}

impl Handle {
    /// As a step of undo is called.
    pub fn label(self) -> &'static str {
        match self {
            Self::Move(_) => "Move",
            Self::Turn(_) | Self::Roll => "Rotate",
            Self::Depth => "Change depth",
        }
    }
}

/// The handles of the selected object as they are seen, in physical pixels of the viewport.
#[derive(Debug, Clone, PartialEq)]
pub struct Gizmo {
    pub photo: PhotoId,
    pub object: ObjectId,
    /// The object's centre, in the camera frame and where it is seen.
    pub pivot_camera_mm: DVec3,
    pub pivot_px: DVec2,
    /// Of the camera or of the object, in the camera frame.
    pub axes: [DVec3; 3],
    /// A locked or confirmed object shows its handles, but they cannot be taken.
    pub movable: bool,
    /// Those farthest from the eye first.
    pub shapes: Vec<HandleShape>,
    pixels_per_point: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct HandleShape {
    pub handle: Handle,
    /// What is before the object's centre, or beside it.
    pub front: Vec<Vec<DVec2>>,
    /// What is behind it: to be seen, not to be taken.
    pub back: Vec<Vec<DVec2>>,
    pub head: Option<[DVec2; 3]>,
    /// Centre and radius.
    pub knob: Option<(DVec2, f64)>,
}

impl Gizmo {
    /// `None` where no handles are wanted, or the selected object is not in view.
    pub fn of(session: &Session, eye: &Eye, pixels_per_point: f64) -> Option<Self> {
        if !session.panes().gizmo {
            return None;
        }
        let (photo, object, annotation) = session.selected_annotation()?;
        let in_scene = session.scene().object(object).filter(|object| object.visible)?;
        let pose = annotation.camera_from_object;
        let pivot_camera_mm = pose.transform_point(in_scene.mesh.mesh.sphere().center);
        let mm_per_point = eye.mm_per_px(pivot_camera_mm)? * pixels_per_point;
        let mut gizmo = Self {
            photo,
            object,
            pivot_camera_mm,
            pivot_px: eye.project(pivot_camera_mm)?,
            axes: axes_of(session.nudge_settings().frame, &pose),
            movable: session.check_movable((photo, object)).is_ok(),
            shapes: Vec::new(),
            pixels_per_point,
        };
        let arrows = Axis::ALL.into_iter().filter_map(|axis| gizmo.arrow(eye, axis, mm_per_point));
        let rings = Axis::ALL.map(|axis| gizmo.ring(eye, axis, mm_per_point));
        gizmo.shapes = gizmo.roll_and_depth().into_iter().chain(rings).chain(arrows).collect();
        Some(gizmo)
    }

    /// The handle under a point: knobs and arrows go before rings, then the nearest one.
    pub fn handle_at(&self, position: DVec2) -> Option<Handle> {
        if !self.movable {
            return None;
        }
        let tolerance_px = TOLERANCE * self.pixels_per_point;
        let taken = |shape: &HandleShape| {
            let distance = shape.distance_px(position);
            (distance <= tolerance_px).then_some((shape.handle.class(), distance, shape.handle))
        };
        let nearest = self.shapes.iter().filter_map(taken);
        let nearest = nearest.min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        nearest.map(|(_, _, handle)| handle)
    }

    pub fn axis(&self, axis: Axis) -> DVec3 {
        self.axes[axis as usize]
    }

    fn arrow(&self, eye: &Eye, axis: Axis, mm_per_point: f64) -> Option<HandleShape> {
        let at = |points: f64| eye.project(self.pivot_camera_mm + self.axis(axis) * points * mm_per_point);
        let (from, to) = (at(ARROW_FROM)?, at(ARROW_TO)?);
        if from.distance(to) < SHORTEST_ARROW * self.pixels_per_point {
            return None;
        }
        let along = (to - from).normalize_or_zero() * ARROW_HEAD * self.pixels_per_point;
        let across = along.perp() * 0.42;
        Some(HandleShape {
            head: Some([to + along, to + across, to - across]),
            ..HandleShape::lines(Handle::Move(axis), vec![vec![from, to]])
        })
    }

    fn ring(&self, eye: &Eye, axis: Axis, mm_per_point: f64) -> HandleShape {
        let (side, other_side) = self.axis(axis).any_orthonormal_pair();
        let radius_mm = RING_RADIUS * mm_per_point;
        let pivot_depth = eye.eye_from_camera.transform_point(self.pivot_camera_mm).z;
        let points = (0..=RING_STEPS).map(|step| {
            let (sin, cos) = (step as f64 / RING_STEPS as f64 * TAU).sin_cos();
            let point = self.pivot_camera_mm + (side * cos + other_side * sin) * radius_mm;
            // A ring that faces the eye is in front all around.
            let is_behind = eye.eye_from_camera.transform_point(point).z > pivot_depth + 0.12 * radius_mm;
            eye.project(point).map(|pixel| (pixel, is_behind))
        });
        let (front, back) = split_runs(points);
        HandleShape { back, ..HandleShape::lines(Handle::Turn(axis), front) }
    }

    fn roll_and_depth(&self) -> [HandleShape; 2] {
        let radius = ROLL_RADIUS * self.pixels_per_point;
        let on_ring = |turn: f64| {
            let (sin, cos) = (turn * TAU).sin_cos();
            self.pivot_px + DVec2::new(cos, -sin) * radius
        };
        let ring = (0..=RING_STEPS).map(|step| on_ring(step as f64 / RING_STEPS as f64)).collect();
        let knob = (on_ring(KNOB_TURN), KNOB_RADIUS * self.pixels_per_point);
        [
            HandleShape::lines(Handle::Roll, vec![ring]),
            HandleShape { knob: Some(knob), ..HandleShape::lines(Handle::Depth, Vec::new()) },
        ]
    }
}

impl Handle {
    fn class(self) -> u8 {
        match self {
            Self::Depth => 0,
            Self::Move(_) => 1,
            Self::Turn(_) => 2,
            Self::Roll => 3,
        }
    }
}

impl HandleShape {
    fn lines(handle: Handle, front: Vec<Vec<DVec2>>) -> Self {
        Self { handle, front, back: Vec::new(), head: None, knob: None }
    }

    /// From a point to what can be taken of it.
    fn distance_px(&self, position: DVec2) -> f64 {
        let lines = self.front.iter().flat_map(|line| line.windows(2));
        let to_lines = lines.map(|ends| distance_to_segment(position, ends[0], ends[1]));
        let to_knob = self.knob.map(|(center, radius)| (position.distance(center) - radius).max(0.0));
        let to_head = self.head.map(|[tip, a, b]| distance_to_segment(position, tip, (a + b) / 2.0));
        to_lines.chain(to_knob).chain(to_head).fold(f64::INFINITY, f64::min)
    }
}

fn axes_of(frame: NudgeFrame, camera_from_object: &Pose) -> [DVec3; 3] {
    match frame {
        NudgeFrame::Camera => DVec3::AXES,
        NudgeFrame::Object => DVec3::AXES.map(|axis| camera_from_object.rotation * axis),
    }
}

/// A closed line in its runs before and behind; points that are not seen end a run.
fn split_runs(points: impl Iterator<Item = Option<(DVec2, bool)>>) -> (Vec<Vec<DVec2>>, Vec<Vec<DVec2>>) {
    let mut runs: [Vec<Vec<DVec2>>; 2] = Default::default();
    let mut last: Option<(DVec2, bool)> = None;
    for point in points {
        if let Some((pixel, is_behind)) = point {
            let side = &mut runs[usize::from(is_behind)];
            match last {
                Some((_, was_behind)) if was_behind == is_behind => {
                    if let Some(run) = side.last_mut() {
                        run.push(pixel);
                    }
                }
                Some((before, _)) => side.push(vec![before, pixel]),
                None => side.push(vec![pixel]),
            }
        }
        last = point;
    }
    let [front, back] = runs;
    (front, back)
}

fn distance_to_segment(point: DVec2, from: DVec2, to: DVec2) -> f64 {
    let way = to - from;
    let part = ((point - from).dot(way) / way.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    point.distance(from + way * part)
}
