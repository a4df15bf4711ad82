//! What a look at the picture says of one point of the contour, and what that means for the pose.

use glam::DVec3;

use super::measurements::{Measurement, Shared, row_of};
use super::picture::Picture;
use crate::math::Pose;
use crate::solve::contour::{ContourPoint, EdgeKind};
use crate::solve::motion::{motion_row, project_with_jacobian};
use crate::solve::robust::biweight;

/// A point of the contour belongs elsewhere on the line across it.
#[derive(Debug, Clone, Copy)]
pub struct Pull {
    pub point: ContourPoint,
    /// How far, counted along the point's normal, in pixels.
    pub offset_px: f64,
    pub variance_px2: f64,
    /// How much larger the offset would be at a [tone](Shared::tone) of 1 instead of 0.
    pub tone_px: f64,
}

/// What pulls say of small motions of `pose` about `pivot_camera_mm`. One of `gate_px` or more is of something else (Tukey's
/// biweight).
pub fn measurements(
    picture: &Picture,
    (pose, pivot_camera_mm): (&Pose, DVec3),
    pulls: &[Pull],
    gate_px: f64,
) -> Vec<Measurement> {
    let measurement = |pull: &Pull| {
        let seen = pose.transform_point(pull.point.point_mm);
        let (_, [by_x, by_y]) = project_with_jacobian(&picture.camera, seen)?;
        let normal = pull.point.normal;
        let sigma_px = pull.variance_px2.sqrt();
        let row = motion_row(seen - pivot_camera_mm, by_x * normal.x + by_y * normal.y);
        let is_outline = pull.point.kind == EdgeKind::Outline;
        let shared = Shared { tone: -pull.tone_px, growth_px: if is_outline { 1.0 } else { 0.0 } };
        Some(Measurement {
            residual: -pull.offset_px / sigma_px,
            row: row_of(&row, shared).map(|value| value / sigma_px),
            trust: biweight((pull.offset_px / gate_px).powi(2)),
        })
    };
    pulls.iter().filter_map(measurement).collect()
}
