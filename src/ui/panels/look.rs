//! How photo and meshes are shown.

use egui::{Button, ComboBox, Slider, Ui};

use super::list;
use super::section::section;
use crate::scene::{Layers, Look, OverlayMode};
use crate::session::{Command, CommandId, Session};
use crate::ui::command_button::{command_button, tooltip};
use crate::ui::icons::{Icon, icon_button};

pub fn draw(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let before = session.look();
    let mut look = before;
    let reset = |ui: &mut Ui| {
        let is_default = before == Look::default();
        let tooltip =
            if is_default { "Everything is as it is at first" } else { "Show everything as at first" };
        icon_button(ui, Icon::Reset, "Reset look", tooltip, !is_default).clicked()
    };
    let mut is_reset = false;
    section(
        ui,
        "Look",
        true,
        |ui| is_reset = reset(ui),
        |ui| {
            mode_choice(ui, &mut look);
            if let Some(opacity) = list::opacity(ui, "opacity", "overlay", look.overlay_opacity) {
                look.overlay_opacity = opacity;
            }
            toggles(ui, session, commands);
            layers_choice(ui, &mut look);
            photo_adjustment(ui, &mut look);
        },
    );
    if is_reset {
        look = Look::default();
    }
    if look != before {
        commands.push(Command::SetLook(look));
    }
}

fn mode_choice(ui: &mut Ui, look: &mut Look) {
    let width = ui.available_width() - 4.0;
    let combo = ComboBox::new("overlay mode", "").selected_text(look.mode.title()).width(width).height(260.0);
    let response = combo
        .show_ui(ui, |ui| {
            for (mode, _, title) in OverlayMode::ALL {
                ui.selectable_value(&mut look.mode, mode, title);
            }
        })
        .response;
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label("Overlay mode"));
    response.on_hover_text(tooltip(ui.ctx(), CommandId::NextOverlay.info()));
}

fn toggles(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let look = session.look();
    let toggles = [
        (CommandId::ToggleOutline, look.outline),
        (CommandId::ToggleXRay, look.x_ray),
        (CommandId::ToggleWipe, look.wipe.is_some()),
        (CommandId::ToggleDifference, look.difference),
    ];
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.spacing_mut().button_padding.x = 7.0;
        for (id, is_on) in toggles {
            let text = egui::RichText::new(id.info().text).small();
            let button = Button::selectable(is_on, text).frame_when_inactive(true);
            if command_button(ui, button, id.info(), session) {
                commands.push(Command::Run(id));
            }
        }
    });
}

fn layers_choice(ui: &mut Ui, look: &mut Look) {
    let choices = [
        (Layers::Both, "Both", "Photo and meshes"),
        (Layers::PhotoOnly, "Photo", "The photo alone"),
        (Layers::MeshOnly, "Mesh", "The meshes alone"),
    ];
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        ui.spacing_mut().button_padding.x = 7.0;
        ui.label(egui::RichText::new("Show").small());
        for (layers, text, meaning) in choices {
            let text = egui::RichText::new(text).small();
            let button = Button::selectable(look.layers == layers, text).frame_when_inactive(true);
            let response = ui.add(button);
            let name = format!("Show {}", meaning.to_lowercase());
            ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(name));
            if response.on_hover_text(format!("{meaning} (I)")).clicked() {
                look.layers = layers;
            }
        }
    });
}

fn photo_adjustment(ui: &mut Ui, look: &mut Look) {
    let photo = &mut look.photo;
    let values = [
        ("brightness", &mut photo.brightness),
        ("contrast", &mut photo.contrast),
        ("saturation", &mut photo.saturation),
    ];
    for (name, value) in values {
        let mut percent = (*value * 100.0).round();
        let slider = Slider::new(&mut percent, -100.0..=100.0).text(name).fixed_decimals(0);
        let response = ui.add(slider);
        ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(format!("Photo {name}")));
        if response.changed() {
            *value = percent / 100.0;
        }
        let rail = response.rect.with_max_x(response.rect.left() + ui.spacing().slider_width);
        let double_clicked =
            ui.input(|input| input.pointer.button_double_clicked(egui::PointerButton::Primary));
        if double_clicked && ui.rect_contains_pointer(rail) {
            *value = 0.0;
        }
        response.on_hover_text("Of the photo, for the eye alone; double click: as it is");
    }
}
