//! What comes up over the rest: questions that an import raises, the sheet of keys, the field to paste a pose.

use egui::{Button, Key, Modifiers, RichText, Ui, Vec2};

use super::{Asked, Dialog, UiState, export_dialog, once, palette, paste_dialog, shortcuts_sheet, theme};
use crate::formats::{Incoming, PosesAs};
use crate::session::{Answer, Command, Question, Session};

/// All buttons of dialogs.
pub const BUTTON_SIZE: Vec2 = Vec2::new(108.0, 30.0);

/// How many of a question's poses fit, and the state of the scene that this was counted for.
#[derive(Debug, Default)]
pub struct FitCount {
    counted: Option<(Vec<String>, u64, usize)>,
}

impl FitCount {
    fn of(&mut self, session: &Session, asked: &[Incoming]) -> usize {
        let revision = session.revision();
        let names = || asked.iter().map(|incoming| &incoming.file_name);
        match &self.counted {
            Some((files, at, count)) if files.iter().eq(names()) && *at == revision => *count,
            _ => {
                let count = session.count_fitting_poses(asked);
                self.counted = Some((names().cloned().collect(), revision, count));
                count
            }
        }
    }
}

pub fn draw(ctx: &egui::Context, session: &Session, state: &mut UiState, asked: &mut Asked) {
    let commands = &mut asked.commands;
    if let Some(question) = session.question() {
        ask(ctx, session, question, &mut state.fit_count, commands);
        return;
    }
    let is_closed = match state.open {
        None => false,
        Some(Dialog::Palette) => {
            let keymap = &state.preferences.keymap;
            palette::draw(ctx, session, keymap, &mut state.palette, commands)
        }
        Some(Dialog::Shortcuts) => {
            shortcuts_sheet::draw(ctx, &mut state.preferences, &mut state.shortcuts_sheet)
        }
        Some(Dialog::PastePose) => paste_dialog::draw(ctx, session, &mut state.paste_dialog, commands),
        Some(Dialog::Export) => {
            export_dialog::draw(ctx, session, &mut state.export_dialog, &mut asked.export)
        }
    };
    if is_closed {
        state.open = None;
    }
}

fn ask(
    ctx: &egui::Context,
    session: &Session,
    question: &Question,
    fit_count: &mut FitCount,
    commands: &mut Vec<Command>,
) {
    let frame = theme::dialog_frame(ctx);
    let modal = once::modal(ctx, "question", frame, |ui| {
        ui.set_width(430.0_f32.min(ui.ctx().content_rect().width() - 64.0));
        match question {
            Question::PosesAs(asked) => {
                poses_question(ui, asked, fit_count.of(session, asked), commands);
            }
            Question::CameraSize { file, photos } => {
                let photo = photos.first().and_then(|id| session.scene().photo(*id));
                let photo_size = photo.map(|photo| (photo.asset.width, photo.asset.height));
                let size = file.size.unwrap_or_default();
                camera_question(ui, &file.file_name, size, photo_size.unwrap_or_default(), commands);
            }
        }
    });
    if modal.should_close() && commands.is_empty() {
        commands.push(Command::Answer(Answer::Refuse));
    }
}

fn poses_question(ui: &mut Ui, asked: &[Incoming], fitting: usize, commands: &mut Vec<Command>) {
    const MOST_NAMED: usize = 4;
    let count: usize = asked.iter().map(Incoming::pose_count).sum();
    let poses = if count == 1 { "1 pose".to_owned() } else { format!("{count} poses") };
    match asked {
        [alone] => ui.heading(format!("{poses} in {}", alone.file_name)),
        _ => ui.heading(format!("{poses} in {} files", asked.len())),
    };
    ui.add_space(4.0);
    if asked.len() > 1 {
        for incoming in asked.iter().take(MOST_NAMED) {
            ui.add(egui::Label::new(format!("{}: {}", incoming.file_name, incoming.pose_count())).truncate());
        }
        if asked.len() > MOST_NAMED {
            ui.label(format!("and {} more files", asked.len() - MOST_NAMED));
        }
        ui.add_space(4.0);
    }
    let verb = if fitting == 1 { "fits" } else { "fit" };
    let leave_out =
        if asked.len() == 1 { "Leave this file out. (Esc)" } else { "Leave these files out. (Esc)" };
    ui.label(match fitting {
        0 => "None fits your files yet: they wait until their photos and meshes come.".to_owned(),
        _ => format!("{fitting} of {count} {verb} your files."),
    });
    ui.label("What are they to be?");
    ui.add_space(8.0);
    let annotations = Answer::UsePosesAs(PosesAs::Annotations);
    let reference = Answer::UsePosesAs(PosesAs::Reference);
    let compare = "Truth or another's poses, to compare with. Read-only.";
    primary_answer(ui, "Start poses", "My poses: I go on from them. (Enter)", annotations, commands);
    answer(ui, Button::new("Reference"), compare, reference, commands);
    answer(ui, Button::new("Cancel"), leave_out, Answer::Refuse, commands);
}

fn camera_question(
    ui: &mut Ui,
    file_name: &str,
    (w, h): (u32, u32),
    photo: (u32, u32),
    commands: &mut Vec<Command>,
) {
    ui.heading("The camera is for another size");
    ui.add_space(4.0);
    ui.label(format!("{file_name} is for {w} × {h} pixels, the photo has {} × {}.", photo.0, photo.1));
    ui.add_space(8.0);
    let scale = "Right if the photo was made smaller or larger as a whole. (Enter)";
    primary_answer(ui, "Scale", scale, Answer::ScaleCamera, commands);
    answer(ui, Button::new("Cancel"), "Keep the camera as it is. (Esc)", Answer::Refuse, commands);
}

/// What Enter answers, while no other button has the keyboard.
fn primary_answer(ui: &mut Ui, text: &str, meaning: &str, reply: Answer, commands: &mut Vec<Command>) {
    answer(ui, theme::primary_button(text), meaning, reply, commands);
    if commands.is_empty() && is_entered(ui) {
        commands.push(Command::Answer(reply));
    }
}

fn answer(ui: &mut Ui, button: Button<'_>, meaning: &str, reply: Answer, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        if ui.add_sized(BUTTON_SIZE, button).clicked() {
            commands.push(Command::Answer(reply));
        }
        ui.add(egui::Label::new(RichText::new(meaning).weak()).wrap());
    });
}

/// Enter was pressed, and no widget has the keyboard for itself.
pub fn is_entered(ui: &Ui) -> bool {
    ui.memory(|memory| memory.focused().is_none())
        && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Enter))
}
