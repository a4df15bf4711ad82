//! How far a pose is from another: the field's errors, as BOP defines them (Hodaň et al., *BOP*, 2018 and 2020).
//!
//! Knows nothing of files: meshes, cameras and poses in, numbers out.

mod compare;
mod evaluation;
mod quick;
mod summary;
mod surface;
mod vertices;

pub use compare::{ComparedPose, Comparison, PoseSet, Recalls, annotated_poses, compare};
pub use evaluation::{Model, PoseErrors, View};
pub use quick::{LIVE_VERTICES, PoseError};
pub use summary::{Metric, Statistics, quantile};
pub use surface::{VSD_DELTA_MM, VSD_TAUS, mask_error, visible_surface_discrepancy};
pub use vertices::{ad_mm, adi_mm, mspd_px, mssd_mm, projection_error_px};

#[cfg(test)]
mod tests;
