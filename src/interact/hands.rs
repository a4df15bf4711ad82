//! Both views with their gestures: which one the pointer acts in.

use glam::DVec2;

use super::gizmo::{GizmoDrag, Handle};
use super::pin_drag::pin_at;
use super::viewpoint::{GroundDrag, Viewpoint};
use super::{Gestures, Hit, PhotoView, PointerEvent, SceneView, StandardView, pick_along};
use crate::session::{Command, Session, Tool};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pane {
    Photo,
    Scene,
}

/// The views' places and the gestures under way in them.
#[derive(Debug, Default)]
pub struct Hands {
    pub photo_view: PhotoView,
    pub scene_view: SceneView,
    photo: Gestures,
    scene: Gestures,
    /// Where the pointer is over a view, in its physical pixels.
    pub pointer: Option<(Pane, DVec2)>,
}

/// What is asked of the scene view besides gestures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SceneMove {
    LookFrom(StandardView),
    /// In physical pixels.
    Orbit(DVec2),
    Reset,
}

impl Hands {
    pub fn set_pixels_per_point(&mut self, pixels_per_point: f64) {
        self.photo.pixels_per_point = pixels_per_point;
        self.scene.pixels_per_point = pixels_per_point;
    }

    /// Reads one event of a view; the commands are to be applied before the next.
    pub fn handle(&mut self, pane: Pane, event: &PointerEvent, session: &Session) -> Vec<Command> {
        match pane {
            Pane::Photo => self.photo.handle(event, session, &mut self.photo_view),
            Pane::Scene => self.scene.handle(event, session, &mut self.scene_view),
        }
    }

    /// The view in which a button went down that is down still.
    pub fn held_in(&self) -> Option<Pane> {
        if self.photo.has_press() {
            return Some(Pane::Photo);
        }
        self.scene.has_press().then_some(Pane::Scene)
    }

    pub fn cancel(&mut self) {
        self.photo.cancel();
        self.scene.cancel();
    }

    /// Two fingers on the ground of a view: pan, and zoom about their middle.
    pub fn two_fingers(&mut self, pane: Pane, middle: DVec2, way_px: DVec2, factor: f64, session: &Session) {
        match pane {
            Pane::Photo => {
                self.photo_view.pan(way_px);
                self.photo_view.zoom_about(middle, factor);
            }
            Pane::Scene => {
                self.scene_view.begin_ground_drag(session);
                self.scene_view.drag_ground(GroundDrag::Pan, way_px);
                Viewpoint::zoom_about(&mut self.scene_view, middle, factor, None);
            }
        }
    }

    pub fn move_scene(&mut self, asked: SceneMove, session: &Session) {
        match asked {
            SceneMove::LookFrom(view) => self.scene_view.look_from(view, session),
            SceneMove::Orbit(way_px) => {
                self.scene_view.begin_ground_drag(session);
                self.scene_view.orbit(way_px);
            }
            SceneMove::Reset => self.scene_view.reset(session),
        }
    }

    pub fn is_dragging_object(&self) -> bool {
        self.photo.is_dragging_object() || self.scene.is_dragging_object()
    }

    /// Do objects or the free eye move under the hand?
    pub fn is_moving(&self) -> bool {
        self.is_dragging_object() || self.scene.has_press() || self.scene_view.is_animating()
    }

    /// The handle that is held in a view.
    pub fn handle_drag(&self, pane: Pane) -> Option<&GizmoDrag> {
        self.gestures(pane).handle_drag()
    }

    /// The pin that is on its way: its number and its pixel.
    pub fn dragged_pin(&self) -> Option<(usize, DVec2)> {
        self.photo.pin_drag().map(|drag| (drag.number(), drag.pixel()))
    }

    /// The number of the pin under the pointer, while nothing is held.
    pub fn hovered_pin(&self, session: &Session) -> Option<usize> {
        let (_, position) =
            self.pointer.filter(|(over, _)| *over == Pane::Photo && self.held_in().is_none())?;
        let eye = self.photo_view.eye(session).filter(|_| session.tool() == Tool::Pin)?;
        pin_at(session, &eye, position, self.photo.pixels_per_point).map(|(_, number, _)| number)
    }

    /// The handle under the pointer, while nothing is held.
    pub fn hovered_handle(&self, pane: Pane, session: &Session) -> Option<Handle> {
        let (_, position) = self.pointer.filter(|(over, _)| *over == pane && self.held_in().is_none())?;
        match pane {
            Pane::Photo => self.photo.handle_at(position, session, &self.photo_view),
            Pane::Scene => self.scene.handle_at(position, session, &self.scene_view),
        }
    }

    /// Is the wipe's line held, or under the pointer?
    pub fn wipe_is_lit(&self, session: &Session) -> bool {
        let over = self.pointer.is_some_and(|(pane, position)| {
            pane == Pane::Photo && self.photo.is_on_wipe(position, session, &self.photo_view)
        });
        self.photo.is_dragging_wipe() || (over && self.held_in().is_none())
    }

    /// The surface point under the pointer.
    pub fn hit_under_pointer(&self, session: &Session) -> Option<Hit> {
        let (pane, position) = self.pointer?;
        let eye = match pane {
            Pane::Photo => self.photo_view.eye(session),
            Pane::Scene => self.scene_view.eye(session),
        }?;
        pick_along(session.scene(), session.photo()?.id, &eye.ray(position)).first().copied()
    }

    /// The point of the photo under the pointer, in the photo view.
    pub fn pixel_under_pointer(&self) -> Option<DVec2> {
        let (_, position) = self.pointer.filter(|(pane, _)| *pane == Pane::Photo)?;
        Some(self.photo_view.image_from_viewport(position))
    }

    fn gestures(&self, pane: Pane) -> &Gestures {
        match pane {
            Pane::Photo => &self.photo,
            Pane::Scene => &self.scene,
        }
    }
}
