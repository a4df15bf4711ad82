//! What is known before the picture is looked at: the start, pins, and how far off outlines are together.

use glam::DVec3;

use super::SnapReach;
use super::measurements::{Equations, Shared, row_of};
use super::picture::Picture;
use crate::math::{Intrinsics, Pose};
use crate::solve::motion::{motion_row, project_with_jacobian, step_between};
use crate::solve::pins::{self, Pin};

/// Noise of a careful click: what a pin pulls with, unless pins leave each other farther off.
const PIN_SIGMA_PX: f64 = 2.0;
const PINS_OF_A_POSE: usize = 4;
/// How many residuals of careful clicks stand beside the pins' own: four pins leave two, which say little.
const CAREFUL_RESIDUALS: f64 = 4.0;
/// Beyond this the pins are not of one pose.
const LARGEST_PIN_SIGMA_PX: f64 = 1.5 * PIN_SIGMA_PX;
/// How far cameras' curves are from the usual one, and outlines from where meshes have them: one standard deviation.
const SHARED_SIGMA: Shared = Shared { tone: 2.0, growth_px: 0.15 };

#[derive(Debug, Clone)]
pub struct Prior {
    /// From the `object` frame to the `camera` frame.
    pub start: Pose,
    /// Those that pull.
    pub pins: Vec<Pin>,
    /// How far a click is off, one standard deviation along each axis of the photo.
    pub pin_sigma_px: f64,
    pub reach: SnapReach,
}

/// How well somebody puts an object by hand, one standard deviation.
struct Spread {
    /// About each axis.
    turn_rad: f64,
    /// As a part of the distance.
    depth: f64,
    /// Along each axis of the photo.
    shift_px: f64,
}

impl Prior {
    pub fn new(camera: &Intrinsics, start: &Pose, pins: &[Pin], reach: SnapReach) -> Self {
        let (pins, rms_px) = pins::explained(camera, pins, start);
        let mut prior = Self { start: *start, pins, pin_sigma_px: PIN_SIGMA_PX, reach };
        if prior.is_pinned() {
            let count = prior.pins.len() as f64;
            let surplus = 2.0 * count - 6.0;
            let squares = count * rms_px * rms_px + CAREFUL_RESIDUALS * PIN_SIGMA_PX * PIN_SIGMA_PX;
            prior.pin_sigma_px = (squares / (surplus + CAREFUL_RESIDUALS)).sqrt().max(PIN_SIGMA_PX);
        }
        prior
    }

    fn spread(&self) -> Spread {
        let Spread { turn_rad, depth, shift_px } = match self.reach {
            SnapReach::Near => Spread { turn_rad: 5_f64.to_radians(), depth: 0.04, shift_px: 10.0 },
            SnapReach::Wide => Spread { turn_rad: 12_f64.to_radians(), depth: 0.08, shift_px: 20.0 },
        };
        // A start that pins made says nothing that the pins do not say themselves.
        let factor = if self.is_pinned() { 10.0 } else { 1.0 };
        Spread { turn_rad: factor * turn_rad, depth: factor * depth, shift_px: factor * shift_px }
    }

    /// Whether there are pins enough to make a pose of.
    pub fn is_pinned(&self) -> bool {
        self.pins.len() >= PINS_OF_A_POSE
    }

    /// Whether the pins want poses too different for their own to be near the truth.
    pub fn pins_disagree(&self) -> bool {
        self.pin_sigma_px > LARGEST_PIN_SIGMA_PX
    }

    /// Adds what pins want of a pose, for small motions of it about `pivot`, in camera axes.
    pub fn add_pins(
        &self,
        equations: &mut Equations,
        picture: &Picture,
        (pose, pivot_camera_mm): (&Pose, DVec3),
    ) {
        for pin in &self.pins {
            let seen = pose.transform_point(pin.point_mm);
            let Some((pixel, jacobian)) = project_with_jacobian(&picture.camera, seen) else { continue };
            let weight = pin.weight * (picture.photo_px / self.pin_sigma_px).powi(2);
            let residual = pixel - picture.place_of(pin.pixel);
            for (gradient, residual) in jacobian.into_iter().zip(residual.to_array()) {
                let row = row_of(&motion_row(seen - pivot_camera_mm, gradient), Shared::default());
                equations.add(&row, residual, weight);
            }
        }
    }

    /// What is shared is as usual, unless the picture says otherwise.
    pub fn add_shared(equations: &mut Equations) {
        let Shared { tone, growth_px } = SHARED_SIGMA;
        for (axis, sigma) in
            [(Shared { tone: 1.0, growth_px: 0.0 }, tone), (Shared { tone: 0.0, growth_px: 1.0 }, growth_px)]
        {
            equations.add(&row_of(&[0.0; 6], axis), 0.0, 1.0 / (sigma * sigma));
        }
    }

    /// The start is where somebody put the object on purpose: what the picture says nothing of stays as it was.
    pub fn add_start(&self, equations: &mut Equations, picture: &Picture, pose: &Pose, center_mm: DVec3) {
        let Spread { turn_rad, depth, shift_px } = self.spread();
        let distance_mm = self.start.transform_point(center_mm).z;
        let lateral_mm = shift_px * distance_mm / (picture.camera.focal_px() * picture.photo_px);
        let depth_mm = depth * distance_mm;
        let sigmas = [turn_rad, turn_rad, turn_rad, lateral_mm, lateral_mm, depth_mm];
        let residuals = step_between(&self.start, pose, center_mm);
        for (i, (residual, sigma)) in residuals.into_iter().zip(sigmas).enumerate() {
            let mut row = [0.0; 6];
            row[i] = 1.0;
            equations.add(&row_of(&row, Shared::default()), residual, 1.0 / (sigma * sigma));
        }
    }
}
