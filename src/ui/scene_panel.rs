//! Photos, objects and references as lists, and how the overlay looks.

use std::sync::Arc;

use egui::{Align, Button, Layout, RichText, Sense, Slider, Ui, Vec2};

use super::theme;
use crate::scene::{Annotation, AnnotationState, Object, Photo, Scene, reference_color};
use crate::session::{Command, CommandId, Session};

pub fn photos(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    theme::section(ui, "Photos");
    let photos = &session.scene().photos;
    if photos.is_empty() {
        ui.label(RichText::new("Drop a photo (PNG, JPEG)").color(theme::WARNING));
    }
    let shown = session.photo().map(|photo| photo.id);
    for photo in photos {
        ui.horizontal(|ui| {
            let (glyph, color, meaning) = photo_state(session.scene(), photo);
            ui.label(RichText::new(glyph).color(color)).on_hover_text(meaning);
            let button = Button::selectable(Some(photo.id) == shown, &photo.asset.file_name).truncate();
            if ui.add_sized([ui.available_width() - 34.0, 22.0], button).clicked() {
                commands.push(Command::ShowPhoto(photo.id));
            }
            if small_button(ui, "🗑", &format!("Remove {}", photo.asset.file_name)) {
                commands.push(Command::RemovePhoto(photo.id));
            }
        });
    }
}

/// What has been done in a photo, as a glyph, a colour and words.
fn photo_state(scene: &Scene, photo: &Photo) -> (&'static str, egui::Color32, &'static str) {
    let states: Vec<AnnotationState> = scene.objects_in(photo.id).map(|(_, annotation)| annotation.state).collect();
    let done = |state: &AnnotationState| matches!(state, AnnotationState::Posed | AnnotationState::Confirmed);
    if states.is_empty() {
        ("○", theme::color32(crate::scene::Rgb([110, 116, 128])), "No object in this photo yet")
    } else if states.iter().all(done) {
        ("●", theme::GOOD, "Every object in this photo is posed")
    } else {
        ("◐", theme::WARNING, "An object in this photo waits for its pose")
    }
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
        let button = Button::selectable(session.selected() == Some(object.id), name).truncate();
        let triangles = object.mesh.mesh.triangles().len();
        let details = format!("{}, {triangles} triangles", object.mesh.file_name);
        if ui.add_sized([ui.available_width() - 96.0, 22.0], button).on_hover_text(details).clicked() {
            commands.push(Command::Select(Some(object.id)));
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            object_buttons(ui, session, object, annotation.is_some(), commands);
        });
    });
}

fn object_buttons(ui: &mut Ui, session: &Session, object: &Object, placed: bool, commands: &mut Vec<Command>) {
    ui.add_space(6.0);
    if small_button(ui, "🗑", &format!("Remove {}", object.name)) {
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
    let (glyph, tooltip) = if object.locked { ("🔒", "Unlock") } else { ("🔓", "Lock") };
    if small_button(ui, glyph, &format!("{tooltip} {}", object.name)) {
        commands.push(Command::SetObjectLocked(object.id, !object.locked));
    }
    let (glyph, tooltip) = if object.visible { ("👁", "Hide") } else { ("–", "Show") };
    if small_button(ui, glyph, &format!("{tooltip} {}", object.name)) {
        commands.push(Command::SetObjectVisible(object.id, !object.visible));
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
            let details = format!("{} poses to compare with, drawn as dashed outlines", reference.poses.len());
            if ui.checkbox(&mut visible, text).on_hover_text(details).changed() {
                commands.push(Command::SetReferenceVisible { name: name.clone(), visible });
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.add_space(6.0);
                if small_button(ui, "🗑", &format!("Remove the reference {}", reference.name)) {
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
        commands.push(Command::SetOverlayOpacity(percent / 100.0));
    }
    let mut outline = session.look().outline;
    if ui.checkbox(&mut outline, "silhouette outline").on_hover_text(CommandId::ToggleOutline.info().tooltip).changed() {
        commands.push(Command::Run(CommandId::ToggleOutline));
    }
}

/// A button of one glyph; `label` is its tooltip and its name for those who do not see the glyph.
fn small_button(ui: &mut Ui, glyph: &str, label: &str) -> bool {
    let response = ui.add(Button::new(RichText::new(glyph).size(13.0)).frame(false).min_size(Vec2::new(20.0, 20.0)));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, label));
    response.on_hover_text(label).clicked()
}
