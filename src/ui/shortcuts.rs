//! Keys to commands, and their names.

use egui::{Event, Key};

use crate::session::{COMMANDS, CommandId, Shortcut};

/// The commands whose keys went down in this frame; their key events are taken, so that no widget sees them too.
pub fn pressed_commands(input: &mut egui::InputState) -> Vec<CommandId> {
    let mut pressed = Vec::new();
    input.events.retain(|event| {
        let Event::Key { key, physical_key, pressed: true, modifiers, .. } = event else { return true };
        let command = COMMANDS.iter().find(|info| {
            info.shortcut
                .is_some_and(|shortcut| matches(shortcut, *key, physical_key.unwrap_or(*key), *modifiers))
        });
        pressed.extend(command.map(|info| info.id));
        command.is_none()
    });
    pressed
}

fn matches(shortcut: Shortcut, key: Key, physical_key: Key, modifiers: egui::Modifiers) -> bool {
    // A question mark is somewhere else on every keyboard: it goes by what is printed on the key.
    if shortcut.key == "?" {
        return key == Key::Questionmark || (key == Key::Slash && modifiers.shift);
    }
    let wanted = Key::from_name(shortcut.key);
    wanted == Some(physical_key)
        && modifiers.command == shortcut.ctrl
        && modifiers.shift == shortcut.shift
        && modifiers.alt == shortcut.alt
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
    use super::*;

    #[test]
    fn every_shortcut_names_a_key() {
        for shortcut in COMMANDS.iter().filter_map(|info| info.shortcut) {
            assert!(shortcut.key == "?" || Key::from_name(shortcut.key).is_some(), "{}", shortcut.key);
        }
    }
}
