//! The gestures of the photo view as a state machine: one call a frame.

use glam::{DVec2, DVec3};

use super::drag::{self, Grab};
use super::{Hit, PhotoView, pick_all};
use crate::math::{Intrinsics, Pose};
use crate::scene::{AnnotationState, ObjectId, PhotoId};
use crate::session::{Command, Session, Tool, with_depth_changed};

/// A press that moves less than this is a click.
const CLICK_RADIUS_PX: f64 = 4.0;

/// One notch of the wheel zooms by this factor.
const ZOOM_PER_NOTCH: f64 = 1.2;

/// Alt makes every drag this much finer.
const FINE: f64 = 0.1;

/// An object that is tiny on screen is turned as if it had this radius, or it would spin.
const MIN_TURN_RADIUS_PX: f64 = 60.0;

/// One thing the pointer did, in physical pixels from the viewport's top left corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointerEvent {
    pub position: DVec2,
    pub action: PointerAction,
    pub modifiers: Modifiers,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PointerAction {
    Move,
    /// A button went down over the viewport, with nothing (a panel, a window) before it.
    Press(Button),
    Release(Button),
    DoubleClick,
    /// Notches, up is positive; either axis, as Shift swaps them in some browsers.
    Wheel(f64),
    /// The factor of a pinch.
    Pinch(f64),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Modifiers {
    pub shift: bool,
    pub ctrl: bool,
    pub alt: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Button {
    Left,
    Middle,
    Right,
}

/// The gesture under way, if any.
#[derive(Debug, Default)]
pub struct PhotoGestures {
    press: Option<Press>,
}

#[derive(Debug)]
struct Press {
    button: Button,
    start: DVec2,
    last: DVec2,
    /// Still within the radius of a click.
    is_click: bool,
    action: Action,
}

#[derive(Debug)]
enum Action {
    Pan,
    Object(ObjectDrag),
    /// Put back by Esc: the button is still down, and does nothing until it is released.
    Ended,
}

#[derive(Debug)]
struct ObjectDrag {
    photo: PhotoId,
    object: ObjectId,
    movable: bool,
    turns: bool,
    grab: Grab,
    /// Where the cursor would be without fine steps, in the `image` frame.
    cursor: DVec2,
}

impl PhotoGestures {
    /// Turns one event into commands; zoom and pan change `view` at once. The commands are to be applied before the next
    /// event comes, for it is read against the session as they leave it.
    pub fn handle(&mut self, event: &PointerEvent, session: &Session, view: &mut PhotoView) -> Vec<Command> {
        match event.action {
            PointerAction::Move => self.drag_to(event, session, view),
            PointerAction::Press(button) => {
                if self.press.is_none() {
                    self.press = Some(start_press(session, view, event.position, button));
                }
                Vec::new()
            }
            PointerAction::Release(button) => {
                let mut commands = self.drag_to(event, session, view);
                if let Some(press) = self.press.take_if(|press| press.button == button) {
                    commands.extend(finish_press(&press, event, session, view));
                }
                commands
            }
            PointerAction::DoubleClick => {
                zoom_by_double_click(event.position, session, view);
                Vec::new()
            }
            PointerAction::Wheel(notches) => self.scroll(notches, event, session, view),
            PointerAction::Pinch(factor) => {
                view.zoom_about(event.position, factor.clamp(0.1, 10.0));
                Vec::new()
            }
        }
    }

    /// Esc: the gesture is over; its button may still be down.
    pub fn cancel(&mut self) {
        if let Some(press) = &mut self.press {
            press.action = Action::Ended;
        }
    }

    pub fn is_dragging_object(&self) -> bool {
        let movable =
            |press: &Press| matches!(&press.action, Action::Object(drag) if drag.movable && !press.is_click);
        self.press.as_ref().is_some_and(movable)
    }

    fn drag_to(&mut self, event: &PointerEvent, session: &Session, view: &mut PhotoView) -> Vec<Command> {
        let Some(press) = &mut self.press else { return Vec::new() };
        if press.is_click && event.position.distance(press.start) < CLICK_RADIUS_PX {
            return Vec::new();
        }
        // The way within the click's radius is not lost: `last` is where the button went down.
        let mut commands = press.begin_object_drag();
        press.is_click = false;
        let delta = event.position - press.last;
        press.last = event.position;
        if delta == DVec2::ZERO {
            return commands;
        }
        match &mut press.action {
            Action::Ended => {}
            Action::Pan => view.pan(delta),
            Action::Object(drag) => commands.extend(drag.advance(delta, event.modifiers, session, view)),
        }
        commands
    }

    fn scroll(
        &mut self,
        notches: f64,
        event: &PointerEvent,
        session: &Session,
        view: &mut PhotoView,
    ) -> Vec<Command> {
        let depth_px = notches * if event.modifiers.alt { FINE } else { 1.0 };
        let Some(press) = &mut self.press else {
            if event.modifiers.shift {
                return depth_by_wheel(session, view, event.position, depth_px).into_iter().collect();
            }
            view.zoom_about(event.position, ZOOM_PER_NOTCH.powf(notches));
            return Vec::new();
        };
        let mut commands = press.begin_object_drag();
        if let Action::Object(drag) = &mut press.action {
            commands.extend(drag.change_depth(depth_px, session));
        }
        commands
    }
}

impl Press {
    /// A press on an object that can be moved stops being a click: its gesture begins.
    fn begin_object_drag(&mut self) -> Vec<Command> {
        match &self.action {
            Action::Object(drag) if drag.movable && self.is_click => {
                self.is_click = false;
                let label = if drag.turns { "Rotate" } else { "Move" };
                vec![Command::Select(Some(drag.object)), Command::BeginGesture(label)]
            }
            _ => Vec::new(),
        }
    }
}

impl ObjectDrag {
    fn advance(
        &mut self,
        delta: DVec2,
        modifiers: Modifiers,
        session: &Session,
        view: &PhotoView,
    ) -> Option<Command> {
        if !self.movable {
            return None;
        }
        let camera = session.scene().photo(self.photo)?.camera;
        let fineness = if modifiers.alt { FINE } else { 1.0 };
        let before = self.cursor;
        self.cursor += delta * fineness / view.zoom;
        let pose = if self.turns {
            let turned = self.turn(session, view, &camera, before, modifiers.ctrl)?;
            self.grab.start = turned;
            turned
        } else {
            self.grab.moved_to(&camera, self.cursor)
        };
        Some(self.command(pose))
    }

    /// The next step of a rotation: valuator, or roll about the view ray with Ctrl.
    fn turn(
        &self,
        session: &Session,
        view: &PhotoView,
        camera: &Intrinsics,
        before: DVec2,
        roll: bool,
    ) -> Option<Pose> {
        let object = session.scene().object(self.object)?;
        let sphere = object.mesh.mesh.sphere();
        let pivot = self.grab.start.transform_point(sphere.center);
        if roll {
            let center = camera.project(pivot)?;
            let (from, to) = (before - center, self.cursor - center);
            return Some(drag::rolled(&self.grab.start, pivot, from.angle_to(to)));
        }
        let radius_px = camera.focal_px() * sphere.radius / pivot.z.max(1.0);
        let radius_px = radius_px.max(MIN_TURN_RADIUS_PX / view.zoom);
        Some(drag::turned(&self.grab.start, pivot, self.cursor - before, radius_px))
    }

    /// Depth during a drag: along the ray of the grabbed point, which stays under the cursor.
    fn change_depth(&mut self, silhouette_px: f64, session: &Session) -> Option<Command> {
        if !self.movable {
            return None;
        }
        let scene = session.scene();
        let camera = scene.photo(self.photo)?.camera;
        let object = scene.object(self.object)?;
        let present = scene.annotation(self.photo, self.object)?.camera_from_object;
        let grabbed_object = self.grab.start.inverse().transform_point(self.grab.point_camera_mm);
        let anchor = present.transform_point(grabbed_object);
        let pose = with_depth_changed(&present, &camera, &object.mesh.mesh, anchor, silhouette_px);
        self.grab = Grab { start: pose, point_camera_mm: pose.transform_point(grabbed_object) };
        if !self.turns {
            self.cursor = camera.project(self.grab.point_camera_mm)?;
        }
        Some(self.command(pose))
    }

    fn command(&self, camera_from_object: Pose) -> Command {
        Command::Drag { photo: self.photo, object: self.object, camera_from_object }
    }
}

fn start_press(session: &Session, view: &PhotoView, position: DVec2, button: Button) -> Press {
    let drag = match button {
        Button::Middle => None,
        Button::Left | Button::Right => start_object_drag(session, view, position, button),
    };
    let action = drag.map_or(Action::Pan, Action::Object);
    Press { button, start: position, last: position, is_click: true, action }
}

fn start_object_drag(
    session: &Session,
    view: &PhotoView,
    position: DVec2,
    button: Button,
) -> Option<ObjectDrag> {
    let pixel = view.image_from_viewport(position);
    let hit = hit_to_move(session, pixel)?;
    let photo = session.photo()?.id;
    let annotation = session.scene().annotation(photo, hit.object)?;
    let locked = session.scene().object(hit.object)?.locked;
    Some(ObjectDrag {
        photo,
        object: hit.object,
        movable: !locked && annotation.state != AnnotationState::Confirmed,
        turns: button == Button::Right || session.tool() == Tool::Rotate,
        grab: Grab { start: annotation.camera_from_object, point_camera_mm: hit.point_camera_mm },
        cursor: pixel,
    })
}

/// The selected object wins if it is under the cursor, else the front one.
fn hit_to_move(session: &Session, pixel: DVec2) -> Option<Hit> {
    let hits = pick_all(session.scene(), session.photo()?.id, pixel);
    let selected = hits.iter().find(|hit| Some(hit.object) == session.selected());
    selected.or(hits.first()).copied()
}

fn finish_press(press: &Press, event: &PointerEvent, session: &Session, view: &PhotoView) -> Option<Command> {
    if press.is_click {
        let selects = press.button == Button::Left && !matches!(press.action, Action::Ended);
        return selects
            .then(|| select_at(session, view.image_from_viewport(press.start), event.modifiers.alt))?;
    }
    let moved = matches!(press.action, Action::Object(ObjectDrag { movable: true, .. }));
    moved.then_some(Command::EndGesture)
}

/// A click selects the front object, with Alt the one behind the selected one, on empty ground none.
fn select_at(session: &Session, pixel: DVec2, behind: bool) -> Option<Command> {
    let hits = pick_all(session.scene(), session.photo()?.id, pixel);
    let selected = hits.iter().position(|hit| Some(hit.object) == session.selected());
    let index = match selected {
        Some(selected) if behind => (selected + 1) % hits.len(),
        _ => 0,
    };
    Some(Command::Select(hits.get(index).map(|hit| hit.object)))
}

/// Shift + wheel: depth along the ray of the surface point under the cursor, or of the object's centre off the object.
fn depth_by_wheel(
    session: &Session,
    view: &PhotoView,
    position: DVec2,
    silhouette_px: f64,
) -> Option<Command> {
    let pixel = view.image_from_viewport(position);
    let (photo, object, anchor) = depth_target(session, pixel)?;
    let scene = session.scene();
    let pose = scene.annotation(photo, object)?.camera_from_object;
    let camera = scene.photo(photo)?.camera;
    let pose = with_depth_changed(&pose, &camera, &scene.object(object)?.mesh.mesh, anchor, silhouette_px);
    Some(Command::Step { photo, object, camera_from_object: pose, label: "Change depth" })
}

fn depth_target(session: &Session, pixel: DVec2) -> Option<(PhotoId, ObjectId, DVec3)> {
    let photo = session.photo()?.id;
    let hits = pick_all(session.scene(), photo, pixel);
    if let Some(hit) = hits.iter().find(|hit| Some(hit.object) == session.selected()) {
        return Some((photo, hit.object, hit.point_camera_mm));
    }
    let (_, object, annotation) = session.selected_annotation()?;
    let center = session.scene().object(object)?.mesh.mesh.sphere().center;
    Some((photo, object, annotation.camera_from_object.transform_point(center)))
}

/// On an object: zoom to it; on empty ground: the whole photo.
fn zoom_by_double_click(position: DVec2, session: &Session, view: &mut PhotoView) {
    let hit = hit_to_move(session, view.image_from_viewport(position));
    let rect = hit.and_then(|hit| super::object_rect(session.scene(), session.photo()?.id, hit.object));
    match rect {
        Some(rect) => view.show(&rect),
        None => view.fit(),
    }
}
