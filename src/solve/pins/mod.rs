//! Pins to a pose: points on a mesh and the pixels where they belong.
//!
//! P3P for three pins, SQPnP for four and more, then Levenberg–Marquardt with the camera's distortion. What the pins leave
//! open is kept from the pose before, so that nothing jumps while they are set one by one.

mod advice;
mod focal;
mod misclicks;
mod p3p;
mod refine;
mod solution;
mod spread;
mod sqpnp;

use thiserror::Error;

use crate::math::{Intrinsics, Pose};
pub use crate::scene::Pin;
pub use advice::PinAdvice;
pub use focal::{FocalError, FocalSolution, solve_focal};
pub use solution::{PinPose, PinSolution, leave_open, solve_pins};

/// What is known of the clicks and the object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinOptions {
    /// The noise of a careful click, per axis: the measure for misclicks, ambiguity and, with few pins, uncertainty.
    pub click_sigma_px: f64,
    /// Lets advice say that the pins are on a small part of the object.
    pub object_diameter_mm: Option<f64>,
}

impl Default for PinOptions {
    fn default() -> Self {
        Self { click_sigma_px: 1.5, object_diameter_mm: None }
    }
}

/// Why there is no pose.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum PinError {
    #[error("pin {pin} holds a number that is not finite or too large, or a negative weight")]
    BadPin { pin: usize },
    #[error(
        "{pins} pins leave the pose open, and there is no pose to start from; three pins that are not on a line are needed"
    )]
    NeedsStart { pins: usize },
    #[error("no pose before the camera brings these pins to their pixels")]
    NoPose,
}

/// Those of the pins that count and that the others do not contradict, and how far their own pose leaves them off, in pixels
/// (root mean square).
pub fn explained(camera: &Intrinsics, pins: &[Pin], start: &Pose) -> (Vec<Pin>, f64) {
    let solution = solve_pins(camera, pins, Some(start), &PinOptions::default());
    let (misclicks, rms_px) =
        solution.map_or_else(|_| (Vec::new(), 0.0), |solution| (solution.misclicks, solution.rms_px));
    let is_explained = |(number, pin): &(usize, &Pin)| pin.counts() && !misclicks.contains(number);
    (pins.iter().enumerate().filter(is_explained).map(|(_, pin)| *pin).collect(), rms_px)
}

/// Farther from the origin than this nothing is: the limit of a mesh's coordinates, and beyond any photo.
const LARGEST_NUMBER: f64 = 1e9;

fn checked(pins: &[Pin]) -> Result<(), PinError> {
    let is_bad = |pin: &Pin| {
        let largest = pin.point_mm.abs().max_element().max(pin.pixel.abs().max_element()).max(pin.weight);
        let is_finite = pin.point_mm.is_finite() && pin.pixel.is_finite() && pin.weight.is_finite();
        !is_finite || largest > LARGEST_NUMBER || pin.weight < 0.0
    };
    pins.iter().position(is_bad).map_or(Ok(()), |pin| Err(PinError::BadPin { pin }))
}

#[cfg(test)]
mod tests;
