//! The commands of the table.

use std::sync::Arc;

use super::{CommandError, CommandId, Effect, Notice, Session, Tool};
use crate::formats::{Keep, write_document, write_workspace};
use crate::scene::{Annotation, Scene, untouched_pose};

type Applied = Result<Vec<Effect>, CommandError>;

impl Session {
    pub(super) fn run(&mut self, id: CommandId, now_ms: f64) -> Applied {
        if let Some(reason) = self.unavailable(id) {
            return Err(CommandError::NotAvailable(id.info().text, reason));
        }
        match id {
            CommandId::OpenFiles => Ok(vec![Effect::PickFiles]),
            CommandId::LoadExample => Ok(vec![Effect::LoadExample]),
            CommandId::ZoomToObject => Ok(vec![Effect::ZoomToObject]),
            CommandId::FitPhoto => Ok(vec![Effect::FitPhoto]),
            CommandId::TogglePanels => Ok(vec![Effect::TogglePanels]),
            CommandId::ToggleShortcuts => Ok(vec![Effect::ToggleShortcuts]),
            CommandId::SavePoses => self.save_poses(),
            CommandId::SaveWorkspace => self.save_workspace(),
            CommandId::NewScene => self.new_scene(),
            CommandId::Undo => self.undo(),
            CommandId::Redo => self.redo(),
            CommandId::NextPhoto => self.step_photo(1),
            CommandId::PreviousPhoto => self.step_photo(-1),
            CommandId::ResetPose => self.reset_pose(now_ms),
            CommandId::Cancel => self.apply(super::Command::CancelGesture, now_ms),
            CommandId::RemoveObject | CommandId::RemovePhoto => self.remove_shown(id, now_ms),
            CommandId::MoveTool => self.apply(super::Command::SetTool(Tool::Move), now_ms),
            CommandId::RotateTool => self.apply(super::Command::SetTool(Tool::Rotate), now_ms),
            CommandId::ToggleOutline => {
                self.look.outline = !self.look.outline;
                self.touched();
                Ok(Vec::new())
            }
        }
    }

    fn save_poses(&mut self) -> Applied {
        let document = self.document(Keep::Annotated);
        let count = document.pose_count();
        let file_name = format!("{}.json", self.file_stem("poses"));
        let notice = match count {
            0 => {
                Notice::warning(format!("{file_name}: no object has been posed yet, the file holds no poses"))
            }
            1 => Notice::info(format!("{file_name}: 1 pose saved")),
            _ => Notice::info(format!("{file_name}: {count} poses saved")),
        };
        let bytes = Arc::from(write_document(&document).into_bytes());
        Ok(vec![Effect::Download { file_name, bytes }, Effect::Notify(notice)])
    }

    fn save_workspace(&mut self) -> Applied {
        let document = self.document(Keep::Everything);
        let bytes = write_workspace(&document, &self.scene)
            .map_err(|error| CommandError::Failed(error.to_string()))?;
        let file_name = format!("{}.zip", self.file_stem("workspace"));
        Ok(vec![Effect::Download { file_name, bytes: Arc::from(bytes) }])
    }

    /// The scene's name, else the only photo's, else `otherwise`: what a person looks for among downloads.
    fn file_stem(&self, otherwise: &str) -> String {
        let name = match self.scene.photos.as_slice() {
            _ if !self.scene.name.is_empty() => self.scene.name.as_str(),
            [photo] => crate::scene::file_stem(&photo.asset.file_name),
            _ => return format!("pinpose-{otherwise}"),
        };
        let safe: String =
            name.chars().map(|c| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' }).collect();
        format!("{safe}-{otherwise}")
    }

    fn new_scene(&mut self) -> Applied {
        self.questions.clear();
        self.waiting.clear();
        self.change("New scene", |scene| *scene = Scene::default())
    }

    fn undo(&mut self) -> Applied {
        self.finish_gesture();
        let present = self.snapshot();
        if let Some(before) = self.history.undo(present) {
            self.restore(before);
        }
        Ok(Vec::new())
    }

    fn redo(&mut self) -> Applied {
        self.finish_gesture();
        let present = self.snapshot();
        if let Some(after) = self.history.redo(present) {
            self.restore(after);
        }
        Ok(Vec::new())
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

    fn reset_pose(&mut self, now_ms: f64) -> Applied {
        let Some((photo, object, _)) = self.selected_annotation() else { return Ok(Vec::new()) };
        let start = self.photo().zip(self.scene.object(object));
        let Some(pose) = start.map(|(photo, object)| untouched_pose(&photo.camera, &object.mesh.mesh)) else {
            return Ok(Vec::new());
        };
        self.change("Reset pose", |scene| {
            scene.annotations.insert((photo, object), Annotation::untouched(pose, now_ms));
        })
    }

    fn remove_shown(&mut self, id: CommandId, now_ms: f64) -> Applied {
        match (id, self.photo, self.selected) {
            (CommandId::RemovePhoto, Some(photo), _) => {
                self.apply(super::Command::RemovePhoto(photo), now_ms)
            }
            (CommandId::RemoveObject, _, Some(object)) => {
                self.apply(super::Command::RemoveObject(object), now_ms)
            }
            _ => Ok(Vec::new()),
        }
    }
}
