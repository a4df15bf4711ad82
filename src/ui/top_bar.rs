//! One line: menus, tools, undo and redo, the scene's name, and whether the work is saved.

use egui::{Align, Button, Key, Layout, MenuBar, RichText, TextEdit, Ui, Vec2};

use super::busy_mark::busy_mark;
use super::command_button::{command_button, tooltip};
use super::icons::{Icon, icon_button};
use super::{Asked, Preferences, Saving, SceneRequest, Surroundings, theme};
use super::{menus, once};
use crate::session::{Command, CommandId, Session, Tool};

/// Below these widths of the window the scene's name and the tools' words make room.
const WIDTH_FOR_NAME: f32 = 720.0;
const WIDTH_FOR_WORDS: f32 = 900.0;

const NAME_WIDTH: f32 = 170.0;

/// The scene's name while it is being typed.
#[derive(Debug, Default)]
pub struct State {
    name: Option<String>,
    takes_focus: bool,
}

pub fn draw(
    ui: &mut Ui,
    session: &Session,
    around: &Surroundings<'_>,
    preferences: &mut Preferences,
    state: &mut State,
    asked: &mut Asked,
) {
    MenuBar::new().ui(ui, |ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let color = theme::accent(ui.visuals());
        if ui.ctx().content_rect().width() >= WIDTH_FOR_NAME {
            ui.label(RichText::new("PinPose").strong().color(color));
            ui.add_space(4.0);
        }
        for plan in &menus::MENUS {
            once::menu(ui, plan.title, |ui| menus::draw(ui, plan, session, around, preferences, asked));
        }
        ui.separator();
        tools(ui, session, &mut asked.commands);
        ui.separator();
        if command_button(ui, Button::new(CommandId::Snap.info().text), CommandId::Snap.info(), session) {
            asked.commands.push(Command::Run(CommandId::Snap));
        }
        ui.separator();
        history_button(ui, Icon::Undo, CommandId::Undo, session, &mut asked.commands);
        history_button(ui, Icon::Redo, CommandId::Redo, session, &mut asked.commands);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            status(ui, session, around, asked);
            scene_name(ui, session, state, &mut asked.commands);
        });
    });
}

fn tools(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    for (tool, id) in [
        (Tool::Move, CommandId::MoveTool),
        (Tool::Rotate, CommandId::RotateTool),
        (Tool::Pin, CommandId::PinTool),
    ] {
        let button = Button::new(id.info().text).selected(session.tool() == tool);
        if command_button(ui, button, id.info(), session) {
            commands.push(Command::Run(id));
        }
    }
}

fn history_button(ui: &mut Ui, icon: Icon, id: CommandId, session: &Session, commands: &mut Vec<Command>) {
    let label = match id {
        CommandId::Undo => session.undo_label(),
        _ => session.redo_label(),
    };
    let mut words = tooltip(ui.ctx(), id.info());
    if let Some(label) = label {
        words = format!("{}: {label}\n{words}", id.info().text);
    }
    let enabled = session.unavailable(id).is_none();
    if icon_button(ui, icon, id.info().text, &words, enabled).clicked() {
        commands.push(Command::Run(id));
    }
}

/// The name, or the field to change it.
fn scene_name(ui: &mut Ui, session: &Session, state: &mut State, commands: &mut Vec<Command>) {
    if session.scene().is_empty() || ui.ctx().content_rect().width() < WIDTH_FOR_NAME {
        state.name = None;
        return;
    }
    let room = ui.available_width().min(NAME_WIDTH);
    if room < 60.0 {
        return;
    }
    if let Some(name) = &mut state.name {
        let field = ui.add(TextEdit::singleline(name).desired_width(room - 12.0));
        field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Scene name"));
        if std::mem::take(&mut state.takes_focus) {
            field.request_focus();
        }
        if field.lost_focus() {
            let name = state.name.take().unwrap_or_default();
            let is_cancelled = ui.input(|input| input.key_pressed(Key::Escape));
            if !is_cancelled && !name.trim().is_empty() && name.trim() != session.scene().name {
                commands.push(Command::RenameScene(name.trim().to_owned()));
            }
        }
        return;
    }
    let name = session.scene().name.trim();
    let text = match name {
        "" => RichText::new("Unnamed scene").weak(),
        name => RichText::new(name),
    };
    let button = Button::new(text).truncate().frame_when_inactive(false);
    let size = Vec2::new(room, 22.0);
    let response = ui
        .allocate_ui_with_layout(size, Layout::right_to_left(Align::Center), |ui| ui.add(button))
        .inner
        .on_hover_text("The scene's name: click to change it");
    if response.clicked() {
        state.name = Some(name.to_owned());
        state.takes_focus = true;
    }
}

fn status(ui: &mut Ui, session: &Session, around: &Surroundings<'_>, asked: &mut Asked) {
    let is_wide = ui.ctx().content_rect().width() >= WIDTH_FOR_WORDS;
    if around.update_ready
        && ui
            .add(theme::primary_button("Update"))
            .on_hover_text("A newer PinPose is ready. Your work is saved and comes back after the reload.")
            .clicked()
    {
        asked.apply_update = true;
    }
    if let Some(busy) = &around.busy {
        if busy.can_cancel && ui.button("Cancel").on_hover_text("Stop this; what is done stays").clicked() {
            asked.cancel_loading = true;
        }
        ui.add(egui::Label::new(RichText::new(&busy.text).weak()).truncate());
        busy_mark(ui);
        return;
    }
    if session.scene().is_empty() {
        return;
    }
    match &around.saving {
        Saving::Saved => {
            let words = if is_wide { "Saved in this browser" } else { "Saved" };
            let scenes = Button::new(RichText::new(words).weak()).frame_when_inactive(false);
            if ui.add(scenes).on_hover_text("Show all scenes that are saved here").clicked() {
                asked.scene_requests.push(SceneRequest::Show);
            }
        }
        Saving::Pending => {
            ui.label(RichText::new("Saving…").weak());
        }
        Saving::Failed(reason) => not_saved(ui, reason, is_wide, asked),
    }
}

/// The way out is right beside the bad news.
fn not_saved(ui: &mut Ui, reason: &str, is_wide: bool, asked: &mut Asked) {
    let download = theme::primary_button(if is_wide { "Download workspace" } else { "Download" });
    if ui.add(download).on_hover_text("A file with everything in it, to open again later").clicked() {
        asked.commands.push(Command::Run(CommandId::ExportWorkspace));
    }
    let words = if is_wide { "Not saved in this browser" } else { "Not saved" };
    let color = theme::error(ui.visuals());
    ui.label(RichText::new(words).color(color)).on_hover_text(reason);
}
