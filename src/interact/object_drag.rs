//! Moving and turning an object under the hand, in whatever view.

use glam::{DVec2, DVec3};

use super::drag::{self, Grab};
use super::{Button, Eye, Hit, Modifiers, pick_along};
use crate::math::Pose;
use crate::scene::{ObjectId, PhotoId};
use crate::session::{Command, Session, Tool};

/// Alt makes every drag this much finer.
pub const FINE: f64 = 0.1;

/// An object that is tiny on screen is turned as if it had this radius, or it would spin.
const MIN_TURN_RADIUS_PX: f64 = 60.0;

/// An object under the hand.
#[derive(Debug)]
pub struct ObjectDrag {
    pub photo: PhotoId,
    pub object: ObjectId,
    /// Not locked, not confirmed.
    pub movable: bool,
    pub turns: bool,
    grab: Grab,
    /// Where the cursor would be without fine steps, in the eye's `image` frame.
    cursor: DVec2,
}

impl ObjectDrag {
    /// `None` where no object is under the cursor.
    pub fn start(session: &Session, eye: &Eye, position: DVec2, button: Button) -> Option<Self> {
        let hit = hit_to_move(session, eye, position)?;
        let photo = session.photo()?.id;
        let annotation = session.scene().annotation(photo, hit.object)?;
        Some(Self {
            photo,
            object: hit.object,
            movable: session.check_movable((photo, hit.object)).is_ok(),
            turns: button == Button::Right || session.tool() == Tool::Rotate,
            grab: Grab { start: annotation.camera_from_object, point_camera_mm: hit.point_camera_mm },
            cursor: eye.image_from_viewport(position),
        })
    }

    /// What begins the gesture. What cannot be moved is tried once, for the session to say why.
    pub fn begin(&self, session: &Session) -> Vec<Command> {
        if !self.movable {
            return vec![self.command(self.grab.start)];
        }
        // Several that are selected move together.
        let select = (!session.is_selected(self.object)).then_some(Command::Select(Some(self.object)));
        let label = if self.turns { "Rotate" } else { "Move" };
        select.into_iter().chain([Command::BeginGesture(label)]).collect()
    }

    pub fn advance(
        &mut self,
        way_px: DVec2,
        modifiers: Modifiers,
        session: &Session,
        eye: &Eye,
    ) -> Option<Command> {
        if !self.movable {
            return None;
        }
        let fineness = if modifiers.alt { FINE } else { 1.0 };
        let before = self.cursor;
        self.cursor += way_px * fineness / eye.zoom;
        let pose = if self.turns {
            let turned = self.turn(session, eye, before, modifiers.ctrl)?;
            self.grab.start = turned;
            turned
        } else {
            eye.moved_to(&self.grab, self.cursor)
        };
        Some(self.command(pose))
    }

    /// The next step of a rotation: valuator, or roll about the view ray with Ctrl.
    fn turn(&self, session: &Session, eye: &Eye, before: DVec2, roll: bool) -> Option<Pose> {
        let object = session.scene().object(self.object)?;
        let sphere = object.mesh.mesh.sphere();
        let pivot = self.grab.start.transform_point(session.pivot_mm(self.photo, self.object)?);
        if roll {
            let center = eye.image_from_viewport(eye.project(pivot)?);
            let (from, to) = (before - center, self.cursor - center);
            return Some(drag::rolled(eye, &self.grab.start, pivot, from.angle_to(to)));
        }
        let depth_mm = eye.eye_from_camera.transform_point(pivot).z;
        let radius_px = eye.camera.focal_px() * sphere.radius / depth_mm.max(1.0);
        let radius_px = radius_px.max(MIN_TURN_RADIUS_PX / eye.zoom);
        Some(drag::turned(eye, &self.grab.start, pivot, self.cursor - before, radius_px))
    }

    /// Depth during a drag: along the ray of the grabbed point, which stays under the cursor.
    pub fn change_depth(&mut self, silhouette_px: f64, session: &Session, eye: &Eye) -> Option<Command> {
        if !self.movable {
            return None;
        }
        let scene = session.scene();
        let object = scene.object(self.object)?;
        let present = scene.annotation(self.photo, self.object)?.camera_from_object;
        let grabbed_object = self.grab.start.inverse().transform_point(self.grab.point_camera_mm);
        let anchor = present.transform_point(grabbed_object);
        let pose = eye.depth_changed(&present, &object.mesh.mesh, anchor, silhouette_px);
        self.grab = Grab { start: pose, point_camera_mm: pose.transform_point(grabbed_object) };
        if !self.turns {
            self.cursor = eye.image_from_viewport(eye.project(self.grab.point_camera_mm)?);
        }
        Some(self.command(pose))
    }

    fn command(&self, camera_from_object: Pose) -> Command {
        Command::Drag { photo: self.photo, object: self.object, camera_from_object }
    }
}

/// The selected object wins if it is under the cursor, else the front one.
pub fn hit_to_move(session: &Session, eye: &Eye, position: DVec2) -> Option<Hit> {
    let hits = pick_along(session.scene(), session.photo()?.id, &eye.ray(position));
    let selected = hits.iter().find(|hit| Some(hit.object) == session.selected());
    selected.or(hits.first()).copied()
}

/// Shift + wheel: depth along the ray of the surface point under the cursor, or of the object's centre off the object.
pub fn depth_by_wheel(session: &Session, eye: &Eye, position: DVec2, silhouette_px: f64) -> Option<Command> {
    let (photo, object, anchor) = depth_target(session, eye, position)?;
    let scene = session.scene();
    let present = scene.annotation(photo, object)?.camera_from_object;
    let pose = eye.depth_changed(&present, &scene.object(object)?.mesh.mesh, anchor, silhouette_px);
    Some(Command::Step { photo, object, camera_from_object: pose, label: "Change depth" })
}

fn depth_target(session: &Session, eye: &Eye, position: DVec2) -> Option<(PhotoId, ObjectId, DVec3)> {
    let photo = session.photo()?.id;
    let hits = pick_along(session.scene(), photo, &eye.ray(position));
    if let Some(hit) = hits.iter().find(|hit| Some(hit.object) == session.selected()) {
        return Some((photo, hit.object, hit.point_camera_mm));
    }
    let (_, object, annotation) = session.selected_annotation()?;
    let pivot = session.pivot_mm(photo, object)?;
    Some((photo, object, annotation.camera_from_object.transform_point(pivot)))
}
