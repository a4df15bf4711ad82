//! Carrying out what the session asks of the world outside.

use super::PinPose;
use crate::interact::object_rect;
use crate::platform;
use crate::session::{Effect, Notice};

impl PinPose {
    pub(super) fn carry_out(&mut self, effect: Effect) {
        match effect {
            Effect::PickFiles(pick) => self.loading.pick_files(pick),
            Effect::LoadExample => self.loading.fetch_example(),
            Effect::Download { file_name, bytes } => {
                if let Err(error) = platform::download(&file_name, &bytes) {
                    self.notify(Notice::error(error));
                }
            }
            Effect::ExportPicture(request) => self.export(request),
            Effect::CopyText(text) => self.ctx.copy_text(text),
            Effect::NewScene => self.new_scene(),
            Effect::ShowScenes => self.show_scenes(),
            Effect::SaveNow => self.save_now(),
            Effect::AskSaveAs => self.ask_save_as(),
            Effect::RenameSelected => self.ui_state.rename_selected(&self.session),
            Effect::ZoomToObject => self.zoom_to_object(),
            Effect::FitPhoto => self.view.fit(),
            Effect::Notify(notice) => self.notify(notice),
            effect => {
                let ctx = self.ctx.clone();
                if let Some(left) = self.ui_state.take_effect(effect, &ctx) {
                    log::debug!("{left:?} is not carried out");
                }
            }
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
