//! Carrying out commands.

use super::{Burst, Command, CommandError, Effect, Gesture, Session, Snapshot};
use crate::math::Pose;
use crate::scene::{Annotation, AnnotationState, ObjectId, PhotoId, PoseSource, Scene};

type Applied = Result<Vec<Effect>, CommandError>;

impl Session {
    /// Carries out one command at the time `now_ms` (milliseconds since 1970, UTC). After an error nothing has changed.
    pub fn apply(&mut self, command: Command, now_ms: f64) -> Applied {
        match command {
            Command::Run(id) => self.run(id, now_ms),
            Command::Import(batch) => Ok(self.import(*batch, now_ms)),
            Command::Open(opening) => Ok(self.open(*opening, now_ms)),
            Command::Answer(answer) => self.answer(answer, now_ms),

            Command::NameScene(name) => {
                self.name_scene(&name);
                Ok(Vec::new())
            }
            Command::ShowPhoto(photo) => self.show_photo(photo),
            Command::Select(object) => self.select(object),
            Command::SetTool(tool) => {
                self.tool = tool;
                Ok(Vec::new())
            }
            Command::SetOverlayOpacity(opacity) => {
                self.look.overlay_opacity = opacity.clamp(0.0, 1.0);
                self.touched();
                Ok(Vec::new())
            }

            Command::SetCamera { photo, camera, origin } => {
                let camera = camera.checked().map_err(|error| CommandError::Failed(error.to_string()))?;
                self.with_photo(photo, "Set camera", |scene| scene.set_camera(photo, camera, origin))
            }
            Command::RemovePhoto(photo) => {
                self.with_photo(photo, "Remove photo", |scene| scene.remove_photo(photo))
            }
            Command::RemoveObject(object) => {
                self.with_object(object, "Remove object", |scene| scene.remove_object(object))
            }
            Command::SetObjectVisible(object, visible) => {
                let label = if visible { "Show object" } else { "Hide object" };
                self.edit_object(object, label, |object| object.visible = visible)
            }
            Command::SetObjectLocked(object, locked) => {
                let label = if locked { "Lock object" } else { "Unlock object" };
                self.edit_object(object, label, |object| object.locked = locked)
            }
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
                self.set_pose(photo, object, camera_from_object, source, now_ms)
            }
            Command::Nudge { photo, object, camera_from_object, label } => {
                self.nudge(Burst { label, photo, object, last_ms: now_ms }, camera_from_object)
            }
            Command::BeginGesture(label) => {
                self.finish_gesture();
                self.gesture = Some(Gesture { label, before: self.snapshot(), revision: self.revision });
                Ok(Vec::new())
            }
            Command::Drag { photo, object, camera_from_object } => {
                self.check_movable(photo, object)?;
                self.write_pose(photo, object, camera_from_object, PoseSource::Manual, now_ms);
                Ok(Vec::new())
            }
            Command::EndGesture => {
                self.finish_gesture();
                Ok(Vec::new())
            }
            Command::CancelGesture => {
                if let Some(gesture) = self.gesture.take() {
                    self.restore(gesture.before);
                }
                Ok(Vec::new())
            }
        }
    }

    /// Names the scene in all of its history: what it is called is no step of the work.
    fn name_scene(&mut self, name: &str) {
        self.finish_gesture();
        if self.scene.name != name {
            name.clone_into(&mut self.scene.name);
            self.history.name_scenes(name);
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

    fn with_photo(&mut self, photo: PhotoId, label: &str, edit: impl FnOnce(&mut Scene)) -> Applied {
        self.scene.photo(photo).ok_or(CommandError::NoPhoto(photo))?;
        self.change(label, edit)
    }

    fn with_object(&mut self, object: ObjectId, label: &str, edit: impl FnOnce(&mut Scene)) -> Applied {
        self.scene.object(object).ok_or(CommandError::NoObject(object))?;
        self.change(label, edit)
    }

    fn edit_object(
        &mut self,
        id: ObjectId,
        label: &str,
        edit: impl FnOnce(&mut crate::scene::Object),
    ) -> Applied {
        self.with_object(id, label, |scene| {
            if let Some(object) = scene.object_mut(id) {
                edit(object);
            }
        })
    }

    pub(super) fn show_photo(&mut self, photo: PhotoId) -> Applied {
        self.scene.photo(photo).ok_or(CommandError::NoPhoto(photo))?;
        self.finish_gesture();
        self.photo = Some(photo);
        self.select_something_in_photo();
        self.touched();
        Ok(Vec::new())
    }

    fn select(&mut self, object: Option<ObjectId>) -> Applied {
        if let Some(object) = object {
            self.scene.object(object).ok_or(CommandError::NoObject(object))?;
        }
        if self.selected != object {
            self.selected = object;
            self.touched();
        }
        Ok(Vec::new())
    }

    fn place(&mut self, photo: PhotoId, object: ObjectId, now_ms: f64) -> Applied {
        self.scene.object(object).ok_or(CommandError::NoObject(object))?;
        self.with_photo(photo, "Place object", |scene| scene.place(photo, object, now_ms))?;
        self.select(Some(object))
    }

    fn withdraw(&mut self, photo: PhotoId, object: ObjectId) -> Applied {
        self.scene.annotation(photo, object).ok_or_else(|| self.not_in_photo(object))?;
        self.change("Take object out of the photo", |scene| {
            scene.annotations.remove(&(photo, object));
        })
    }

    fn set_pose(
        &mut self,
        photo: PhotoId,
        object: ObjectId,
        pose: Pose,
        source: PoseSource,
        now_ms: f64,
    ) -> Applied {
        self.scene.photo(photo).ok_or(CommandError::NoPhoto(photo))?;
        let target = self.scene.object(object).ok_or(CommandError::NoObject(object))?;
        if target.locked {
            return Err(CommandError::Locked(target.name.clone()));
        }
        self.finish_gesture();
        let before = self.snapshot();
        self.write_pose(photo, object, pose, source, now_ms);
        self.history.push("Set pose", before);
        Ok(Vec::new())
    }

    fn nudge(&mut self, step: Burst, pose: Pose) -> Applied {
        self.check_movable(step.photo, step.object)?;
        // Within a drag, a step belongs to the drag.
        if self.gesture.is_none() {
            if !self.burst.as_ref().is_some_and(|burst| burst.continues(&step)) {
                self.history.push(step.label, self.snapshot());
            }
            self.burst = Some(step.clone());
        }
        self.write_pose(step.photo, step.object, pose, PoseSource::Manual, step.last_ms);
        Ok(Vec::new())
    }

    fn check_movable(&self, photo: PhotoId, object: ObjectId) -> Result<(), CommandError> {
        let annotation = self.scene.annotation(photo, object).ok_or_else(|| self.not_in_photo(object))?;
        let target = self.scene.object(object).ok_or(CommandError::NoObject(object))?;
        if target.locked || annotation.state == AnnotationState::Confirmed {
            return Err(CommandError::Locked(target.name.clone()));
        }
        Ok(())
    }

    fn not_in_photo(&self, object: ObjectId) -> CommandError {
        match self.scene.object(object) {
            Some(object) => CommandError::NotInPhoto(object.name.clone()),
            None => CommandError::NoObject(object),
        }
    }

    fn write_pose(&mut self, photo: PhotoId, object: ObjectId, pose: Pose, source: PoseSource, now_ms: f64) {
        let annotation = Annotation {
            camera_from_object: pose,
            state: AnnotationState::Posed,
            source,
            changed_at_ms: now_ms,
            camera_changed: false,
        };
        self.scene.annotations.insert((photo, object), annotation);
        self.touched();
    }

    /// Makes the drag under way, if any, one undo step.
    pub(super) fn finish_gesture(&mut self) {
        self.burst = None;
        if let Some(gesture) = self.gesture.take()
            && gesture.before.scene != self.scene
        {
            self.history.push(gesture.label, gesture.before);
        }
    }

    pub(super) fn snapshot(&self) -> Snapshot {
        Snapshot { scene: self.scene.clone(), photo: self.photo, selected: self.selected }
    }

    pub(super) fn restore(&mut self, snapshot: Snapshot) {
        self.scene = snapshot.scene;
        self.photo = snapshot.photo;
        self.selected = snapshot.selected;
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
        if self.selected.is_none_or(|id| self.scene.object(id).is_none()) {
            self.selected = None;
            self.select_something_in_photo();
        }
    }

    /// Selects the photo's first object, if the selected one is not in it.
    pub(super) fn select_something_in_photo(&mut self) {
        let Some(photo) = self.photo else { return };
        let selected_is_here = self.selected.is_some_and(|id| self.scene.annotation(photo, id).is_some());
        if !selected_is_here && let Some((object, _)) = self.scene.objects_in(photo).next() {
            self.selected = Some(object.id);
        }
    }
}
