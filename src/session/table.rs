//! The one table of named commands: menus, the palette, the shortcuts sheet, key handling and the page's API are all drawn
//! from it.

use super::availability::*;
use super::{Nudge, Session};

/// Where a command is found in the menus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Menu {
    File,
    Edit,
    View,
    Pose,
    Study,
    Help,
    /// In no menu: a key alone.
    Keys,
}

/// A key with its modifiers, by the name of its physical position on a US keyboard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shortcut {
    pub key: &'static str,
    pub ctrl: bool,
    pub shift: bool,
    pub alt: bool,
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
    Some(Shortcut { key, ctrl: false, shift: false, alt: false })
}

const fn shift(key: &'static str) -> Option<Shortcut> {
    Some(Shortcut { key, ctrl: false, shift: true, alt: false })
}

const fn ctrl(key: &'static str) -> Option<Shortcut> {
    Some(Shortcut { key, ctrl: true, shift: false, alt: false })
}

const fn ctrl_shift(key: &'static str) -> Option<Shortcut> {
    Some(Shortcut { key, ctrl: true, shift: true, alt: false })
}

/// Where the browser keeps the plain combination for itself.
const fn ctrl_alt(key: &'static str) -> Option<Shortcut> {
    Some(Shortcut { key, ctrl: true, shift: false, alt: true })
}

macro_rules! commands {
    ($(($id:ident, $name:literal, $menu:ident, $text:literal, $tooltip:literal, $shortcut:expr, $unavailable:ident)),+ $(,)?) => {
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum CommandId {
            $($id),+
        }

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
    };
}

#[rustfmt::skip]
commands![
    (OpenFiles, "open_files", File, "Open files…", "Add photos, meshes, cameras, poses or a workspace", ctrl("O"), always),
    (OpenFolder, "open_folder", File, "Open folder…", "Open a data set: BOP, Linemod, MegaPose, or photos and meshes in a folder", None, always),
    (NewScene, "new_scene", File, "New scene", "Start an empty scene; this one stays among your scenes", ctrl_alt("N"), needs_content),
    (OpenScene, "open_scene", File, "Open scene…", "All scenes that are kept in this browser", ctrl_shift("O"), always),
    (SaveScene, "save_scene", File, "Save", "Keep the scene in this browser now; it is also done by itself", ctrl("S"), needs_content),
    (SaveSceneAs, "save_scene_as", File, "Save as…", "Go on with a copy under another name", ctrl_shift("S"), needs_content),
    (ImportPhotos, "import_photos", File, "Import photos…", "PNG, JPEG, WebP, BMP or TIFF", None, always),
    (ImportMeshes, "import_meshes", File, "Import meshes…", "3D models of the objects", None, always),
    (ImportMasks, "import_masks", File, "Import masks…", "Images of the shown photo's size: what is not black is in the mask", None, needs_photo),
    (ImportDepth, "import_depth", File, "Import depth map…", "A grey image of the shown photo's size, mostly of 16 bits: hides what is behind the scene", None, needs_photo),
    (ImportCamera, "import_camera", File, "Import camera…", "Intrinsics for the photos", None, always),
    (ImportPoses, "import_poses", File, "Import poses…", "To go on from, or to compare with", None, always),
    (OpenWorkspace, "open_workspace", File, "Open workspace…", "A zip with photos, meshes and poses", None, always),
    (ExportFiles, "export", File, "Export…", "Poses in any convention, a BOP dataset, masks, depth, boxes: of one photo or all", ctrl_alt("E"), needs_content),
    (ExportPoses, "export_poses", File, "Export poses (JSON)", "Download the poses of all photos as JSON", ctrl("E"), needs_content),
    (ExportOverlay, "export_overlay", File, "Export overlay (PNG)", "The photo with the meshes over it, at the photo's resolution", None, needs_photo),
    (ExportMask, "export_mask", File, "Export mask (PNG)", "The selected object's silhouette, white on black", None, needs_selected_pose),
    (ExportVisibleMask, "export_visible_mask", File, "Export visible mask (PNG)", "The part of the silhouette that no other object hides", None, needs_selected_pose),
    (ExportDepth, "export_depth", File, "Export depth (PNG)", "The objects' depth, 16 bits, in tenths of a millimetre", None, needs_photo),
    (ExportMesh, "export_mesh", File, "Export mesh (PLY)", "The selected mesh after mirror and spacing, in millimetres", None, needs_selection),
    (ExportWorkspace, "export_workspace", File, "Export workspace (zip)", "The poses with all photos and meshes, to open anywhere", ctrl_shift("E"), needs_content),
    (LoadExample, "load_example", File, "Try the example", "Open the example scene", None, always),
    (Undo, "undo", Edit, "Undo", "Take back the last change", ctrl("Z"), needs_undo),
    (Redo, "redo", Edit, "Redo", "Bring back what was undone", ctrl_shift("Z"), needs_redo),
    (CopyPose, "copy_pose", Edit, "Copy pose", "Copy the selected object's 4×4, row by row", ctrl("C"), needs_selected_pose),
    (CopyPoseNumPy, "copy_pose_numpy", Edit, "Copy pose as NumPy", "Copy the selected object's 4×4 as np.array", None, needs_selected_pose),
    (CopyPoseJson, "copy_pose_json", Edit, "Copy pose as JSON", "Copy the selected object's 4×4 as JSON", None, needs_selected_pose),
    (PastePose, "paste_pose", Edit, "Paste pose…", "Set the selected object's pose from text: a matrix, NumPy or JSON", ctrl("V"), needs_selected_pose),
    (SelectAll, "select_all", Edit, "Select all", "Select every object of this photo", ctrl("A"), needs_objects_here),
    (DuplicateObject, "duplicate_object", Edit, "Duplicate object", "Another object of the same mesh, beside this one", ctrl("D"), needs_selected_pose),
    (LinkObjects, "link_objects", Edit, "Link objects", "Move the selected objects together from now on", ctrl("L"), needs_several),
    (UnlinkObjects, "unlink_objects", Edit, "Unlink objects", "Let the selected objects move by themselves again", ctrl_shift("L"), needs_link),
    (RenameObject, "rename_object", Edit, "Rename object", "Give the selected object another name", key("F2"), needs_selection),
    (RemoveObject, "remove_object", Edit, "Remove object", "Remove the selected objects from the scene", key("Delete"), needs_selection),
    (RemovePhoto, "remove_photo", Edit, "Remove photo", "Remove the photo that is shown, with its poses", None, needs_photo),
    (ClearLog, "clear_log", Edit, "Clear history list", "Empty the list of poses; undo brings it back", None, needs_log),
    (CycleViews, "cycle_views", View, "Next view", "Photo view, scene view, both", key("V"), needs_photo),
    (PhotoView, "photo_view", View, "Photo view", "Look through the camera that took the photo", None, needs_photo),
    (SceneView, "scene_view", View, "Scene view", "Look at photo and objects from anywhere", None, needs_photo),
    (SplitView, "split_view", View, "Both views", "Photo view and scene view side by side", None, needs_photo),
    (ZoomToObject, "zoom_to_object", View, "Zoom to object", "Fill the view with the selected object", key("F"), needs_selected_pose),
    (FitPhoto, "fit_photo", View, "Fit photo", "Show the whole photo", key("0"), needs_photo),
    (ResetSceneView, "reset_scene_view", View, "Reset scene view", "Look from the camera's place again", key("Home"), needs_photo),
    (NextPhoto, "next_photo", View, "Next photo", "Show the next photo", key("N"), needs_two_photos),
    (PreviousPhoto, "previous_photo", View, "Previous photo", "Show the photo before this one", key("P"), needs_two_photos),
    (NextOverlay, "next_overlay", View, "Next overlay", "Shaded, texture, NOCS, normals, depth, outline, edges, wireframe", key("O"), always),
    (ToggleOverlay, "toggle_overlay", View, "Hide overlay", "Hide the meshes; held down, only as long as the key is", key("H"), always),
    (NextLayers, "next_layers", View, "Photo only, mesh only", "Photo with meshes, the photo alone, the meshes alone", key("I"), always),
    (ToggleOutline, "toggle_outline", View, "Outline", "Show or hide the objects' silhouette lines", key("U"), always),
    (ToggleXRay, "toggle_x_ray", View, "X-ray", "See objects through those before them", key("Z"), always),
    (ToggleWipe, "toggle_wipe", View, "Wipe", "Show the overlay left of a line that can be dragged", key("J"), always),
    (ToggleDifference, "toggle_difference", View, "Difference", "Show where meshes and photo differ", key("K"), always),
    (ToggleGizmo, "toggle_gizmo", View, "Handles", "Handles on the object to move, turn, roll and bring it nearer", key("G"), always),
    (TogglePanels, "toggle_panels", View, "Panels", "Show or hide the side panel", key("F9"), always),
    (ToggleTheme, "toggle_theme", View, "Light or dark", "Switch between the light and the dark theme", None, always),
    (MoveTool, "move_tool", Pose, "Move", "Drag an object: the point you grab stays under the cursor", key("M"), always),
    (RotateTool, "rotate_tool", Pose, "Rotate", "Drag an object to turn it about its centre", key("R"), always),
    (PinTool, "pin_tool", Pose, "Pin", "Click a point of the object, then drag the pin to where that point is in the photo; Shift + click sets the place in the photo first", key("X"), always),
    (SolvePins, "solve_pins", Pose, "Pose from pins", "The pose that brings the pins to their pixels", shift("X"), needs_pins),
    (ClearPins, "clear_pins", Pose, "Remove all pins", "Remove the pins of the selected object in this photo; the pose stays", None, needs_pins),
    (FocalFromPins, "focal_from_pins", Pose, "Focal length from pins", "The focal length and the pose that fit six pins or more", None, needs_six_pins),
    (CopyPinsToNext, "copy_pins_to_next", Pose, "Pins to next photo", "The same points in the next photo, to be dragged to their pixels there", None, needs_pins_and_next),
    (ExportPins, "export_pins", Pose, "Save pins (JSON)", "Points, pixels and the camera, as \"pinpose pins\" reads them", None, needs_pins),
    (Snap, "snap", Pose, "Snap", "Refine the selected object's pose to the photo: its outline, its edges, its pins", key("Space"), needs_selected_pose),
    (SnapWide, "snap_wide", Pose, "Snap from farther", "The same for a pose that is off by up to 20° or a fifth of the object: more starts are tried", shift("Space"), needs_selected_pose),
    (SnapAll, "snap_all", Pose, "Snap on all photos", "Refine every placed pose that is neither locked nor confirmed, on all photos, as one step", None, needs_snappable),
    (FindSymmetries, "find_symmetries", Pose, "Find symmetries", "Look for the turns that leave the selected object's mesh as it is: the Symmetry panel lists them", None, needs_selection),
    (ConfirmAndNext, "confirm", Pose, "Confirm and next", "Confirm this photo's poses, carry them to an untouched next photo, and go there", key("Enter"), needs_objects_here),
    (Reopen, "reopen", Pose, "Reopen", "Take back the confirmation of this photo's poses", shift("Enter"), needs_confirmed),
    (ResetPose, "reset_pose", Pose, "Reset pose", "Put the selected object back to its start pose", None, needs_selected_pose),
    (StoreReference, "store_reference", Pose, "Store as reference", "Keep this pose to come back to", None, needs_selected_pose),
    (BackToReference, "back_to_reference", Pose, "Back to stored pose", "Return to the pose that was stored", None, needs_stored),
    (CopyFromPrevious, "copy_from_previous", Pose, "Pose from photo before", "Take over the selected objects' poses from the photo before this one", None, needs_photo_before),
    (ToggleNudgeFrame, "toggle_nudge_frame", Pose, "Nudge in object axes", "Nudge along and about the object's axes, or the camera's", key("L"), always),
    (NudgeLeft, "nudge_left", Pose, "Nudge left", "1 px to the left (Shift: 10, Alt: 0.1)", key("ArrowLeft"), needs_selected_pose),
    (NudgeRight, "nudge_right", Pose, "Nudge right", "1 px to the right (Shift: 10, Alt: 0.1)", key("ArrowRight"), needs_selected_pose),
    (NudgeUp, "nudge_up", Pose, "Nudge up", "1 px up (Shift: 10, Alt: 0.1)", key("ArrowUp"), needs_selected_pose),
    (NudgeDown, "nudge_down", Pose, "Nudge down", "1 px down (Shift: 10, Alt: 0.1)", key("ArrowDown"), needs_selected_pose),
    (NudgeNearer, "nudge_nearer", Pose, "Nearer", "1 px wider (Shift: 10, Alt: 0.1)", key("CloseBracket"), needs_selected_pose),
    (NudgeFarther, "nudge_farther", Pose, "Farther", "1 px narrower (Shift: 10, Alt: 0.1)", key("OpenBracket"), needs_selected_pose),
    (PitchForward, "pitch_forward", Pose, "Pitch forward", "1° (Shift: 10°, Alt: 0.1°)", key("W"), needs_selected_pose),
    (PitchBack, "pitch_back", Pose, "Pitch back", "1° (Shift: 10°, Alt: 0.1°)", key("S"), needs_selected_pose),
    (YawLeft, "yaw_left", Pose, "Yaw left", "1° (Shift: 10°, Alt: 0.1°)", key("A"), needs_selected_pose),
    (YawRight, "yaw_right", Pose, "Yaw right", "1° (Shift: 10°, Alt: 0.1°)", key("D"), needs_selected_pose),
    (RollLeft, "roll_left", Pose, "Roll left", "1° (Shift: 10°, Alt: 0.1°)", key("Q"), needs_selected_pose),
    (RollRight, "roll_right", Pose, "Roll right", "1° (Shift: 10°, Alt: 0.1°)", key("E"), needs_selected_pose),
    (Select1, "select_1", Keys, "Select object 1", "Select the first object of this photo", key("1"), needs_objects_here),
    (Select2, "select_2", Keys, "Select object 2", "Select the second object of this photo", key("2"), needs_objects_here),
    (Select3, "select_3", Keys, "Select object 3", "Select the third object of this photo", key("3"), needs_objects_here),
    (Select4, "select_4", Keys, "Select object 4", "Select the fourth object of this photo", key("4"), needs_objects_here),
    (Select5, "select_5", Keys, "Select object 5", "Select the fifth object of this photo", key("5"), needs_objects_here),
    (Select6, "select_6", Keys, "Select object 6", "Select the sixth object of this photo", key("6"), needs_objects_here),
    (Select7, "select_7", Keys, "Select object 7", "Select the seventh object of this photo", key("7"), needs_objects_here),
    (Select8, "select_8", Keys, "Select object 8", "Select the eighth object of this photo", key("8"), needs_objects_here),
    (Select9, "select_9", Keys, "Select object 9", "Select the ninth object of this photo", key("9"), needs_objects_here),
    (BuildStudy, "build_study", Study, "Build a study…", "Choose samples, texts, tools and questions; export a folder for participants", None, needs_content),
    (ChangeStudy, "change_study", Study, "Change a study…", "Choose the zip of an exported study and its true poses, and go on building it", None, always),
    (StudyReport, "study_report", Study, "Report of results…", "A paper's tables and figures from participants' result files", None, always),
    (WatchTrial, "watch_trial", Study, "Watch a trial…", "Choose a study's zip and a participant's results, and watch what was done", None, always),
    (KeptResults, "kept_results", Study, "Results kept here…", "What was done in studies in this browser: download or remove it", None, always),
    (ExampleStudy, "example_study", Study, "Try the example study", "See a study as its participants do", None, always),
    (TogglePalette, "palette", Help, "Find a command…", "Every command by its name", ctrl("K"), always),
    (ToggleShortcuts, "shortcuts", Help, "Mouse and keys", "All gestures and keys on one sheet", key("?"), always),
    (Cancel, "cancel", Edit, "Cancel", "Put back the drag that is under way", key("Escape"), always),
];

impl CommandId {
    /// This command's row of the table.
    pub fn info(self) -> &'static CommandInfo {
        // The macro declares variants and rows together.
        &COMMANDS[self as usize]
    }

    /// The nudge that a command stands for; Shift and Alt make it ten times coarser or finer.
    pub fn nudge(self) -> Option<Nudge> {
        Some(match self {
            Self::NudgeLeft => Nudge::Left,
            Self::NudgeRight => Nudge::Right,
            Self::NudgeUp => Nudge::Up,
            Self::NudgeDown => Nudge::Down,
            Self::NudgeNearer => Nudge::Nearer,
            Self::NudgeFarther => Nudge::Farther,
            Self::PitchForward => Nudge::PitchForward,
            Self::PitchBack => Nudge::PitchBack,
            Self::YawLeft => Nudge::YawLeft,
            Self::YawRight => Nudge::YawRight,
            Self::RollLeft => Nudge::RollLeft,
            Self::RollRight => Nudge::RollRight,
            _ => return None,
        })
    }

    /// The place in the list, from 0, of the object that a command selects.
    pub fn selects(self) -> Option<usize> {
        let number = (self as usize).checked_sub(Self::Select1 as usize)?;
        (number < 9).then_some(number)
    }
}

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
    fn names_and_shortcuts_are_unique() {
        for info in COMMANDS {
            assert_eq!(info.id.info().name, info.name);
            let same = |other: &&CommandInfo| {
                other.name == info.name || (info.shortcut.is_some() && other.shortcut == info.shortcut)
            };
            assert_eq!(COMMANDS.iter().filter(same).count(), 1, "{}", info.name);
        }
    }

    /// A nudge takes Shift and Alt for itself.
    #[test]
    fn no_shortcut_is_a_nudge_with_a_modifier() {
        let nudges = COMMANDS.iter().filter(|info| info.id.nudge().is_some());
        for nudge in nudges.filter_map(|info| info.shortcut) {
            let takes = |info: &CommandInfo| {
                info.shortcut.is_some_and(|other| other.key == nudge.key && !other.ctrl && other != nudge)
            };
            assert!(!COMMANDS.iter().any(takes), "{nudge:?}");
        }
    }
}
