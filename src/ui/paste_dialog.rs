//! A field to paste a pose into, which says at once what it understood.

use egui::{Align, Button, Key, Layout, Modifiers, RichText, TextEdit, Ui};

use super::dialogs::BUTTON_SIZE;
use super::{once, theme};
use crate::formats::read_pose_text;
use crate::math::Pose;
use crate::session::{Command, Session};

/// From here on it is worth saying that R was corrected; the design's bound for reports.
const REPORTED_DEFECT: f64 = 1e-3;

#[derive(Debug, Default)]
pub struct State {
    text: String,
    was_open: bool,
}

/// Draws the dialog; true if it is to be closed.
pub fn draw(ctx: &egui::Context, session: &Session, state: &mut State, commands: &mut Vec<Command>) -> bool {
    let is_new = !std::mem::replace(&mut state.was_open, true);
    if is_new {
        state.text.clear();
    }
    let Some((_, object, annotation)) = session.selected_annotation() else {
        state.was_open = false;
        return true;
    };
    let name = session.scene().object(object).map_or("the object", |object| object.name.as_str());
    let present = &annotation.camera_from_object;
    let frame = theme::dialog_frame(ctx);
    let modal = once::modal(ctx, "paste pose", frame, |ui| {
        ui.set_width(430.0_f32.min(ui.ctx().content_rect().width() - 64.0));
        ui.heading(format!("Pose of {name}"));
        ui.add_space(4.0);
        ui.weak(
            "Paste a 4×4, R and t, R or t alone: as rows, NumPy or JSON. Millimetres, OpenCV camera axes.",
        );
        ui.add_space(8.0);
        field(ui, &mut state.text, is_new);
        ui.add_space(4.0);
        let understood = understood(&state.text, present);
        verdict(ui, &state.text, understood.as_ref());
        ui.add_space(8.0);
        buttons(ui, &state.text, understood.is_ok(), commands)
    });
    let is_done = modal.inner || modal.should_close();
    state.was_open = !is_done;
    is_done
}

fn field(ui: &mut Ui, text: &mut String, takes_focus: bool) {
    let hint = "1 0 0 0\n0 1 0 0\n0 0 1 800\n0 0 0 1";
    let field = TextEdit::multiline(text)
        .font(egui::TextStyle::Monospace)
        .hint_text(hint)
        .desired_rows(6)
        .desired_width(f32::INFINITY);
    let response = egui::ScrollArea::vertical().max_height(180.0).show(ui, |ui| ui.add(field)).inner;
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Pose as text"));
    if takes_focus {
        response.request_focus();
    }
}

/// What the text is, in words, or what is wrong with it.
fn understood(text: &str, present: &Pose) -> Result<String, String> {
    let (pose, defect) = read_pose_text(text, present).map_err(|error| error.to_string())?;
    let parts = match (pose.rotation == present.rotation, pose.translation_mm == present.translation_mm) {
        (true, false) => "Translation alone, the rotation stays",
        (false, true) => "Rotation alone, the translation stays",
        _ => "A whole pose",
    };
    let rotation = if defect > REPORTED_DEFECT {
        format!("R is made a proper rotation (it was off by {defect:.4})")
    } else {
        "proper rotation".to_owned()
    };
    let [x, y, z] = pose.translation_mm.to_array();
    Ok(format!("{parts}, {rotation}, t = ({x:.2}, {y:.2}, {z:.2}) mm"))
}

fn verdict(ui: &mut Ui, text: &str, understood: Result<&String, &String>) {
    let visuals = ui.visuals();
    let words = match understood {
        _ if text.trim().is_empty() => RichText::new("Nothing is pasted yet").weak(),
        Ok(words) => RichText::new(words).color(theme::good(visuals)),
        Err(problem) => RichText::new(problem).color(theme::error(visuals)),
    };
    ui.add(egui::Label::new(words).wrap());
}

/// Set and Cancel; true if the dialog is done.
fn buttons(ui: &mut Ui, text: &str, is_understood: bool, commands: &mut Vec<Command>) -> bool {
    let mut is_set = is_understood && ui.input_mut(|input| input.consume_key(Modifiers::COMMAND, Key::Enter));
    let mut is_cancelled = false;
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let set = theme::primary_button("Set pose").min_size(BUTTON_SIZE);
        is_set |= ui.add_enabled(is_understood, set).on_hover_text("Ctrl+Enter").clicked();
        is_cancelled = ui.add(Button::new("Cancel").min_size(BUTTON_SIZE)).clicked();
    });
    if is_set {
        commands.push(Command::SetPoseFromText(text.to_owned()));
    }
    is_set || is_cancelled
}
