//! Unit, axes, mirror and spacing: what may be done to a mesh before a pose, so that a pose stays a proper rotation.

use glam::{DMat4, DVec3, DVec4};
use thiserror::Error;

use crate::mesh::{FileUnit, MeshUnit};

/// The transform from a mesh file's numbers to the `object` frame, with the names that people have for its parts.
///
/// Mirrors and spacings act along the file's own axes and about its origin, so that each is undone exactly by itself; the turn
/// that puts one of the file's axes upright comes last.
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

    /// The unit of the file's numbers, where it is one that people have and the same along each axis.
    pub fn unit(&self, file: FileUnit) -> Option<MeshUnit> {
        let spacing = self.spacing() * file.loaded_factor();
        let is_even = (spacing / spacing.x - 1.0).abs().max_element() < 1e-9;
        MeshUnit::of_mm(spacing.x).filter(|_| is_even)
    }

    /// With every axis in this unit.
    pub fn with_unit(&self, unit: MeshUnit, file: FileUnit) -> Result<Self, MeshFrameError> {
        let spacing = unit.in_mm() / file.loaded_factor();
        (0..3).try_fold(*self, |frame, axis| frame.with_spacing(axis, spacing))
    }

    /// Which of the file's axes (0 to 2) is z in the `object` frame; `None` after a turn that has no such name.
    pub fn up_axis(&self) -> Option<usize> {
        let is_turned_by = |turn: DMat4| {
            let rest = turn.transpose() * self.0;
            (0..3).all(|axis| (0..3).all(|row| row == axis || rest.col(axis)[row] == 0.0))
        };
        (0..3).find(|&axis| is_turned_by(upright(axis)))
    }

    /// Turned so that this axis of the file points up.
    pub fn with_up_axis(&self, axis: usize) -> Self {
        let present = upright(self.up_axis().unwrap_or(Z));
        Self(without_negative_zeros(upright(axis) * present.transpose() * self.0))
    }

    /// How many times larger everything is than in another frame of the same file; `None` where they differ in more than that.
    pub fn times_larger_than(&self, other: &Self) -> Option<f64> {
        let factor = self.0.col(0).length() / other.0.col(0).length();
        let scaled = other.0 * DMat4::from_scale(DVec3::splat(factor));
        let tolerance = 1e-12 * self.spacing().max_element();
        self.0.abs_diff_eq(scaled, tolerance).then_some(factor)
    }

    /// Is an axis (0 to 2) of the file turned round?
    pub fn is_mirrored(&self, axis: usize) -> bool {
        let turn = upright(self.up_axis().unwrap_or(Z));
        (turn.transpose() * self.0).col(axis)[axis] < 0.0
    }

    pub fn mirrored(&self, axis: usize) -> Self {
        let mut signs = DVec3::ONE;
        signs[axis] = -1.0;
        Self(without_negative_zeros(self.0 * DMat4::from_scale(signs)))
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

/// The axis that points up where nothing was turned.
const Z: usize = 2;

/// The rotation that makes one of three axes z. It keeps x where it can, as programs do that turn "y up" into "z up".
fn upright(axis: usize) -> DMat4 {
    match axis {
        0 => DMat4::from_cols(DVec4::Z, DVec4::X, DVec4::Y, DVec4::W),
        1 => DMat4::from_cols(DVec4::X, DVec4::Z, -DVec4::Y, DVec4::W),
        _ => DMat4::IDENTITY,
    }
}

fn without_negative_zeros(matrix: DMat4) -> DMat4 {
    DMat4::from_cols_array(&matrix.to_cols_array().map(|number| number + 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_and_axes_are_undone_by_themselves() {
        let start = MeshFrame(DMat4::IDENTITY);
        let unknown = FileUnit::Unknown;
        assert_eq!((start.unit(unknown), start.up_axis()), (Some(MeshUnit::Millimetre), Some(2)));
        assert_eq!(start.unit(FileUnit::Gltf), Some(MeshUnit::Metre));
        for unit in MeshUnit::ALL {
            for axis in 0..3 {
                for mirror in 0..3 {
                    let changed = start.with_up_axis(axis).mirrored(mirror).with_unit(unit, unknown).unwrap();
                    assert_eq!((changed.unit(unknown), changed.up_axis()), (Some(unit), Some(axis)));
                    assert_eq!(
                        [0, 1, 2].map(|axis| changed.is_mirrored(axis)),
                        [0, 1, 2].map(|a| a == mirror)
                    );
                    assert_eq!(
                        changed.times_larger_than(&start.with_up_axis(axis).mirrored(mirror)),
                        Some(unit.in_mm())
                    );
                    let back = changed.with_unit(MeshUnit::Millimetre, unknown).unwrap().mirrored(mirror);
                    assert_eq!(back.with_up_axis(2), start);
                }
            }
        }
        let spaced = start.with_spacing(1, 2.5).unwrap();
        assert_eq!((spaced.unit(unknown), spaced.times_larger_than(&start)), (None, None));
    }

    #[test]
    fn the_axis_that_is_up_becomes_z() {
        let start = MeshFrame(DMat4::IDENTITY);
        for (axis, up) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate() {
            let turned = start.with_up_axis(axis).0;
            assert_eq!(turned.transform_vector3(up), DVec3::Z);
            assert_eq!(turned.determinant(), 1.0);
        }
        assert_eq!(start.with_up_axis(1).0.transform_vector3(DVec3::X), DVec3::X);
        // A frame from elsewhere keeps what it has and is turned on top of it.
        let odd = MeshFrame(DMat4::from_rotation_x(0.3));
        assert_eq!(odd.up_axis(), None);
        // Products of sines and cosines: a few roundings.
        assert!((odd.with_up_axis(1).0.determinant() - 1.0).abs() < 1e-12);
    }

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
