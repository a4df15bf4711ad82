//! The foot of the panel: the selected object's pose, live, and what was done to poses.

use egui::{RichText, Ui};

use super::history;
use super::number_field::note;
use crate::math::Pose;
use crate::scene::{Annotation, AnnotationState, PoseSource};
use crate::session::{Command, CommandId, Session};
use crate::ui::command_button::{command_icon, command_item};
use crate::ui::icons::{Icon, icon_button};

#[derive(Debug, Default)]
pub struct OutputState {
    pub folded: bool,
    search: String,
}

pub fn draw(ui: &mut Ui, session: &Session, state: &mut OutputState, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing = egui::Vec2::new(6.0, 3.0);
    header(ui, session, state, commands);
    if state.folded {
        return;
    }
    pose(ui, session);
    history::draw(ui, session, &mut state.search, commands);
}

fn header(ui: &mut Ui, session: &Session, state: &mut OutputState, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let label = if state.folded { "Unfold output" } else { "Fold output" };
        let arrow = if state.folded { Icon::ChevronRight } else { Icon::ChevronDown };
        if icon_button(ui, arrow, label, label, true).clicked() {
            state.folded = !state.folded;
        }
        let width = (ui.available_width() - 56.0).max(40.0);
        let layout = egui::Layout::left_to_right(egui::Align::Center);
        ui.allocate_ui_with_layout(egui::Vec2::new(width, 22.0), layout, |ui| {
            ui.set_width(width);
            ui.add(egui::Label::new(title(session)).truncate());
        });
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            copy_menu(ui, session, commands);
            if command_icon(ui, Icon::Reset, CommandId::ResetPose, session).clicked() {
                commands.push(Command::Run(CommandId::ResetPose));
            }
        });
    });
}

fn title(session: &Session) -> RichText {
    match session.selected_annotation() {
        Some((_, object, annotation)) => {
            let name = session.scene().object(object).map_or("", |object| object.name.as_str());
            RichText::new(format!("{name}: {}", state_text(annotation)))
        }
        None if session.scene().objects.is_empty() => RichText::new("No object yet").weak(),
        None => RichText::new("Select an object of this photo").weak(),
    }
}

fn copy_menu(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let reason = session.unavailable(CommandId::CopyPose);
    let tooltip =
        reason.map_or("Copy the pose as text".to_owned(), |reason| format!("Copy the pose: {reason}"));
    let button = icon_button(ui, Icon::Copy, "Copy pose", &tooltip, reason.is_none());
    egui::Popup::menu(&button).show(|ui| {
        ui.set_min_width(210.0);
        command_item(ui, session, CommandId::CopyPose, Some("Matrix, row by row"), commands);
        command_item(ui, session, CommandId::CopyPoseNumPy, Some("NumPy"), commands);
        command_item(ui, session, CommandId::CopyPoseJson, Some("JSON"), commands);
        ui.separator();
        command_item(ui, session, CommandId::PastePose, None, commands);
    });
}

fn pose(ui: &mut Ui, session: &Session) {
    let Some((_, _, annotation)) = session.selected_annotation() else { return };
    if annotation.camera_changed {
        note(ui, "The camera was changed after this pose was set: look at it again.", true);
    }
    // Smaller where the panel is narrow, so that no column is cut.
    let size = (ui.available_width() / 41.0 * 1.66).clamp(9.0, 12.0);
    let text = RichText::new(matrix_text(&annotation.camera_from_object)).monospace().size(size);
    ui.add(egui::Label::new(text).selectable(true).extend())
        .on_hover_text("camera_from_object, mm, OpenCV axes: x right, y down, z forward");
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

/// Four rows of columns that stand still while the numbers run.
fn matrix_text(pose: &Pose) -> String {
    let [x, y, z, _] = pose.to_rows();
    // Adding zero makes a zero of a negative one, and rounding first makes one of what is printed as one.
    let rounded = |value: f64, scale: f64| (value * scale).round() / scale + 0.0;
    let row = |row: [f64; 4]| {
        let [a, b, c] = [row[0], row[1], row[2]].map(|value| rounded(value, 1e4));
        format!("{a:8.4}{b:9.4}{c:9.4}{:10.2}", rounded(row[3], 1e2))
    };
    let last = format!("{:8}{:9}{:9}{:10}", 0, 0, 0, 1);
    [row(x), row(y), row(z), last].join("\n")
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn columns_stand_still() {
        let poses = [
            Pose::exp(DVec3::new(1.0, -0.4, 0.2), DVec3::new(-1234.5, 0.001, 99_999.0)),
            Pose::from_translation(DVec3::new(-1e-9, 0.0, 1.0)),
        ];
        for pose in poses {
            let text = matrix_text(&pose);
            let lengths: Vec<usize> = text.lines().map(str::len).collect();
            assert_eq!(lengths, [36; 4], "{text}");
            assert!(!text.contains("-0.00 ") && !text.contains("-0.0000"), "{text}");
        }
    }
}
