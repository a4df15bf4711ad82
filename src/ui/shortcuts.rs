//! Keys to commands, and their names.

use egui::{Event, Key};

use crate::session::{COMMANDS, CommandId, Shortcut};

/// A command whose key went down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pressed {
    pub id: CommandId,
    /// How many steps a nudge goes: Shift makes ten of one, Alt a tenth.
    pub factor: f64,
}

/// The commands whose keys went down in this frame; their key events are taken, so that no widget sees them too.
pub fn pressed_commands(input: &mut egui::InputState) -> Vec<Pressed> {
    let mut pressed = Vec::new();
    input.events.retain(|event| {
        let (id, factor, is_repeat) = match event {
            Event::Copy => (Some(CommandId::CopyPose), 1.0, false),
            Event::Key { key, physical_key, pressed: true, modifiers, repeat } => {
                let physical_key = physical_key.unwrap_or(*key);
                // Comes as an event of the clipboard, with what is in it.
                if is_clipboard_key(physical_key, *modifiers) {
                    return true;
                }
                let id = command_of_key(*key, physical_key, *modifiers);
                (id, nudge_factor(*modifiers), *repeat)
            }
            _ => return true,
        };
        let Some(id) = id else { return true };
        if !is_repeat || repeats(id) {
            let factor = if id.nudge().is_some() { factor } else { 1.0 };
            pressed.push(Pressed { id, factor });
        }
        false
    });
    pressed
}

/// Did a command's key go up in this frame, whatever the modifiers are by now? Without the focus no key is seen going up.
pub fn is_released(input: &egui::InputState, id: CommandId) -> bool {
    let wanted = id.info().shortcut.and_then(|shortcut| Key::from_name(shortcut.key));
    let went_up = |event: &Event| {
        matches!(event, Event::Key { key, physical_key, pressed: false, .. }
            if Some(physical_key.unwrap_or(*key)) == wanted)
    };
    !input.focused || input.events.iter().any(went_up)
}

fn command_of_key(key: Key, physical_key: Key, modifiers: egui::Modifiers) -> Option<CommandId> {
    let is_meant = |id: CommandId, shortcut: Shortcut| {
        // A nudge takes Shift and Alt for its size.
        let free = if id.nudge().is_some() {
            egui::Modifiers::SHIFT | egui::Modifiers::ALT
        } else {
            egui::Modifiers::NONE
        };
        matches(shortcut, key, physical_key, modifiers, free)
    };
    let info =
        COMMANDS.iter().find(|info| info.shortcut.is_some_and(|shortcut| is_meant(info.id, shortcut)))?;
    Some(info.id)
}

fn nudge_factor(modifiers: egui::Modifiers) -> f64 {
    let coarse = if modifiers.shift { 10.0 } else { 1.0 };
    let fine = if modifiers.alt { 0.1 } else { 1.0 };
    coarse * fine
}

/// What goes on while its key is held down.
fn repeats(id: CommandId) -> bool {
    let steps = [CommandId::Undo, CommandId::Redo, CommandId::NextPhoto, CommandId::PreviousPhoto];
    id.nudge().is_some() || steps.contains(&id)
}

fn is_clipboard_key(physical_key: Key, modifiers: egui::Modifiers) -> bool {
    let plain_command = modifiers.command && !modifiers.shift && !modifiers.alt;
    plain_command && [Key::C, Key::V, Key::X].contains(&physical_key)
}

/// `free`: modifiers that may be down or not.
fn matches(
    shortcut: Shortcut,
    key: Key,
    physical_key: Key,
    modifiers: egui::Modifiers,
    free: egui::Modifiers,
) -> bool {
    // A question mark is somewhere else on every keyboard: it goes by what is printed on the key.
    if shortcut.key == "?" {
        return key == Key::Questionmark || (key == Key::Slash && modifiers.shift);
    }
    Key::from_name(shortcut.key) == Some(physical_key)
        && modifiers.command == shortcut.ctrl
        && (free.shift || modifiers.shift == shortcut.shift)
        && (free.alt || modifiers.alt == shortcut.alt)
}

/// A shortcut as it is printed in menus.
pub fn shortcut_text(shortcut: Shortcut) -> String {
    let mut text = String::new();
    if shortcut.ctrl {
        text += "Ctrl+";
    }
    if shortcut.alt {
        text += "Alt+";
    }
    if shortcut.shift {
        text += "Shift+";
    }
    text + match shortcut.key {
        "Escape" => "Esc",
        "ArrowLeft" => "Left",
        "ArrowRight" => "Right",
        "ArrowUp" => "Up",
        "ArrowDown" => "Down",
        "OpenBracket" => "[",
        "CloseBracket" => "]",
        key => key,
    }
}

#[cfg(test)]
mod tests {
    use egui::Modifiers;

    use super::*;

    fn pressed(key: Key, modifiers: Modifiers, repeat: bool) -> Vec<Pressed> {
        let mut input = egui::InputState::default();
        let event = Event::Key { key, physical_key: Some(key), pressed: true, repeat, modifiers };
        input.events.push(event);
        pressed_commands(&mut input)
    }

    #[test]
    fn shift_and_alt_make_a_nudge_ten_times_coarser_or_finer() {
        let nudge = |factor| vec![Pressed { id: CommandId::NudgeLeft, factor }];
        assert_eq!(pressed(Key::ArrowLeft, Modifiers::NONE, false), nudge(1.0));
        assert_eq!(pressed(Key::ArrowLeft, Modifiers::SHIFT, true), nudge(10.0));
        assert_eq!(pressed(Key::ArrowLeft, Modifiers::ALT, true), nudge(0.1));
        assert_eq!(pressed(Key::ArrowLeft, Modifiers::COMMAND, false), vec![]);
    }

    #[test]
    fn a_key_that_is_held_toggles_once() {
        assert_eq!(pressed(Key::O, Modifiers::NONE, false).len(), 1);
        assert_eq!(pressed(Key::O, Modifiers::NONE, true), vec![]);
        assert_eq!(pressed(Key::Tab, Modifiers::NONE, false), vec![]);
    }

    #[test]
    fn the_clipboards_keys_come_as_its_events() {
        assert_eq!(pressed(Key::C, Modifiers::COMMAND, false), vec![]);
        let mut input = egui::InputState::default();
        input.events.push(Event::Copy);
        assert_eq!(pressed_commands(&mut input), [Pressed { id: CommandId::CopyPose, factor: 1.0 }]);
    }

    #[test]
    fn every_shortcut_names_a_key() {
        for shortcut in COMMANDS.iter().filter_map(|info| info.shortcut) {
            assert!(shortcut.key == "?" || Key::from_name(shortcut.key).is_some(), "{}", shortcut.key);
        }
    }
}
