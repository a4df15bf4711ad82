//! Questions that an import raises, and the sheet of gestures and keys.

use egui::{Grid, Id, Modal, RichText, Ui};

use super::{Dialog, UiState, shortcut_text, theme};
use crate::formats::PosesAs;
use crate::session::{Answer, COMMANDS, Command, Question, Session};

const GESTURES: [(&str, &str); 10] = [
    ("Click", "select an object (Alt: the one behind)"),
    ("Drag an object", "move it; the point you grab stays under the cursor"),
    ("Right drag an object", "turn it about its centre"),
    ("Ctrl + right drag", "roll it about the line of sight"),
    ("Shift + wheel", "nearer or farther, 1 px of its width a notch"),
    ("Alt while dragging", "ten times finer"),
    ("Wheel", "zoom to the cursor"),
    ("Drag the ground, middle drag", "move the photo"),
    ("Double click", "zoom to the object, or show the whole photo"),
    ("Esc", "put back the drag under way"),
];

pub fn draw(ctx: &egui::Context, session: &Session, state: &mut UiState, commands: &mut Vec<Command>) {
    if let Some(question) = session.question() {
        let modal = Modal::new(Id::unique("question")).frame(theme::dialog_frame(ctx)).show(ctx, |ui| {
            ui.set_width(400.0);
            match question {
                Question::PosesAs(incoming) => {
                    poses_question(ui, &incoming.file_name, incoming.pose_count(), commands);
                }
                Question::CameraSize { file, photos } => {
                    let size = file.size.unwrap_or_default();
                    let photo = photos.first().and_then(|id| session.scene().photo(*id));
                    let photo_size =
                        photo.map(|photo| (photo.asset.width, photo.asset.height)).unwrap_or_default();
                    camera_question(ui, &file.file_name, size, photo_size, commands);
                }
            }
        });
        if modal.should_close() && commands.is_empty() {
            commands.push(Command::Answer(Answer::Refuse));
        }
        return;
    }
    if state.open == Some(Dialog::Shortcuts) {
        let modal = Modal::new(Id::unique("shortcuts"))
            .frame(theme::dialog_frame(ctx))
            .show(ctx, |ui| shortcuts(ui, &mut state.open));
        if modal.should_close() {
            state.open = None;
        }
    }
}

fn poses_question(ui: &mut Ui, file_name: &str, count: usize, commands: &mut Vec<Command>) {
    let poses = if count == 1 { "1 pose".to_owned() } else { format!("{count} poses") };
    ui.heading(format!("{poses} in {file_name}"));
    ui.add_space(6.0);
    ui.label("What are they to be?");
    ui.add_space(8.0);
    let annotations = Answer::UsePosesAs(PosesAs::Annotations);
    answer(ui, theme::primary_button("Start poses"), "My poses: I go on from them.", annotations, commands);
    let reference = Answer::UsePosesAs(PosesAs::Reference);
    answer(
        ui,
        egui::Button::new("Reference"),
        "Truth or another's poses, to compare with. Read-only.",
        reference,
        commands,
    );
    answer(ui, egui::Button::new("Cancel"), "Leave this file out.", Answer::Refuse, commands);
}

fn camera_question(
    ui: &mut Ui,
    file_name: &str,
    (w, h): (u32, u32),
    photo: (u32, u32),
    commands: &mut Vec<Command>,
) {
    ui.heading("The camera is for another size");
    ui.add_space(6.0);
    ui.label(format!("{file_name} is for {w} × {h} pixels, the photo has {} × {}.", photo.0, photo.1));
    ui.add_space(8.0);
    let scale = "Right if the photo was made smaller or larger as a whole.";
    answer(ui, theme::primary_button("Scale"), scale, Answer::ScaleCamera, commands);
    answer(ui, egui::Button::new("Cancel"), "Keep the camera as it is.", Answer::Refuse, commands);
}

fn answer(ui: &mut Ui, button: egui::Button<'_>, meaning: &str, answer: Answer, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        if ui.add_sized([116.0, 30.0], button).clicked() {
            commands.push(Command::Answer(answer));
        }
        ui.label(RichText::new(meaning).weak());
    });
}

fn shortcuts(ui: &mut Ui, open: &mut Option<Dialog>) {
    ui.set_width(520.0);
    ui.horizontal(|ui| {
        ui.heading("Mouse and keys");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if ui.button("Close").clicked() {
                *open = None;
            }
        });
    });
    ui.add_space(6.0);
    egui::ScrollArea::vertical().max_height(ui.ctx().content_rect().height() - 140.0).show(ui, |ui| {
        Grid::new("gestures").num_columns(2).spacing([20.0, 5.0]).show(ui, |ui| {
            for (gesture, effect) in GESTURES {
                row(ui, gesture, effect);
            }
            for info in COMMANDS {
                if let Some(shortcut) = info.shortcut.filter(|shortcut| shortcut.key != "Escape") {
                    row(ui, &shortcut_text(shortcut), info.tooltip);
                }
            }
        });
    });
}

fn row(ui: &mut Ui, gesture: &str, effect: &str) {
    ui.label(RichText::new(gesture).strong());
    ui.label(effect);
    ui.end_row();
}
