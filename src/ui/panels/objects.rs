//! The list of objects.

use egui::{Sense, Stroke, Ui, Vec2};

use super::PanelState;
use super::list::{self, List, NameLook, NameUse, Rename, RowKey};
use super::section::section;
use crate::scene::{Annotation, AnnotationState, Object, ObjectId, object_color};
use crate::session::{Command, CommandId, ObjectChange, Session};
use crate::ui::command_button::{command_icon, command_item};
use crate::ui::icons::{self, Icon};
use crate::ui::theme;

pub fn draw(ui: &mut Ui, session: &Session, state: &mut PanelState, commands: &mut Vec<Command>) {
    let objects = &session.scene().objects;
    let selected = session.selected();
    let is_new = std::mem::replace(&mut state.shown_object, selected) != selected;
    let reveal = objects.iter().position(|object| is_new && Some(object.id) == selected);
    let mut asked = Vec::new();
    let import = |ui: &mut Ui| {
        if command_icon(ui, Icon::Plus, CommandId::ImportMeshes, session).clicked() {
            asked.push(Command::Run(CommandId::ImportMeshes));
        }
    };
    section(ui, "Objects", true, import, |ui| {
        if objects.is_empty() {
            super::number_field::note(ui, "Drop a mesh (PLY, OBJ, STL, GLB, OFF)", true);
        }
        list::rows(ui, List::Objects, objects.len(), reveal, |ui, index| {
            object_row(ui, session, index, &objects[index], state, commands);
        });
        selected_opacity(ui, session, commands);
    });
    commands.append(&mut asked);
}

/// Goes for all selected objects.
fn selected_opacity(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let Some(object) = session.selected().and_then(|id| session.scene().object(id)) else { return };
    let count = session.selection().len();
    let text = if count > 1 { format!("of {count} objects") } else { "opacity".to_owned() };
    if let Some(opacity) = list::opacity(ui, "Object opacity", &text, object.opacity) {
        commands.push(Command::EditObject(object.id, ObjectChange::Opacity(opacity)));
    }
}

fn object_row(
    ui: &mut Ui,
    session: &Session,
    index: usize,
    object: &Object,
    state: &mut PanelState,
    commands: &mut Vec<Command>,
) {
    let key = RowKey { list: List::Objects, id: object.id.0 };
    let photo = session.photo().map(|photo| photo.id);
    let annotation = photo.and_then(|photo| session.scene().annotation(photo, object.id));
    let mut asked = Vec::new();
    let dropped = list::row(ui, key, index, |ui| {
        let strength = if annotation.is_some() { 1.0 } else { 0.3 };
        if let Some(color) = list::swatch(ui, &object.name, object.color, strength) {
            asked.push(Command::EditObject(object.id, ObjectChange::Color(color)));
        }
        badge(ui, annotation);
        let name = object_name(ui, session, key, object, annotation.is_some(), &mut state.rename);
        if let Some(new) = name.renamed {
            asked.push(Command::EditObject(object.id, ObjectChange::Name(new)));
        }
        if let Some(response) = &name.response {
            choose(ui, session, object.id, response, &mut state.range_anchor, &mut asked);
        }
        chain(ui, session, object);
        row_buttons(ui, session, object, annotation.is_some(), &mut asked);
        let dots = list::row_menu(ui, &object.name, name.response.as_ref(), |ui| {
            object_menu(ui, session, index, object, annotation.is_some(), &mut state.rename, &mut asked);
        });
        // The menu's commands act on the selection.
        if dots.clicked() && !session.is_selected(object.id) {
            asked.push(Command::Select(Some(object.id)));
        }
    });
    commands.append(&mut asked);
    commands.extend(dropped.map(|(id, to)| Command::MoveObject(ObjectId(id), to)));
}

fn object_name(
    ui: &mut Ui,
    session: &Session,
    key: RowKey,
    object: &Object,
    placed: bool,
    rename: &mut Option<Rename>,
) -> NameUse {
    let triangles = object.mesh.mesh.triangles().len();
    let is_first_of_several = session.selected() == Some(object.id) && session.selection().len() > 1;
    let mut tooltip = format!("{}, {triangles} triangles", object.mesh.file_name);
    if !placed {
        tooltip += "\nNot in this photo";
    }
    let look = NameLook {
        name: &object.name,
        selected: session.is_selected(object.id),
        weak: !placed || !object.visible,
        room: if object.link.is_some() { 98.0 } else { 78.0 },
        tooltip: &tooltip,
    };
    let used = list::name(ui, key, look, rename);
    // Of several that are selected, keys and numbers act on this one.
    if let Some(response) = used.response.as_ref().filter(|_| is_first_of_several) {
        let bar = response.rect.with_max_x(response.rect.left() + 3.0).shrink2(Vec2::new(0.0, 3.0));
        ui.painter().rect_filled(bar, 1.5, ui.visuals().strong_text_color());
    }
    used
}

fn row_buttons(ui: &mut Ui, session: &Session, object: &Object, placed: bool, asked: &mut Vec<Command>) {
    if !placed && let Some(photo) = session.photo() {
        let place = egui::Button::new(egui::RichText::new("Place").small()).min_size(Vec2::new(48.0, 18.0));
        if ui.add(place).on_hover_text(format!("Put {} into this photo", object.name)).clicked() {
            asked.push(Command::Place { photo: photo.id, object: object.id });
        }
        return;
    }
    if list::lock(ui, &object.name, object.locked) {
        asked.push(Command::EditObject(object.id, ObjectChange::Locked(!object.locked)));
    }
    if list::eye(ui, &object.name, object.visible) {
        asked.push(Command::EditObject(object.id, ObjectChange::Visible(!object.visible)));
    }
}

/// Click: this one alone. Ctrl + click: this one too, or no more. Shift + click: all from the last one that was clicked.
fn choose(
    ui: &Ui,
    session: &Session,
    object: ObjectId,
    response: &egui::Response,
    range_anchor: &mut Option<ObjectId>,
    commands: &mut Vec<Command>,
) {
    if response.secondary_clicked() && !session.is_selected(object) {
        commands.push(Command::Select(Some(object)));
    }
    if !response.clicked() {
        return;
    }
    let modifiers = ui.input(|input| input.modifiers);
    if modifiers.shift {
        let anchor = range_anchor.or(session.selected());
        commands.extend(range_commands(session, anchor, object));
        return;
    }
    *range_anchor = Some(object);
    commands.push(if modifiers.command {
        Command::SelectAlso(object)
    } else {
        Command::Select(Some(object))
    });
}

/// The rows from the anchor to the one that was clicked, which comes last and is the one that keys act on.
fn range_commands(session: &Session, anchor: Option<ObjectId>, object: ObjectId) -> Vec<Command> {
    let ids: Vec<ObjectId> = session.scene().objects.iter().map(|object| object.id).collect();
    let position = |id: ObjectId| ids.iter().position(|candidate| *candidate == id);
    let (Some(to), Some(from)) = (position(object), anchor.and_then(position)) else {
        return vec![Command::Select(Some(object))];
    };
    let mut range: Vec<ObjectId> = ids[from.min(to)..=from.max(to)].to_vec();
    if from > to {
        range.reverse();
    }
    let first = range.first().copied();
    let others = range.into_iter().skip(1).map(Command::SelectAlso);
    std::iter::once(Command::Select(first)).chain(others).collect()
}

fn object_menu(
    ui: &mut Ui,
    session: &Session,
    index: usize,
    object: &Object,
    placed: bool,
    rename: &mut Option<Rename>,
    commands: &mut Vec<Command>,
) {
    command_item(ui, session, CommandId::ZoomToObject, None, commands);
    if list::item(ui, "Rename", None) {
        *rename = Some(Rename::new(RowKey { list: List::Objects, id: object.id.0 }, &object.name));
    }
    command_item(ui, session, CommandId::DuplicateObject, Some("Duplicate"), commands);
    if let Some(photo) = session.photo() {
        let (photo, object) = (photo.id, object.id);
        if placed && list::item(ui, "Take out of this photo", None) {
            commands.push(Command::Withdraw { photo, object });
        } else if !placed && list::item(ui, "Place in this photo", None) {
            commands.push(Command::Place { photo, object });
        }
    }
    ui.separator();
    command_item(ui, session, CommandId::LinkObjects, Some("Link the selected ones"), commands);
    command_item(ui, session, CommandId::UnlinkObjects, Some("Unlink the selected ones"), commands);
    command_item(ui, session, CommandId::ResetPose, None, commands);
    command_item(ui, session, CommandId::StoreReference, None, commands);
    command_item(ui, session, CommandId::BackToReference, None, commands);
    if let Some(to) = list::move_items(ui, index, session.scene().objects.len()) {
        commands.push(Command::MoveObject(object.id, to));
    }
    ui.separator();
    if list::item(ui, &format!("Remove {}", object.name), None) {
        commands.push(Command::RemoveObject(object.id));
    }
}

/// Linked objects show a chain; those of one group in one colour.
fn chain(ui: &mut Ui, session: &Session, object: &Object) {
    let Some(link) = object.link else { return };
    let (rect, response) = ui.allocate_exact_size(Vec2::new(16.0, list::ROW_HEIGHT), Sense::hover());
    let square = egui::Rect::from_center_size(rect.center(), Vec2::splat(13.0));
    let color = theme::color32(object_color(link as usize));
    icons::draw(ui.painter(), Icon::Chain, square, Stroke::new(1.3, color));
    let scene = session.scene();
    let others =
        scene.linked_to(object.id).filter_map(|id| scene.object(id)).map(|other| other.name.as_str());
    let others: Vec<&str> = others.collect();
    response.on_hover_text(format!("Moves together with {}", others.join(", ")));
}

/// How far a pose is: an empty ring, a half one, a full dot, a tick; words on hover.
fn badge(ui: &mut Ui, annotation: Option<&Annotation>) {
    let (rect, response) = ui.allocate_exact_size(Vec2::new(12.0, list::ROW_HEIGHT), Sense::hover());
    let Some(annotation) = annotation else {
        response.on_hover_text("Not in this photo");
        return;
    };
    let center = rect.center();
    let painter = ui.painter();
    let weak = ui.visuals().weak_text_color();
    let warning = ui.visuals().warn_fg_color;
    let meaning = match annotation.state {
        AnnotationState::Untouched => {
            painter.circle_stroke(center, 3.5, Stroke::new(1.3, weak));
            "Untouched: at its start pose, drag it"
        }
        AnnotationState::Carried => {
            painter.circle_stroke(center, 3.5, Stroke::new(1.3, warning));
            painter.circle_filled(center, 1.6, warning);
            "Carried over from another photo: check it"
        }
        AnnotationState::Posed => {
            painter.circle_filled(center, 4.0, theme::GOOD);
            "Posed"
        }
        AnnotationState::Confirmed => {
            let square = egui::Rect::from_center_size(center, Vec2::splat(11.0));
            icons::draw(painter, Icon::Check, square, Stroke::new(2.0, theme::GOOD));
            "Confirmed: held until it is reopened"
        }
    };
    if annotation.camera_changed {
        painter.circle_stroke(center, 5.5, Stroke::new(1.3, warning));
        response.on_hover_text(format!("{meaning}\nThe camera was changed since: look at it again"));
    } else {
        response.on_hover_text(meaning);
    }
}
