//! Which keys run which commands: the table's shortcuts with the user's own over them.

use std::collections::BTreeMap;
use std::sync::Arc;

use egui::{Id, Key, Modifiers};

use crate::session::{COMMANDS, CommandId, Shortcut};

/// A key with its modifiers. Keys are physical positions, but for the question mark, which is elsewhere on every keyboard.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Binding {
    pub key: Key,
    pub ctrl: bool,
    pub shift: bool,
    pub alt: bool,
}

impl Binding {
    pub fn of_shortcut(shortcut: Shortcut) -> Option<Self> {
        let Shortcut { key, ctrl, shift, alt } = shortcut;
        let key = if key == "?" { Key::Questionmark } else { Key::from_name(key)? };
        Some(Self { key, ctrl, shift, alt })
    }

    /// What was pressed, as a binding.
    pub fn pressed(key: Key, physical_key: Option<Key>, modifiers: Modifiers) -> Self {
        if is_question_mark(key, modifiers) {
            return Self { key: Key::Questionmark, ctrl: false, shift: false, alt: false };
        }
        let Modifiers { command, shift, alt, .. } = modifiers;
        Self { key: physical_key.unwrap_or(key), ctrl: command, shift, alt }
    }

    /// As it is printed in menus.
    pub fn text(&self) -> String {
        let mut text = self.modifiers_text();
        text += match self.key {
            Key::Escape => "Esc",
            Key::ArrowLeft => "Left",
            Key::ArrowRight => "Right",
            Key::ArrowUp => "Up",
            Key::ArrowDown => "Down",
            Key::OpenBracket => "[",
            Key::CloseBracket => "]",
            Key::Questionmark => "?",
            key => key.name(),
        };
        text
    }

    /// As it is saved: names of keys that are read back.
    pub fn saved_text(&self) -> String {
        self.modifiers_text() + self.key.name()
    }

    pub fn from_saved_text(text: &str) -> Option<Self> {
        let mut rest = text;
        let mut has = |prefix: &str| match rest.strip_prefix(prefix) {
            Some(after) if !after.is_empty() => {
                rest = after;
                true
            }
            _ => false,
        };
        let (ctrl, alt, shift) = (has("Ctrl+"), has("Alt+"), has("Shift+"));
        Some(Self { key: Key::from_name(rest)?, ctrl, shift, alt })
    }

    fn modifiers_text(&self) -> String {
        let held = [(self.ctrl, "Ctrl+"), (self.alt, "Alt+"), (self.shift, "Shift+")];
        held.into_iter().filter(|(held, _)| *held).map(|(_, text)| text).collect()
    }
}

/// Shift and slash give it on some keyboards whose layout the browser does not tell.
fn is_question_mark(key: Key, modifiers: Modifiers) -> bool {
    key == Key::Questionmark || (key == Key::Slash && modifiers.shift)
}

/// Why a key cannot be given to a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refusal {
    /// Another command has it.
    Conflict(CommandId),
    /// A nudge takes Shift and Alt for itself.
    NudgeTakesModifiers,
    /// Esc cancels and Tab goes on to the next widget.
    Reserved,
}

/// The table's shortcuts, and what the user made of them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Keymap {
    /// `None`: the command has no key.
    own: BTreeMap<CommandId, Option<Binding>>,
}

impl Keymap {
    /// Lets every widget of a frame know the keys, as it knows the theme.
    pub fn put_on(&self, ctx: &egui::Context) {
        let known = Self::of(ctx);
        if *known != *self {
            ctx.data_mut(|data| data.insert_temp(Id::NULL, Arc::new(self.clone())));
        }
    }

    /// The keys that were put on this context last; the table's own before that.
    pub fn of(ctx: &egui::Context) -> Arc<Self> {
        ctx.data(|data| data.get_temp(Id::NULL)).unwrap_or_default()
    }

    pub fn binding(&self, id: CommandId) -> Option<Binding> {
        match self.own.get(&id) {
            Some(own) => *own,
            None => default_binding(id),
        }
    }

    /// A command's key as it is printed.
    pub fn text(&self, id: CommandId) -> Option<String> {
        self.binding(id).map(|binding| binding.text())
    }

    pub fn is_changed(&self, id: CommandId) -> bool {
        self.own.contains_key(&id)
    }

    pub fn is_any_changed(&self) -> bool {
        !self.own.is_empty()
    }

    /// Gives a key to a command, if that is free.
    pub fn set(&mut self, id: CommandId, binding: Binding) -> Result<(), Refusal> {
        if matches!(binding.key, Key::Escape | Key::Tab) {
            return Err(Refusal::Reserved);
        }
        if id.nudge().is_some() && (binding.shift || binding.alt) {
            return Err(Refusal::NudgeTakesModifiers);
        }
        if let Some(other) = self.conflict(id, binding) {
            return Err(Refusal::Conflict(other));
        }
        self.write(id, Some(binding));
        Ok(())
    }

    /// Gives a key to a command, and the key that this one had to those that had that one.
    pub fn swap(&mut self, id: CommandId, binding: Binding) {
        let mut freed = self.binding(id);
        while let Some(other) = self.conflict(id, binding) {
            let other_takes = freed.take();
            self.write(other, None);
            self.write(id, Some(binding));
            if let Some(freed) = other_takes {
                // It may be one that the other cannot have; then that has none.
                self.set(other, freed).ok();
            }
        }
        self.write(id, Some(binding));
    }

    pub fn clear(&mut self, id: CommandId) {
        self.write(id, None);
    }

    /// Back to the table's key; another command that took it meanwhile loses it.
    pub fn reset(&mut self, id: CommandId) {
        self.own.remove(&id);
        if let Some(binding) = self.binding(id) {
            while let Some(other) = self.conflict(id, binding) {
                self.write(other, None);
            }
        }
    }

    pub fn reset_all(&mut self) {
        self.own.clear();
    }

    /// Another command that would run by the same key.
    pub fn conflict(&self, id: CommandId, binding: Binding) -> Option<CommandId> {
        let wanted = taken(id, binding);
        let overlaps = |other: CommandId| {
            let held = self.binding(other).map(|held| taken(other, held)).unwrap_or_default();
            held.iter().any(|key| wanted.contains(key))
        };
        COMMANDS.iter().map(|info| info.id).find(|other| *other != id && overlaps(*other))
    }

    /// The command of a key that was pressed, and by which factor it acts.
    pub fn command_of(&self, pressed: Binding) -> Option<(CommandId, f64)> {
        COMMANDS.iter().find_map(|info| {
            let binding = self.binding(info.id)?;
            let factor = match info.id.nudge() {
                Some(_) if binding.key == pressed.key && binding.ctrl == pressed.ctrl => {
                    nudge_factor(pressed.shift, pressed.alt)
                }
                _ if binding == pressed => Some(1.0),
                _ => None,
            };
            factor.map(|factor| (info.id, factor))
        })
    }

    /// By the names of commands; an empty text is no key.
    pub fn to_saved(&self) -> BTreeMap<String, String> {
        let saved = |(id, own): (&CommandId, &Option<Binding>)| {
            (id.info().name.to_owned(), own.map(|binding| binding.saved_text()).unwrap_or_default())
        };
        self.own.iter().map(saved).collect()
    }

    /// What this program does not know is left out.
    pub fn from_saved(saved: &BTreeMap<String, String>) -> Self {
        let mut keymap = Self::default();
        for (name, text) in saved {
            let Some(info) = COMMANDS.iter().find(|info| info.name == name) else { continue };
            let binding = Binding::from_saved_text(text);
            if binding.is_some() || text.is_empty() {
                keymap.write(info.id, binding);
            }
        }
        keymap
    }

    fn write(&mut self, id: CommandId, binding: Option<Binding>) {
        if binding == default_binding(id) {
            self.own.remove(&id);
        } else {
            self.own.insert(id, binding);
        }
    }
}

fn default_binding(id: CommandId) -> Option<Binding> {
    Binding::of_shortcut(id.info().shortcut?)
}

/// Shift is ten times coarser, Alt ten times finer; both at once is no nudge.
fn nudge_factor(shift: bool, alt: bool) -> Option<f64> {
    match (shift, alt) {
        (false, false) => Some(1.0),
        (true, false) => Some(10.0),
        (false, true) => Some(0.1),
        (true, true) => None,
    }
}

/// All that a command answers to if it has this key.
fn taken(id: CommandId, binding: Binding) -> Vec<Binding> {
    if id.nudge().is_none() {
        return vec![binding];
    }
    let plain = Binding { shift: false, alt: false, ..binding };
    vec![plain, Binding { shift: true, ..plain }, Binding { alt: true, ..plain }]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn binding(text: &str) -> Binding {
        Binding::from_saved_text(text).unwrap()
    }

    #[test]
    fn a_keymap_comes_back_as_it_was_saved() {
        let mut keymap = Keymap::default();
        keymap.set(CommandId::NextPhoto, binding("Ctrl+Alt+Shift+F7")).unwrap();
        keymap.set(CommandId::NudgeNearer, binding("Plus")).unwrap();
        keymap.clear(CommandId::Undo);
        assert_eq!(Keymap::from_saved(&keymap.to_saved()), keymap);
        assert_eq!(keymap.binding(CommandId::Undo), None);
        let strange = BTreeMap::from([
            ("no_such_command".to_owned(), "F".to_owned()),
            ("undo".to_owned(), "Ctrl+NoSuchKey".to_owned()),
        ]);
        assert_eq!(Keymap::from_saved(&strange), Keymap::default());
    }

    #[test]
    fn every_shortcut_of_the_table_is_a_binding_of_its_own() {
        let keymap = Keymap::default();
        for info in COMMANDS {
            let Some(shortcut) = info.shortcut else { continue };
            let binding = Binding::of_shortcut(shortcut).unwrap();
            assert_eq!(keymap.conflict(info.id, binding), None, "{}", info.name);
            assert_eq!(keymap.command_of(binding), Some((info.id, 1.0)), "{}", info.name);
            assert_eq!(Binding::from_saved_text(&binding.saved_text()), Some(binding));
        }
    }

    #[test]
    fn a_key_that_is_taken_is_swapped() {
        let mut keymap = Keymap::default();
        let taken = keymap.binding(CommandId::FitPhoto).unwrap();
        let refusal = keymap.set(CommandId::NextPhoto, taken);
        assert_eq!(refusal, Err(Refusal::Conflict(CommandId::FitPhoto)));
        keymap.swap(CommandId::NextPhoto, taken);
        assert_eq!(keymap.binding(CommandId::NextPhoto), Some(taken));
        assert_eq!(keymap.text(CommandId::FitPhoto).as_deref(), Some("N"));
        keymap.reset(CommandId::NextPhoto);
        assert_eq!(keymap.text(CommandId::NextPhoto).as_deref(), Some("N"));
        assert_eq!(keymap.binding(CommandId::FitPhoto), None, "its key went back");
        keymap.reset_all();
        assert_eq!(keymap, Keymap::default());
    }

    #[test]
    fn a_nudge_has_its_key_with_shift_and_alt_too() {
        let mut keymap = Keymap::default();
        let refused = keymap.set(CommandId::NextPhoto, binding("Shift+W"));
        assert_eq!(refused, Err(Refusal::Conflict(CommandId::PitchForward)));
        let refused = keymap.set(CommandId::PitchForward, binding("Alt+F7"));
        assert_eq!(refused, Err(Refusal::NudgeTakesModifiers));
        assert_eq!(keymap.set(CommandId::Undo, binding("Tab")), Err(Refusal::Reserved));
        let factor = |text: &str| keymap.command_of(binding(text)).map(|(_, factor)| factor);
        assert_eq!(factor("W"), Some(1.0));
        assert_eq!(factor("Shift+W"), Some(10.0));
        assert_eq!(factor("Alt+W"), Some(0.1));
        assert_eq!(factor("Alt+Shift+W"), None);
    }
}
