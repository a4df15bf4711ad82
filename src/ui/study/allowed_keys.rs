//! Which gestures and keys a condition allows, in a few lines.

use egui::{Grid, RichText, Ui};

use super::has;
use crate::session::CommandId;
use crate::study::Tool;
use crate::ui::Keymap;

/// What a tool is worked with, and what for.
fn lines(tool: Tool, keymap: &Keymap) -> Vec<(String, &'static str)> {
    let key = |id: CommandId| keymap.text(id).unwrap_or_default();
    let line = |how: &str, what: &'static str| (how.to_owned(), what);
    match tool {
        Tool::Move => vec![
            line("Drag the object", "Move it: the point you grab stays under the cursor"),
            line("Shift + wheel", "Nearer or farther"),
        ],
        Tool::Rotate => {
            vec![line("Right drag", "Turn it"), line("Ctrl + right drag", "Turn it in the picture's plane")]
        }
        Tool::Handles => vec![line("Drag a coloured handle", "Move or turn it along one direction only")],
        Tool::Nudge => vec![
            line("Arrow keys", "Move it by a pixel (Shift: ten, Alt: a tenth)"),
            line("[  ]", "Farther or nearer by a little"),
            line("W S A D Q E", "Turn it by a degree"),
        ],
        Tool::Pins => vec![(
            format!("{}, then drag a point", key(CommandId::PinTool)),
            "Pin a point of the object to where it is in the photo",
        )],
        Tool::Snap => vec![(key(CommandId::Snap), "Snap: fit the pose to the photo, from near by")],
        Tool::Numbers => vec![(key(CommandId::PastePose), "Paste a pose as numbers")],
        Tool::SceneView => vec![(key(CommandId::CycleViews), "Look at photo and object from anywhere")],
        Tool::Looks => vec![
            (format!("{} held", key(CommandId::ToggleOverlay)), "Hide the object as long as the key is down"),
            (key(CommandId::NextOverlay), "Draw it in another way"),
        ],
        Tool::Undo => vec![(key(CommandId::Undo), "Undo"), (key(CommandId::Redo), "Redo")],
    }
}

pub fn draw(ui: &mut Ui, tools: &[Tool]) {
    let keymap = Keymap::of(ui.ctx());
    Grid::new("allowed keys").num_columns(2).spacing([20.0, 6.0]).show(ui, |ui| {
        let mut row = |how: &str, what: &str| {
            ui.label(RichText::new(how).strong());
            ui.label(what);
            ui.end_row();
        };
        for tool in Tool::ALL.into_iter().filter(|tool| has(tools, *tool)) {
            lines(tool, &keymap).iter().for_each(|(how, what)| row(how, what));
        }
        row("Wheel", "Zoom the photo; drag beside the object to move it");
        row(&keymap.text(CommandId::ConfirmAndNext).unwrap_or_default(), "Confirm: done with this photo");
    });
}
