//! Poses under the hand: drags, steps, typed and pasted poses, and what moves along.

use super::apply::Applied;
use super::{Burst, BurstKey, CommandError, Effect, Gesture, LogEntry, Notice, Nudge, Session};
use crate::formats::read_pose_text;
use crate::math::Pose;
use crate::scene::{Annotation, AnnotationState, ObjectId, PhotoId, PoseSource, Scene, untouched_pose};

/// A pose's place: one object in one photo.
type Target = (PhotoId, ObjectId);

/// From here on, ‖RᵀR − I‖ of a typed rotation is worth a word.
const REPORTED_DEFECT: f64 = 1e-3;

/// The name of the reference that "Store as reference" keeps.
pub(super) const STORED: &str = "stored";

impl Session {
    pub(super) fn place(&mut self, photo: PhotoId, object: ObjectId, now_ms: f64) -> Applied {
        self.scene.object(object).ok_or(CommandError::NoObject(object))?;
        self.with_photo(photo, "Place object", |scene| scene.place(photo, object, now_ms))?;
        self.select(Some(object))
    }

    pub(super) fn withdraw(&mut self, photo: PhotoId, object: ObjectId) -> Applied {
        self.scene.annotation(photo, object).ok_or_else(|| self.not_in_photo(object))?;
        self.change("Take object out of the photo", |scene| {
            scene.annotations.remove(&(photo, object));
        })
    }

    pub(super) fn begin_gesture(&mut self, label: &'static str) {
        self.finish_gesture();
        self.gesture = Some(Gesture { label, before: self.snapshot(), revision: self.revision });
    }

    pub(super) fn drag(&mut self, target: Target, pose: Pose, now_ms: f64) -> Applied {
        self.check_movable(target)?;
        // Followers go from where the gesture began, so that no rounding gathers.
        let origin = self.gesture.as_ref().map_or(&self.scene, |gesture| &gesture.before.scene);
        let poses = self.with_followers(origin, target, pose);
        self.write_poses(poses, PoseSource::Manual, now_ms);
        Ok(Vec::new())
    }

    pub(super) fn step(&mut self, target: Target, pose: Pose, label: &'static str, now_ms: f64) -> Applied {
        self.check_movable(target)?;
        let poses = self.with_followers(&self.scene, target, pose);
        // Within a drag, a step belongs to the drag.
        if self.gesture.is_some() {
            self.write_poses(poses, PoseSource::Manual, now_ms);
            return Ok(Vec::new());
        }
        let key = BurstKey { label, photo: Some(target.0), target: target.1.0 };
        let goes_on = self.burst.as_ref().is_some_and(|burst| burst.continues(&key, now_ms));
        if !goes_on {
            let before = self.snapshot();
            self.history.push(label, before);
        }
        self.write_poses(poses, PoseSource::Manual, now_ms);
        let entry = self.log_entry(target, label);
        match entry {
            Some(entry) if goes_on => self.log.replace_last(entry),
            Some(entry) => self.log.push(entry),
            None => {}
        }
        self.burst = Some(Burst { key, last_ms: now_ms });
        Ok(Vec::new())
    }

    pub(super) fn nudge(&mut self, nudge: Nudge, factor: f64, now_ms: f64) -> Applied {
        let Some((photo, object, annotation)) = self.selected_annotation() else {
            return Err(CommandError::NotAvailable(nudge.label(), "no object of this photo is selected"));
        };
        let present = annotation.camera_from_object;
        let camera = self.scene.photo(photo).ok_or(CommandError::NoPhoto(photo))?.camera;
        let mesh = &self.scene.object(object).ok_or(CommandError::NoObject(object))?.mesh.mesh;
        let pivot_mm = self.pivot_mm(photo, object).unwrap_or_else(|| mesh.sphere().center);
        let pose = nudge.applied(&present, &camera, mesh, pivot_mm, &self.nudge, factor);
        self.step((photo, object), pose, nudge.label(), now_ms)
    }

    pub(super) fn set_pose(
        &mut self,
        label: &'static str,
        target: Target,
        pose: Pose,
        source: PoseSource,
        now_ms: f64,
    ) -> Applied {
        self.check_settable(target)?;
        self.change_poses(label, vec![(target, pose)], source, now_ms)
    }

    pub(super) fn set_pose_from_text(&mut self, text: &str, now_ms: f64) -> Applied {
        let Some((photo, object, annotation)) = self.selected_annotation() else {
            return Err(CommandError::NotAvailable("Set pose", "no object of this photo is selected"));
        };
        let (pose, defect) = read_pose_text(text, &annotation.camera_from_object)
            .map_err(|error| CommandError::Failed(error.to_string()))?;
        let mut effects = self.set_pose("Set pose", (photo, object), pose, PoseSource::Manual, now_ms)?;
        if defect > REPORTED_DEFECT {
            let text =
                format!("The rotation was not quite one (‖RᵀR − I‖ = {defect:.3}): the nearest one is used");
            effects.push(Effect::Notify(Notice::warning(text)));
        }
        Ok(effects)
    }

    pub(super) fn set_pose_from_reference(&mut self, name: &str, now_ms: f64) -> Applied {
        let Some((photo, object, _)) = self.selected_annotation() else {
            return Err(CommandError::NotAvailable("Set pose", "no object of this photo is selected"));
        };
        let reference = self.scene.references.iter().find(|reference| reference.name == name);
        let pose = reference.and_then(|reference| reference.poses.get(&(photo, object))).copied();
        let missing = || CommandError::Failed(format!("{name} has no pose of this object in this photo"));
        self.set_pose(
            "Pose from reference",
            (photo, object),
            pose.ok_or_else(missing)?,
            PoseSource::Imported,
            now_ms,
        )
    }

    pub(super) fn copy_poses_from(&mut self, from: PhotoId, now_ms: f64) -> Applied {
        let to = self.photo.ok_or(CommandError::NotAvailable("Copy poses", "no photo is open"))?;
        let selection = self.selection();
        let known =
            |object: &ObjectId| Some((*object, self.scene.annotation(from, *object)?.camera_from_object));
        let poses: Vec<_> =
            selection.iter().filter_map(known).map(|(object, pose)| ((to, object), pose)).collect();
        if poses.is_empty() {
            return Err(CommandError::Failed("the selected objects are not in that photo".to_owned()));
        }
        for (target, _) in &poses {
            self.check_settable(*target)?;
        }
        self.change_poses("Copy poses", poses, PoseSource::Manual, now_ms)
    }

    pub(super) fn return_to(&mut self, entry: &LogEntry, now_ms: f64) -> Applied {
        let target = (entry.photo, entry.object);
        self.scene.photo(entry.photo).ok_or(CommandError::NoPhoto(entry.photo))?;
        self.check_settable(target)?;
        self.photo = Some(entry.photo);
        self.select(Some(entry.object))?;
        self.set_pose("Return to pose", target, entry.camera_from_object, entry.source, now_ms)
    }

    pub(super) fn reset_pose(&mut self, now_ms: f64) -> Applied {
        let Some((photo, object, _)) = self.selected_annotation() else { return Ok(Vec::new()) };
        self.check_movable((photo, object))?;
        let start = self.photo().zip(self.scene.object(object));
        let Some(pose) = start.map(|(photo, object)| untouched_pose(&photo.camera, &object.mesh.mesh)) else {
            return Ok(Vec::new());
        };
        let before = self.scene.clone();
        self.change("Reset pose", |scene| {
            // Its pins go too: they would bring back what was given up.
            scene.annotations.insert((photo, object), Annotation::untouched(pose, now_ms));
        })?;
        self.record_changes(&before, "Reset pose");
        Ok(Vec::new())
    }

    /// Keeps the selected objects' poses in this photo, to come back to.
    pub(super) fn store_reference(&mut self) -> Applied {
        let Some(photo) = self.photo else { return Ok(Vec::new()) };
        let known = |object: ObjectId| {
            Some(((photo, object), self.scene.annotation(photo, object)?.camera_from_object))
        };
        let poses: Vec<_> = self.selection().into_iter().filter_map(known).collect();
        self.change("Store as reference", |scene| {
            let position = scene.references.iter().position(|reference| reference.name == STORED);
            let position = position.unwrap_or_else(|| {
                scene.references.push(crate::scene::Reference {
                    name: STORED.to_owned(),
                    // It is where the object is now: an outline would only be in the way.
                    visible: false,
                    poses: std::collections::BTreeMap::new(),
                });
                scene.references.len() - 1
            });
            scene.references[position].poses.extend(poses);
        })?;
        Ok(vec![Effect::Notify(Notice::info("The pose is stored; \"Back to stored pose\" returns to it"))])
    }

    /// The poses of one motion: the target's own, and those of what is linked to it or selected with it.
    pub(super) fn with_followers(&self, origin: &Scene, target: Target, pose: Pose) -> Vec<(Target, Pose)> {
        let object = target.1;
        let selected = if self.is_selected(object) { self.selection() } else { Vec::new() };
        self.moved_together(origin, target, pose, self.scene.linked_to(object).chain(selected).collect())
    }

    /// The poses of one motion: the target's own, and those of what is linked to it.
    pub(super) fn with_linked(&self, target: Target, pose: Pose) -> Vec<(Target, Pose)> {
        self.moved_together(&self.scene, target, pose, self.scene.linked_to(target.1).collect())
    }

    fn moved_together(
        &self,
        origin: &Scene,
        target: Target,
        pose: Pose,
        mut followers: Vec<ObjectId>,
    ) -> Vec<(Target, Pose)> {
        let (photo, object) = target;
        let mut poses = vec![(target, pose)];
        let Some(start) = origin.annotation(photo, object).map(|annotation| annotation.camera_from_object)
        else {
            return poses;
        };
        let moved_from_before = pose * start.inverse();
        followers.sort_unstable();
        followers.dedup();
        for follower in followers.into_iter().filter(|follower| *follower != object) {
            let target = (photo, follower);
            if self.check_movable(target).is_ok()
                && let Some(annotation) = origin.annotation(photo, follower)
            {
                poses.push((target, (moved_from_before * annotation.camera_from_object).renormalized()));
            }
        }
        poses
    }

    /// Why a pose cannot be moved now.
    pub fn check_movable(&self, (photo, object): Target) -> Result<(), CommandError> {
        self.scene.annotation(photo, object).ok_or_else(|| self.not_in_photo(object))?;
        self.check_settable((photo, object))
    }

    /// May a pose be put there, whether or not there is one?
    pub(super) fn check_settable(&self, (photo, object): Target) -> Result<(), CommandError> {
        let in_photo = self.scene.photo(photo).ok_or(CommandError::NoPhoto(photo))?;
        let target = self.scene.object(object).ok_or(CommandError::NoObject(object))?;
        if in_photo.locked {
            return Err(CommandError::Locked(in_photo.name.clone()));
        }
        if target.locked {
            return Err(CommandError::Locked(target.name.clone()));
        }
        match self.scene.annotation(photo, object) {
            Some(annotation) if annotation.state == AnnotationState::Confirmed => {
                Err(CommandError::Confirmed(target.name.clone()))
            }
            _ => Ok(()),
        }
    }

    pub(super) fn not_in_photo(&self, object: ObjectId) -> CommandError {
        match self.scene.object(object) {
            Some(object) => CommandError::NotInPhoto(object.name.clone()),
            None => CommandError::NoObject(object),
        }
    }

    /// Poses that come at once: one undo step, a line of the log each.
    pub(super) fn change_poses(
        &mut self,
        label: &'static str,
        poses: Vec<(Target, Pose)>,
        source: PoseSource,
        now_ms: f64,
    ) -> Applied {
        self.finish_gesture();
        let before = self.snapshot();
        self.write_poses(poses, source, now_ms);
        self.record_changes(&before.scene, label);
        self.history.push(label, before);
        Ok(Vec::new())
    }

    pub(super) fn write_poses(&mut self, poses: Vec<(Target, Pose)>, source: PoseSource, now_ms: f64) {
        for (target, camera_from_object) in poses {
            let before = self.scene.annotations.remove(&target);
            let annotation = Annotation {
                camera_from_object,
                state: AnnotationState::Posed,
                source,
                changed_at_ms: now_ms,
                camera_changed: false,
                score: None,
                pins: before.map_or_else(Vec::new, |before| before.pins),
            };
            self.scene.annotations.insert(target, annotation);
        }
        self.touched();
    }

    /// A line of the log for each pose that is not what it was.
    pub(super) fn record_changes(&mut self, before: &Scene, label: &'static str) {
        let changed = |(target, annotation): (&Target, &Annotation)| {
            let old = before.annotations.get(target).map(|old| old.camera_from_object);
            (old != Some(annotation.camera_from_object)).then_some(*target)
        };
        let targets: Vec<Target> = self.scene.annotations.iter().filter_map(changed).collect();
        for target in targets {
            if let Some(entry) = self.log_entry(target, label) {
                self.log.push(entry);
            }
        }
    }

    /// The same of poses that came from a file, unless it were so many that nobody could look back at anything else.
    pub(super) fn record_imports(&mut self, before: &Scene) {
        const MOST_LINES: usize = 200;
        let is_new = |(target, annotation): &(&Target, &Annotation)| {
            annotation.source == PoseSource::Imported && before.annotations.get(*target) != Some(*annotation)
        };
        let targets: Vec<Target> =
            self.scene.annotations.iter().filter(is_new).map(|(target, _)| *target).collect();
        if targets.len() <= MOST_LINES {
            let entries: Vec<LogEntry> =
                targets.into_iter().filter_map(|target| self.log_entry(target, "Import")).collect();
            entries.into_iter().for_each(|entry| self.log.push(entry));
        }
    }

    pub(super) fn log_entry(&self, (photo, object): Target, label: &'static str) -> Option<LogEntry> {
        let annotation = self.scene.annotation(photo, object)?;
        Some(LogEntry {
            time_ms: annotation.changed_at_ms,
            photo,
            object,
            photo_name: self.scene.photo(photo)?.name.as_str().into(),
            object_name: self.scene.object(object)?.name.as_str().into(),
            label,
            source: annotation.source,
            camera_from_object: annotation.camera_from_object,
            summary: None,
        })
    }
}
