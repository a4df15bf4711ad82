//! The masks of the photo that is shown.

use egui::Ui;

use super::PanelState;
use super::list::{self, List, NameLook, Rename, RowKey};
use super::section::section;
use crate::scene::{Mask, MaskId};
use crate::session::{Command, CommandId, MaskChange, Session};
use crate::ui::command_button::command_icon;
use crate::ui::icons::Icon;

pub fn draw(ui: &mut Ui, session: &Session, state: &mut PanelState, commands: &mut Vec<Command>) {
    let Some(photo) = session.photo() else { return };
    // With its position in the list of all photos' masks, which is what a move is about.
    let all = session.scene().masks.iter().enumerate();
    let masks: Vec<(usize, &Mask)> = all.filter(|(_, mask)| mask.photo == photo.id).collect();
    let mut asked = Vec::new();
    let import = |ui: &mut Ui| {
        if command_icon(ui, Icon::Plus, CommandId::ImportMasks, session).clicked() {
            asked.push(Command::Run(CommandId::ImportMasks));
        }
    };
    section(ui, "Masks", true, import, |ui| {
        list::rows(ui, List::Masks, masks.len(), None, |ui, row| {
            let (position, mask) = masks[row];
            mask_row(ui, session, (row, position, &masks), mask, state, commands);
        });
    });
    commands.append(&mut asked);
}

/// A mask's row, its position in the scene's list, and the masks of this photo.
type Place<'a> = (usize, usize, &'a [(usize, &'a Mask)]);

fn mask_row(
    ui: &mut Ui,
    session: &Session,
    (row, position, masks): Place<'_>,
    mask: &Mask,
    state: &mut PanelState,
    commands: &mut Vec<Command>,
) {
    let key = RowKey { list: List::Masks, id: mask.id.0 };
    let shows = mask.object.and_then(|id| session.scene().object(id)).map(|object| object.name.as_str());
    let mut asked = Vec::new();
    let dropped = list::row(ui, key, position, |ui| {
        let strength = if mask.visible { 1.0 } else { 0.3 };
        if let Some(color) = list::swatch(ui, &mask.name, mask.color, strength) {
            asked.push(Command::EditMask(mask.id, MaskChange::Color(color)));
        }
        let tooltip = match shows {
            Some(object) => format!("Shows {object}"),
            None => "Which object it shows is not said".to_owned(),
        };
        let look = NameLook {
            name: &mask.name,
            selected: false,
            weak: !mask.visible,
            room: 52.0,
            tooltip: &tooltip,
        };
        let name = list::name(ui, key, look, &mut state.rename);
        if let Some(new) = name.renamed {
            asked.push(Command::EditMask(mask.id, MaskChange::Name(new)));
        }
        if list::eye(ui, &mask.name, mask.visible) {
            asked.push(Command::EditMask(mask.id, MaskChange::Visible(!mask.visible)));
        }
        list::row_menu(ui, &mask.name, name.response.as_ref(), |ui| {
            mask_menu(ui, session, (row, position, masks), mask, &mut state.rename, &mut asked);
        });
    });
    commands.append(&mut asked);
    commands.extend(dropped.map(|(id, to)| Command::MoveMask(MaskId(id), to)));
}

fn mask_menu(
    ui: &mut Ui,
    session: &Session,
    (row, _, masks): Place<'_>,
    mask: &Mask,
    rename: &mut Option<Rename>,
    commands: &mut Vec<Command>,
) {
    if list::item(ui, "Rename", None) {
        *rename = Some(Rename::new(RowKey { list: List::Masks, id: mask.id.0 }, &mask.name));
    }
    let name = format!("Opacity of {}", mask.name);
    if let Some(opacity) = list::opacity(ui, &name, "opacity", mask.opacity) {
        commands.push(Command::EditMask(mask.id, MaskChange::Opacity(opacity)));
    }
    if let Some(to) = list::move_items(ui, row, masks.len()) {
        // From rows of this photo to positions among all masks.
        let last = masks.last().map_or(0, |(position, _)| position + 1);
        let to = masks.get(to).map_or(last, |(position, _)| *position);
        commands.push(Command::MoveMask(mask.id, to));
    }
    ui.separator();
    ui.label(egui::RichText::new("Shows").small().weak());
    let mut choose = |ui: &mut Ui, text: &str, object| {
        if ui.add(egui::Button::selectable(mask.object == object, text)).clicked() {
            commands.push(Command::EditMask(mask.id, MaskChange::Object(object)));
            ui.close();
        }
    };
    egui::ScrollArea::vertical().max_height(160.0).show(ui, |ui| {
        choose(ui, "No object", None);
        for object in &session.scene().objects {
            choose(ui, &object.name, Some(object.id));
        }
    });
    ui.separator();
    if list::item(ui, &format!("Remove {}", mask.name), None) {
        commands.push(Command::RemoveMask(mask.id));
    }
}
