//! The one table of named commands: menus, the shortcuts sheet, key handling and the page's API are all drawn from it.

use super::Session;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CommandId {
    OpenFiles,
    LoadExample,
    NewScene,
    SavePoses,
    SaveWorkspace,
    Undo,
    Redo,
    RemoveObject,
    RemovePhoto,
    ResetPose,
    MoveTool,
    RotateTool,
    ZoomToObject,
    FitPhoto,
    NextPhoto,
    PreviousPhoto,
    ToggleOutline,
    TogglePanels,
    ToggleShortcuts,
    Cancel,
}

/// Where a command is found in the menus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Menu {
    File,
    Edit,
    View,
    Pose,
    Help,
}

/// A key with its modifiers, by the name of its physical position on a US keyboard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shortcut {
    pub key: &'static str,
    pub ctrl: bool,
    pub shift: bool,
}

#[derive(Debug, Clone, Copy)]
pub struct CommandInfo {
    pub id: CommandId,
    /// The name in the page's API.
    pub name: &'static str,
    pub menu: Menu,
    pub text: &'static str,
    pub tooltip: &'static str,
    pub shortcut: Option<Shortcut>,
    /// Why it cannot be used now; `None` where it can.
    pub unavailable: fn(&Session) -> Option<&'static str>,
}

const fn key(key: &'static str) -> Option<Shortcut> {
    Some(Shortcut { key, ctrl: false, shift: false })
}

const fn ctrl(key: &'static str) -> Option<Shortcut> {
    Some(Shortcut { key, ctrl: true, shift: false })
}

const fn ctrl_shift(key: &'static str) -> Option<Shortcut> {
    Some(Shortcut { key, ctrl: true, shift: true })
}

fn always(_: &Session) -> Option<&'static str> {
    None
}

fn needs_photo(session: &Session) -> Option<&'static str> {
    session.photo().is_none().then_some("no photo is open")
}

fn needs_two_photos(session: &Session) -> Option<&'static str> {
    (session.scene().photos.len() < 2).then_some("only one photo is open")
}

fn needs_content(session: &Session) -> Option<&'static str> {
    session.scene().is_empty().then_some("the scene is empty")
}

fn needs_selection(session: &Session) -> Option<&'static str> {
    session.selected().is_none().then_some("no object is selected")
}

fn needs_selected_pose(session: &Session) -> Option<&'static str> {
    session.selected_annotation().is_none().then_some("no object of this photo is selected")
}

fn needs_undo(session: &Session) -> Option<&'static str> {
    let nothing = session.undo_label().is_none() && !session.gesture_under_way();
    nothing.then_some("there is nothing to undo")
}

fn needs_redo(session: &Session) -> Option<&'static str> {
    session.redo_label().is_none().then_some("nothing was undone")
}

macro_rules! commands {
    ($(($id:ident, $name:literal, $menu:ident, $text:literal, $tooltip:literal, $shortcut:expr, $unavailable:ident)),+ $(,)?) => {
        /// Every command, in the order of the menus.
        pub const COMMANDS: &[CommandInfo] = &[$(CommandInfo {
            id: CommandId::$id,
            name: $name,
            menu: Menu::$menu,
            text: $text,
            tooltip: $tooltip,
            shortcut: $shortcut,
            unavailable: $unavailable,
        }),+];

        impl CommandId {
            /// This command's row of the table.
            pub fn info(self) -> &'static CommandInfo {
                // The variants are declared in the table's order; a test holds them to it.
                &COMMANDS[self as usize]
            }
        }
    };
}

#[rustfmt::skip]
commands![
    (OpenFiles, "open_files", File, "Open files…", "Add photos, meshes, cameras, poses or a workspace", ctrl("O"), always),
    (LoadExample, "load_example", File, "Try the example", "Open the example scene", None, always),
    (NewScene, "new_scene", File, "New scene", "Start over with an empty scene; undo brings this one back", None, needs_content),
    (SavePoses, "save_poses", File, "Save poses (JSON)", "Download the poses of all photos as JSON", ctrl("S"), needs_content),
    (SaveWorkspace, "save_workspace", File, "Save workspace (zip)", "Download the poses with all photos and meshes, to open anywhere", ctrl_shift("S"), needs_content),
    (Undo, "undo", Edit, "Undo", "Take back the last change", ctrl("Z"), needs_undo),
    (Redo, "redo", Edit, "Redo", "Bring back what was undone", ctrl_shift("Z"), needs_redo),
    (RemoveObject, "remove_object", Edit, "Remove object", "Remove the selected object from the scene", key("Delete"), needs_selection),
    (RemovePhoto, "remove_photo", Edit, "Remove photo", "Remove the photo that is shown, with its poses", None, needs_photo),
    (ResetPose, "reset_pose", Pose, "Reset pose", "Put the selected object back to its start pose", None, needs_selected_pose),
    (MoveTool, "move_tool", Pose, "Move", "Drag an object: the point you grab stays under the cursor", key("M"), always),
    (RotateTool, "rotate_tool", Pose, "Rotate", "Drag an object to turn it about its centre", key("R"), always),
    (ZoomToObject, "zoom_to_object", View, "Zoom to object", "Fill the view with the selected object", key("F"), needs_selected_pose),
    (FitPhoto, "fit_photo", View, "Fit photo", "Show the whole photo", key("0"), needs_photo),
    (NextPhoto, "next_photo", View, "Next photo", "Show the next photo", key("N"), needs_two_photos),
    (PreviousPhoto, "previous_photo", View, "Previous photo", "Show the photo before this one", key("P"), needs_two_photos),
    (ToggleOutline, "toggle_outline", View, "Outline", "Show or hide the objects' silhouette lines", key("L"), always),
    (TogglePanels, "toggle_panels", View, "Panels", "Show or hide the side panel", key("F9"), always),
    (ToggleShortcuts, "shortcuts", Help, "Mouse and keys", "All gestures and keys on one sheet", key("?"), always),
    (Cancel, "cancel", Edit, "Cancel", "Put back the drag that is under way", key("Escape"), always),
];

impl Session {
    /// Why a command cannot be used now; `None` where it can.
    pub fn unavailable(&self, id: CommandId) -> Option<&'static str> {
        (id.info().unavailable)(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_ids_and_names_are_unique() {
        for (index, info) in COMMANDS.iter().enumerate() {
            assert_eq!(info.id as usize, index, "{}", info.name);
            let same = |other: &&CommandInfo| {
                other.name == info.name || (info.shortcut.is_some() && other.shortcut == info.shortcut)
            };
            assert_eq!(COMMANDS.iter().filter(same).count(), 1, "{}", info.name);
        }
    }
}
