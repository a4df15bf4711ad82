//! Poses and symmetries as the files of a study have them.

use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

use crate::math::{Pose, PoseError};
use crate::scene::{ContinuousSymmetry, Symmetries};

/// A `camera_from_object` (or `object_from_object`) in a file: R row by row, t in millimetres, OpenCV camera axes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PoseRecord {
    #[serde(rename = "R")]
    pub rotation: [[f64; 3]; 3],
    #[serde(rename = "t")]
    pub translation_mm: [f64; 3],
}

impl From<Pose> for PoseRecord {
    fn from(pose: Pose) -> Self {
        Self { rotation: pose.rotation_rows(), translation_mm: pose.translation_mm.to_array() }
    }
}

impl PoseRecord {
    /// The pose, bit for bit where it is one; a rotation that is slightly off is brought back to SO(3).
    pub fn to_pose(&self) -> Result<Pose, PoseError> {
        let rotation = DMat3::from_cols_array_2d(&self.rotation).transpose();
        Pose::from_parts(rotation, DVec3::from_array(self.translation_mm)).map(|(pose, _)| pose)
    }
}

/// An object's transforms onto itself, in its own frame, millimetres.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SymmetriesRecord {
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub discrete: Vec<PoseRecord>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub continuous: Vec<ContinuousRecord>,
}

/// Every turn about an axis through a point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContinuousRecord {
    pub axis: [f64; 3],
    pub offset_mm: [f64; 3],
}

impl SymmetriesRecord {
    pub fn of(symmetries: &Symmetries) -> Self {
        let continuous = symmetries.continuous.iter().map(|symmetry| ContinuousRecord {
            axis: symmetry.axis.to_array(),
            offset_mm: symmetry.offset_mm.to_array(),
        });
        Self {
            discrete: symmetries.discrete.iter().map(|pose| PoseRecord::from(*pose)).collect(),
            continuous: continuous.collect(),
        }
    }

    /// `None` where a matrix is no pose or an axis has no length.
    pub fn to_symmetries(&self) -> Option<Symmetries> {
        let discrete = self.discrete.iter().map(|pose| pose.to_pose().ok()).collect::<Option<Vec<_>>>()?;
        let continuous = self.continuous.iter().map(|record| {
            let axis = DVec3::from_array(record.axis).try_normalize()?;
            Some(ContinuousSymmetry { axis, offset_mm: DVec3::from_array(record.offset_mm) })
        });
        Some(Symmetries { discrete, continuous: continuous.collect::<Option<Vec<_>>>()? })
    }
}
