//! What a mesh is drawn as, made ahead: on the page it takes longer than a frame may, so the worker does it.

use std::sync::{Mutex, PoisonError};

use super::{CoarseMesh, Mesh, ShadingMesh, coarse_mesh, shading_vertices};

/// From so many triangles on it is worth the way from the worker.
const FROM_TRIANGLES: usize = 20_000;

/// A mesh's vertices for the GPU, and those of its coarse copy if it has one.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnMesh {
    pub shading: ShadingMesh,
    pub coarse: Option<(CoarseMesh, ShadingMesh)>,
}

impl DrawnMesh {
    pub fn of(mesh: &Mesh) -> Self {
        let coarse = coarse_mesh(mesh).map(|coarse| {
            let shading = shading_vertices(&coarse.mesh);
            (coarse, shading)
        });
        Self { shading: shading_vertices(mesh), coarse }
    }

    /// Where making it would be noticed.
    pub fn ahead_of(mesh: &Mesh) -> Option<Self> {
        (mesh.triangles().len() >= FROM_TRIANGLES).then(|| Self::of(mesh))
    }
}

/// Kept until it is drawn for the first time: after that it is on the GPU.
#[derive(Debug, Default)]
pub struct DrawnAhead(Mutex<Option<DrawnMesh>>);

impl DrawnAhead {
    pub fn new(drawn: Option<DrawnMesh>) -> Self {
        Self(Mutex::new(drawn))
    }

    /// Has it not been drawn yet?
    pub fn is_fresh(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    pub fn take(&self) -> Option<DrawnMesh> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}
