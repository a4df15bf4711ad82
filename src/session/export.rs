//! Files that the session makes of itself.

use std::sync::Arc;

use super::apply::Applied;
use super::{CommandError, CommandId, Effect, Notice, PictureKind, PictureRequest, Session};
use crate::formats::export::safe_file_name;
use crate::formats::{Keep, PoseText, write_document, write_pose_text, write_workspace};

impl Session {
    pub(super) fn export_poses(&self) -> Applied {
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

    pub(super) fn export_workspace(&self) -> Applied {
        let document = self.document(Keep::Everything);
        let bytes = write_workspace(&document, &self.scene)
            .map_err(|error| CommandError::Failed(error.to_string()))?;
        let file_name = format!("{}.zip", self.file_stem("workspace"));
        Ok(vec![Effect::Download { file_name, bytes: Arc::from(bytes) }])
    }

    /// The selected object's mesh after mirror and spacing, still in the `object` frame.
    pub(super) fn export_mesh(&self) -> Applied {
        let Some(object) = self.selected.and_then(|id| self.scene.object(id)) else { return Ok(Vec::new()) };
        let file_name = format!("{}.ply", safe_file_name(&object.name));
        let bytes = crate::mesh::write_ply(&object.mesh.mesh);
        Ok(vec![Effect::Download { file_name, bytes: Arc::from(bytes) }])
    }

    pub(super) fn export_picture(&self, id: CommandId) -> Applied {
        let Some(photo) = self.photo() else { return Ok(Vec::new()) };
        let (kind, suffix) = match id {
            CommandId::ExportMask => (PictureKind::Mask, "mask"),
            CommandId::ExportVisibleMask => (PictureKind::VisibleMask, "mask_visib"),
            CommandId::ExportDepth => (PictureKind::Depth, "depth"),
            _ => (PictureKind::Overlay, "overlay"),
        };
        let of_one_object = matches!(kind, PictureKind::Mask | PictureKind::VisibleMask);
        let object = self.selected.filter(|_| of_one_object);
        let mut stem = safe_file_name(crate::scene::file_stem(&photo.name));
        if let Some(object) = object.and_then(|id| self.scene.object(id)) {
            stem += &format!("-{}", safe_file_name(&object.name));
        }
        let request =
            PictureRequest { kind, photo: photo.id, object, file_name: format!("{stem}-{suffix}.png") };
        Ok(vec![Effect::ExportPicture(request)])
    }

    pub(super) fn copy_pose(&self, style: PoseText) -> Applied {
        let Some((_, _, annotation)) = self.selected_annotation() else { return Ok(Vec::new()) };
        Ok(vec![
            Effect::CopyText(write_pose_text(&annotation.camera_from_object, style)),
            Effect::Notify(Notice::info("The pose is in the clipboard: camera_from_object, mm, row by row")),
        ])
    }

    /// The scene's name, else the only photo's, else `otherwise`: what a person looks for among downloads.
    fn file_stem(&self, otherwise: &str) -> String {
        let name = match self.scene.photos.as_slice() {
            _ if !self.scene.name.is_empty() => self.scene.name.as_str(),
            [photo] => crate::scene::file_stem(&photo.name),
            _ => return format!("pinpose-{otherwise}"),
        };
        format!("{}-{otherwise}", safe_file_name(name))
    }
}
