//! Small exact steps by button, and how far one goes.

use egui::{Button, Sense, Ui, Vec2};

use super::number_field::{NumberField, column_width};
use super::section::section;
use crate::session::{Command, CommandId, NudgeFrame, Session};
use crate::ui::command_button::command_icon;
use crate::ui::icons::Icon;

/// As the keys lie: arrows with `[` and `]` above them, Q W E over A S D.
const MOVES: [[(Icon, CommandId); 3]; 2] = [
    [
        (Icon::Farther, CommandId::NudgeFarther),
        (Icon::Arrow(0, -1), CommandId::NudgeUp),
        (Icon::Nearer, CommandId::NudgeNearer),
    ],
    [
        (Icon::Arrow(-1, 0), CommandId::NudgeLeft),
        (Icon::Arrow(0, 1), CommandId::NudgeDown),
        (Icon::Arrow(1, 0), CommandId::NudgeRight),
    ],
];
const TURNS: [[(Icon, CommandId); 3]; 2] = [
    [
        (Icon::Roll { left: true }, CommandId::RollLeft),
        (Icon::Pitch { forward: true }, CommandId::PitchForward),
        (Icon::Roll { left: false }, CommandId::RollRight),
    ],
    [
        (Icon::Yaw { left: true }, CommandId::YawLeft),
        (Icon::Pitch { forward: false }, CommandId::PitchBack),
        (Icon::Yaw { left: false }, CommandId::YawRight),
    ],
];

pub fn draw(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    section(
        ui,
        "Nudge",
        false,
        |_| {},
        |ui| {
            ui.horizontal(|ui| {
                let gap = ((ui.available_width() - 2.0 * 78.0) / 3.0).max(0.0);
                ui.spacing_mut().item_spacing = Vec2::splat(2.0);
                ui.add_space(gap);
                pad(ui, session, &MOVES, commands);
                ui.add_space(gap);
                pad(ui, session, &TURNS, commands);
            });
            settings(ui, session, commands);
        },
    );
}

fn pad(ui: &mut Ui, session: &Session, rows: &[[(Icon, CommandId); 3]; 2], commands: &mut Vec<Command>) {
    ui.vertical(|ui| {
        for row in rows {
            ui.horizontal(|ui| {
                for (icon, id) in row {
                    key(ui, session, *icon, *id, commands);
                }
            });
        }
    });
}

fn key(ui: &mut Ui, session: &Session, icon: Icon, id: CommandId, commands: &mut Vec<Command>) {
    let (rect, _) = ui.allocate_exact_size(Vec2::splat(24.0), Sense::hover());
    ui.painter().rect_filled(rect, 5.0, ui.visuals().widgets.inactive.weak_bg_fill.gamma_multiply(0.7));
    let inside = egui::UiBuilder::new().max_rect(rect.shrink(1.0));
    let response = ui.scope_builder(inside, |ui| command_icon(ui, icon, id, session)).inner;
    if response.clicked()
        && let Some(nudge) = id.nudge()
    {
        let modifiers = ui.input(|input| input.modifiers);
        let coarser = if modifiers.shift { 10.0 } else { 1.0 };
        let finer = if modifiers.alt { 0.1 } else { 1.0 };
        commands.push(Command::Nudge(nudge, coarser * finer));
    }
}

fn settings(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let before = session.nudge_settings();
    let mut settings = before;
    let width = column_width(ui, 2);
    ui.horizontal(|ui| {
        let step = NumberField {
            label: "Step",
            name: "nudge step px",
            unit: " px",
            tooltip: "One nudge to the side or in depth, in pixels of the photo (Shift: ×10, Alt: ×0.1)",
            speed: 0.01,
            ..NumberField::default()
        };
        step.show(ui, width, 34.0, &mut settings.step_px);
        let turn = NumberField {
            label: "Turn",
            name: "nudge step degrees",
            unit: "°",
            tooltip: "One nudge of the rotation, in degrees (Shift: ×10, Alt: ×0.1)",
            speed: 0.01,
            ..NumberField::default()
        };
        turn.show(ui, width, 34.0, &mut settings.step_degrees);
    });
    ui.horizontal(|ui| {
        ui.label("Axes");
        let frames = [
            (NudgeFrame::Camera, "Camera", "Along and about the camera's axes (L)"),
            (NudgeFrame::Object, "Object", "Along and about the object's own axes (L)"),
        ];
        for (frame, text, tooltip) in frames {
            let button = Button::selectable(settings.frame == frame, text).frame_when_inactive(true);
            if ui.add(button).on_hover_text(tooltip).clicked() {
                settings.frame = frame;
            }
        }
    });
    let is_sensible = |step: f64, most: f64| step.is_finite() && step > 0.0 && step <= most;
    if settings != before
        && is_sensible(settings.step_px, 1000.0)
        && is_sensible(settings.step_degrees, 180.0)
    {
        commands.push(Command::SetNudge(settings));
    }
}
