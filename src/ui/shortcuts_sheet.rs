//! The sheet of gestures and keys, where every key can be changed.

use egui::{Button, Context, Event, Grid, Key, RichText, TextEdit, Ui};

use super::keymap::{Binding, Keymap, Refusal};
use super::menus::{self, NUDGES};
use super::{DragModifier, ModifierKey, ModifierMap, Preferences, once, theme};
use crate::session::CommandId;

const WIDTH: f32 = 640.0;

#[derive(Debug, Default)]
pub struct State {
    search: String,
    recording: Option<Recording>,
}

/// A command whose new key is waited for.
#[derive(Debug)]
struct Recording {
    id: CommandId,
    /// What was pressed and cannot be given just so.
    refused: Option<(Binding, Refusal)>,
}

/// Draws the sheet; true if it is to be closed.
pub fn draw(ctx: &Context, preferences: &mut Preferences, state: &mut State) -> bool {
    record(ctx, &mut preferences.keymap, &mut state.recording);
    let is_toggled = state.recording.is_none() && is_toggled(ctx, &preferences.keymap);
    let mut is_closed = false;
    let frame = theme::dialog_frame(ctx);
    let modal = once::modal(ctx, "shortcuts", frame, |ui| {
        ui.set_width(WIDTH.min(ui.ctx().content_rect().width() - 48.0));
        is_closed = header(ui, preferences, state);
        ui.separator();
        let height = (ui.ctx().content_rect().height() - 150.0).max(120.0);
        // Without the least height, the area would stay as low as it was when it was first drawn.
        let area = egui::ScrollArea::vertical().max_height(height).min_scrolled_height(height);
        area.auto_shrink([false, true]).show(ui, |ui| {
            contents(ui, preferences, state);
        });
    });
    // Esc has ended a recording before it gets here.
    let is_done = is_closed || is_toggled || modal.should_close();
    if is_done {
        *state = State::default();
    }
    is_done
}

/// The key that opens the sheet closes it, unless it is typed into the search field.
fn is_toggled(ctx: &Context, keymap: &Keymap) -> bool {
    if ctx.text_edit_focused() {
        return false;
    }
    let own = keymap.binding(CommandId::ToggleShortcuts);
    let is_own = |event: &Event| match event {
        Event::Key { key, physical_key, pressed: true, modifiers, .. } => {
            own == Some(Binding::pressed(*key, *physical_key, *modifiers))
        }
        _ => false,
    };
    ctx.input(|input| input.events.iter().any(is_own))
}

/// Takes the key that is pressed for the command that waits for one.
fn record(ctx: &Context, keymap: &mut Keymap, recording: &mut Option<Recording>) {
    let Some(waiting) = recording else { return };
    let mut pressed = None;
    ctx.input_mut(|input| {
        input.events.retain(|event| match event {
            Event::Key { key, physical_key, pressed: true, modifiers, .. } => {
                pressed = Some(Binding::pressed(*key, *physical_key, *modifiers));
                false
            }
            Event::Copy => {
                pressed = Some(Binding { key: Key::C, ctrl: true, shift: false, alt: false });
                false
            }
            Event::Text(_) | Event::Paste(_) | Event::Cut => false,
            _ => true,
        });
    });
    let Some(binding) = pressed else { return };
    if binding.key == Key::Escape {
        *recording = None;
        return;
    }
    match keymap.set(waiting.id, binding) {
        Ok(()) => *recording = None,
        Err(refusal) => waiting.refused = Some((binding, refusal)),
    }
}

/// Title, search and the buttons for all; true if the sheet is to be closed.
fn header(ui: &mut Ui, preferences: &mut Preferences, state: &mut State) -> bool {
    let mut is_closed = false;
    ui.horizontal(|ui| {
        ui.heading("Mouse and keys");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            is_closed = ui.button("Close").clicked();
            let is_changed =
                preferences.keymap.is_any_changed() || preferences.modifiers != ModifierMap::default();
            let reset = ui.add_enabled(is_changed, Button::new("Reset all"));
            if reset.on_hover_text("All keys and modifiers as they were at first").clicked() {
                preferences.keymap.reset_all();
                preferences.modifiers = ModifierMap::default();
                state.recording = None;
            }
            let width = ui.available_width().min(180.0);
            let search = TextEdit::singleline(&mut state.search).hint_text("Search").desired_width(width);
            let response = ui.add(search);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Search keys"));
        });
    });
    is_closed
}

fn contents(ui: &mut Ui, preferences: &mut Preferences, state: &mut State) {
    let search = state.search.trim().to_lowercase();
    let matches = |text: &str| search.is_empty() || text.to_lowercase().contains(&search);
    let mut is_any_shown = gestures(ui, &preferences.modifiers, &matches);
    if search.is_empty() {
        modifiers(ui, &mut preferences.modifiers);
    }
    let keymap = &mut preferences.keymap;
    for plan in &menus::MENUS {
        let ids = plan.groups.iter().filter(|group| **group != NUDGES).flat_map(|group| group.iter());
        let shown: Vec<CommandId> = ids
            .copied()
            .filter(|id| matches(id.info().text) || keymap.text(*id).is_some_and(|text| matches(&text)))
            .filter(|id| *id != CommandId::Cancel)
            .collect();
        if !shown.is_empty() {
            is_any_shown = true;
            theme::group_title(ui, plan.title);
            rows(ui, plan.title, &shown, 1, keymap, &mut state.recording);
        }
    }
    let is_nudge = |id: &CommandId| id.nudge().is_some();
    let nudges: Vec<CommandId> =
        NUDGES.iter().copied().filter(is_nudge).filter(|id| matches(id.info().text)).collect();
    if !nudges.is_empty() {
        is_any_shown = true;
        theme::group_title(ui, "Nudge");
        ui.weak("One pixel or one degree. With Shift ten times as much, with Alt a tenth.");
        rows(ui, "nudges", &nudges, 2, keymap, &mut state.recording);
    }
    if search.is_empty() {
        ui.weak("1 to 9 select the objects of the photo in the order of the list.");
    } else if !is_any_shown {
        ui.weak("No gesture or key is called that.");
    }
}

fn gestures(ui: &mut Ui, modifiers: &ModifierMap, matches: &dyn Fn(&str) -> bool) -> bool {
    let name = |what| modifiers.get(what).name();
    let (fine, roll, depth) = (name(DragModifier::Fine), name(DragModifier::Roll), name(DragModifier::Depth));
    let gestures = [
        ("Click".to_owned(), "select an object (Alt: the one behind; Ctrl: add to the selection)"),
        ("Drag an object".to_owned(), "move it; the point you grab stays under the cursor"),
        ("Right drag an object".to_owned(), "turn it about its centre, or its one pin"),
        (format!("{roll} + right drag"), "roll it about the line of sight"),
        (format!("{depth} + wheel"), "nearer or farther, 1 px of its width a notch"),
        (format!("{fine} while dragging"), "ten times finer"),
        (
            "Pin tool: drag a point".to_owned(),
            "pin it, and bring it to its pixel; the pose follows. A click pins it where it is",
        ),
        ("Pin tool: click the ground".to_owned(), "the pixel of a pin; then click its point on the object"),
        ("Wheel".to_owned(), "zoom to the cursor"),
        ("Drag the ground, middle drag".to_owned(), "move the photo"),
        ("Double click".to_owned(), "zoom to the object, or show the whole photo"),
        (
            "In the scene view".to_owned(),
            "drag the ground to look round, Shift or middle to move, wheel to zoom",
        ),
        ("Two fingers".to_owned(), "move and zoom"),
        ("Esc".to_owned(), "put back the drag under way"),
    ];
    let shown = gestures.iter().filter(|(gesture, effect)| matches(gesture) || matches(effect));
    let shown: Vec<_> = shown.collect();
    if shown.is_empty() {
        return false;
    }
    theme::group_title(ui, "Mouse");
    Grid::new("gestures").num_columns(2).spacing([16.0, 4.0]).show(ui, |ui| {
        for (gesture, effect) in shown {
            ui.label(RichText::new(gesture).strong());
            ui.label(*effect);
            ui.end_row();
        }
    });
    true
}

fn modifiers(ui: &mut Ui, map: &mut ModifierMap) {
    theme::group_title(ui, "Modifiers of drags");
    Grid::new("modifiers").num_columns(2).spacing([16.0, 4.0]).show(ui, |ui| {
        for (what, name) in [
            (DragModifier::Fine, "Ten times finer"),
            (DragModifier::Roll, "Roll about the line of sight"),
            (DragModifier::Depth, "Depth by the wheel"),
        ] {
            ui.label(name);
            ui.horizontal(|ui| {
                for (key, key_name) in ModifierKey::ALL {
                    let choice = ui.selectable_label(map.get(what) == key, key_name);
                    choice.widget_info(|| {
                        let label = format!("{name}: {key_name}");
                        egui::WidgetInfo::selected(egui::Role::RadioButton, true, map.get(what) == key, label)
                    });
                    if choice.clicked() {
                        map.set(what, key);
                    }
                }
            });
            ui.end_row();
        }
    });
}

fn rows(
    ui: &mut Ui,
    name: &str,
    ids: &[CommandId],
    commands_in_row: usize,
    keymap: &mut Keymap,
    recording: &mut Option<Recording>,
) {
    let grid = Grid::new(name).num_columns(2 * commands_in_row).min_col_width(136.0);
    grid.spacing([16.0, 4.0]).show(ui, |ui| {
        for row in ids.chunks(commands_in_row) {
            for id in row {
                ui.label(id.info().text).on_hover_text(id.info().tooltip);
                key_cell(ui, *id, keymap, recording);
            }
            ui.end_row();
        }
    });
}

/// The command's key, to click and press another.
fn key_cell(ui: &mut Ui, id: CommandId, keymap: &mut Keymap, recording: &mut Option<Recording>) {
    ui.horizontal(|ui| {
        if recording.as_ref().is_some_and(|recording| recording.id == id) {
            recording_cell(ui, id, keymap, recording);
            return;
        }
        let text = keymap.text(id);
        let shown = match &text {
            Some(text) => RichText::new(text).strong(),
            None => RichText::new("none").weak(),
        };
        let button = ui.add(Button::new(shown).min_size(egui::vec2(84.0, 22.0)));
        let key = text.as_deref().unwrap_or("none");
        let label = format!("Key of {}: {key}", id.info().text);
        button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &label));
        if button.on_hover_text("Click, then press the new key").clicked() {
            *recording = Some(Recording { id, refused: None });
        }
        if keymap.is_changed(id) {
            let reset = ui.small_button("Reset");
            let label = format!("Reset key of {}", id.info().text);
            reset.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &label));
            if reset.clicked() {
                keymap.reset(id);
            }
        }
    });
}

fn recording_cell(ui: &mut Ui, id: CommandId, keymap: &mut Keymap, recording: &mut Option<Recording>) {
    let refused = recording.as_ref().and_then(|recording| recording.refused);
    let (mut is_done, color) = (false, theme::warning(ui.visuals()));
    match refused {
        None => {
            ui.label(RichText::new("Press a key…").color(theme::accent(ui.visuals())));
        }
        Some((binding, Refusal::Conflict(other))) => {
            let text = format!("{} is {}", binding.text(), other.info().text);
            ui.label(RichText::new(text).color(color));
            if ui.small_button("Swap").on_hover_text("Each gets the other's key").clicked() {
                keymap.swap(id, binding);
                is_done = true;
            }
        }
        Some((_, Refusal::NudgeTakesModifiers)) => {
            ui.label(RichText::new("Shift and Alt make nudges coarser and finer").color(color));
        }
        Some((binding, Refusal::Reserved)) => {
            ui.label(RichText::new(format!("{} keeps its meaning", binding.text())).color(color));
        }
    }
    if refused.is_none() && ui.small_button("No key").clicked() {
        keymap.clear(id);
        is_done = true;
    }
    is_done |= ui.small_button("Cancel").clicked();
    if is_done {
        *recording = None;
    }
}
