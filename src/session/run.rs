//! The commands of the table.

use super::apply::Applied;
use super::pose::STORED;
use super::{Arrangement, Command, CommandError, CommandId, Effect, NudgeFrame, Pick, Session, Tool};
use crate::formats::PoseText;
use crate::scene::{Layers, Look};
use crate::solve::snap::SnapReach;

/// Where the wipe's line is when it is switched on.
const WIPE_START: f32 = 0.5;

impl Session {
    pub(super) fn run(&mut self, id: CommandId, now_ms: f64) -> Applied {
        if let Some(reason) = self.unavailable(id) {
            return Err(CommandError::NotAvailable(id.info().text, reason));
        }
        if let Some(nudge) = id.nudge() {
            return self.nudge(nudge, 1.0, now_ms);
        }
        if let Some(number) = id.selects() {
            return self.select_number(number);
        }
        if let Some(effect) = effect_of(id) {
            return Ok(vec![effect]);
        }
        match id {
            CommandId::ExportPoses => self.export_poses(),
            CommandId::ExportWorkspace => self.export_workspace(),
            CommandId::ExportMesh => self.export_mesh(),
            CommandId::ExportOverlay
            | CommandId::ExportMask
            | CommandId::ExportVisibleMask
            | CommandId::ExportDepth => self.export_picture(id),
            CommandId::Undo => Ok(self.undo()),
            CommandId::Redo => Ok(self.redo()),
            CommandId::CopyPose => self.copy_pose(PoseText::Matrix),
            CommandId::CopyPoseNumPy => self.copy_pose(PoseText::NumPy),
            CommandId::CopyPoseJson => self.copy_pose(PoseText::Json),
            CommandId::SelectAll => Ok(self.select_all()),
            CommandId::DuplicateObject => self.duplicate_selected(now_ms),
            CommandId::LinkObjects => self.link_selected(),
            CommandId::UnlinkObjects => self.unlink_selected(),
            CommandId::RemoveObject => self.remove_selected(),
            CommandId::RemovePhoto => match self.photo {
                Some(photo) => self.apply(Command::RemovePhoto(photo), now_ms),
                None => Ok(Vec::new()),
            },
            CommandId::ClearLog => Ok(self.clear_log()),
            CommandId::NextPhoto => self.step_photo(1),
            CommandId::PreviousPhoto => self.step_photo(-1),
            CommandId::MoveTool => self.apply(Command::SetTool(Tool::Move), now_ms),
            CommandId::RotateTool => self.apply(Command::SetTool(Tool::Rotate), now_ms),
            CommandId::PinTool => self.apply(Command::SetTool(Tool::Pin), now_ms),
            CommandId::Snap => self.ask_snap(SnapReach::Near),
            CommandId::SnapWide => self.ask_snap(SnapReach::Wide),
            CommandId::SnapAll => self.ask_snap_all(),
            CommandId::SolvePins => self.solve_selected(now_ms),
            CommandId::FocalFromPins => self.focal_from_pins(now_ms),
            CommandId::ClearPins => self.clear_pins(),
            CommandId::CopyPinsToNext => self.copy_pins_to_next(now_ms),
            CommandId::ExportPins => self.export_pins(),
            CommandId::FindSymmetries => self.ask_symmetries(),
            CommandId::ConfirmAndNext => self.confirm_and_next(now_ms),
            CommandId::Reopen => self.reopen(),
            CommandId::ResetPose => self.reset_pose(now_ms),
            CommandId::StoreReference => self.store_reference(),
            CommandId::BackToReference => self.set_pose_from_reference(STORED, now_ms),
            CommandId::CopyFromPrevious => self.copy_from_previous(now_ms),
            CommandId::Cancel => self.apply(Command::CancelGesture, now_ms),
            _ => Ok(self.change_view(id)),
        }
    }

    /// Commands that change how the scene is looked at.
    fn change_view(&mut self, id: CommandId) -> Vec<Effect> {
        let Look { mode, outline, x_ray, layers, wipe, difference, .. } = self.look;
        match id {
            CommandId::CycleViews => self.panes.arrangement = self.panes.arrangement.next(),
            CommandId::PhotoView => self.panes.arrangement = Arrangement::Photo,
            CommandId::SceneView => self.panes.arrangement = Arrangement::Scene,
            CommandId::SplitView => self.panes.arrangement = Arrangement::Split,
            CommandId::NextOverlay => self.look.mode = mode.next(),
            CommandId::ToggleOverlay => {
                let hidden = layers == Layers::PhotoOnly;
                self.look.layers = if hidden { Layers::Both } else { Layers::PhotoOnly };
            }
            CommandId::NextLayers => self.look.layers = layers.next(),
            CommandId::ToggleOutline => self.look.outline = !outline,
            CommandId::ToggleXRay => self.look.x_ray = !x_ray,
            CommandId::ToggleWipe => self.look.wipe = wipe.is_none().then_some(WIPE_START),
            CommandId::ToggleDifference => self.look.difference = !difference,
            CommandId::ToggleGizmo => self.panes.gizmo = !self.panes.gizmo,
            CommandId::ToggleNudgeFrame => {
                self.nudge.frame = match self.nudge.frame {
                    NudgeFrame::Camera => NudgeFrame::Object,
                    NudgeFrame::Object => NudgeFrame::Camera,
                };
            }
            _ => debug_assert!(false, "{id:?} is answered elsewhere"),
        }
        self.touched();
        Vec::new()
    }

    pub(super) fn undo(&mut self) -> Vec<Effect> {
        self.finish_gesture();
        let present = self.snapshot();
        if let Some(before) = self.history.undo(present) {
            self.restore(before);
        }
        Vec::new()
    }

    fn redo(&mut self) -> Vec<Effect> {
        self.finish_gesture();
        let present = self.snapshot();
        if let Some(after) = self.history.redo(present) {
            self.restore(after);
        }
        Vec::new()
    }

    fn step_photo(&mut self, step: isize) -> Applied {
        let photos = &self.scene.photos;
        let shown = photos.iter().position(|photo| Some(photo.id) == self.photo).unwrap_or(0);
        let next = shown.saturating_add_signed(step).min(photos.len().saturating_sub(1));
        match photos.get(next).map(|photo| photo.id) {
            Some(photo) => self.show_photo(photo),
            None => Ok(Vec::new()),
        }
    }

    fn copy_from_previous(&mut self, now_ms: f64) -> Applied {
        let photos = &self.scene.photos;
        let shown = photos.iter().position(|photo| Some(photo.id) == self.photo);
        let before = shown.and_then(|shown| photos.get(shown.checked_sub(1)?)).map(|photo| photo.id);
        match before {
            Some(before) => self.copy_poses_from(before, now_ms),
            None => Ok(Vec::new()),
        }
    }

    fn select_number(&mut self, number: usize) -> Applied {
        let Some(photo) = self.photo else { return Ok(Vec::new()) };
        let object = self.scene.objects_in(photo).nth(number).map(|(object, _)| object.id);
        match object {
            Some(object) => self.select(Some(object)),
            None => Ok(Vec::new()),
        }
    }

    fn select_all(&mut self) -> Vec<Effect> {
        let Some(photo) = self.photo else { return Vec::new() };
        self.also_selected = self.scene.objects_in(photo).map(|(object, _)| object.id).collect();
        let present = self.selected.filter(|selected| self.also_selected.contains(selected));
        self.selected = present.or_else(|| self.also_selected.first().copied());
        if let Some(selected) = self.selected {
            self.also_selected.remove(&selected);
        }
        self.touched();
        Vec::new()
    }

    fn remove_selected(&mut self) -> Applied {
        let selection = self.selection();
        self.change("Remove object", |scene| selection.iter().for_each(|id| scene.remove_object(*id)))
    }

    fn clear_log(&mut self) -> Vec<Effect> {
        self.finish_gesture();
        let before = self.snapshot();
        self.log.clear();
        self.history.push("Clear history list", before);
        Vec::new()
    }
}

impl Session {
    /// Of a command that switches something: whether it is on.
    pub fn is_on(&self, id: CommandId) -> bool {
        let look = self.look();
        match id {
            CommandId::PhotoView => self.panes.arrangement == Arrangement::Photo,
            CommandId::SceneView => self.panes.arrangement == Arrangement::Scene,
            CommandId::SplitView => self.panes.arrangement == Arrangement::Split,
            CommandId::ToggleOutline => look.outline,
            CommandId::ToggleXRay => look.x_ray,
            CommandId::ToggleWipe => look.wipe.is_some(),
            CommandId::ToggleDifference => look.difference,
            CommandId::ToggleGizmo => self.panes.gizmo,
            CommandId::MoveTool => self.tool() == Tool::Move,
            CommandId::RotateTool => self.tool() == Tool::Rotate,
            CommandId::PinTool => self.tool() == Tool::Pin,
            CommandId::ToggleNudgeFrame => self.nudge_settings().frame == NudgeFrame::Object,
            _ => false,
        }
    }
}

/// What only the world outside can do.
fn effect_of(id: CommandId) -> Option<Effect> {
    Some(match id {
        CommandId::OpenFiles => Effect::PickFiles(Pick::Anything),
        CommandId::OpenFolder => Effect::PickFolder,
        CommandId::ImportPhotos => Effect::PickFiles(Pick::Photos),
        CommandId::ImportMeshes => Effect::PickFiles(Pick::Meshes),
        CommandId::ImportMasks => Effect::PickFiles(Pick::Masks),
        CommandId::ImportDepth => Effect::PickFiles(Pick::DepthMap),
        CommandId::ImportCamera => Effect::PickFiles(Pick::Cameras),
        CommandId::ImportPoses => Effect::PickFiles(Pick::Poses),
        CommandId::OpenWorkspace => Effect::PickFiles(Pick::Workspace),
        CommandId::LoadExample => Effect::LoadExample,
        CommandId::NewScene => Effect::NewScene,
        CommandId::OpenScene => Effect::ShowScenes,
        CommandId::SaveScene => Effect::SaveNow,
        CommandId::SaveSceneAs => Effect::AskSaveAs,
        CommandId::PastePose => Effect::AskForPose,
        CommandId::ExportFiles => Effect::AskForExport,
        CommandId::BuildStudy => Effect::BuildStudy,
        CommandId::ExampleStudy => Effect::ShowExampleStudy,
        CommandId::ChangeStudy => Effect::PickStudy,
        CommandId::StudyReport => Effect::ShowStudyReport,
        CommandId::KeptResults => Effect::ShowKeptResults,
        CommandId::WatchTrial => Effect::PickResults,
        CommandId::RenameObject => Effect::RenameSelected,
        CommandId::ZoomToObject => Effect::ZoomToObject,
        CommandId::FitPhoto => Effect::FitPhoto,
        CommandId::ResetSceneView => Effect::ResetSceneView,
        CommandId::TogglePanels => Effect::TogglePanels,
        CommandId::ToggleTheme => Effect::ToggleTheme,
        CommandId::TogglePalette => Effect::TogglePalette,
        CommandId::ToggleShortcuts => Effect::ToggleShortcuts,
        _ => return None,
    })
}
