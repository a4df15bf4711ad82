//! Buttons of the command table: the same tooltip, shortcut and reason wherever a command is offered.

use egui::{Button, Context, Response, Ui};

use super::Keymap;
use super::icons::{Icon, icon_button};
use crate::session::{Command, CommandId, CommandInfo, Session};

/// A button of the command table: disabled, with the reason, where the command cannot be used.
pub fn command_button(ui: &mut Ui, button: Button<'_>, info: &CommandInfo, session: &Session) -> bool {
    let reason = session.unavailable(info.id);
    let response = ui.add_enabled(reason.is_none(), button).on_hover_text(tooltip(ui.ctx(), info));
    let response = match reason {
        Some(reason) => response.on_disabled_hover_text(format!("{}: {reason}", info.tooltip)),
        None => response,
    };
    response.clicked()
}

/// The same as an entry of a menu, under a name of its own where the table's is too long.
pub fn command_item(
    ui: &mut Ui,
    session: &Session,
    id: CommandId,
    text: Option<&str>,
    commands: &mut Vec<Command>,
) {
    let info = id.info();
    let mut button = Button::new(text.unwrap_or(info.text)).selected(session.is_on(id));
    if let Some(shortcut) = Keymap::of(ui.ctx()).text(id) {
        button = button.shortcut_text(shortcut);
    }
    if command_button(ui, button, info, session) {
        commands.push(Command::Run(id));
        ui.close();
    }
}

/// The same as an icon.
pub fn command_icon(ui: &mut Ui, icon: Icon, id: CommandId, session: &Session) -> Response {
    let info = id.info();
    match session.unavailable(id) {
        None => icon_button(ui, icon, info.text, &tooltip(ui.ctx(), info), true),
        Some(reason) => icon_button(ui, icon, info.text, &format!("{}: {reason}", info.tooltip), false),
    }
}

pub fn tooltip(ctx: &Context, info: &CommandInfo) -> String {
    match Keymap::of(ctx).text(info.id) {
        Some(shortcut) => format!("{} ({shortcut})", info.tooltip),
        None => info.tooltip.to_owned(),
    }
}
