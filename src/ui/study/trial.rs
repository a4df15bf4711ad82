//! A trial: the photo fills the window, and one line above it says where one is and what may be used.

use egui::{Align, Button, Layout, RichText, Ui, Vec2};

use super::{State, StudyRequest, StudyView, allowed_keys, has};
use crate::session::{Command, CommandId, Session, Tool as SessionTool};
use crate::study::Tool;
use crate::ui::busy_mark::busy_mark;
use crate::ui::command_button::{command_button, tooltip};
use crate::ui::icons::{Icon, icon_button};
use crate::ui::{Asked, theme};

#[derive(Debug, Clone, Copy)]
pub struct TrialView<'a> {
    /// From 1; of the practice samples where it is practice.
    pub number: usize,
    pub count: usize,
    pub is_practice: bool,
    pub tools: &'a [Tool],
    pub may_pause: bool,
    pub is_paused: bool,
    /// The object has been moved: there is something to confirm.
    pub can_confirm: bool,
    pub seconds_left: Option<f64>,
    /// A rest is due.
    pub suggests_pause: bool,
    /// A solver works.
    pub busy: Option<&'a str>,
}

/// Below this width of the window words make room.
const WIDE: f32 = 860.0;

pub fn bar(
    ui: &mut Ui,
    session: &Session,
    view: &StudyView<'_>,
    trial: &TrialView<'_>,
    state: &mut State,
    asked: &mut Asked,
    requests: &mut Vec<StudyRequest>,
) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        let kind = if trial.is_practice { "Practice" } else { "Photo" };
        ui.label(RichText::new(format!("{kind} {} of {}", trial.number, trial.count)).strong());
        if let Some(seconds) = trial.seconds_left {
            let color = if seconds < 15.0 { theme::warning(ui.visuals()) } else { ui.visuals().text_color() };
            let whole = seconds.max(0.0).ceil() as u32;
            ui.label(RichText::new(format!("{}:{:02} left", whole / 60, whole % 60)).color(color));
        }
        ui.separator();
        if !trial.is_paused {
            tools(ui, session, trial, asked);
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            confirm(ui, trial, requests);
            if trial.may_pause && !trial.is_paused {
                let hint = "The clock stands still, and the photo is hidden meanwhile";
                if ui.button("Pause").on_hover_text(hint).clicked() {
                    requests.push(StudyRequest::Pause);
                }
            }
            if ui.button("Help").clicked() {
                state.help_is_open = !state.help_is_open;
            }
            if view.is_preview && ui.button("End preview").clicked() {
                requests.push(StudyRequest::LeavePreview);
            }
            if let Some(busy) = trial.busy {
                ui.label(RichText::new(busy).weak());
                busy_mark(ui);
            } else if trial.suggests_pause && ui.ctx().content_rect().width() >= WIDE {
                ui.label(RichText::new("Time for a short break?").weak());
            }
        });
    });
}

fn confirm(ui: &mut Ui, trial: &TrialView<'_>, requests: &mut Vec<StudyRequest>) {
    let button = theme::primary_button("Confirm").min_size(Vec2::new(96.0, 26.0));
    let response = ui.add_enabled(trial.can_confirm && !trial.is_paused, button);
    let response = response.on_hover_text("The object lies on its image as well as you can (Enter)");
    if response.on_disabled_hover_text("Move the object first").clicked() {
        requests.push(StudyRequest::Confirm);
    }
}

/// Buttons of what is allowed, and of nothing else.
fn tools(ui: &mut Ui, session: &Session, trial: &TrialView<'_>, asked: &mut Asked) {
    let choices = [
        (SessionTool::Move, CommandId::MoveTool, Tool::Move),
        (SessionTool::Rotate, CommandId::RotateTool, Tool::Rotate),
        (SessionTool::Pin, CommandId::PinTool, Tool::Pins),
    ];
    let allowed = choices.into_iter().filter(|(.., tool)| has(trial.tools, *tool));
    for (tool, id, _) in allowed {
        let button = Button::new(id.info().text).selected(session.tool() == tool);
        if command_button(ui, button, id.info(), session) {
            asked.commands.push(Command::Run(id));
        }
    }
    if has(trial.tools, Tool::Snap) {
        ui.separator();
        let info = CommandId::Snap.info();
        if command_button(ui, Button::new(info.text), info, session) {
            asked.commands.push(Command::Run(CommandId::Snap));
        }
    }
    if has(trial.tools, Tool::Undo) {
        ui.separator();
        for (icon, id) in [(Icon::Undo, CommandId::Undo), (Icon::Redo, CommandId::Redo)] {
            let is_possible = session.unavailable(id).is_none();
            let words = tooltip(ui.ctx(), id.info());
            if icon_button(ui, icon, id.info().text, &words, is_possible).clicked() {
                asked.commands.push(Command::Run(id));
            }
        }
        if ui.button("Start over").on_hover_text("Put the object back to where it was").clicked() {
            asked.commands.push(Command::Run(CommandId::ResetPose));
        }
    }
}

/// In place of the photo, so that nobody works while the clock stands still.
pub fn paused(ui: &mut Ui, requests: &mut Vec<StudyRequest>) {
    ui.vertical_centered(|ui| {
        ui.add_space(ui.available_height() * 0.35);
        ui.label(RichText::new("Paused").heading());
        ui.add_space(4.0);
        ui.label("The clock stands still. Your work on this photo is kept.");
        ui.add_space(16.0);
        if ui.add(theme::primary_button("Go on").min_size(Vec2::new(140.0, 36.0))).clicked() {
            requests.push(StudyRequest::Resume);
        }
    });
}

/// What may be used, over the photo; false once it is closed.
pub fn help(ctx: &egui::Context, view: &StudyView<'_>, trial: &TrialView<'_>) -> bool {
    let mut is_open = true;
    let mut is_done = false;
    egui::Window::new("What you can do")
        .id(egui::Id::unique("study help"))
        .open(&mut is_open)
        .collapsible(false)
        .resizable(false)
        .anchor(egui::Align2::CENTER_CENTER, Vec2::ZERO)
        .show(ctx, |ui| {
            allowed_keys::draw(ui, trial.tools);
            if !view.contact.is_empty() {
                ui.label(RichText::new(format!("Questions: {}", view.contact)).weak());
            }
            ui.add_space(8.0);
            is_done = ui.add(theme::primary_button("Close")).clicked();
        });
    is_open && !is_done && !ctx.input(|input| input.key_pressed(egui::Key::Escape))
}
