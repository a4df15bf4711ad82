//! The menus: the command table in groups.

use egui::{Button, Ui};

use super::command_button::command_item;
use super::scenes_dialog::words;
use super::{Asked, Preferences, SceneRequest, Surroundings, ThemeChoice, once};
use crate::session::{CommandId, Session};

/// What a menu has between two lines.
type Group = &'static [CommandId];

pub struct MenuPlan {
    pub title: &'static str,
    pub groups: &'static [Group],
}

/// Every command of the table, but those that are keys alone.
pub const MENUS: [MenuPlan; 6] = [
    MenuPlan {
        title: "File",
        groups: &[
            &[CommandId::NewScene, CommandId::OpenScene, CommandId::SaveScene, CommandId::SaveSceneAs],
            &[CommandId::OpenFiles, CommandId::OpenFolder],
            &[
                CommandId::ImportPhotos,
                CommandId::ImportMeshes,
                CommandId::ImportMasks,
                CommandId::ImportDepth,
                CommandId::ImportCamera,
                CommandId::ImportPoses,
                CommandId::OpenWorkspace,
            ],
            &[
                CommandId::ExportFiles,
                CommandId::ExportPoses,
                CommandId::ExportOverlay,
                CommandId::ExportMask,
                CommandId::ExportVisibleMask,
                CommandId::ExportDepth,
                CommandId::ExportMesh,
                CommandId::ExportWorkspace,
            ],
            &[CommandId::LoadExample],
        ],
    },
    MenuPlan {
        title: "Edit",
        groups: &[
            &[CommandId::Undo, CommandId::Redo, CommandId::Cancel],
            &[CommandId::CopyPose, CommandId::CopyPoseNumPy, CommandId::CopyPoseJson, CommandId::PastePose],
            &[
                CommandId::SelectAll,
                CommandId::DuplicateObject,
                CommandId::LinkObjects,
                CommandId::UnlinkObjects,
                CommandId::RenameObject,
            ],
            &[CommandId::RemoveObject, CommandId::RemovePhoto, CommandId::ClearLog],
        ],
    },
    MenuPlan {
        title: "View",
        groups: &[
            &[CommandId::CycleViews, CommandId::PhotoView, CommandId::SceneView, CommandId::SplitView],
            &[CommandId::ZoomToObject, CommandId::FitPhoto, CommandId::ResetSceneView],
            &[CommandId::NextPhoto, CommandId::PreviousPhoto],
            &[
                CommandId::NextOverlay,
                CommandId::ToggleOverlay,
                CommandId::NextLayers,
                CommandId::ToggleOutline,
                CommandId::ToggleXRay,
                CommandId::ToggleWipe,
                CommandId::ToggleDifference,
                CommandId::ToggleGizmo,
            ],
            &[CommandId::TogglePanels, CommandId::ToggleTheme],
        ],
    },
    MenuPlan {
        title: "Pose",
        groups: &[
            &[CommandId::MoveTool, CommandId::RotateTool, CommandId::PinTool],
            &[
                CommandId::Snap,
                CommandId::SnapWide,
                CommandId::SnapAll,
                CommandId::FindSymmetries,
                CommandId::SolvePins,
                CommandId::FocalFromPins,
                CommandId::ClearPins,
                CommandId::CopyPinsToNext,
                CommandId::ExportPins,
            ],
            &[CommandId::ConfirmAndNext, CommandId::Reopen],
            &[
                CommandId::ResetPose,
                CommandId::StoreReference,
                CommandId::BackToReference,
                CommandId::CopyFromPrevious,
            ],
            NUDGES,
        ],
    },
    MenuPlan {
        title: "Study",
        groups: &[
            &[CommandId::BuildStudy, CommandId::ChangeStudy],
            &[CommandId::StudyReport, CommandId::WatchTrial, CommandId::KeptResults],
            &[CommandId::ExampleStudy],
        ],
    },
    MenuPlan { title: "Help", groups: &[&[CommandId::TogglePalette, CommandId::ToggleShortcuts]] },
];

/// A menu of their own: they are for keys, and here to be found.
pub const NUDGES: Group = &[
    CommandId::ToggleNudgeFrame,
    CommandId::NudgeLeft,
    CommandId::NudgeRight,
    CommandId::NudgeUp,
    CommandId::NudgeDown,
    CommandId::NudgeNearer,
    CommandId::NudgeFarther,
    CommandId::PitchForward,
    CommandId::PitchBack,
    CommandId::YawLeft,
    CommandId::YawRight,
    CommandId::RollLeft,
    CommandId::RollRight,
];

/// The menu that a command is in; nothing for those that are keys alone.
pub fn menu_of(id: CommandId) -> Option<&'static str> {
    let has = |plan: &&MenuPlan| plan.groups.iter().any(|group| group.contains(&id));
    MENUS.iter().find(has).map(|plan| plan.title)
}

pub fn draw(
    ui: &mut Ui,
    plan: &MenuPlan,
    session: &Session,
    around: &Surroundings<'_>,
    preferences: &mut Preferences,
    asked: &mut Asked,
) {
    ui.set_min_width(240.0);
    let height = ui.ctx().content_rect().height() - 64.0;
    // Scrolls in windows that are too low for it alone.
    egui::ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
        for (index, group) in plan.groups.iter().enumerate() {
            if index > 0 {
                ui.separator();
            }
            if *group == NUDGES {
                once::menu(ui, "Nudge", |ui| {
                    ui.set_min_width(220.0);
                    items(ui, group, session, asked);
                });
            } else {
                items(ui, group, session, asked);
            }
            if group.contains(&CommandId::SaveSceneAs) {
                recent_scenes(ui, around, asked);
            }
            if group.contains(&CommandId::ToggleTheme) {
                themes(ui, preferences);
            }
        }
    });
}

fn items(ui: &mut Ui, group: Group, session: &Session, asked: &mut Asked) {
    for id in group {
        command_item(ui, session, *id, None, &mut asked.commands);
    }
}

fn recent_scenes(ui: &mut Ui, around: &Surroundings<'_>, asked: &mut Asked) {
    const MOST: usize = 8;
    let others = || around.scenes.iter().filter(|scene| around.store.open_scene != Some(&scene.id));
    if others().next().is_none() {
        ui.add_enabled(false, Button::new("Recent scenes"))
            .on_disabled_hover_text("No other scene is kept in this browser");
        return;
    }
    once::menu(ui, "Recent scenes", |ui| {
        ui.set_min_width(260.0);
        for scene in others().take(MOST) {
            let when = words::when_text(scene.heading.changed_at_ms, around.store.now_ms);
            let button = Button::new(scene.heading.title()).truncate().shortcut_text(when);
            if ui.add(button).clicked() {
                asked.scene_requests.push(SceneRequest::Open(scene.id.clone()));
                ui.close();
            }
        }
    });
}

fn themes(ui: &mut Ui, preferences: &mut Preferences) {
    once::menu(ui, "Theme", |ui| {
        for (theme, title) in ThemeChoice::ALL {
            if ui.radio_value(&mut preferences.theme, theme, title).clicked() {
                ui.close();
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{COMMANDS, Menu};

    #[test]
    fn every_command_of_the_table_is_in_its_menu_once() {
        for info in COMMANDS {
            let places =
                MENUS.iter().flat_map(|plan| plan.groups.iter().map(move |group| (plan.title, group)));
            let places: Vec<&str> =
                places.filter(|(_, group)| group.contains(&info.id)).map(|(title, _)| title).collect();
            let expected = match info.menu {
                Menu::Keys => Vec::new(),
                menu => vec![format!("{menu:?}")],
            };
            assert_eq!(places, expected, "{}", info.name);
        }
    }
}
