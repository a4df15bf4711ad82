//! Carrying out what the session asks of the world outside.

use super::PinPose;
use crate::interact::{SceneMove, Viewpoint};
use crate::platform;
use crate::scene::ObjectId;
use crate::session::{Effect, Notice, Session};
use crate::ui::Dialog;

impl PinPose {
    pub(super) fn carry_out(&mut self, effect: Effect) {
        match effect {
            Effect::PickFiles(_) => self.loading.pick_files(),
            Effect::LoadExample => self.loading.fetch_example(),
            Effect::Download { file_name, bytes } => {
                if let Err(error) = platform::download(&file_name, &bytes) {
                    self.notify(Notice::error(error));
                }
            }
            Effect::ExportPicture(request) => self.export(request),
            Effect::CopyText(text) => self.ctx.copy_text(text),
            Effect::AskForPose => self.ui_state.open = Some(Dialog::PastePose),
            Effect::NewScene => self.session = Session::default(),
            Effect::ShowScenes | Effect::SaveNow | Effect::AskSaveAs => {}
            Effect::ResetSceneView => self.hands.move_scene(SceneMove::Reset, &self.session),
            Effect::TogglePalette => self.ui_state.toggle(Dialog::Palette),
            Effect::ToggleTheme => {}
            Effect::RenameSelected => {}
            Effect::ZoomToObject => self.show(self.session.selected()),
            Effect::FitPhoto => self.show(None),
            Effect::TogglePanels => self.ui_state.panels_hidden = !self.ui_state.panels_hidden,
            Effect::ToggleShortcuts => self.ui_state.toggle(Dialog::Shortcuts),
            Effect::Notify(notice) => self.notify(notice),
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
