//! What a view has to offer for the hand to act in it.

use glam::{DVec2, DVec3};

use super::{Button, Eye, Modifiers};
use crate::scene::ObjectId;
use crate::session::Session;

/// What a drag of the ground does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GroundDrag {
    Pan,
    Orbit,
}

/// A view of the scene. Positions and ways are in physical pixels of its viewport.
pub trait Viewpoint {
    /// `None` where no photo is shown.
    fn eye(&self, session: &Session) -> Option<Eye>;

    /// Is its eye the photo's camera, so that its pixels are the photo's?
    fn is_photo(&self) -> bool;

    /// What is meant by a press whatever is under it; `None`: that depends on what is there.
    fn ground_drag_anywhere(&self, button: Button, modifiers: Modifiers) -> Option<GroundDrag>;

    /// What a drag that begins on empty ground does.
    fn ground_drag(&self) -> GroundDrag;

    /// Called where a drag of the ground begins.
    fn begin_ground_drag(&mut self, session: &Session);

    fn drag_ground(&mut self, kind: GroundDrag, way_px: DVec2);

    /// Zooms by a factor; what is under `position` stays there. `surface_camera_mm` is what is there, if anything is.
    fn zoom_about(&mut self, position: DVec2, factor: f64, surface_camera_mm: Option<DVec3>);

    /// Shows an object, or all there is.
    fn show(&mut self, session: &Session, object: Option<ObjectId>);

    /// The line of the wipe that can be dragged: its x.
    fn wipe_px(&self, session: &Session) -> Option<f64>;

    fn width_px(&self) -> f64;
}
