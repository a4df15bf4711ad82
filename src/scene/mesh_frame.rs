//! Mirror and spacing: what may be done to a mesh before a pose, so that a pose stays a proper rotation.

use glam::{DMat4, DVec3, DVec4};
use thiserror::Error;

/// The transform from a mesh file's numbers to the `object` frame, with the names that people have for its parts.
///
/// Mirrors and spacings act along the file's own axes and about its origin, so that each is undone exactly by itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshFrame(pub DMat4);

#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum MeshFrameError {
    #[error("a spacing of {0} is not possible, a number above 0 is expected")]
    Spacing(f64),
    #[error("the transform of a mesh has to be an invertible affine 4×4")]
    NotInvertible,
}

impl MeshFrame {
    /// Takes a matrix from outside.
    pub fn checked(mesh_from_file: DMat4) -> Result<Self, MeshFrameError> {
        let determinant = mesh_from_file.determinant();
        let affine = mesh_from_file.row(3) == DVec4::W;
        if mesh_from_file.is_finite() && affine && determinant.is_finite() && determinant.abs() > 1e-30 {
            Ok(Self(mesh_from_file))
        } else {
            Err(MeshFrameError::NotInvertible)
        }
    }

    /// The length in millimetres of one unit of the file along each of its axes.
    pub fn spacing(&self) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|axis| self.0.col(axis).length()))
    }

    /// Is an axis (0 to 2) of the file turned round?
    pub fn is_mirrored(&self, axis: usize) -> bool {
        self.0.col(axis)[axis] < 0.0
    }

    pub fn mirrored(&self, axis: usize) -> Self {
        let mut signs = DVec3::ONE;
        signs[axis] = -1.0;
        Self(self.0 * DMat4::from_scale(signs))
    }

    pub fn with_spacing(&self, axis: usize, spacing: f64) -> Result<Self, MeshFrameError> {
        if !(spacing.is_finite() && spacing > 0.0) {
            return Err(MeshFrameError::Spacing(spacing));
        }
        let mut matrix = self.0;
        let column = matrix.col(axis);
        // An axis-aligned column is set, not scaled: typing the old number brings back the old matrix bit for bit.
        let aligned = (0..3).find(|&row| column[row].abs() == column.length());
        *matrix.col_mut(axis) = match aligned {
            Some(row) => {
                let mut set = DVec4::ZERO;
                set[row] = spacing * column[row].signum();
                set
            }
            None => column * (spacing / column.length()),
        };
        Self::checked(matrix)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mirrors_and_spacings_are_undone_by_themselves() {
        let start = MeshFrame(DMat4::IDENTITY);
        let changed = start.mirrored(1).with_spacing(1, 0.3).unwrap().with_spacing(2, 7.1).unwrap();
        assert!(changed.is_mirrored(1) && !changed.is_mirrored(0));
        assert_eq!(changed.spacing(), DVec3::new(1.0, 0.3, 7.1));
        let back = changed.with_spacing(2, 1.0).unwrap().with_spacing(1, 1.0).unwrap().mirrored(1);
        assert_eq!(back, start);
    }

    #[test]
    fn a_mesh_cannot_be_made_flat() {
        let start = MeshFrame(DMat4::IDENTITY);
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(start.with_spacing(0, bad), Err(MeshFrameError::Spacing(_))), "{bad}");
        }
        assert!(MeshFrame::checked(DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0))).is_err());
        assert!(MeshFrame::checked(DMat4::from_cols_array(&[f64::NAN; 16])).is_err());
    }
}
