//! The search for symmetries: the worker looks, the panel shows what it found.

use std::sync::Arc;

use super::PinPose;
use crate::scene::{MeshAsset, ObjectId};
use crate::session::Notice;
use crate::solve::symmetry::FoundSymmetries;
use crate::ui::{Busy, SymmetryView};

#[derive(Default)]
pub struct SymmetrySearch {
    /// The mesh that the worker has, as it is in the scene.
    asked: Option<Arc<MeshAsset>>,
    /// What was found last, and of which mesh: a mesh in another frame has other axes.
    found: Option<(Arc<MeshAsset>, FoundSymmetries)>,
}

impl SymmetrySearch {
    pub fn busy(&self) -> Option<Busy> {
        self.asked.as_ref().map(|_| Busy { text: "Looking for symmetries…".to_owned(), can_cancel: true })
    }

    /// What comes of it is not taken; false if nothing was under way.
    pub fn cancel(&mut self) -> bool {
        self.asked.take().is_some()
    }

    pub fn view(&self) -> SymmetryView<'_> {
        SymmetryView { found: self.found.as_ref().map(|(mesh, found)| (mesh, found)) }
    }
}

impl PinPose {
    pub(super) fn find_symmetries(&mut self, object: ObjectId) {
        let Some(object) = self.session.scene().object(object) else { return };
        let mesh = object.mesh.clone();
        self.loading.find_symmetries(&mesh);
        self.symmetries.asked = Some(mesh);
    }

    pub(super) fn tick_symmetries(&mut self) {
        for (mesh, found) in self.loading.take_symmetries() {
            let is_wanted = self.symmetries.asked.take_if(|asked| Arc::ptr_eq(asked, &mesh)).is_some();
            if !is_wanted {
                continue;
            }
            match found {
                Some(found) => {
                    let text = match found.found.len() {
                        0 => "No symmetry found: every turn of this mesh looks different".to_owned(),
                        1 => "One symmetry found: see the Symmetry panel".to_owned(),
                        count => format!("{count} symmetries found: see the Symmetry panel"),
                    };
                    self.notify(Notice::info(text));
                    self.symmetries.found = Some((mesh, found));
                }
                None => self.notify(Notice::error("The search for symmetries failed")),
            }
        }
    }
}
