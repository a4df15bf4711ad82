//! The selected object's pose, live.

use egui::{RichText, Ui};

use super::theme;
use crate::math::Pose;
use crate::scene::{Annotation, AnnotationState, PoseSource};
use crate::session::{Command, CommandId, Session};

pub fn draw(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    theme::section(ui, "Pose");
    let Some((_, object, annotation)) = session.selected_annotation() else {
        let hint = if session.scene().objects.is_empty() {
            "No object yet"
        } else {
            "Select an object of this photo"
        };
        ui.label(RichText::new(hint).weak());
        return;
    };
    let name = session.scene().object(object).map_or("", |object| object.name.as_str());
    ui.label(format!("{name}: {}", state_text(annotation)));
    if annotation.camera_changed {
        let text = "The camera was changed after this pose was set: look at it again.";
        ui.label(RichText::new(text).small().color(theme::WARNING));
    }
    let pose = &annotation.camera_from_object;
    ui.add(egui::Label::new(RichText::new(matrix_text(pose)).monospace()).selectable(true))
        .on_hover_text("camera_from_object, mm, OpenCV axes: x right, y down, z forward");
    ui.horizontal(|ui| {
        if ui.small_button("Copy matrix").on_hover_text("Copy the 4×4, row by row").clicked() {
            ui.ctx().copy_text(full_matrix_text(pose));
        }
        let reset = CommandId::ResetPose;
        if ui.small_button("Reset").on_hover_text(reset.info().tooltip).clicked() {
            commands.push(Command::Run(reset));
        }
    });
    ui.add_space(12.0);
}

fn state_text(annotation: &Annotation) -> &'static str {
    match (annotation.state, annotation.source) {
        (AnnotationState::Untouched, _) => "not posed yet, drag it",
        (AnnotationState::Carried, _) => "carried over, check it",
        (AnnotationState::Confirmed, _) => "confirmed",
        (AnnotationState::Posed, PoseSource::Imported) => "imported",
        (AnnotationState::Posed, _) => "posed",
    }
}

/// Three rows that fit the panel.
fn matrix_text(pose: &Pose) -> String {
    let [x, y, z, _] = pose.to_rows();
    // Adding zero makes a zero of a negative one, and rounding first makes one of what is printed as one.
    let rounded = |value: f64, scale: f64| (value * scale).round() / scale + 0.0;
    let row = |row: [f64; 4]| {
        let [a, b, c] = [row[0], row[1], row[2]].map(|value| rounded(value, 1e4));
        format!("{a:8.4}{b:8.4}{c:8.4}{:9.2}", rounded(row[3], 1e2))
    };
    [row(x), row(y), row(z)].join("\n")
}

/// The 4×4 with every digit, as a NumPy or JSON literal.
fn full_matrix_text(pose: &Pose) -> String {
    let rows = pose.to_rows().map(|row| format!("[{}]", row.map(|value| value.to_string()).join(", ")));
    format!("[{}]", rows.join(",\n "))
}
