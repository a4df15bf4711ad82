//! All errors of one pose together.

use super::quick::add_mm;
use super::{
    VSD_TAUS, adi_mm, mask_error, mspd_px, mssd_mm, projection_error_px, visible_surface_discrepancy,
};
use crate::math::{Intrinsics, Pose};
use crate::mesh::{Mesh, PointTree};

/// An object's mesh with what its errors need, made once for all of its poses.
#[derive(Debug)]
pub struct Model<'a> {
    mesh: &'a Mesh,
    tree: PointTree,
    diameter_mm: f64,
    /// `object_from_object`, the identity first.
    symmetries: Vec<Pose>,
}

/// The photo that the poses are in.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    pub camera: &'a Intrinsics,
    /// z in millimetres for each of the camera's pixels, row by row; 0 where nothing was measured.
    pub depth_mm: Option<&'a [f32]>,
}

/// The errors of an estimated pose against a reference; see SOLVERS' and BOP's definitions at the functions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseErrors {
    /// The angle between the rotations. Knows nothing of symmetries, as in BOP.
    pub rotation_rad: f64,
    pub translation_mm: f64,
    /// Signed: how much farther from the camera, along its axis, the estimate has the middle of the object's box.
    pub depth_mm: f64,
    pub add_mm: f64,
    pub adi_mm: f64,
    /// ADI if the object is symmetric, else ADD.
    pub ad_mm: f64,
    pub mssd_mm: f64,
    /// `None` where a vertex is behind the camera; so the next.
    pub mspd_px: Option<f64>,
    pub projection_px: Option<f64>,
    /// For each of [`VSD_TAUS`].
    pub vsd: [f64; VSD_TAUS.len()],
    pub cus: f64,
}

impl<'a> Model<'a> {
    /// `symmetries` are `object_from_object`; the identity is added if it is not among them. `None` for a mesh without
    /// vertices.
    pub fn new(mesh: &'a Mesh, symmetries: Vec<Pose>) -> Option<Self> {
        let tree = PointTree::build(mesh.positions_mm())?;
        let diameter_mm = tree.diameter();
        let others = symmetries.into_iter().filter(|symmetry| *symmetry != Pose::IDENTITY);
        let symmetries = std::iter::once(Pose::IDENTITY).chain(others).collect();
        Some(Self { mesh, tree, diameter_mm, symmetries })
    }

    /// The largest distance between two vertices.
    pub fn diameter_mm(&self) -> f64 {
        self.diameter_mm
    }

    pub fn is_symmetric(&self) -> bool {
        self.symmetries.len() > 1
    }

    pub fn errors(&self, estimate: &Pose, reference: &Pose, view: View<'_>) -> PoseErrors {
        let mesh = self.mesh;
        let add_mm = add_mm(estimate, reference, mesh, usize::MAX);
        let adi_mm = adi_mm(estimate, reference, mesh, &self.tree);
        let center = mesh.bounds().center();
        let depth_of = |pose: &Pose| pose.transform_point(center).z;
        PoseErrors {
            rotation_rad: estimate.angle_to(reference),
            translation_mm: estimate.translation_mm.distance(reference.translation_mm),
            depth_mm: depth_of(estimate) - depth_of(reference),
            add_mm,
            adi_mm,
            ad_mm: if self.is_symmetric() { adi_mm } else { add_mm },
            mssd_mm: mssd_mm(estimate, reference, mesh, &self.symmetries),
            mspd_px: mspd_px(estimate, reference, mesh, &self.symmetries, view.camera),
            projection_px: projection_error_px(estimate, reference, mesh, view.camera),
            vsd: visible_surface_discrepancy(
                estimate,
                reference,
                mesh,
                view.camera,
                view.depth_mm,
                self.diameter_mm,
            ),
            cus: mask_error(estimate, reference, mesh, view.camera),
        }
    }
}
