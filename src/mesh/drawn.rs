//! What a mesh is drawn as, made ahead: on the page it takes longer than a frame may, so the worker does it.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::{CoarseMesh, Mesh, ShadingMesh, coarse_mesh, shading_vertices};

/// From so many triangles on it is worth the way from the worker.
const FROM_TRIANGLES: usize = 20_000;

/// A mesh's vertices for the GPU, and those of its coarse copy if it has one.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnMesh {
    /// `None`: they come later, or are made when they are needed.
    pub shading: Option<ShadingMesh>,
    pub coarse: Option<(CoarseMesh, ShadingMesh)>,
}

impl DrawnMesh {
    /// The coarse copy alone, for a mesh that has one: it is what is seen first.
    pub fn of(mesh: &Mesh) -> Self {
        let coarse = coarse_mesh(mesh).map(|coarse| {
            let shading = shading_vertices(&coarse.mesh);
            (coarse, shading)
        });
        let shading = coarse.is_none().then(|| shading_vertices(mesh));
        Self { shading, coarse }
    }

    /// Where making it would be noticed.
    pub fn ahead_of(mesh: &Mesh) -> Option<Self> {
        (mesh.triangles().len() >= FROM_TRIANGLES).then(|| Self::of(mesh))
    }

    /// Is what is missing worth a way to the worker of its own?
    pub fn is_coarse_alone(&self) -> bool {
        self.shading.is_none()
    }
}

/// Kept until it is drawn for the first time: after that it is on the GPU.
#[derive(Debug, Default)]
pub struct DrawnAhead(Mutex<Ahead>);

#[derive(Debug, Default)]
struct Ahead {
    first: Option<DrawnMesh>,
    /// What came after a coarse copy.
    whole: Option<ShadingMesh>,
    is_promised: bool,
}

impl DrawnAhead {
    pub fn new(drawn: Option<DrawnMesh>) -> Self {
        Self(Mutex::new(Ahead { first: drawn, ..Ahead::default() }))
    }

    /// With a coarse copy; the vertices of the whole are on their way.
    pub fn promised(drawn: DrawnMesh) -> Self {
        Self(Mutex::new(Ahead { first: Some(drawn), whole: None, is_promised: true }))
    }

    /// Has it not been drawn yet, or not all of it?
    pub fn is_fresh(&self) -> bool {
        let ahead = self.lock();
        ahead.first.is_some() || ahead.is_promised
    }

    pub fn take(&self) -> Option<DrawnMesh> {
        self.lock().first.take()
    }

    pub fn take_whole(&self) -> Option<ShadingMesh> {
        self.lock().whole.take()
    }

    pub fn give_whole(&self, shading: ShadingMesh) {
        let mut ahead = self.lock();
        (ahead.whole, ahead.is_promised) = (Some(shading), false);
    }

    /// Nobody is at it any more: whoever draws it makes it.
    pub fn withdraw(&self) {
        self.lock().is_promised = false;
    }

    fn lock(&self) -> MutexGuard<'_, Ahead> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
