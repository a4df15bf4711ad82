//! The gestures of a view as a state machine: one call an event.

use glam::DVec2;

use super::gizmo::{Gizmo, GizmoDrag, Handle};
use super::object_drag::{FINE, ObjectDrag, depth_by_wheel, hit_to_move};
use super::pin_drag::{HalfPinOn, PinDrag, half_pin};
use super::viewpoint::{GroundDrag, Viewpoint};
use super::{Button, Eye, PointerAction, PointerEvent, pick_along};
use crate::math::sort_short;
use crate::scene::{Look, ObjectId};
use crate::session::{Command, Session, Tool};

/// A press that moves less than this is a click.
const CLICK_RADIUS_PX: f64 = 4.0;

/// One notch of the wheel zooms by this factor.
const ZOOM_PER_NOTCH: f64 = 1.2;

/// The wipe's line is grabbed this near to it.
const WIPE_GRIP_POINTS: f64 = 7.0;

/// The gesture under way in one view, if any.
#[derive(Debug)]
pub struct Gestures {
    press: Option<Press>,
    /// What a click on the ground deselected, the first one last: it comes back if that becomes a double click.
    deselected: Vec<ObjectId>,
    pub pixels_per_point: f64,
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
    Ground(GroundDrag),
    Object(ObjectDrag),
    Handle(Box<GizmoDrag>),
    Pin(PinDrag),
    Wipe,
    /// Put back by Esc: the button is still down, and does nothing until it is released.
    Ended,
}

impl Default for Gestures {
    fn default() -> Self {
        Self { press: None, deselected: Vec::new(), pixels_per_point: 1.0 }
    }
}

impl Gestures {
    /// Turns one event into commands; zoom, pan and orbit change `view` at once. The commands are to be applied before the
    /// next event comes, for it is read against the session as they leave it.
    pub fn handle(
        &mut self,
        event: &PointerEvent,
        session: &Session,
        view: &mut impl Viewpoint,
    ) -> Vec<Command> {
        match event.action {
            PointerAction::Move => self.drag_to(event, session, view),
            PointerAction::Press(button) => {
                if self.press.is_none() {
                    self.press = Some(self.start_press(event, button, session, view));
                }
                Vec::new()
            }
            PointerAction::Release(button) => {
                let mut commands = self.drag_to(event, session, view);
                if let Some(press) = self.press.take_if(|press| press.button == button) {
                    commands.extend(self.finish_press(&press, event, session, view));
                }
                commands
            }
            PointerAction::DoubleClick => self.double_click(event.position, session, view),
            PointerAction::Wheel(notches) => self.scroll(notches, event, session, view),
            PointerAction::Pinch(factor) => {
                zoom(event.position, factor.clamp(0.1, 10.0), session, view);
                Vec::new()
            }
        }
    }

    /// Esc: the gesture is over; its button may still be down.
    pub fn cancel(&mut self) {
        if let Some(press) = &mut self.press {
            press.action = Action::Ended;
            press.is_click = false;
        }
    }

    /// Is a button down that went down here?
    pub fn has_press(&self) -> bool {
        self.press.is_some()
    }

    pub fn is_dragging_object(&self) -> bool {
        let drags = |press: &Press| match &press.action {
            Action::Object(drag) => drag.movable && !press.is_click,
            Action::Handle(_) | Action::Pin(_) => !press.is_click,
            _ => false,
        };
        self.press.as_ref().is_some_and(drags)
    }

    pub fn is_dragging_wipe(&self) -> bool {
        self.press.as_ref().is_some_and(|press| matches!(press.action, Action::Wipe))
    }

    /// The pin that is on its way.
    pub fn pin_drag(&self) -> Option<&PinDrag> {
        match self.press.as_ref().filter(|press| !press.is_click).map(|press| &press.action) {
            Some(Action::Pin(drag)) => Some(drag),
            _ => None,
        }
    }

    /// The handle that is held.
    pub fn handle_drag(&self) -> Option<&GizmoDrag> {
        match &self.press.as_ref()?.action {
            Action::Handle(drag) => Some(drag),
            _ => None,
        }
    }

    /// The handle that a press would take.
    pub fn handle_at(&self, position: DVec2, session: &Session, view: &impl Viewpoint) -> Option<Handle> {
        let gizmo = Gizmo::of(session, &view.eye(session)?, self.pixels_per_point)?;
        gizmo.handle_at(position)
    }

    /// Would a press take the wipe's line?
    pub fn is_on_wipe(&self, position: DVec2, session: &Session, view: &impl Viewpoint) -> bool {
        let distance_px = view.wipe_px(session).map(|line| (line - position.x).abs());
        distance_px.is_some_and(|distance| distance <= WIPE_GRIP_POINTS * self.pixels_per_point)
    }

    fn start_press(
        &self,
        event: &PointerEvent,
        button: Button,
        session: &Session,
        view: &mut impl Viewpoint,
    ) -> Press {
        let action = self.action_of_press(event, button, session, view);
        if matches!(action, Action::Ground(_)) {
            view.begin_ground_drag(session);
        }
        Press { button, start: event.position, last: event.position, is_click: true, action }
    }

    fn action_of_press(
        &self,
        event: &PointerEvent,
        button: Button,
        session: &Session,
        view: &impl Viewpoint,
    ) -> Action {
        if let Some(kind) = view.ground_drag_anywhere(button, event.modifiers) {
            return Action::Ground(kind);
        }
        let Some(eye) = view.eye(session) else { return Action::Ground(view.ground_drag()) };
        if button == Button::Left {
            let gizmo = Gizmo::of(session, &eye, self.pixels_per_point);
            if let Some(drag) =
                gizmo.and_then(|gizmo| GizmoDrag::start(session, &eye, &gizmo, event.position))
            {
                return Action::Handle(Box::new(drag));
            }
            if self.is_on_wipe(event.position, session, view) {
                return Action::Wipe;
            }
        }
        if button == Button::Left && session.tool() == Tool::Pin {
            return self.action_of_pin_tool(event, session, view, &eye);
        }
        match ObjectDrag::start(session, &eye, event.position, button) {
            Some(drag) => Action::Object(drag),
            None => Action::Ground(view.ground_drag()),
        }
    }

    /// In the photo view pins are set and dragged, unless a pin waits for its other half or Shift asks for one; the scene view
    /// is a turntable.
    fn action_of_pin_tool(
        &self,
        event: &PointerEvent,
        session: &Session,
        view: &impl Viewpoint,
        eye: &Eye,
    ) -> Action {
        let sets_pins = view.is_photo() && session.half_pin().is_none() && !event.modifiers.shift;
        let drag = sets_pins.then(|| PinDrag::start(session, eye, event.position, self.pixels_per_point));
        drag.flatten().map_or(Action::Ground(view.ground_drag()), Action::Pin)
    }

    fn drag_to(
        &mut self,
        event: &PointerEvent,
        session: &Session,
        view: &mut impl Viewpoint,
    ) -> Vec<Command> {
        let Some(press) = &mut self.press else { return Vec::new() };
        if press.is_click && event.position.distance(press.start) < press.click_radius_px() {
            return Vec::new();
        }
        // The way within the click's radius is not lost: `last` is where the button went down.
        let mut commands = press.begin_drag(session);
        let way_px = event.position - press.last;
        press.last = event.position;
        if way_px == DVec2::ZERO {
            return commands;
        }
        match &mut press.action {
            Action::Ended => {}
            Action::Ground(kind) => view.drag_ground(*kind, way_px),
            Action::Wipe => {
                let part = (event.position.x / view.width_px()).clamp(0.0, 1.0) as f32;
                commands.push(Command::SetLook(Look { wipe: Some(part), ..session.look() }));
            }
            Action::Object(drag) => {
                let eye = view.eye(session);
                commands.extend(eye.and_then(|eye| drag.advance(way_px, event.modifiers, session, &eye)));
            }
            Action::Handle(drag) => {
                let eye = view.eye(session);
                commands.extend(eye.and_then(|eye| drag.advance(way_px, event.modifiers.alt, session, &eye)));
            }
            Action::Pin(drag) => {
                let eye = view.eye(session);
                commands.extend(eye.map(|eye| drag.advance(way_px, event.modifiers, &eye)));
            }
        }
        commands
    }

    fn scroll(
        &mut self,
        notches: f64,
        event: &PointerEvent,
        session: &Session,
        view: &mut impl Viewpoint,
    ) -> Vec<Command> {
        let depth_px = notches * if event.modifiers.alt { FINE } else { 1.0 };
        let Some(press) = &mut self.press else {
            if event.modifiers.shift {
                let eye = view.eye(session);
                let step = eye.and_then(|eye| depth_by_wheel(session, &eye, event.position, depth_px));
                return step.into_iter().collect();
            }
            zoom(event.position, ZOOM_PER_NOTCH.powf(notches), session, view);
            return Vec::new();
        };
        let Action::Object(drag) = &press.action else { return Vec::new() };
        if !drag.movable {
            return Vec::new();
        }
        let mut commands = press.begin_drag(session);
        if let (Action::Object(drag), Some(eye)) = (&mut press.action, view.eye(session)) {
            commands.extend(drag.change_depth(depth_px, session, &eye));
        }
        commands
    }

    fn finish_press(
        &mut self,
        press: &Press,
        event: &PointerEvent,
        session: &Session,
        view: &impl Viewpoint,
    ) -> Vec<Command> {
        match &press.action {
            Action::Pin(drag) if press.is_click => drag.click(session),
            Action::Ground(_) if press.is_click && press.is_of_pin_tool(session) => {
                let eye = view.eye(session);
                let on = if !view.is_photo() {
                    HalfPinOn::Scene
                } else if event.modifiers.shift {
                    HalfPinOn::PhotoAlone
                } else {
                    HalfPinOn::Photo
                };
                eye.map_or_else(Vec::new, |eye| half_pin(session, &eye, press.start, on))
            }
            Action::Ground(_) | Action::Object(_) if press.is_click => {
                let selects = press.button == Button::Left;
                if selects { self.click(press.start, event, session, view) } else { Vec::new() }
            }
            Action::Object(ObjectDrag { movable: true, .. }) | Action::Handle(_) | Action::Pin(_)
                if !press.is_click =>
            {
                vec![Command::EndGesture]
            }
            _ => Vec::new(),
        }
    }

    /// A click selects the front object, with Alt the one behind the selected one, with Ctrl or Shift one more; on empty
    /// ground none.
    fn click(
        &mut self,
        position: DVec2,
        event: &PointerEvent,
        session: &Session,
        view: &impl Viewpoint,
    ) -> Vec<Command> {
        let (Some(eye), Some(photo)) = (view.eye(session), session.photo()) else { return Vec::new() };
        let hits = pick_along(session.scene(), photo.id, &eye.ray(position));
        let adds = event.modifiers.ctrl || event.modifiers.shift;
        let selected = hits.iter().position(|hit| Some(hit.object) == session.selected());
        let index = match selected {
            Some(selected) if event.modifiers.alt => (selected + 1) % hits.len(),
            _ => 0,
        };
        match hits.get(index).map(|hit| hit.object) {
            Some(object) => {
                self.deselected.clear();
                vec![if adds { Command::SelectAlso(object) } else { Command::Select(Some(object)) }]
            }
            None if adds => Vec::new(),
            None => {
                let mut selection = session.selection();
                let is_first = |id: &ObjectId| Some(*id) == session.selected();
                sort_short(&mut selection, |a, b| is_first(a).cmp(&is_first(b)));
                if !selection.is_empty() {
                    self.deselected = selection;
                }
                vec![Command::Select(None)]
            }
        }
    }

    /// On an object: zoom to it; on empty ground: everything, and what was selected stays so.
    fn double_click(
        &mut self,
        position: DVec2,
        session: &Session,
        view: &mut impl Viewpoint,
    ) -> Vec<Command> {
        // The second of two quick clicks for two pins.
        if session.tool() == Tool::Pin {
            return Vec::new();
        }
        let hit = view.eye(session).and_then(|eye| hit_to_move(session, &eye, position));
        view.show(session, hit.map(|hit| hit.object));
        let known = |object: &ObjectId| session.scene().object(*object).is_some();
        let before: Vec<ObjectId> = self.deselected.drain(..).filter(known).collect();
        if hit.is_some() || session.selected().is_some() {
            return Vec::new();
        }
        before.into_iter().map(Command::SelectAlso).collect()
    }
}

impl Press {
    /// A click on a pin that is there does nothing, so the least move is a drag: the last pixel counts.
    fn click_radius_px(&self) -> f64 {
        match &self.action {
            Action::Pin(drag) if !drag.is_new() => f64::MIN_POSITIVE,
            _ => CLICK_RADIUS_PX,
        }
    }

    fn is_of_pin_tool(&self, session: &Session) -> bool {
        self.button == Button::Left && session.tool() == Tool::Pin
    }

    /// A press that moves stops being a click: its gesture begins.
    fn begin_drag(&mut self, session: &Session) -> Vec<Command> {
        if !std::mem::take(&mut self.is_click) {
            return Vec::new();
        }
        match &self.action {
            Action::Object(drag) => drag.begin(session),
            Action::Pin(drag) => drag.begin(session),
            Action::Handle(drag) => vec![Command::BeginGesture(drag.handle.label())],
            _ => Vec::new(),
        }
    }
}

/// Zooms so that what is under the cursor stays there.
fn zoom(position: DVec2, factor: f64, session: &Session, view: &mut impl Viewpoint) {
    let hits = session
        .photo()
        .zip(view.eye(session))
        .map(|(photo, eye)| pick_along(session.scene(), photo.id, &eye.ray(position)));
    let surface = hits.and_then(|hits| hits.first().map(|hit| hit.point_camera_mm));
    view.zoom_about(position, factor, surface);
}
