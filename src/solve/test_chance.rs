//! Repeatable chance for this room's tests.

use glam::{DVec2, DVec3};

use crate::math::{Intrinsics, Pose};

/// Vigna's SplitMix64.
pub struct Chance(pub u64);

impl Chance {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// From −1 to 1.
    pub fn signed(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    /// Of variance one (Box and Muller).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (0.5 + 0.5 * self.signed()).max(1e-300).ln()).sqrt();
        radius * (std::f64::consts::PI * self.signed()).cos()
    }

    pub fn normal_pixel(&mut self) -> DVec2 {
        DVec2::new(self.normal(), self.normal())
    }

    pub fn vector(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }

    /// Any rotation, near the optical axis, at this distance.
    pub fn pose(&mut self, distance_mm: f64) -> Pose {
        let axis = DVec3::new(self.normal(), self.normal(), self.normal()).normalize();
        let turn = Pose::exp(axis * (std::f64::consts::PI * self.signed()), DVec3::ZERO);
        turn.translated(DVec3::new(100.0 * self.signed(), 80.0 * self.signed(), distance_mm))
    }
}

/// The camera of Linemod, roughly.
pub fn camera() -> Intrinsics {
    Intrinsics::pinhole(572.4, 573.6, 325.3, 242.0, 640, 480)
}
