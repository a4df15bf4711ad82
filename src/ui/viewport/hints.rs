//! One line that says what to do next, where that may not be clear.

use egui::{Align2, Area, Id, Order, Rect, RichText, Ui, Vec2};

use super::chooser;
use crate::scene::{AnnotationState, ObjectId, PhotoId};
use crate::session::{Command, HalfPin, Session, Tool};
use crate::ui::{Asked, Surroundings, theme};

/// From the view's top to the line: beside the choices in the corner, and below them where it would lie on them.
const TOPS: [f32; 2] = [12.0, 52.0];
const GAP: f32 = 4.0;

struct Hint {
    text: String,
    place: Option<(PhotoId, ObjectId)>,
}

pub fn draw(ui: &Ui, rect: Rect, session: &Session, around: &Surroundings<'_>, asked: &mut Asked) {
    if around.hands.is_dragging_object() || session.question().is_some() {
        return;
    }
    let Some(hint) = hint(session) else { return };
    // Each text has its own area: egui shows one only when its size is known.
    let id = Id::unique("hint").with(&hint.text);
    let area_of = |id| ui.memory(|memory| memory.area_rect(id));
    let is_beside = area_of(chooser::area())
        .zip(area_of(id))
        .is_none_or(|(choices, line)| rect.center().x - 0.5 * line.width() > choices.right() + GAP);
    let top = if is_beside { TOPS[0] } else { TOPS[1] };
    Area::new(id)
        .order(Order::Middle)
        .pivot(Align2::CENTER_TOP)
        .fixed_pos(rect.center_top() + Vec2::new(0.0, top))
        .interactable(hint.place.is_some())
        .show(ui.ctx(), |ui| {
            theme::overlay_frame().show(ui, |ui| {
                ui.horizontal(|ui| {
                    ui.label(RichText::new(hint.text));
                    if let Some((photo, object)) = hint.place
                        && ui.add(theme::primary_button("Place it here")).clicked()
                    {
                        asked.commands.push(Command::Place { photo, object });
                    }
                });
            });
        });
}

/// What the next pin is for.
fn pin_hint(session: &Session) -> Option<Hint> {
    let (_, _, annotation) = session.selected_annotation()?;
    let text = match (session.half_pin(), annotation.pins.len()) {
        (Some(HalfPin::Pixel(_)), _) => "Now click the same point on the object, here or in the scene view",
        (Some(HalfPin::Point(..)), _) => "Now click where that point is in the photo",
        (None, 0) => "Press on a point of the object and drag it to where it is in the photo",
        (None, 1) => "One pin moves the object. Drag a second point, far from it: that sets roll and size",
        (None, 2) => "Two more points, off their line, set the tilt",
        (None, 3) => "One more point settles it",
        _ => return None,
    };
    Some(Hint { text: text.to_owned(), place: None })
}

fn hint(session: &Session) -> Option<Hint> {
    let scene = session.scene();
    let selected = session.selected().and_then(|id| scene.object(id));
    let say = |text: &str| Some(Hint { text: text.to_owned(), place: None });
    let Some(photo) = session.photo() else { return say("Now drop a photo") };
    if scene.objects.is_empty() {
        return say("Now drop the mesh of the object (PLY, OBJ, STL, GLB, OFF)");
    }
    if scene.objects_in(photo.id).next().is_none() && selected.is_none() {
        return say("Nothing is placed in this photo: choose an object in the list");
    }
    if session.tool() == Tool::Pin && session.selected_annotation().is_some() {
        return pin_hint(session);
    }
    match (selected, session.selected_annotation()) {
        (Some(object), None) => {
            let text = format!("{} is not in this photo", object.name);
            Some(Hint { text, place: Some((photo.id, object.id)) })
        }
        (_, Some((_, _, annotation))) if annotation.state == AnnotationState::Untouched => {
            say("Drag the object onto its image.  Right drag: turn.  Shift + wheel: depth.")
        }
        _ => None,
    }
}
