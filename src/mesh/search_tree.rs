//! A mesh's tree, made when it is first asked for, or by somebody who said so.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::DAffine3;

use super::{Bvh, Mesh};

/// The place of a mesh's tree. A mesh of a million triangles is shown before it has one.
#[derive(Debug, Default)]
pub struct SearchTree {
    tree: OnceLock<Bvh>,
    /// Another thread is at it.
    is_promised: AtomicBool,
}

impl SearchTree {
    pub fn promised() -> Self {
        Self { tree: OnceLock::new(), is_promised: AtomicBool::new(true) }
    }

    /// Of the mesh whose place this is; `None` for the moment until a promised one comes.
    pub fn of(&self, mesh: &Mesh) -> Option<&Bvh> {
        match self.tree.get() {
            None if self.is_promised.load(Ordering::Relaxed) => None,
            _ => Some(self.tree.get_or_init(|| Bvh::build(mesh))),
        }
    }

    /// The same of a mesh that is `source_mesh` after a transform, and whose tree this one's is made of if it can be.
    pub fn of_transformed(
        &self,
        mesh: &Mesh,
        (source, source_mesh): (&Self, &Mesh),
        transform: &DAffine3,
    ) -> Option<&Bvh> {
        if self.tree.get().is_none() {
            let tree = source.of(source_mesh)?.transformed(transform);
            self.give(tree.unwrap_or_else(|| Bvh::build(mesh)));
        }
        self.tree.get()
    }

    /// Is it promised and not there yet?
    pub fn is_awaited(&self) -> bool {
        self.tree.get().is_none() && self.is_promised.load(Ordering::Relaxed)
    }

    pub fn give(&self, tree: Bvh) {
        // Two that are made of one mesh are the same.
        let _ = self.tree.set(tree);
    }

    /// Nobody is at it any more: whoever asks makes it.
    pub fn withdraw(&self) {
        self.is_promised.store(false, Ordering::Relaxed);
    }
}

impl From<Bvh> for SearchTree {
    fn from(tree: Bvh) -> Self {
        let place = Self::default();
        place.give(tree);
        place
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::math::Ray;
    use crate::mesh::test_shapes::cube;

    #[test]
    fn a_tree_is_made_when_asked_for_unless_somebody_promised_it() {
        let mesh = cube();
        assert!(SearchTree::default().of(&mesh).is_some());
        let promised = SearchTree::promised();
        assert!(promised.of(&mesh).is_none());
        promised.give(Bvh::build(&mesh));
        assert!(promised.of(&mesh).is_some());
        let withdrawn = SearchTree::promised();
        withdrawn.withdraw();
        assert!(withdrawn.of(&mesh).is_some());
    }

    #[test]
    fn a_transformed_meshes_tree_waits_for_its_sources() {
        let source_mesh = cube();
        let transform = DAffine3::from_scale(DVec3::splat(10.0));
        let mesh = source_mesh.transformed(&transform).unwrap();
        let (source, place) = (SearchTree::promised(), SearchTree::default());
        assert!(place.of_transformed(&mesh, (&source, &source_mesh), &transform).is_none());
        source.withdraw();
        let tree = place.of_transformed(&mesh, (&source, &source_mesh), &transform).unwrap();
        let center = mesh.bounds().center();
        let ray = Ray { origin: center - DVec3::Z * 1e3, direction: DVec3::Z };
        let built = Bvh::build(&mesh).cast(&mesh, &ray).unwrap();
        assert_eq!(tree.cast(&mesh, &ray).unwrap().distance_mm, built.distance_mm);
    }
}
