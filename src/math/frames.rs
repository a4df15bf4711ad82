//! From the camera frame to a picture: rectangles of the image, and the one place where y and z are flipped.

use glam::{DMat4, DVec2, DVec4};

use super::Intrinsics;

/// Points nearer than this to the optical centre are not drawn.
pub const NEAR_MM: f64 = 1.0;

/// A rectangle of the `image` frame, in pixels. The whole photo is [-0.5, width − 0.5] × [-0.5, height − 0.5].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageRect {
    pub min: DVec2,
    pub max: DVec2,
}

impl ImageRect {
    /// The whole of a photo.
    pub fn of_photo(width: u32, height: u32) -> Self {
        let size = DVec2::new(f64::from(width), f64::from(height));
        Self { min: DVec2::splat(-0.5), max: size - 0.5 }
    }

    pub fn size(&self) -> DVec2 {
        self.max - self.min
    }

    pub fn center(&self) -> DVec2 {
        (self.min + self.max) / 2.0
    }

    /// The smallest rectangle around the pixels; `None` where there are none.
    pub fn around(pixels: impl IntoIterator<Item = DVec2>) -> Option<Self> {
        pixels.into_iter().fold(None, |rect: Option<Self>, pixel| {
            Some(rect.map_or(Self { min: pixel, max: pixel }, |rect| Self {
                min: rect.min.min(pixel),
                max: rect.max.max(pixel),
            }))
        })
    }
}

/// The projection that draws what the camera sees within `rect` so that it fills the target: wgpu clip coordinates (y up,
/// depth 1 at [`NEAR_MM`] falling to 0 at infinity) from the camera frame (y down, z forward).
///
/// This is the one flip from OpenCV's axes to the renderer's. Depth is reversed because a 32-bit float has its fine steps
/// near zero, where perspective needs them. Lens distortion is applied to the vertices before this.
pub fn clip_from_camera(camera: &Intrinsics, rect: &ImageRect) -> DMat4 {
    let size = rect.size();
    let row_x = DVec4::new(
        2.0 * camera.fx / size.x,
        2.0 * camera.skew / size.x,
        2.0 * (camera.cx - rect.min.x) / size.x - 1.0,
        0.0,
    );
    let row_y =
        DVec4::new(0.0, -2.0 * camera.fy / size.y, 1.0 - 2.0 * (camera.cy - rect.min.y) / size.y, 0.0);
    let row_depth = DVec4::new(0.0, 0.0, 0.0, NEAR_MM);
    let row_w = DVec4::new(0.0, 0.0, 1.0, 0.0);
    DMat4::from_cols(row_x, row_y, row_depth, row_w).transpose()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn the_photo_fills_the_target_from_edge_to_edge() {
        let camera = Intrinsics::pinhole(500.0, 520.0, 300.0, 200.0, 640, 480);
        let clip = clip_from_camera(&camera, &ImageRect::of_photo(640, 480));
        for (pixel, expected) in [
            (DVec2::new(-0.5, -0.5), DVec2::new(-1.0, 1.0)),
            (DVec2::new(639.5, 479.5), DVec2::new(1.0, -1.0)),
            (DVec2::new(319.5, 239.5), DVec2::ZERO),
        ] {
            let position = clip * (camera.unproject(pixel) * 800.0).extend(1.0);
            assert!((position.truncate().truncate() / position.w).distance(expected) < 1e-12);
        }
    }

    #[test]
    fn depth_is_one_at_the_near_plane_and_falls_with_distance() {
        let camera = Intrinsics::from_focal(500.0, 64, 48);
        let clip = clip_from_camera(&camera, &ImageRect::of_photo(64, 48));
        let depth = |z: f64| {
            let position = clip * DVec3::new(0.0, 0.0, z).extend(1.0);
            position.z / position.w
        };
        assert_eq!(depth(NEAR_MM), 1.0);
        assert!(depth(100.0) > depth(101.0) && depth(1e9) > 0.0);
    }
}
