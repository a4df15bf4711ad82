//! The pinhole camera with Brown–Conrady distortion: K, and what it does to points and pixels.

use glam::{DMat3, DVec2, DVec3};
use thiserror::Error;

use super::Ray;

/// Brown–Conrady coefficients in OpenCV's order `k1 k2 p1 p2 k3`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Distortion {
    pub k1: f64,
    pub k2: f64,
    pub p1: f64,
    pub p2: f64,
    pub k3: f64,
}

/// A photo's intrinsics: K = [[fx, skew, cx], [0, fy, cy], [0, 0, 1]] in pixels of an image of this size, in the `image`
/// frame (pixel centres at whole numbers).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intrinsics {
    pub fx: f64,
    pub fy: f64,
    pub cx: f64,
    pub cy: f64,
    pub skew: f64,
    pub distortion: Distortion,
    pub width: u32,
    pub height: u32,
}

/// Why numbers are not a camera.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum CameraError {
    #[error("{name} is {value}, expected a finite number")]
    NotFinite { name: &'static str, value: f64 },
    #[error("the focal length {name} is {value}, expected a positive number of pixels")]
    FocalNotPositive { name: &'static str, value: f64 },
    #[error("K is not [[fx, s, cx], [0, fy, cy], [0, 0, 1]]")]
    NotACameraMatrix,
    #[error("the image size {width}×{height} is empty or larger than 65535 pixels a side")]
    BadSize { width: u32, height: u32 },
}

impl Distortion {
    pub const NONE: Self = Self { k1: 0.0, k2: 0.0, p1: 0.0, p2: 0.0, k3: 0.0 };

    pub fn is_none(&self) -> bool {
        *self == Self::NONE
    }

    pub fn to_array(self) -> [f64; 5] {
        [self.k1, self.k2, self.p1, self.p2, self.k3]
    }

    pub fn from_array([k1, k2, p1, p2, k3]: [f64; 5]) -> Self {
        Self { k1, k2, p1, p2, k3 }
    }

    /// Moves a normalised point (x/z, y/z) to where the lens puts it.
    pub fn distort(&self, normalized: DVec2) -> DVec2 {
        let DVec2 { x, y } = normalized;
        let r2 = self.held_radius_squared(normalized.length_squared());
        let radial = 1.0 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3));
        DVec2::new(
            x * radial + 2.0 * self.p1 * x * y + self.p2 * (r2 + 2.0 * x * x),
            y * radial + self.p1 * (r2 + 2.0 * y * y) + 2.0 * self.p2 * x * y,
        )
    }

    /// Undoes [`Self::distort`] by fixed-point iteration, as OpenCV's `undistortPoints` does.
    pub fn undistort(&self, distorted: DVec2) -> DVec2 {
        if self.is_none() {
            return distorted;
        }
        let mut normalized = distorted;
        for _ in 0..50 {
            let step = distorted - self.distort(normalized);
            normalized += step;
            if step.length_squared() < 1e-28 || !normalized.is_finite() {
                break;
            }
        }
        if normalized.is_finite() { normalized } else { distorted }
    }

    /// The squared radius that counts: the point's own within the lens, the lens's beyond it.
    fn held_radius_squared(&self, r2: f64) -> f64 {
        // Near the axis the polynomial grows whatever the signs are; the search for its end is left out there.
        let falls_at_most =
            r2 * (3.0 * self.k1.abs() + r2 * (5.0 * self.k2.abs() + r2 * 7.0 * self.k3.abs()));
        if falls_at_most < 1.0 { r2 } else { r2.min(self.valid_radius_squared()) }
    }

    /// The largest squared radius up to which the radial polynomial grows. Beyond it a real lens shows nothing, and the
    /// polynomial would fold far points back into the picture; there the factor is held.
    pub fn valid_radius_squared(&self) -> f64 {
        // d/dr (r + k1 r³ + k2 r⁵ + k3 r⁷) = 1 + 3 k1 s + 5 k2 s² + 7 k3 s³ with s = r²; the first root, by marching:
        // coarse and safe, for coefficients are given to a few digits only.
        let slope = |s: f64| 1.0 + s * (3.0 * self.k1 + s * (5.0 * self.k2 + s * 7.0 * self.k3));
        let steps = 512;
        let farthest = 16.0;
        (1..=steps)
            .map(|i| farthest * f64::from(i) / f64::from(steps))
            .find(|&s| slope(s) <= 0.0)
            .unwrap_or(f64::INFINITY)
    }
}

impl Intrinsics {
    /// A pinhole camera without skew or distortion.
    pub fn pinhole(fx: f64, fy: f64, cx: f64, cy: f64, width: u32, height: u32) -> Self {
        Self { fx, fy, cx, cy, skew: 0.0, distortion: Distortion::NONE, width, height }
    }

    /// A camera with its principal point in the middle of the image and this horizontal field of view.
    pub fn from_horizontal_fov(fov_rad: f64, width: u32, height: u32) -> Self {
        Self::from_focal(f64::from(width) / 2.0 / (fov_rad / 2.0).tan(), width, height)
    }

    /// A camera with its principal point in the middle of the image and this focal length in pixels.
    pub fn from_focal(focal_px: f64, width: u32, height: u32) -> Self {
        let middle = |size: u32| (f64::from(size) - 1.0) / 2.0;
        Self::pinhole(focal_px, focal_px, middle(width), middle(height), width, height)
    }

    /// Takes K row by row.
    pub fn from_k_rows(k: &[[f64; 3]; 3], width: u32, height: u32) -> Result<Self, CameraError> {
        if k[1][0] != 0.0 || k[2] != [0.0, 0.0, 1.0] {
            return Err(CameraError::NotACameraMatrix);
        }
        let camera =
            Self { skew: k[0][1], ..Self::pinhole(k[0][0], k[1][1], k[0][2], k[1][2], width, height) };
        camera.checked()
    }

    /// The camera, if it can be used: finite, with positive focal lengths and a size.
    pub fn checked(self) -> Result<Self, CameraError> {
        let [k1, k2, p1, p2, k3] = self.distortion.to_array();
        let named = [
            ("fx", self.fx),
            ("fy", self.fy),
            ("cx", self.cx),
            ("cy", self.cy),
            ("the skew", self.skew),
            ("k1", k1),
            ("k2", k2),
            ("p1", p1),
            ("p2", p2),
            ("k3", k3),
        ];
        if let Some(&(name, value)) = named.iter().find(|(_, value)| !value.is_finite()) {
            return Err(CameraError::NotFinite { name, value });
        }
        if let Some(&(name, value)) = named[..2].iter().find(|(_, value)| *value <= 0.0) {
            return Err(CameraError::FocalNotPositive { name, value });
        }
        let (width, height) = (self.width, self.height);
        if !(1..=65535).contains(&width) || !(1..=65535).contains(&height) {
            return Err(CameraError::BadSize { width, height });
        }
        Ok(self)
    }

    pub fn k_rows(&self) -> [[f64; 3]; 3] {
        [[self.fx, self.skew, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]]
    }

    pub fn k_matrix(&self) -> DMat3 {
        DMat3::from_cols_array_2d(&self.k_rows()).transpose()
    }

    /// The pixel of a point in the camera frame; `None` for a point not in front of the camera.
    pub fn project(&self, point_camera_mm: DVec3) -> Option<DVec2> {
        if point_camera_mm.z <= 0.0 {
            return None;
        }
        let normalized = point_camera_mm.truncate() / point_camera_mm.z;
        let bent = if self.distortion.is_none() { normalized } else { self.distortion.distort(normalized) };
        Some(DVec2::new(self.fx * bent.x + self.skew * bent.y + self.cx, self.fy * bent.y + self.cy))
    }

    /// The point at z = 1 in the camera frame that is seen at `pixel`.
    pub fn unproject(&self, pixel: DVec2) -> DVec3 {
        let y = (pixel.y - self.cy) / self.fy;
        let x = (pixel.x - self.cx - self.skew * y) / self.fx;
        self.distortion.undistort(DVec2::new(x, y)).extend(1.0)
    }

    /// The view ray through `pixel`, in the camera frame.
    pub fn ray(&self, pixel: DVec2) -> Ray {
        Ray { origin: DVec3::ZERO, direction: self.unproject(pixel).normalize() }
    }

    /// The same camera for the image resampled to another size: c′ = (c + ½)·s − ½, for pixels are counted from their
    /// centres.
    pub fn scaled_to(&self, width: u32, height: u32) -> Self {
        let sx = f64::from(width) / f64::from(self.width);
        let sy = f64::from(height) / f64::from(self.height);
        Self {
            fx: self.fx * sx,
            fy: self.fy * sy,
            cx: (self.cx + 0.5) * sx - 0.5,
            cy: (self.cy + 0.5) * sy - 0.5,
            skew: self.skew * sx,
            distortion: self.distortion,
            width,
            height,
        }
    }

    /// The mean focal length in pixels: how many pixels one radian covers near the optical axis.
    pub fn focal_px(&self) -> f64 {
        (self.fx * self.fy).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn camera() -> Intrinsics {
        Intrinsics { skew: 0.7, ..Intrinsics::pinhole(572.4, 573.6, 325.3, 242.0, 640, 480) }
    }

    proptest! {
        #[test]
        fn unproject_undoes_project(x in -300.0..300.0, y in -300.0..300.0, z in 400.0..3000.0) {
            let lens = Distortion { k1: -0.12, k2: 0.03, p1: 0.001, p2: -0.002, k3: 0.0 };
            for distortion in [Distortion::NONE, lens] {
                let camera = Intrinsics { distortion, ..camera() };
                let point = DVec3::new(x, y, z);
                let pixel = camera.project(point).unwrap();
                // The fixed-point iteration ends at a step of 1e-14 in normalised units.
                prop_assert!((camera.unproject(pixel) * z).distance(point) < 1e-8 * z);
            }
        }

        #[test]
        fn a_scaled_camera_sees_the_same_place(x in -300.0..300.0, y in -300.0..300.0, s in 1_u32..5) {
            let point = DVec3::new(x, y, 900.0);
            let pixel = camera().project(point).unwrap();
            let scaled = camera().scaled_to(640 * s, 480 * s).project(point).unwrap();
            let expected = (pixel + 0.5) * f64::from(s) - 0.5;
            prop_assert!(scaled.distance(expected) < 1e-9);
        }
    }

    #[test]
    fn k_is_used_exactly() {
        let camera = camera();
        let point = DVec3::new(12.0, -34.0, 567.0);
        let uvw = camera.k_matrix() * point;
        assert!(camera.project(point).unwrap().distance(uvw.truncate() / uvw.z) < 1e-10);
    }

    #[test]
    fn bad_cameras_are_refused() {
        let zero_focal = Intrinsics::pinhole(0.0, 1.0, 0.0, 0.0, 4, 4).checked();
        assert!(matches!(zero_focal, Err(CameraError::FocalNotPositive { name: "fx", .. })));
        let nan = Intrinsics::pinhole(1.0, 1.0, f64::NAN, 0.0, 4, 4).checked();
        assert!(matches!(nan, Err(CameraError::NotFinite { name: "cx", .. })));
        let k = [[1.0, 0.0, 0.0], [0.1, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(Intrinsics::from_k_rows(&k, 4, 4), Err(CameraError::NotACameraMatrix));
    }

    #[test]
    fn points_outside_a_strong_lens_do_not_fold_back() {
        let lens = Distortion { k1: -0.4, ..Distortion::NONE };
        let radii: Vec<f64> = (0..60).map(|i| lens.distort(DVec2::new(f64::from(i) * 0.1, 0.0)).x).collect();
        assert!(radii.windows(2).all(|pair| pair[1] > pair[0]), "{radii:?}");
    }
}
