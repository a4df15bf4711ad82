//! When a command can be used, and the words for why not.

use super::Session;
use super::pose::STORED;
use crate::scene::AnnotationState;

type Reason = Option<&'static str>;

pub fn always(_: &Session) -> Reason {
    None
}

pub fn needs_photo(session: &Session) -> Reason {
    session.photo().is_none().then_some("no photo is open")
}

pub fn needs_two_photos(session: &Session) -> Reason {
    (session.scene().photos.len() < 2).then_some("only one photo is open")
}

pub fn needs_photo_before(session: &Session) -> Reason {
    let shown = session.photo().map(|photo| photo.id);
    let is_first = session.scene().photos.first().map(|photo| photo.id) == shown;
    is_first.then_some("there is no photo before this one").or_else(|| needs_selection(session))
}

pub fn needs_content(session: &Session) -> Reason {
    session.scene().is_empty().then_some("the scene is empty")
}

pub fn needs_selection(session: &Session) -> Reason {
    session.selected().is_none().then_some("no object is selected")
}

pub fn needs_selected_pose(session: &Session) -> Reason {
    session.selected_annotation().is_none().then_some("no object of this photo is selected")
}

pub fn needs_snappable(session: &Session) -> Reason {
    session.snappable().is_empty().then_some("no object is placed whose pose is neither locked nor confirmed")
}

pub fn needs_pins(session: &Session) -> Reason {
    let has_pins =
        session.selected_annotation().is_some_and(|(_, _, annotation)| !annotation.pins.is_empty());
    (!has_pins).then_some("the selected object has no pins in this photo")
}

pub fn needs_six_pins(session: &Session) -> Reason {
    let pulling = session
        .selected_annotation()
        .map_or(0, |(_, _, annotation)| annotation.pins.iter().filter(|pin| pin.counts()).count());
    let is_locked = session.photo().is_some_and(|photo| photo.locked);
    (pulling < 6)
        .then_some("six pins are needed, not all in one plane")
        .or(is_locked.then_some("the camera is locked"))
}

pub fn needs_pins_and_next(session: &Session) -> Reason {
    let shown = session.photo().map(|photo| photo.id);
    let is_last = session.scene().photos.last().map(|photo| photo.id) == shown;
    needs_pins(session).or(is_last.then_some("there is no photo after this one"))
}

pub fn needs_objects_here(session: &Session) -> Reason {
    let empty = session.photo().is_none_or(|photo| session.scene().objects_in(photo.id).next().is_none());
    empty.then_some("no object is in this photo")
}

pub fn needs_several(session: &Session) -> Reason {
    (session.selection().len() < 2).then_some("select two objects or more: Ctrl + click in the list")
}

pub fn needs_link(session: &Session) -> Reason {
    let linked = |id| session.scene().object(id).is_some_and(|object| object.link.is_some());
    (!session.selection().into_iter().any(linked)).then_some("no selected object is linked")
}

pub fn needs_confirmed(session: &Session) -> Reason {
    let confirmed = session.photo().is_some_and(|photo| {
        let mut states = session.scene().objects_in(photo.id).map(|(_, annotation)| annotation.state);
        states.any(|state| state == AnnotationState::Confirmed)
    });
    (!confirmed).then_some("no pose of this photo is confirmed")
}

pub fn needs_stored(session: &Session) -> Reason {
    let stored = session.selected_annotation().is_some_and(|(photo, object, _)| {
        let mut stored = session.scene().references.iter().filter(|reference| reference.name == STORED);
        stored.any(|reference| reference.poses.contains_key(&(photo, object)))
    });
    (!stored).then_some("no pose of this object was stored in this photo")
}

pub fn needs_log(session: &Session) -> Reason {
    session.log().is_empty().then_some("the list is empty")
}

pub fn needs_undo(session: &Session) -> Reason {
    let nothing = session.undo_label().is_none() && !session.gesture_under_way();
    nothing.then_some("there is nothing to undo")
}

pub fn needs_redo(session: &Session) -> Reason {
    session.redo_label().is_none().then_some("nothing was undone")
}
