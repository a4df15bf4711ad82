//! What can be changed of photos, objects and masks besides poses.

use std::sync::Arc;

use super::apply::Applied;
use super::{BurstKey, CommandError, Effect, MaskChange, Notice, ObjectChange, PhotoChange, Session};
use crate::math::Pose;
use crate::scene::{Annotation, AnnotationState, DepthMap, MaskId, Object, ObjectId, PhotoAsset, PhotoId};

/// A duplicate is put beside its original by this part of its radius.
const DUPLICATE_OFFSET: f64 = 0.5;

impl Session {
    pub(super) fn edit_photo(&mut self, id: PhotoId, change: PhotoChange, now_ms: f64) -> Applied {
        self.scene.photo(id).ok_or(CommandError::NoPhoto(id))?;
        let label = match change {
            PhotoChange::Name(_) => "Rename photo",
            PhotoChange::Visible(_) => "Show or hide photo",
            PhotoChange::Opacity(_) => "Photo opacity",
            PhotoChange::Locked(_) => "Lock or unlock photo",
            PhotoChange::DepthScale(_) => "Depth map's unit",
            PhotoChange::DepthOccludes(_) => "Hide behind depth map",
            PhotoChange::WithoutDepth => "Remove depth map",
        };
        if let PhotoChange::DepthScale(scale) = change
            && !(scale.is_finite() && scale > 0.0)
        {
            return Err(CommandError::Failed("the depth map's unit has to be above 0 mm".to_owned()));
        }
        let key = BurstKey { label, photo: Some(id), target: id.0 };
        self.change_smoothly(key, now_ms, |scene| {
            let Some(photo) = scene.photo_mut(id) else { return };
            match change {
                PhotoChange::Name(name) => photo.name = name,
                PhotoChange::Visible(visible) => photo.visible = visible,
                PhotoChange::Opacity(opacity) => photo.opacity = opacity.clamp(0.0, 1.0),
                PhotoChange::Locked(locked) => photo.locked = locked,
                PhotoChange::WithoutDepth => photo.depth = None,
                PhotoChange::DepthScale(_) | PhotoChange::DepthOccludes(_) => {
                    if let Some(depth) = &mut photo.depth {
                        change_depth(depth, &change);
                    }
                }
            }
        })
    }

    /// Colour and name are one object's; what concerns how it is shown or held goes for all selected ones if it is among them.
    pub(super) fn edit_object(&mut self, id: ObjectId, change: ObjectChange, now_ms: f64) -> Applied {
        self.scene.object(id).ok_or(CommandError::NoObject(id))?;
        let (label, for_all) = match &change {
            ObjectChange::MeshFrame(frame) => return self.set_mesh_frame(id, *frame),
            ObjectChange::MeshUnit(unit) => return self.set_mesh_unit(id, *unit),
            ObjectChange::UpAxis(axis) => return self.set_up_axis(id, *axis),
            ObjectChange::AddSymmetry(axis) => return self.add_symmetry(id, axis),
            ObjectChange::RemoveSymmetry(axis) => return self.remove_symmetry(id, axis),
            ObjectChange::Name(_) => ("Rename object", false),
            ObjectChange::Color(_) => ("Object colour", false),
            ObjectChange::Opacity(_) => ("Object opacity", true),
            ObjectChange::Visible(_) => ("Show or hide object", true),
            ObjectChange::Locked(_) => ("Lock or unlock object", true),
        };
        let ids = if for_all && self.is_selected(id) { self.selection() } else { vec![id] };
        let key = BurstKey { label, photo: None, target: id.0 };
        self.change_smoothly(key, now_ms, |scene| {
            for object in scene.objects.iter_mut().filter(|object| ids.contains(&object.id)) {
                change_object(object, &change);
            }
        })
    }

    pub(super) fn edit_mask(&mut self, id: MaskId, change: MaskChange, now_ms: f64) -> Applied {
        let photo = self.scene.mask(id).ok_or(CommandError::NoMask(id))?.photo;
        let label = match change {
            MaskChange::Name(_) => "Rename mask",
            MaskChange::Color(_) => "Mask colour",
            MaskChange::Opacity(_) => "Mask opacity",
            MaskChange::Visible(_) => "Show or hide mask",
            MaskChange::Object(_) => "Mask's object",
        };
        let key = BurstKey { label, photo: Some(photo), target: id.0 };
        self.change_smoothly(key, now_ms, |scene| {
            let Some(mask) = scene.masks.iter_mut().find(|mask| mask.id == id) else { return };
            match change {
                MaskChange::Name(name) => mask.name = name,
                MaskChange::Color(color) => mask.color = color,
                MaskChange::Opacity(opacity) => mask.opacity = opacity.clamp(0.0, 1.0),
                MaskChange::Visible(visible) => mask.visible = visible,
                MaskChange::Object(object) => mask.object = object,
            }
        })
    }

    /// Nothing says what a step of it is; most are in millimetres.
    pub(super) fn import_depth(&mut self, image: Arc<PhotoAsset>) -> Applied {
        let photo = self.photo().ok_or(CommandError::NotAvailable("Import depth map", "no photo is open"))?;
        let (id, width, height) = (photo.id, photo.asset.width, photo.asset.height);
        if (image.width, image.height) != (width, height) {
            return Err(CommandError::Failed(format!(
                "{}: a depth map of the photo's size, {width} × {height} pixels, expected; this has {} × {}",
                image.file_name, image.width, image.height
            )));
        }
        let known_scale = photo.depth.as_ref().map(|depth| depth.mm_per_unit);
        let depth = DepthMap { asset: image, mm_per_unit: known_scale.unwrap_or(1.0), occludes: true };
        self.change("Import depth map", |scene| {
            if let Some(photo) = scene.photo_mut(id) {
                photo.depth = Some(depth);
            }
        })
    }

    pub(super) fn import_masks(&mut self, images: &[Arc<PhotoAsset>]) -> Applied {
        let photo = self.photo().ok_or(CommandError::NotAvailable("Import mask", "no photo is open"))?;
        let (id, size) = (photo.id, (photo.asset.width, photo.asset.height));
        let object = self.selected_annotation().map(|(_, object, _)| object);
        let (fitting, others): (Vec<_>, Vec<_>) =
            images.iter().partition(|image| (image.width, image.height) == size);
        self.change("Import masks", |scene| {
            for image in fitting {
                scene.add_mask(id, object, image.clone());
            }
        })?;
        let refused = |image: &Arc<PhotoAsset>| {
            Effect::Notify(Notice::error(format!(
                "{}: a mask of the photo's size, {} × {} pixels, expected; this has {} × {}",
                image.file_name, size.0, size.1, image.width, image.height
            )))
        };
        Ok(others.into_iter().map(refused).collect())
    }

    /// Another object of the same mesh, beside the selected one, in the photo that is shown.
    pub(super) fn duplicate_selected(&mut self, now_ms: f64) -> Applied {
        let Some((photo, object, annotation)) = self.selected_annotation() else { return Ok(Vec::new()) };
        let radius_mm = self.scene.object(object).map_or(0.0, |object| object.mesh.mesh.sphere().radius);
        let pose: Pose =
            annotation.camera_from_object.translated(glam::DVec3::X * radius_mm * DUPLICATE_OFFSET);
        let beside = Annotation {
            camera_from_object: pose,
            state: AnnotationState::Carried,
            changed_at_ms: now_ms,
            pins: Vec::new(),
            ..annotation.clone()
        };
        let mut copy = None;
        self.change("Duplicate object", |scene| {
            copy = scene.duplicate_object(object);
            if let Some(copy) = copy {
                scene.annotations.insert((photo, copy), beside);
            }
        })?;
        self.select(copy)
    }

    pub(super) fn link_selected(&mut self) -> Applied {
        let selection = self.selection();
        self.change("Link objects", |scene| scene.link(&selection))
    }

    pub(super) fn unlink_selected(&mut self) -> Applied {
        let selection = self.selection();
        self.change("Unlink objects", |scene| {
            scene.unlink(&selection);
        })
    }
}

fn change_depth(depth: &mut DepthMap, change: &PhotoChange) {
    match change {
        PhotoChange::DepthScale(mm_per_unit) => depth.mm_per_unit = *mm_per_unit,
        PhotoChange::DepthOccludes(occludes) => depth.occludes = *occludes,
        _ => {}
    }
}

fn change_object(object: &mut Object, change: &ObjectChange) {
    match change {
        ObjectChange::Name(name) => object.name.clone_from(name),
        ObjectChange::Color(color) => object.color = *color,
        ObjectChange::Opacity(opacity) => object.opacity = opacity.clamp(0.0, 1.0),
        ObjectChange::Visible(visible) => object.visible = *visible,
        ObjectChange::Locked(locked) => object.locked = *locked,
        ObjectChange::MeshFrame(_)
        | ObjectChange::MeshUnit(_)
        | ObjectChange::UpAxis(_)
        | ObjectChange::AddSymmetry(_)
        | ObjectChange::RemoveSymmetry(_) => {}
    }
}
