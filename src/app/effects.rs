//! Carrying out what the session asks of the world outside.

use super::PinPose;
use crate::interact::object_rect;
use crate::platform;
use crate::session::{Effect, Notice};
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
            Effect::NewScene => self.new_scene(),
            Effect::ShowScenes => self.show_scenes(),
            Effect::SaveNow => self.save_now(),
            Effect::AskSaveAs => self.ask_save_as(),
            Effect::ResetSceneView => {}
            Effect::TogglePalette => self.ui_state.toggle(Dialog::Palette),
            Effect::ToggleTheme => {}
            Effect::RenameSelected => {}
            Effect::ZoomToObject => self.zoom_to_object(),
            Effect::FitPhoto => self.view.fit(),
            Effect::TogglePanels => self.ui_state.panels_hidden = !self.ui_state.panels_hidden,
            Effect::ToggleShortcuts => self.ui_state.toggle(Dialog::Shortcuts),
            Effect::Notify(notice) => self.notify(notice),
        }
    }

    fn zoom_to_object(&mut self) {
        let selected = self.session.selected_annotation();
        let rect = selected.and_then(|(photo, object, _)| object_rect(self.session.scene(), photo, object));
        if let Some(rect) = rect {
            self.view.show(&rect);
        }
    }
}
