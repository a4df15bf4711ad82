//! The unit and the axes of meshes: guessed where files do not say them, and changed.

use std::sync::Arc;

use super::apply::Applied;
use super::{CommandError, Effect, Notice, Session};
use crate::formats::Incoming;
use crate::mesh::{FileUnit, MeshUnit};
use crate::scene::{AnnotationState, MeshAsset, MeshFrame, ObjectId, PoseSource, Scene};

/// Meshes whose files do not say their unit, and whose size leaves it open. They are loaded in the likely one, and the user
/// goes on as long as they like.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitQuestion {
    /// Never empty.
    pub objects: Vec<ObjectId>,
    pub likely: MeshUnit,
}

impl Session {
    /// The question about units that is open: what the user has settled otherwise is not asked.
    pub fn unit_question(&self) -> Option<UnitQuestion> {
        self.unit_questions.iter().find_map(|question| {
            let is_open = |id: &ObjectId| self.unit_of(*id) == Some(question.likely);
            let objects: Vec<ObjectId> = question.objects.iter().copied().filter(is_open).collect();
            (!objects.is_empty()).then_some(UnitQuestion { objects, likely: question.likely })
        })
    }

    fn unit_of(&self, id: ObjectId) -> Option<MeshUnit> {
        let object = self.scene.object(id)?;
        MeshFrame(object.mesh_from_file).unit(object.mesh.file_unit())
    }

    pub(super) fn answer_unit(&mut self, unit: MeshUnit) -> Applied {
        let question =
            self.unit_question().ok_or_else(|| CommandError::Failed("no question is open".to_owned()))?;
        let applied = self
            .change_frames("Mesh unit", &question.objects, |frame, file| Ok(frame.with_unit(unit, file)?))?;
        // What was asked about is settled, whatever the answer.
        self.unit_questions.retain(|asked| !asked.objects.iter().any(|id| question.objects.contains(id)));
        Ok(applied)
    }

    /// Do poses that come with an object, or those that wait for it, say how its mesh's file is meant?
    pub(super) fn is_told_frame(&self, id: ObjectId, poses: &[Incoming]) -> bool {
        let Some(object) = self.scene.object(id) else { return false };
        let mut told = poses.iter().chain(self.waiting.iter().map(|waiting| &waiting.incoming));
        told.any(|incoming| incoming.says_frame_of(&object.mesh))
    }

    /// Gives meshes that have just come the unit that their file says, or the likely one. What is doubtful is asked.
    pub(super) fn give_units(&mut self, new: &[ObjectId]) -> Vec<Effect> {
        let mut effects = Vec::new();
        let mut doubtful: Vec<UnitQuestion> = Vec::new();
        for &id in new {
            let Some(object) = self.scene.object_mut(id) else { continue };
            let file = object.mesh.file_unit();
            let (unit, is_doubtful) = match file {
                FileUnit::Gltf => continue,
                FileUnit::Named(unit) => (unit, false),
                FileUnit::Unknown => MeshUnit::likely(object.mesh.mesh.bounds().size().max_element()),
            };
            let frame = MeshFrame(object.mesh_from_file);
            let given = frame
                .with_unit(unit, file)
                .ok()
                .and_then(|wanted| Some((wanted, object.mesh.with_mesh_from_file(frame.0, wanted.0).ok()?)));
            // Too large for any unit but its own: it stays as it is.
            let Some((wanted, mesh)) = given else { continue };
            if wanted != frame && !is_doubtful {
                effects.push(Effect::Notify(Notice::info(format!(
                    "{}: in {unit}, as its file says",
                    object.name
                ))));
            }
            (object.mesh, object.mesh_from_file) = (mesh, wanted.0);
            if is_doubtful {
                match doubtful.iter_mut().find(|question| question.likely == unit) {
                    Some(question) => question.objects.push(id),
                    None => doubtful.push(UnitQuestion { objects: vec![id], likely: unit }),
                }
            }
        }
        self.unit_questions.extend(doubtful);
        effects
    }

    /// Mirrors or spaces an object's mesh.
    pub(super) fn set_mesh_frame(&mut self, id: ObjectId, frame: MeshFrame) -> Applied {
        self.scene.object(id).ok_or(CommandError::NoObject(id))?;
        self.change_frames("Mirror or space mesh", &[id], |_, _| Ok(MeshFrame::checked(frame.0)?))
    }

    pub(super) fn set_mesh_unit(&mut self, id: ObjectId, unit: MeshUnit) -> Applied {
        let same = self.of_same_file(id)?;
        self.change_frames("Mesh unit", &same, |frame, file| Ok(frame.with_unit(unit, file)?))
    }

    pub(super) fn set_up_axis(&mut self, id: ObjectId, axis: usize) -> Applied {
        let same = self.of_same_file(id)?;
        self.change_frames("Mesh axes", &same, |frame, _| Ok(frame.with_up_axis(axis)))
    }

    fn of_same_file(&self, id: ObjectId) -> Result<Vec<ObjectId>, CommandError> {
        let sha256 = self.scene.object(id).ok_or(CommandError::NoObject(id))?.mesh.sha256;
        let same = self.scene.objects.iter().filter(|object| object.mesh.sha256 == sha256);
        Ok(same.map(|object| object.id).collect())
    }

    fn change_frames(
        &mut self,
        label: &str,
        ids: &[ObjectId],
        wanted: impl Fn(&MeshFrame, FileUnit) -> Result<MeshFrame, CommandError>,
    ) -> Applied {
        let mut changes = Vec::new();
        for object in self.scene.objects.iter().filter(|object| ids.contains(&object.id)) {
            let present = MeshFrame(object.mesh_from_file);
            let frame = wanted(&present, object.mesh.file_unit())?;
            let mesh = object.mesh.with_mesh_from_file(present.0, frame.0);
            let mesh = mesh.map_err(|error| CommandError::Failed(error.to_string()))?;
            changes.push((object.id, frame, mesh));
        }
        self.change(label, |scene| {
            for (id, frame, mesh) in changes {
                change_frame(scene, id, frame, mesh);
            }
        })
    }
}

/// Poses stay as they are. Where only the unit is another one, those that were made by hand go along with it, so that the
/// picture stays; imported ones are in millimetres whatever the mesh was taken for; untouched ones are placed again.
fn change_frame(scene: &mut Scene, id: ObjectId, frame: MeshFrame, mesh: Arc<MeshAsset>) {
    let Some(object) = scene.object_mut(id) else { return };
    let factor = frame.times_larger_than(&MeshFrame(object.mesh_from_file)).filter(|factor| *factor != 1.0);
    let new_from_old = frame.0 * object.mesh_from_file.inverse();
    object.symmetries = object.symmetries.of_transformed(&new_from_old);
    object.mesh = mesh;
    object.mesh_from_file = frame.0;
    let mut untouched = Vec::new();
    for (key, annotation) in scene.annotations.iter_mut().filter(|((_, object), _)| *object == id) {
        annotation.pins = annotation.pins.iter().map(|pin| pin.of_transformed(&new_from_old)).collect();
        let Some(factor) = factor else { continue };
        if annotation.state == AnnotationState::Untouched {
            untouched.push((*key, annotation.changed_at_ms));
        } else if annotation.source != PoseSource::Imported {
            annotation.camera_from_object.translation_mm *= factor;
        }
    }
    for ((photo, object), placed_at_ms) in untouched {
        scene.annotations.remove(&(photo, object));
        scene.place(photo, object, placed_at_ms);
    }
}
