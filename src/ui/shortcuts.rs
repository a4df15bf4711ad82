//! Keys that went down, as commands.

use egui::Event;

use super::keymap::{Binding, Keymap};
use crate::session::CommandId;

/// A command whose key went down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pressed {
    pub id: CommandId,
    /// Of a nudge: 10 with Shift, 0.1 with Alt.
    pub factor: f64,
}

/// The commands whose keys went down in this frame; their key events are taken, so that no widget sees them too.
pub fn pressed_commands(input: &mut egui::InputState, keymap: &Keymap) -> Vec<Pressed> {
    let mut pressed = Vec::new();
    input.events.retain(|event| {
        let binding = match event {
            Event::Key { key, physical_key, pressed: true, modifiers, .. } => {
                Binding::pressed(*key, *physical_key, *modifiers)
            }
            // A desktop says this in place of the key.
            Event::Copy => Binding { key: egui::Key::C, ctrl: true, shift: false, alt: false },
            _ => return true,
        };
        let command = keymap.command_of(binding);
        pressed.extend(command.map(|(id, factor)| Pressed { id, factor }));
        command.is_none()
    });
    // A browser says the key and the copy.
    pressed.dedup_by(|a, b| a.id == b.id && a.id == CommandId::CopyPose);
    pressed
}

/// A shortcut of the table as it is printed.
pub fn shortcut_text(shortcut: crate::session::Shortcut) -> String {
    Binding::of_shortcut(shortcut).map(|binding| binding.text()).unwrap_or_default()
}
