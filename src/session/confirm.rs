//! Confirming a photo's poses, and carrying them to the next photo of a sequence.

use super::apply::Applied;
use super::{Effect, Notice, Session};
use crate::scene::{Annotation, AnnotationState, ObjectId, PhotoId, Scene};

impl Session {
    /// Confirms every pose of the shown photo that somebody has looked at, carries them to the next photo where that is
    /// untouched, and shows it.
    pub(super) fn confirm_and_next(&mut self, now_ms: f64) -> Applied {
        let Some(photo) = self.photo else { return Ok(Vec::new()) };
        let next = self.photo_after(photo);
        let mut confirmed = Vec::new();
        self.change("Confirm", |scene| {
            confirmed = confirm(scene, photo);
            if let Some(next) = next {
                carry(scene, photo, next, now_ms);
            }
        })?;
        if confirmed.is_empty() {
            let nothing = "Nothing to confirm: no object of this photo has been posed yet";
            return Ok(vec![Effect::Notify(Notice::warning(nothing))]);
        }
        match next {
            Some(next) => self.show_photo(next),
            None => Ok(vec![Effect::Notify(self.progress_notice())]),
        }
    }

    /// Takes back the confirmation of the shown photo's poses.
    pub(super) fn reopen(&mut self) -> Applied {
        let Some(photo) = self.photo else { return Ok(Vec::new()) };
        self.change("Reopen", |scene| {
            for (_, annotation) in scene.annotations_in_mut(photo) {
                if annotation.state == AnnotationState::Confirmed {
                    annotation.state = AnnotationState::Posed;
                }
            }
        })
    }

    fn photo_after(&self, photo: PhotoId) -> Option<PhotoId> {
        let photos = &self.scene.photos;
        let position = photos.iter().position(|candidate| candidate.id == photo)?;
        photos.get(position + 1).map(|photo| photo.id)
    }

    fn progress_notice(&self) -> Notice {
        let photos = self.scene.photos.iter();
        let open =
            photos.filter(|photo| self.scene.photo_state(photo.id) != Some(AnnotationState::Confirmed));
        match open.count() {
            0 => Notice::info("Every photo is confirmed"),
            1 => Notice::info("Confirmed. One photo is not confirmed yet"),
            open => Notice::info(format!("Confirmed. {open} photos are not confirmed yet")),
        }
    }
}

fn confirm(scene: &mut Scene, photo: PhotoId) -> Vec<ObjectId> {
    let mut confirmed = Vec::new();
    for (object, annotation) in scene.annotations_in_mut(photo) {
        if annotation.state != AnnotationState::Untouched {
            annotation.state = AnnotationState::Confirmed;
            annotation.camera_changed = false;
            confirmed.push(object);
        }
    }
    confirmed
}

/// Photos are a sequence if they have one size. A pose is carried where its object waits untouched, and to a photo that has
/// no object yet; a photo that shows other things, or of which a reference knows others alone, is left alone.
fn carry(scene: &mut Scene, from: PhotoId, to: PhotoId, now_ms: f64) {
    let size = |id: PhotoId| scene.photo(id).map(|photo| (photo.asset.width, photo.asset.height));
    if size(from) != size(to) || scene.photo(to).is_none_or(|photo| photo.locked) {
        return;
    }
    let is_empty = scene.objects_in(to).next().is_none();
    let confirmed: Vec<(ObjectId, Annotation)> = scene
        .objects_in(from)
        .filter(|(_, annotation)| annotation.state == AnnotationState::Confirmed)
        .map(|(object, annotation)| (object.id, annotation.clone()))
        .collect();
    for (object, annotation) in confirmed {
        let waits = match scene.annotation(to, object) {
            Some(there) => there.state == AnnotationState::Untouched,
            None => is_empty && may_be_in(scene, to, object),
        };
        if waits {
            let carried = Annotation {
                state: AnnotationState::Carried,
                changed_at_ms: now_ms,
                camera_changed: false,
                score: None,
                pins: Vec::new(),
                ..annotation
            };
            scene.annotations.insert((to, object), carried);
        }
    }
}

/// False where references say which objects are in a photo, and this is none of them.
fn may_be_in(scene: &Scene, photo: PhotoId, object: ObjectId) -> bool {
    let known = scene.references.iter().flat_map(|reference| reference.poses.keys());
    let mut in_photo = known.filter(|(known, _)| *known == photo).map(|(_, object)| *object).peekable();
    in_photo.peek().is_none() || in_photo.any(|known| known == object)
}
