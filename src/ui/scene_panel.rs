//! Photos, objects and references as lists, and how the overlay looks.

use std::sync::Arc;

use egui::{Align, Button, Layout, RichText, Sense, Slider, Ui, Vec2};

use super::icons::{Icon, icon_button};
use super::theme;
use crate::scene::{Annotation, AnnotationState, Object, Photo, Scene, reference_color};
use crate::session::{Command, CommandId, ObjectChange, Session};

pub fn photos(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    theme::section(ui, "Photos");
    let photos = &session.scene().photos;
    if photos.is_empty() {
        ui.label(RichText::new("Drop a photo (PNG, JPEG)").color(theme::WARNING));
    }
    let shown = session.photo().map(|photo| photo.id);
    for photo in photos {
        ui.horizontal(|ui| {
            photo_state(ui, session.scene(), photo);
            let name = RichText::new(&photo.asset.file_name);
            if name_button(ui, Some(photo.id) == shown, name, 38.0).clicked() {
                commands.push(Command::ShowPhoto(photo.id));
            }
            if row_button(ui, Icon::Trash, &format!("Remove {}", photo.asset.file_name)) {
                commands.push(Command::RemovePhoto(photo.id));
            }
        });
    }
}

/// What has been done in a photo: an empty, a half or a full dot, and words.
fn photo_state(ui: &mut Ui, scene: &Scene, photo: &Photo) {
    let states: Vec<AnnotationState> =
        scene.objects_in(photo.id).map(|(_, annotation)| annotation.state).collect();
    let done = |state: &AnnotationState| matches!(state, AnnotationState::Posed | AnnotationState::Confirmed);
    let (filled, color, meaning) = if states.is_empty() {
        (0.0, ui.visuals().weak_text_color(), "No object in this photo yet")
    } else if states.iter().all(done) {
        (5.0, theme::GOOD, "Every object in this photo is posed")
    } else {
        (2.2, theme::WARNING, "An object in this photo waits for its pose")
    };
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(12.0), Sense::hover());
    ui.painter().circle(rect.center(), 4.5, egui::Color32::TRANSPARENT, egui::Stroke::new(1.3, color));
    ui.painter().circle_filled(rect.center(), filled, color);
    response.on_hover_text(meaning);
}

pub fn objects(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    theme::section(ui, "Objects");
    let scene = session.scene();
    if scene.objects.is_empty() {
        ui.label(RichText::new("Drop a mesh (PLY, OBJ, GLB)").color(theme::WARNING));
    }
    let photo = session.photo().map(|photo| photo.id);
    for object in &scene.objects {
        let annotation = photo.and_then(|photo| scene.annotation(photo, object.id));
        object_row(ui, session, object, annotation, commands);
    }
}

fn object_row(
    ui: &mut Ui,
    session: &Session,
    object: &Object,
    annotation: Option<&Annotation>,
    commands: &mut Vec<Command>,
) {
    ui.horizontal(|ui| {
        let (swatch, _) = ui.allocate_exact_size(Vec2::new(12.0, 12.0), Sense::hover());
        let color = theme::color32(object.color);
        let color = if annotation.is_some() { color } else { color.gamma_multiply(0.3) };
        ui.painter().rect_filled(swatch, 3.0, color);
        let name = RichText::new(&object.name);
        let name = if annotation.is_some() { name } else { name.weak() };
        let triangles = object.mesh.mesh.triangles().len();
        let details = format!("{}, {triangles} triangles", object.mesh.file_name);
        let selected = session.selected() == Some(object.id);
        if name_button(ui, selected, name, 98.0).on_hover_text(details).clicked() {
            commands.push(Command::Select(Some(object.id)));
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            object_buttons(ui, session, object, annotation.is_some(), commands);
        });
    });
}

fn object_buttons(
    ui: &mut Ui,
    session: &Session,
    object: &Object,
    placed: bool,
    commands: &mut Vec<Command>,
) {
    ui.spacing_mut().item_spacing.x = 4.0;
    ui.add_space(8.0);
    if row_button(ui, Icon::Trash, &format!("Remove {}", object.name)) {
        commands.push(Command::RemoveObject(object.id));
    }
    if !placed {
        let Some(photo) = session.photo() else { return };
        let place = ui.small_button("Place").on_hover_text(format!("Put {} into this photo", object.name));
        if place.clicked() {
            commands.push(Command::Place { photo: photo.id, object: object.id });
        }
        return;
    }
    let (icon, tooltip) = if object.locked { (Icon::Lock, "Unlock") } else { (Icon::LockOpen, "Lock") };
    if row_button(ui, icon, &format!("{tooltip} {}", object.name)) {
        commands.push(Command::EditObject(object.id, ObjectChange::Locked(!object.locked)));
    }
    let (icon, tooltip) = if object.visible { (Icon::Eye, "Hide") } else { (Icon::EyeClosed, "Show") };
    if row_button(ui, icon, &format!("{tooltip} {}", object.name)) {
        commands.push(Command::EditObject(object.id, ObjectChange::Visible(!object.visible)));
    }
}

pub fn references(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let references = &session.scene().references;
    if references.is_empty() {
        return;
    }
    theme::section(ui, "References");
    for reference in references {
        let name: Arc<str> = Arc::from(reference.name.as_str());
        ui.horizontal(|ui| {
            let mut visible = reference.visible;
            let text = RichText::new(&reference.name).color(theme::color32(reference_color()));
            let details =
                format!("{} poses to compare with, drawn as dashed outlines", reference.poses.len());
            if ui.checkbox(&mut visible, text).on_hover_text(details).changed() {
                commands.push(Command::SetReferenceVisible { name: name.clone(), visible });
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.add_space(8.0);
                if row_button(ui, Icon::Trash, &format!("Remove the reference {}", reference.name)) {
                    commands.push(Command::RemoveReference { name });
                }
            });
        });
    }
}

pub fn overlay(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    theme::section(ui, "Overlay");
    let mut percent = session.look().overlay_opacity * 100.0;
    let slider = Slider::new(&mut percent, 0.0..=100.0).text("opacity").suffix(" %").fixed_decimals(0);
    if ui.add(slider).changed() {
        commands.push(Command::SetLook(crate::scene::Look {
            overlay_opacity: percent / 100.0,
            ..session.look()
        }));
    }
    let mut outline = session.look().outline;
    if ui
        .checkbox(&mut outline, "silhouette outline")
        .on_hover_text(CommandId::ToggleOutline.info().tooltip)
        .changed()
    {
        commands.push(Command::Run(CommandId::ToggleOutline));
    }
}

fn row_button(ui: &mut Ui, icon: Icon, label: &str) -> bool {
    icon_button(ui, icon, label, label, true).clicked()
}

/// A name that fills the row, and can be chosen.
fn name_button(ui: &mut Ui, selected: bool, text: RichText, room_for_buttons: f32) -> egui::Response {
    let width = (ui.available_width() - room_for_buttons).max(40.0);
    ui.allocate_ui_with_layout(
        Vec2::new(width, 22.0),
        Layout::left_to_right(Align::Center).with_main_justify(true),
        |ui| ui.add(Button::selectable(selected, (text, egui::Atom::grow())).truncate()),
    )
    .inner
}
