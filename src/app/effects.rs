//! Carrying out what the session asks of the world outside.

use super::PinPose;
use crate::interact::{SceneMove, Viewpoint};
use crate::platform;
use crate::scene::ObjectId;
use crate::session::{Effect, Notice};

impl PinPose {
    pub(super) fn carry_out(&mut self, effect: Effect) {
        match effect {
            Effect::PickFiles(pick) => self.loading.pick_files(pick),
            Effect::PickFolder => self.datasets.pick_folder(),
            Effect::LoadExample => self.loading.fetch_example(),
            Effect::Download { file_name, bytes } => {
                if let Err(error) = platform::download(&file_name, &bytes) {
                    self.notify(Notice::error(error));
                }
            }
            Effect::ExportPicture(request) => self.export(request),
            Effect::Snap { photo, object, reach } => self.start_snap(photo, object, reach),
            Effect::SnapAll(targets) => self.start_batch(targets),
            Effect::FindSymmetries(object) => self.find_symmetries(object),
            Effect::ShowExampleStudy => self.fetch_example_study(),
            Effect::PickStudy => self.pick_study(),
            Effect::ShowKeptResults => self.show_kept(),
            Effect::ShowStudyReport => self.show_report(),
            Effect::PickResults => self.pick_results(),
            Effect::CopyText(text) => self.ctx.copy_text(text),
            Effect::NewScene => self.new_scene(),
            Effect::ShowScenes => self.show_scenes(),
            Effect::SaveNow => self.save_now(),
            Effect::AskSaveAs => self.ask_save_as(),
            Effect::ResetSceneView => self.hands.move_scene(SceneMove::Reset, &self.session),
            Effect::RenameSelected => self.ui_state.rename_selected(&self.session),
            Effect::ZoomToObject => self.show(self.session.selected()),
            Effect::FitPhoto => self.show(None),
            Effect::Notify(notice) => self.notify(notice),
            Effect::AskForPose
            | Effect::AskForExport
            | Effect::BuildStudy
            | Effect::TogglePalette
            | Effect::ToggleShortcuts
            | Effect::TogglePanels
            | Effect::ToggleTheme => {
                self.ui_state.take_effect(effect, &self.ctx);
            }
        }
    }

    /// Shows an object, or everything, in the views that are on screen.
    fn show(&mut self, object: Option<ObjectId>) {
        let arrangement = self.session.panes().arrangement;
        if arrangement.shows_photo() {
            Viewpoint::show(&mut self.hands.photo_view, &self.session, object);
        }
        if arrangement.shows_scene() {
            self.hands.scene_view.show(&self.session, object);
        }
    }
}
