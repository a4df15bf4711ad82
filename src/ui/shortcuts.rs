//! Keys that went down, as commands.

use egui::{Event, InputState, Key, Modifiers};

use super::keymap::{Binding, Keymap};
use crate::session::CommandId;

/// A command whose key went down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pressed {
    pub id: CommandId,
    /// How many steps a nudge goes: Shift makes ten of one, Alt a tenth.
    pub factor: f64,
}

/// The commands whose keys went down in this frame; their key events are taken, so that no widget sees them too.
pub fn pressed_commands(input: &mut InputState, keymap: &Keymap) -> Vec<Pressed> {
    let mut pressed = Vec::new();
    input.events.retain(|event| {
        let (binding, is_repeat) = match event {
            // Copy and paste come as events of the clipboard; a browser says the key too.
            Event::Key { key, physical_key, modifiers, .. }
                if is_clipboard_key(physical_key.unwrap_or(*key), *modifiers) =>
            {
                return true;
            }
            Event::Key { key, physical_key, pressed: true, modifiers, repeat } => {
                (Binding::pressed(*key, *physical_key, *modifiers), *repeat)
            }
            Event::Copy => (Binding { key: Key::C, ctrl: true, shift: false, alt: false }, false),
            _ => return true,
        };
        let Some((id, factor)) = keymap.command_of(binding) else { return true };
        if !is_repeat || repeats(id) {
            pressed.push(Pressed { id, factor });
        }
        false
    });
    pressed
}

/// Did a command's key go up in this frame, whatever the modifiers are by now? Without the focus no key is seen going up.
pub fn is_released(input: &InputState, id: CommandId, keymap: &Keymap) -> bool {
    let wanted = keymap.binding(id).map(|binding| binding.key);
    let went_up = |event: &Event| {
        matches!(event, Event::Key { key, physical_key, pressed: false, .. }
            if Some(physical_key.unwrap_or(*key)) == wanted)
    };
    !input.focused || input.events.iter().any(went_up)
}

/// A shortcut of the table as it is printed.
pub fn shortcut_text(shortcut: crate::session::Shortcut) -> String {
    Binding::of_shortcut(shortcut).map(|binding| binding.text()).unwrap_or_default()
}

/// What goes on while its key is held down.
fn repeats(id: CommandId) -> bool {
    let steps = [CommandId::Undo, CommandId::Redo, CommandId::NextPhoto, CommandId::PreviousPhoto];
    id.nudge().is_some() || steps.contains(&id)
}

fn is_clipboard_key(physical_key: Key, modifiers: Modifiers) -> bool {
    let plain_command = modifiers.command && !modifiers.shift && !modifiers.alt;
    plain_command && [Key::C, Key::V, Key::X].contains(&physical_key)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pressed(key: Key, modifiers: Modifiers, repeat: bool) -> Vec<Pressed> {
        let mut input = InputState::default();
        let event = Event::Key { key, physical_key: Some(key), pressed: true, repeat, modifiers };
        input.events.push(event);
        pressed_commands(&mut input, &Keymap::default())
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
        let mut input = InputState::default();
        input.events.push(Event::Copy);
        let copied = pressed_commands(&mut input, &Keymap::default());
        assert_eq!(copied, [Pressed { id: CommandId::CopyPose, factor: 1.0 }]);
    }
}
