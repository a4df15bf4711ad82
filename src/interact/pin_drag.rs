//! Pins under the hand: a new one on the surface, an old one to its pixel.

use glam::DVec2;

use super::object_drag::{FINE, hit_to_move};
use super::{Eye, Hit, Modifiers};
use crate::scene::{ObjectId, PhotoId, Pin};
use crate::session::{Command, HalfPin, Session};

/// A pin is taken this near to its pixel.
const GRIP_POINTS: f64 = 11.0;

/// A pin that is held, in the photo view.
#[derive(Debug)]
pub struct PinDrag {
    photo: PhotoId,
    object: ObjectId,
    /// Its number among the pose's pins; a new one comes after them.
    pin: usize,
    /// What is set first, if it is not there yet.
    new: Option<Pin>,
    /// Where the pin is, in the photo's `image` frame.
    pixel: DVec2,
}

impl PinDrag {
    /// The pin under the pointer, else a new one on the surface there. `None` on empty ground.
    pub fn start(session: &Session, eye: &Eye, position: DVec2, pixels_per_point: f64) -> Option<Self> {
        let photo = session.photo()?.id;
        if let Some((object, pin, pixel)) = pin_at(session, eye, position, pixels_per_point) {
            return Some(Self { photo, object, pin, new: None, pixel });
        }
        let hit = hit_to_move(session, eye, position)?;
        let pin = session.scene().annotation(photo, hit.object)?.pins.len();
        let pixel = eye.image_from_viewport(position);
        let new = Some(Pin::new(hit.point_object_mm, pixel));
        Some(Self { photo, object: hit.object, pin, new, pixel })
    }

    /// What begins the gesture. What cannot be moved is tried once, for the session to say why.
    pub fn begin(&self, session: &Session) -> Vec<Command> {
        if session.check_movable((self.photo, self.object)).is_err() {
            return vec![self.dragged()];
        }
        let label = if self.new.is_some() { "Add pin" } else { "Drag pin" };
        let select = self.select(session);
        select.into_iter().chain([Command::BeginGesture(label)]).chain(self.add()).collect()
    }

    pub fn advance(&mut self, way_px: DVec2, modifiers: Modifiers, eye: &Eye) -> Command {
        let fineness = if modifiers.alt { FINE } else { 1.0 };
        self.pixel += way_px * fineness / eye.zoom;
        self.dragged()
    }

    /// A click sets a new pin where it is, so that nothing moves.
    pub fn click(&self, session: &Session) -> Vec<Command> {
        self.select(session).into_iter().chain(self.add()).collect()
    }

    /// Where the pin is, in the photo's `image` frame.
    pub fn pixel(&self) -> DVec2 {
        self.pixel
    }

    /// It comes with this gesture.
    pub fn is_new(&self) -> bool {
        self.new.is_some()
    }

    pub fn number(&self) -> usize {
        self.pin
    }

    fn select(&self, session: &Session) -> Option<Command> {
        (session.selected() != Some(self.object)).then_some(Command::Select(Some(self.object)))
    }

    fn add(&self) -> Option<Command> {
        Some(Command::AddPin { photo: self.photo, object: self.object, pin: self.new? })
    }

    fn dragged(&self) -> Command {
        Command::DragPin { photo: self.photo, object: self.object, pin: self.pin, pixel: self.pixel }
    }
}

/// The selected pose's pin under the pointer, in the photo view: its object, number and pixel; of several the nearest.
pub fn pin_at(
    session: &Session,
    eye: &Eye,
    position: DVec2,
    pixels_per_point: f64,
) -> Option<(ObjectId, usize, DVec2)> {
    let (_, object, annotation) = session.selected_annotation()?;
    let distance = |pin: &Pin| eye.viewport_from_image(pin.pixel).distance(position);
    let pins = annotation.pins.iter().enumerate();
    let (number, pin) = pins.min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))?;
    (distance(pin) <= GRIP_POINTS * pixels_per_point).then_some((object, number, pin.pixel))
}

/// Where a half of a pin is clicked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HalfPinOn {
    /// A place is looked for, and a point of the object if the place is known already.
    Photo,
    /// A place, though the object be drawn over it.
    PhotoAlone,
    /// A point of the object.
    Scene,
}

/// A click with the Pin tool that sets one half of a pin, or the half that is missing.
pub fn half_pin(session: &Session, eye: &Eye, position: DVec2, on: HalfPinOn) -> Vec<Command> {
    let Some(photo) = session.photo().map(|photo| photo.id) else { return Vec::new() };
    let hit = if on == HalfPinOn::PhotoAlone { None } else { hit_to_move(session, eye, position) };
    let complete = |object: ObjectId, pin: Pin| {
        let select = (session.selected() != Some(object)).then_some(Command::Select(Some(object)));
        select.into_iter().chain([Command::CompletePin { photo, object, pin }]).collect()
    };
    let pixel = (on != HalfPinOn::Scene).then(|| eye.image_from_viewport(position));
    match (session.half_pin(), pixel, hit) {
        (Some(HalfPin::Point(object, point_mm)), Some(pixel), _) => {
            complete(object, Pin::new(point_mm, pixel))
        }
        (Some(HalfPin::Pixel(pixel)), _, Some(Hit { object, point_object_mm, .. })) => {
            complete(object, Pin::new(point_object_mm, pixel))
        }
        (_, Some(pixel), None) if session.selected_annotation().is_some() => {
            vec![Command::BeginPin(Some(HalfPin::Pixel(pixel)))]
        }
        (_, None, Some(Hit { object, point_object_mm, .. })) => {
            vec![Command::BeginPin(Some(HalfPin::Point(object, point_object_mm)))]
        }
        _ => Vec::new(),
    }
}
