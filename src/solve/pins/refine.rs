//! The pose that brings pins nearest to their pixels, from a start: robust least squares on SE(3).

use glam::{DVec2, DVec3};

use super::super::least_squares::{Limits, NormalEquations, levenberg_marquardt};
use super::super::motion::{motion_row, moved_about, project_with_jacobian, turn_row};
use super::Pin;
use crate::math::{Intrinsics, Pose};

/// How a residual's size counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kernel {
    Square,
    /// Beyond this many pixels it counts in proportion to its size (Huber, 1964).
    Huber(f64),
    /// Beyond this many pixels it does not count at all (Beaton and Tukey, 1974).
    Tukey(f64),
}

impl Kernel {
    /// The loss, and the weight with which a square stands for it, both 1 · r² for small residuals.
    fn loss_and_weight(self, squared: f64) -> (f64, f64) {
        match self {
            Self::Huber(width) if squared > width * width => {
                let size = squared.sqrt();
                (width * (2.0 * size - width), width / size)
            }
            Self::Tukey(width) if squared > width * width => (width * width / 3.0, 0.0),
            Self::Tukey(width) => {
                let rest = 1.0 - squared / (width * width);
                (width * width / 3.0 * (1.0 - rest.powi(3)), rest * rest)
            }
            Self::Square | Self::Huber(_) => (squared, 1.0),
        }
    }
}

/// What is thought of the pose before any pin is looked at: it stays as it is in what pins say nothing of.
#[derive(Debug, Clone, Copy)]
pub struct Prior {
    pose: Pose,
    pivot_object_mm: DVec3,
    tilt_sigma_rad: f64,
    depth_sigma_mm: f64,
}

/// Weak in roll and depth, and none at all in place, for pins say much of these: one standard deviation is half a turn.
const ROLL_SIGMA: f64 = 3.0;

impl Prior {
    /// About the place that the pins have in common.
    pub fn new(pose: Pose, pivot_object_mm: DVec3, tilt_sigma_rad: f64) -> Self {
        let depth_sigma_mm = pose.transform_point(pivot_object_mm).z.abs().max(1.0);
        Self { pose, pivot_object_mm, tilt_sigma_rad, depth_sigma_mm }
    }

    /// Adds its residuals, in units of its standard deviations times `unit_px`.
    fn add_to(&self, equations: &mut NormalEquations<6>, pose: &Pose, unit_px: f64) {
        let place = pose.transform_point(self.pivot_object_mm);
        let first = self.pose.transform_point(self.pivot_object_mm);
        let weight = |sigma: f64| (unit_px / sigma).powi(2);
        let depth_row = motion_row(DVec3::ZERO, DVec3::Z);
        equations.add(&depth_row, place.z - first.z, weight(self.depth_sigma_mm));
        // Two axes fixed to the object: the one that looked at the camera, and one across. What they gained along the axes
        // that they were perpendicular to is the tilt, and the roll.
        let view = first.normalize();
        let (across, up) = view.any_orthonormal_pair();
        let back = self.pose.rotation.transpose();
        let now = |axis: DVec3| pose.rotation * (back * axis);
        for (axis, against, sigma) in
            [(view, across, self.tilt_sigma_rad), (view, up, self.tilt_sigma_rad), (across, up, ROLL_SIGMA)]
        {
            let axis = now(axis);
            equations.add(&turn_row(axis, against), axis.dot(against), weight(sigma));
        }
    }
}

/// What a pose is fitted to.
#[derive(Debug, Clone, Copy)]
pub struct Fitting<'a> {
    pub camera: &'a Intrinsics,
    pub pins: &'a [Pin],
    pub kernel: Kernel,
    pub prior: Option<Prior>,
    /// The noise of a click: what a standard deviation of the prior is worth.
    pub click_sigma_px: f64,
}

/// A local minimum.
#[derive(Debug, Clone)]
pub struct Fit {
    pub pose: Pose,
    /// What steps of [`moved_about`] turn about.
    pub pivot_camera_mm: DVec3,
    /// In pixels, at `pose`.
    pub equations: NormalEquations<6>,
}

impl Fitting<'_> {
    /// Goes down from a start; `None` if a pin is behind the camera there.
    pub fn descend(&self, start: Pose) -> Option<Fit> {
        self.descend_within(start, 40)
    }

    pub fn descend_within(&self, start: Pose, iterations: u32) -> Option<Fit> {
        let pivot_object_mm = middle(self.pins)?;
        let limits = Limits {
            iterations,
            relative_decrease: 1e-10,
            // A ten-millionth of a pixel.
            good_enough: 1e-14 * self.pins.len() as f64,
        };
        let (pose, equations) = levenberg_marquardt(
            start,
            limits,
            |pose| self.linearize(pose, pose.transform_point(pivot_object_mm)),
            |pose, step| moved_about(pose, pose.transform_point(pivot_object_mm), step),
        )?;
        let pivot_camera_mm = pose.transform_point(pivot_object_mm);
        Some(Fit { pose, pivot_camera_mm, equations })
    }

    fn linearize(&self, pose: &Pose, pivot_camera_mm: DVec3) -> Option<NormalEquations<6>> {
        let mut equations = NormalEquations::ZERO;
        for pin in self.pins {
            let seen = pose.transform_point(pin.point_mm);
            let (pixel, jacobian) = project_with_jacobian(self.camera, seen)?;
            let residual = pixel - pin.pixel;
            let squared = residual.length_squared();
            let (loss, weight) = self.kernel.loss_and_weight(squared);
            for (gradient, residual) in jacobian.into_iter().zip(residual.to_array()) {
                equations.add(&motion_row(seen - pivot_camera_mm, gradient), residual, weight * pin.weight);
            }
            equations.cost += (loss - weight * squared) * pin.weight;
        }
        if let Some(prior) = &self.prior {
            prior.add_to(&mut equations, pose, self.click_sigma_px);
        }
        Some(equations)
    }
}

/// The weighted middle of the pins' points; `None` without pins.
pub fn middle(pins: &[Pin]) -> Option<DVec3> {
    let weight: f64 = pins.iter().map(|pin| pin.weight).sum();
    let sum: DVec3 = pins.iter().map(|pin| pin.point_mm * pin.weight).sum();
    (weight > 0.0).then(|| sum / weight)
}

/// Where the pin's point is seen minus where it was clicked; `None` where it is behind the camera.
pub fn residual(camera: &Intrinsics, pose: &Pose, pin: &Pin) -> Option<DVec2> {
    let pixel = camera.project(pose.transform_point(pin.point_mm))?;
    Some(pixel - pin.pixel).filter(|residual| residual.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_are_smooth_and_square_near_zero() {
        for kernel in [Kernel::Square, Kernel::Huber(3.0), Kernel::Tukey(3.0)] {
            for size in [0.1, 1.0, 2.9, 3.1, 5.0] {
                let (loss, weight) = kernel.loss_and_weight(size * size);
                let (next, _) = kernel.loss_and_weight((size + 1e-6_f64).powi(2));
                // The loss's slope is 2 r times the weight; the step is 1e-6, the curvature at most 2.
                assert!(((next - loss) / 1e-6 - 2.0 * size * weight).abs() < 1e-5, "{kernel:?} at {size}");
            }
            assert!((kernel.loss_and_weight(1e-4).0 - 1e-4).abs() < 1e-8);
        }
    }
}
