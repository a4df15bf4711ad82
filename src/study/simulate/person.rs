//! One simulated person: how exact, how fast.

use std::f64::consts::TAU;

use glam::{DMat3, DQuat, DVec3};

use crate::math::Pose;
use crate::study::{Chance, Tool};

/// Half a turn about each axis, in radians: together about the paper's 5 degrees.
const TURN_RAD: f64 = 0.045;
/// Sideways, as a part of the distance: a few pixels at common focal lengths.
const SIDEWAYS: f64 = 0.004;
/// Along the view ray, as a part of the distance: an outline hardly shows it.
const AWAY: f64 = 0.02;
/// The paper's people took about 100 seconds, and between 54 and 155 on the average.
const SECONDS: f64 = 90.0;
const SPREAD_OF_SECONDS: f64 = 0.3;
/// How much longer the first trial takes, and after how many trials that has gone down to a third.
const LEARNING: f64 = 0.5;
const TRIALS_OF_LEARNING: f64 = 6.0;

/// What refining by the photo leaves of the noise and of the time.
const WITH_SNAP: [f64; 2] = [0.45, 0.75];
/// What pins leave.
const WITH_PINS: [f64; 2] = [0.8, 0.9];

/// Someone with a skill and a pace of their own.
pub struct Person {
    chance: Chance,
    /// Noise as a part of the usual.
    clumsiness: f64,
    /// Time as a part of the usual.
    slowness: f64,
    /// −1 to 1 or so: how good the tool seems.
    pub mood: f64,
}

impl Person {
    pub fn new(seed: u64, id: &str) -> Self {
        let mut chance = Chance::of(seed, id);
        let clumsiness = (0.3 * normal(&mut chance)).exp();
        let slowness = (SPREAD_OF_SECONDS * normal(&mut chance)).exp();
        let mood = 0.5 * normal(&mut chance);
        Self { chance, clumsiness, slowness, mood }
    }

    pub fn chance(&mut self) -> &mut Chance {
        &mut self.chance
    }

    pub fn normal(&mut self) -> f64 {
        normal(&mut self.chance)
    }

    /// The true pose at any of the object's symmetries, turned about the object's middle and moved, mostly in depth.
    pub fn pose(&mut self, truth: &Pose, symmetries: &[Pose], center_object: DVec3, tools: &[Tool]) -> Pose {
        let twin = symmetries.get(self.chance.below(symmetries.len())).copied().unwrap_or_default();
        let truth = *truth * twin;
        let noise = self.clumsiness * (0.3 * self.normal()).exp() * factor(tools, 0);
        let center_camera = truth.transform_point(center_object);
        let distance_mm = center_camera.length();
        let turn = self.normal_vector() * (TURN_RAD * noise);
        let sideways = self.normal_vector() * (SIDEWAYS * noise * distance_mm);
        let away = center_camera.normalize_or_zero() * (self.normal() * AWAY * noise * distance_mm);
        let turn = DMat3::from_quat(DQuat::from_scaled_axis(turn));
        (Pose::rotation_about(center_camera, turn) * truth).translated(sideways + away).renormalized()
    }

    /// For the trial in this place of the person's order.
    pub fn seconds(&mut self, place: usize, tools: &[Tool]) -> f64 {
        let learning = 1.0 + LEARNING * (-(place as f64) / TRIALS_OF_LEARNING).exp();
        let spread = (SPREAD_OF_SECONDS * self.normal()).exp();
        SECONDS * self.slowness * learning * spread * factor(tools, 1)
    }

    fn normal_vector(&mut self) -> DVec3 {
        DVec3::new(self.normal(), self.normal(), self.normal())
    }
}

/// How much the tools leave of the noise (0) or of the time (1).
fn factor(tools: &[Tool], of: usize) -> f64 {
    let mut factor = 1.0;
    for (tool, leaves) in [(Tool::Snap, WITH_SNAP), (Tool::Pins, WITH_PINS)] {
        if tools.contains(&tool) {
            factor *= leaves[of];
        }
    }
    // The usual is a person with the mouse alone, as in the paper.
    factor
}

/// Mean 0, standard deviation 1. (Box and Muller, 1958.)
fn normal(chance: &mut Chance) -> f64 {
    let radius = (-2.0 * (1.0 - chance.unit()).ln()).sqrt();
    radius * (TAU * chance.unit()).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_numbers_are_spread_as_they_say() {
        let mut chance = Chance::new(1);
        let drawn: Vec<f64> = (0..20_000).map(|_| normal(&mut chance)).collect();
        let mean = drawn.iter().sum::<f64>() / 20_000.0;
        let variance = drawn.iter().map(|value| value * value).sum::<f64>() / 20_000.0;
        // Four standard errors: 4/√20000 and 4·√(2/20000).
        assert!(mean.abs() < 0.029 && (variance - 1.0).abs() < 0.04, "{mean} {variance}");
    }
}
