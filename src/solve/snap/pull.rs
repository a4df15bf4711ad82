//! What a look at the picture says of one point of the contour, and what that means for the pose.

use glam::DVec3;

use super::picture::Picture;
use crate::math::Pose;
use crate::solve::contour::{ContourPoint, EdgeKind};
use crate::solve::least_squares::NormalEquations;
use crate::solve::motion::{motion_row, project_with_jacobian};

/// A point of the contour belongs elsewhere on the line across it.
#[derive(Debug, Clone, Copy)]
pub struct Pull {
    pub point: ContourPoint,
    /// How far, counted along the point's normal, in pixels.
    pub offset_px: f64,
    pub variance_px: f64,
}

/// How much pulls of one kind count.
#[derive(Debug, Clone, Copy)]
pub struct Trust {
    /// What part of a measurement each is: neighbours err together.
    pub share: f64,
    /// A pull that is still this far off counts nothing (Tukey's biweight).
    pub gate_px: f64,
}

/// Adds the pulls to the normal equations of small motions of `pose` about `pivot_camera_mm`, and returns the gradient that
/// all of them would add if the whole contour were seen a pixel farther out.
pub fn add_pulls(
    equations: &mut NormalEquations<6>,
    picture: &Picture,
    (pose, pivot_camera_mm): (&Pose, DVec3),
    pulls: &[Pull],
    trust: Trust,
) -> [f64; 6] {
    let mut outward = [0.0; 6];
    for pull in pulls {
        let seen = pose.transform_point(pull.point.point_mm);
        let Some((pixel, [by_x, by_y])) = project_with_jacobian(&picture.camera, seen) else { continue };
        let normal = pull.point.normal;
        let residual = (pixel - pull.point.pixel).dot(normal) - pull.offset_px;
        let rest = 1.0 - (residual / trust.gate_px).powi(2);
        if rest > 0.0 {
            let row = motion_row(seen - pivot_camera_mm, by_x * normal.x + by_y * normal.y);
            let weight = trust.share * rest * rest / pull.variance_px;
            equations.add(&row, residual, weight);
            if pull.point.kind == EdgeKind::Outline {
                outward.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
            }
        }
    }
    outward
}
