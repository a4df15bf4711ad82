//! Carrying out commands: which one goes where, and what all changes have in common.

use super::{Burst, BurstKey, Command, CommandError, Effect, Session, Snapshot};
use crate::math::Intrinsics;
use crate::scene::{CameraOrigin, ObjectId, PhotoId, Scene};

pub(super) type Applied = Result<Vec<Effect>, CommandError>;

impl Session {
    /// Carries out one command at the time `now_ms` (milliseconds since 1970, UTC). After an error nothing has changed.
    pub fn apply(&mut self, command: Command, now_ms: f64) -> Applied {
        match command {
            Command::Run(id) => self.run(id, now_ms),
            Command::Import(batch) => Ok(self.import(*batch, now_ms)),
            Command::ImportMasks(images) => self.import_masks(&images),
            Command::ImportDepth(image) => self.import_depth(image),
            Command::OpenDataset(import) => Ok(self.open_dataset(*import, now_ms)),
            Command::Open(opening) => Ok(self.open(*opening, now_ms)),
            Command::Answer(answer) => self.answer(answer, now_ms),
            Command::AnswerUnit(unit) => self.answer_unit(unit),
            Command::RenameScene(name) => {
                self.rename_scene(&name);
                Ok(Vec::new())
            }

            Command::ShowPhoto(photo) => self.show_photo(photo),
            Command::Select(object) => self.select(object),
            Command::SelectAlso(object) => self.select_also(object),
            Command::SetTool(tool) => {
                self.tool = tool;
                self.half_pin = None;
                Ok(Vec::new())
            }
            Command::SetLook(look) => {
                self.look = look.in_range();
                self.touched();
                Ok(Vec::new())
            }
            Command::SetPanes(panes) => {
                self.panes = panes;
                self.touched();
                Ok(Vec::new())
            }
            Command::SetNudge(settings) => {
                self.nudge = settings;
                Ok(Vec::new())
            }

            Command::SetCamera { photo, camera, origin } => self.set_camera(photo, camera, origin, now_ms),
            Command::SetFocal { photo, fx } => self.set_focal(photo, fx),
            Command::ResetCamera(photo) => self.reset_camera(photo, now_ms),
            Command::EditPhoto(photo, change) => self.edit_photo(photo, change, now_ms),
            Command::EditObject(object, change) => self.edit_object(object, change, now_ms),
            Command::EditMask(mask, change) => self.edit_mask(mask, change, now_ms),
            Command::RemovePhoto(photo) => {
                self.with_photo(photo, "Remove photo", |scene| scene.remove_photo(photo))
            }
            Command::RemoveObject(object) => {
                self.with_object(object, "Remove object", |scene| scene.remove_object(object))
            }
            Command::RemoveMask(mask) => {
                self.scene.mask(mask).ok_or(CommandError::NoMask(mask))?;
                self.change("Remove mask", |scene| scene.masks.retain(|candidate| candidate.id != mask))
            }
            Command::MovePhoto(photo, to) => self.with_photo(photo, "Reorder photos", |scene| {
                move_before(&mut scene.photos, |candidate| candidate.id == photo, to);
            }),
            Command::MoveObject(object, to) => self.with_object(object, "Reorder objects", |scene| {
                move_before(&mut scene.objects, |candidate| candidate.id == object, to);
            }),
            Command::MoveMask(mask, to) => self.change("Reorder masks", |scene| {
                move_before(&mut scene.masks, |candidate| candidate.id == mask, to);
            }),
            Command::SetReferenceVisible { name, visible } => {
                self.change("Show or hide reference", |scene| {
                    let named = scene.references.iter_mut().filter(|reference| *reference.name == *name);
                    named.for_each(|reference| reference.visible = visible);
                })
            }
            Command::RemoveReference { name } => self.change("Remove reference", |scene| {
                scene.references.retain(|reference| *reference.name != *name);
            }),

            Command::Place { photo, object } => self.place(photo, object, now_ms),
            Command::Withdraw { photo, object } => self.withdraw(photo, object),
            Command::SetPose { photo, object, camera_from_object, source } => {
                self.set_pose("Set pose", (photo, object), camera_from_object, source, now_ms)
            }
            Command::SetPoseFromText(text) => self.set_pose_from_text(&text, now_ms),
            Command::SetPoseFromReference { name } => self.set_pose_from_reference(&name, now_ms),
            Command::CopyPosesFrom(photo) => self.copy_poses_from(photo, now_ms),
            Command::Nudge(nudge, factor) => self.nudge(nudge, factor, now_ms),
            Command::Step { photo, object, camera_from_object, label } => {
                self.step((photo, object), camera_from_object, label, now_ms)
            }
            Command::AddPin { photo, object, pin } => self.add_pin((photo, object), pin),
            Command::BeginPin(half) => {
                self.half_pin = half;
                Ok(Vec::new())
            }
            Command::CompletePin { photo, object, pin } => self.complete_pin((photo, object), pin, now_ms),
            Command::DragPin { photo, object, pin, pixel } => {
                self.drag_pin((photo, object), pin, pixel, now_ms)
            }
            Command::EditPins(change) => self.edit_pins(change, now_ms),
            Command::NoteFitScores { photo, object, scores } => {
                self.note_fit_scores((photo, object), scores);
                Ok(Vec::new())
            }
            Command::TakeSnap { photo, object, camera_from_object, covariance } => {
                let covariance = covariance.map(|covariance| *covariance);
                self.take_snap((photo, object), camera_from_object, covariance, now_ms)
            }
            Command::NoteSnap { photo, object, covariance } => {
                self.note_snap((photo, object), covariance.map(|covariance| *covariance));
                Ok(Vec::new())
            }
            Command::TakeSnaps { snaps, summary, least_sure } => {
                self.take_snaps(snaps, (summary, least_sure), now_ms)
            }
            Command::BeginGesture(label) => {
                self.begin_gesture(label);
                Ok(Vec::new())
            }
            Command::Drag { photo, object, camera_from_object } => {
                self.drag((photo, object), camera_from_object, now_ms)
            }
            Command::EndGesture => {
                self.finish_gesture();
                Ok(Vec::new())
            }
            Command::CancelGesture => {
                let had_half_pin = self.half_pin.take().is_some();
                if let Some(gesture) = self.gesture.take() {
                    self.restore(gesture.before);
                } else if !had_half_pin && self.is_snap_in_view() {
                    return Ok(self.undo());
                }
                Ok(Vec::new())
            }
            Command::ReturnTo(entry) => self.return_to(&entry, now_ms),
        }
    }

    /// Was a snap of the selected pose the last thing that was done? To look at it from all sides is no thing done.
    fn is_snap_in_view(&self) -> bool {
        let selected = self.selected_annotation().map(|(photo, object, _)| (photo, object));
        self.snapped
            .is_some_and(|(target, step)| selected == Some(target) && self.history.newest() == Some(step))
    }

    /// Names the scene in all of its history: what it is called is no step of the work.
    fn rename_scene(&mut self, name: &str) {
        self.finish_gesture();
        if self.scene.name != name {
            name.clone_into(&mut self.scene.name);
            self.history.rename_scenes(name);
            self.touched();
        }
    }

    /// Changes the scene as one undo step.
    pub(super) fn change(&mut self, label: &str, edit: impl FnOnce(&mut Scene)) -> Applied {
        self.finish_gesture();
        let before = self.snapshot();
        edit(&mut self.scene);
        if self.scene != before.scene {
            self.history.push(label, before);
            self.keep_selection_valid();
            self.touched();
        }
        Ok(Vec::new())
    }

    /// Changes the scene; changes of one thing in quick succession (a slider under the hand) are one undo step.
    pub(super) fn change_smoothly(
        &mut self,
        key: BurstKey,
        now_ms: f64,
        edit: impl FnOnce(&mut Scene),
    ) -> Applied {
        let goes_on = self.burst.as_ref().is_some_and(|burst| burst.continues(&key, now_ms));
        if goes_on {
            edit(&mut self.scene);
            self.touched();
        } else {
            let before = self.revision;
            self.change(key.label, edit)?;
            if self.revision == before {
                // Nothing changed, so there is no undo step yet that what follows could belong to.
                return Ok(Vec::new());
            }
        }
        self.burst = Some(Burst { key, last_ms: now_ms });
        Ok(Vec::new())
    }

    pub(super) fn with_photo(
        &mut self,
        photo: PhotoId,
        label: &str,
        edit: impl FnOnce(&mut Scene),
    ) -> Applied {
        self.scene.photo(photo).ok_or(CommandError::NoPhoto(photo))?;
        self.change(label, edit)
    }

    pub(super) fn with_object(
        &mut self,
        object: ObjectId,
        label: &str,
        edit: impl FnOnce(&mut Scene),
    ) -> Applied {
        self.scene.object(object).ok_or(CommandError::NoObject(object))?;
        self.change(label, edit)
    }

    pub(super) fn show_photo(&mut self, photo: PhotoId) -> Applied {
        self.scene.photo(photo).ok_or(CommandError::NoPhoto(photo))?;
        self.finish_gesture();
        self.photo = Some(photo);
        self.select_something_in_photo();
        self.touched();
        Ok(Vec::new())
    }

    pub(super) fn select(&mut self, object: Option<ObjectId>) -> Applied {
        if let Some(object) = object {
            self.scene.object(object).ok_or(CommandError::NoObject(object))?;
        }
        if self.selected != object || !self.also_selected.is_empty() {
            self.selected = object;
            self.also_selected.clear();
            self.touched();
        }
        Ok(Vec::new())
    }

    fn select_also(&mut self, object: ObjectId) -> Applied {
        self.scene.object(object).ok_or(CommandError::NoObject(object))?;
        if self.selected == Some(object) {
            self.selected = self.also_selected.pop_last();
        } else if !self.also_selected.remove(&object) {
            self.also_selected.extend(self.selected);
            self.selected = Some(object);
        }
        self.touched();
        Ok(Vec::new())
    }

    fn set_camera(
        &mut self,
        photo: PhotoId,
        camera: Intrinsics,
        origin: CameraOrigin,
        now_ms: f64,
    ) -> Applied {
        let camera = camera.checked().map_err(|error| CommandError::Failed(error.to_string()))?;
        let target = self.scene.photo(photo).ok_or(CommandError::NoPhoto(photo))?;
        if target.locked {
            return Err(CommandError::Locked(target.name.clone()));
        }
        let key = BurstKey { label: "Set camera", photo: Some(photo), target: photo.0 };
        self.change_smoothly(key, now_ms, |scene| scene.set_camera(photo, camera, origin))
    }

    fn reset_camera(&mut self, photo: PhotoId, now_ms: f64) -> Applied {
        let (camera, origin) =
            self.scene.photo(photo).ok_or(CommandError::NoPhoto(photo))?.given_camera.clone();
        self.set_camera(photo, camera, origin, now_ms)
    }

    /// Makes the drag under way, if any, one undo step.
    pub(super) fn finish_gesture(&mut self) {
        self.burst = None;
        if let Some(gesture) = self.gesture.take()
            && gesture.before.scene != self.scene
        {
            self.record_changes(&gesture.before.scene, gesture.label);
            self.history.push(gesture.label, gesture.before);
        }
    }

    pub(super) fn snapshot(&self) -> Snapshot {
        Snapshot {
            scene: self.scene.clone(),
            photo: self.photo,
            selected: self.selected,
            also_selected: self.also_selected.clone(),
            log_cleared: self.log.cleared,
        }
    }

    pub(super) fn restore(&mut self, snapshot: Snapshot) {
        self.scene = snapshot.scene;
        self.photo = snapshot.photo;
        self.selected = snapshot.selected;
        self.also_selected = snapshot.also_selected;
        self.log.cleared = snapshot.log_cleared;
        self.burst = None;
        self.keep_selection_valid();
        self.touched();
    }

    pub(super) fn touched(&mut self) {
        self.revision += 1;
    }

    /// After photos or objects have come or gone: something that exists is shown and selected.
    pub(super) fn keep_selection_valid(&mut self) {
        if self.photo().is_none() {
            self.photo = self.scene.photos.first().map(|photo| photo.id);
        }
        let scene = &self.scene;
        self.also_selected.retain(|id| scene.object(*id).is_some());
        if self.selected.is_none_or(|id| self.scene.object(id).is_none()) {
            self.selected = self.also_selected.pop_last();
            self.select_something_in_photo();
        }
    }

    /// Selects the photo's first object, if the selected one is not in it.
    pub(super) fn select_something_in_photo(&mut self) {
        let Some(photo) = self.photo else { return };
        let selected_is_here = self.selected.is_some_and(|id| self.scene.annotation(photo, id).is_some());
        if !selected_is_here && let Some((object, _)) = self.scene.objects_in(photo).next() {
            self.selected = Some(object.id);
            self.also_selected.clear();
        }
    }
}

/// Moves an entry before the one that is at position `to` now; past the end: to the end.
fn move_before<T>(list: &mut Vec<T>, is_moved: impl Fn(&T) -> bool, to: usize) {
    let Some(from) = list.iter().position(is_moved) else { return };
    let entry = list.remove(from);
    let to = if to > from { to - 1 } else { to };
    list.insert(to.min(list.len()), entry);
}
