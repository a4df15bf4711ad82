//! One line: menus, tools, undo and redo, and whether the work is saved.

use egui::{Align, Button, Layout, MenuBar, RichText, Ui};

use super::icons::{Icon, icon_button};
use super::{Asked, Saving, SceneRequest, Surroundings, shortcut_text, theme};
use crate::session::{COMMANDS, Command, CommandId, CommandInfo, Menu, Session, Tool};

const MENUS: [(Menu, &str); 5] = [
    (Menu::File, "File"),
    (Menu::Edit, "Edit"),
    (Menu::View, "View"),
    (Menu::Pose, "Pose"),
    (Menu::Help, "Help"),
];

pub fn draw(ui: &mut Ui, session: &Session, around: &Surroundings<'_>, asked: &mut Asked) {
    MenuBar::new().ui(ui, |ui| {
        ui.label(RichText::new("PinPose").strong().color(theme::ACCENT));
        ui.add_space(4.0);
        for (menu, title) in MENUS {
            ui.menu_button(title, |ui| menu_items(ui, menu, session, &mut asked.commands));
        }
        ui.separator();
        tools(ui, session, &mut asked.commands);
        ui.separator();
        history_button(ui, Icon::Undo, CommandId::Undo, session, &mut asked.commands);
        history_button(ui, Icon::Redo, CommandId::Redo, session, &mut asked.commands);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| status(ui, session, around, asked));
    });
}

fn menu_items(ui: &mut Ui, menu: Menu, session: &Session, commands: &mut Vec<Command>) {
    ui.set_min_width(230.0);
    for info in COMMANDS.iter().filter(|info| info.menu == menu) {
        let mut button = Button::new(info.text);
        if let Some(shortcut) = info.shortcut {
            button = button.shortcut_text(shortcut_text(shortcut));
        }
        if command_button(ui, button, info, session) {
            commands.push(Command::Run(info.id));
            ui.close();
        }
    }
}

fn tools(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    for (tool, id) in [(Tool::Move, CommandId::MoveTool), (Tool::Rotate, CommandId::RotateTool)] {
        let button = Button::new(id.info().text).selected(session.tool() == tool);
        if command_button(ui, button, id.info(), session) {
            commands.push(Command::Run(id));
        }
    }
}

fn history_button(ui: &mut Ui, icon: Icon, id: CommandId, session: &Session, commands: &mut Vec<Command>) {
    let enabled = session.unavailable(id).is_none();
    if icon_button(ui, icon, id.info().text, &tooltip(id.info()), enabled).clicked() {
        commands.push(Command::Run(id));
    }
}

/// A button of the command table: disabled, with the reason, where the command cannot be used.
fn command_button(ui: &mut Ui, button: Button<'_>, info: &CommandInfo, session: &Session) -> bool {
    let reason = session.unavailable(info.id);
    let response = ui.add_enabled(reason.is_none(), button).on_hover_text(tooltip(info));
    let response = match reason {
        Some(reason) => response.on_disabled_hover_text(format!("{}: {reason}", info.tooltip)),
        None => response,
    };
    response.clicked()
}

fn tooltip(info: &CommandInfo) -> String {
    match info.shortcut {
        Some(shortcut) => format!("{} ({})", info.tooltip, shortcut_text(shortcut)),
        None => info.tooltip.to_owned(),
    }
}

fn status(ui: &mut Ui, session: &Session, around: &Surroundings<'_>, asked: &mut Asked) {
    if around.update_ready
        && ui
            .add(theme::primary_button("Update"))
            .on_hover_text("A newer PinPose is ready. Your work is saved and comes back after the reload.")
            .clicked()
    {
        asked.apply_update = true;
    }
    if let Some(busy) = &around.busy {
        ui.label(RichText::new(busy).weak());
        ui.spinner();
        return;
    }
    if session.scene().is_empty() {
        return;
    }
    match &around.saving {
        Saving::Saved => {
            let label = RichText::new("Saved in this browser").weak();
            let scenes = Button::new(label).frame_when_inactive(false);
            if ui.add(scenes).on_hover_text("Show all scenes that are saved here").clicked() {
                asked.scene_requests.push(SceneRequest::Show);
            }
        }
        Saving::Pending => {
            ui.label(RichText::new("Saving…").weak());
        }
        Saving::Failed(reason) => not_saved(ui, reason, asked),
    }
}

/// The way out is right beside the bad news.
fn not_saved(ui: &mut Ui, reason: &str, asked: &mut Asked) {
    let download = theme::primary_button("Download workspace");
    if ui.add(download).on_hover_text("A file with everything in it, to open again later").clicked() {
        asked.commands.push(Command::Run(CommandId::ExportWorkspace));
    }
    ui.label(RichText::new("Not saved in this browser").color(theme::ERROR)).on_hover_text(reason);
}
