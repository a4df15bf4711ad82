//! Which turns leave an object's mesh as it is: added and removed by hand, or accepted from what was found.

use super::apply::Applied;
use super::{CommandError, Effect, Session};
use crate::scene::{Object, ObjectId, Symmetries, SymmetryAxis, SymmetryError};

impl Session {
    /// Adds an axis and what follows from it.
    pub(super) fn add_symmetry(&mut self, id: ObjectId, axis: &SymmetryAxis) -> Applied {
        self.change_symmetries("Add symmetry", id, |symmetries, object| {
            symmetries.add_axis(axis, &object.mesh.mesh.sphere())
        })
    }

    pub(super) fn remove_symmetry(&mut self, id: ObjectId, axis: &SymmetryAxis) -> Applied {
        self.change_symmetries("Remove symmetry", id, |symmetries, object| {
            symmetries.remove_axis(axis, &object.mesh.mesh.sphere());
            Ok(())
        })
    }

    pub(super) fn ask_symmetries(&self) -> Applied {
        Ok(self.selected.map(Effect::FindSymmetries).into_iter().collect())
    }

    /// They are the mesh's: all objects of its file have them, each in its own frame.
    fn change_symmetries(
        &mut self,
        label: &str,
        id: ObjectId,
        edit: impl FnOnce(&mut Symmetries, &Object) -> Result<(), SymmetryError>,
    ) -> Applied {
        let object = self.scene.object(id).ok_or(CommandError::NoObject(id))?;
        if object.locked {
            return Err(CommandError::Locked(object.name.clone()));
        }
        let mut symmetries = object.symmetries.clone();
        edit(&mut symmetries, object).map_err(|error| CommandError::Failed(error.to_string()))?;
        let (sha256, file_from_mesh) = (object.mesh.sha256, object.mesh_from_file.inverse());
        self.change(label, |scene| {
            for other in scene.objects.iter_mut().filter(|other| other.mesh.sha256 == sha256) {
                other.symmetries = if other.id == id {
                    symmetries.clone()
                } else {
                    symmetries.of_transformed(&(other.mesh_from_file * file_from_mesh))
                };
            }
        })
    }
}
