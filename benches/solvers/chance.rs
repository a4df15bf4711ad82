//! Repeatable chance.

use glam::{DVec2, DVec3};
use pinpose::math::Pose;

/// Vigna's SplitMix64.
pub struct Chance(pub u64);

impl Chance {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// From 0 to 1.
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From −1 to 1.
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    pub fn sign(&mut self) -> f64 {
        if self.next() & 1 == 0 { 1.0 } else { -1.0 }
    }

    /// Of variance one (Box and Muller).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.unit()).cos()
    }

    pub fn direction(&mut self) -> DVec3 {
        DVec3::new(self.normal(), self.normal(), self.normal()).normalize()
    }

    pub fn direction_in_image(&mut self) -> DVec2 {
        DVec2::from_angle(std::f64::consts::TAU * self.unit())
    }

    /// Any rotation, all alike.
    pub fn rotation(&mut self) -> Pose {
        let quaternion = glam::DQuat::from_xyzw(self.normal(), self.normal(), self.normal(), self.normal());
        let rotation = glam::DMat3::from_quat(quaternion.normalize());
        Pose { rotation, translation_mm: DVec3::ZERO }
    }
}
