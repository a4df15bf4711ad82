//! What this user likes: theme, keys, modifiers. Kept in the browser, apart from scenes.

use std::collections::BTreeMap;

use egui::ThemePreference;
use serde::{Deserialize, Serialize};

use super::Keymap;
use crate::platform;
use crate::solve::Tolerances;

const KEY: &str = "interface";

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ThemeChoice {
    #[default]
    Dark,
    Light,
    System,
}

impl ThemeChoice {
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::Dark, "Dark"), (Self::Light, "Light"), (Self::System, "As the system")];

    pub(super) fn preference(self) -> ThemePreference {
        match self {
            Self::Dark => ThemePreference::Dark,
            Self::Light => ThemePreference::Light,
            Self::System => ThemePreference::System,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ModifierKey {
    Alt,
    Ctrl,
    Shift,
}

impl ModifierKey {
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::Alt, "Alt"), (Self::Ctrl, "Ctrl"), (Self::Shift, "Shift")];

    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }

    pub fn is_held(self, modifiers: egui::Modifiers) -> bool {
        match self {
            Self::Alt => modifiers.alt,
            Self::Ctrl => modifiers.command,
            Self::Shift => modifiers.shift,
        }
    }
}

/// What a modifier does to a drag.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DragModifier {
    /// Ten times finer.
    Fine,
    /// A turn is about the line of sight.
    Roll,
    /// The wheel changes the depth.
    Depth,
}

/// The modifiers of drags, each another one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct ModifierMap {
    fine: ModifierKey,
    roll: ModifierKey,
    depth: ModifierKey,
}

impl Default for ModifierMap {
    fn default() -> Self {
        Self { fine: ModifierKey::Alt, roll: ModifierKey::Ctrl, depth: ModifierKey::Shift }
    }
}

impl ModifierMap {
    pub fn get(&self, what: DragModifier) -> ModifierKey {
        match what {
            DragModifier::Fine => self.fine,
            DragModifier::Roll => self.roll,
            DragModifier::Depth => self.depth,
        }
    }

    /// What had this modifier gets the one that is freed.
    pub fn set(&mut self, what: DragModifier, key: ModifierKey) {
        let freed = self.get(what);
        for slot in [&mut self.fine, &mut self.roll, &mut self.depth] {
            if *slot == key {
                *slot = freed;
            }
        }
        match what {
            DragModifier::Fine => self.fine = key,
            DragModifier::Roll => self.roll = key,
            DragModifier::Depth => self.depth = key,
        }
    }

    fn is_consistent(&self) -> bool {
        self.fine != self.roll && self.fine != self.depth && self.roll != self.depth
    }
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct Preferences {
    pub theme: ThemeChoice,
    pub keymap: Keymap,
    pub modifiers: ModifierMap,
    /// The strip of photos shows its progress alone.
    pub strip_folded: bool,
    /// Of the focal length and the mesh, for how sure a pose is.
    pub tolerances: Tolerances,
}

/// As they are stored; a field that is missing is as at first.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default)]
struct Saved {
    theme: ThemeChoice,
    keys: BTreeMap<String, String>,
    modifiers: ModifierMap,
    strip_folded: bool,
    /// As parts, not per cent.
    focal_tolerance: f64,
    mesh_tolerance: f64,
}

/// A tolerance as it may be; what is none is as at first.
fn tolerance(part: f64) -> f64 {
    if (0.0..1.0).contains(&part) { part } else { 0.0 }
}

impl Preferences {
    /// What was kept last; what cannot be read is as if nothing had been kept.
    pub fn load() -> Self {
        platform::read_preference(KEY).map(|text| Self::from_json(&text)).unwrap_or_default()
    }

    pub fn store(&self) {
        platform::write_preference(KEY, &self.to_json());
    }

    fn to_json(&self) -> String {
        let saved = Saved {
            theme: self.theme,
            keys: self.keymap.to_saved(),
            modifiers: self.modifiers,
            strip_folded: self.strip_folded,
            focal_tolerance: self.tolerances.focal,
            mesh_tolerance: self.tolerances.mesh_scale,
        };
        serde_json::to_string(&saved).unwrap_or_default()
    }

    fn from_json(text: &str) -> Self {
        let saved: Saved = serde_json::from_slice(text.as_bytes()).unwrap_or_default();
        Self {
            theme: saved.theme,
            keymap: Keymap::from_saved(&saved.keys),
            modifiers: Some(saved.modifiers).filter(ModifierMap::is_consistent).unwrap_or_default(),
            strip_folded: saved.strip_folded,
            tolerances: Tolerances {
                focal: tolerance(saved.focal_tolerance),
                mesh_scale: tolerance(saved.mesh_tolerance),
            },
        }
    }

    /// From dark to light and back, whatever was chosen.
    pub fn toggle_theme(&mut self, shown: egui::Theme) {
        self.theme = match shown {
            egui::Theme::Dark => ThemeChoice::Light,
            egui::Theme::Light => ThemeChoice::Dark,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::CommandId;

    #[test]
    fn preferences_come_back_and_damage_is_no_harm() {
        let mut preferences = Preferences { theme: ThemeChoice::System, ..Preferences::default() };
        preferences.keymap.clear(CommandId::Undo);
        preferences.modifiers.set(DragModifier::Fine, ModifierKey::Ctrl);
        assert_eq!(preferences.modifiers.get(DragModifier::Roll), ModifierKey::Alt, "they were swapped");
        preferences.tolerances.focal = 0.01;
        assert_eq!(Preferences::from_json(&preferences.to_json()), preferences);
        for damaged in ["", "[]", "{\"theme\": 3}", "{}"] {
            assert_eq!(Preferences::from_json(damaged), Preferences::default());
        }
    }
}
