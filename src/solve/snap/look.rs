//! What a pose looks like in a picture.

use glam::DVec3;

use super::colors::{Band, ColorModel};
use super::picture::Picture;
use super::score::{SnapScore, score};
use super::sight::Sight;
use crate::math::{ImageRect, Intrinsics, NEAR_MM, Pose};
use crate::raster::PixelRegion;
use crate::solve::contour::{ContourModel, ContourPoint, DepthView};

/// Contour points, about; more lie so close that they tell the same.
const POINTS: f64 = 220.0;

/// How many points are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Density {
    /// Half as many: enough to find the way.
    Coarse,
    Fine,
}

pub struct Look {
    pub view: DepthView,
    /// One plus the number of the face that is seen, pixel by pixel.
    pub faces: Vec<u32>,
    pub points: Vec<ContourPoint>,
    /// The object's diameter here.
    pub size_px: f64,
    /// Points closer than two pixels to each other tell the same: what part of their weight is their own.
    pub independence: f64,
}

impl Look {
    pub fn at(sight: &Sight, model: &ContourModel, pose: &Pose, density: Density) -> Self {
        let Sight { picture, occluders } = sight;
        let region = PixelRegion::of_camera(&picture.camera);
        let (view, faces) = DepthView::draw_faces(&picture.camera, model, *pose, occluders, region);
        let distance = pose.transform_point(model.center_mm()).z.max(NEAR_MM);
        let size_px = picture.camera.focal_px() * model.diameter_mm() / distance;
        let sparseness = if density == Density::Coarse { 2.0 } else { 1.0 };
        let spacing_px = sparseness * (std::f64::consts::PI * size_px / POINTS).max(0.5);
        let points = model.points(&picture.camera, pose, &view, spacing_px);
        Self { view, faces, points, size_px, independence: (spacing_px / 2.0).min(1.0) }
    }

    /// The colours on the two sides of this pose's outline. Pixels within `unsure_px` of it teach nothing, or those within a
    /// part of the object's size if that is less.
    pub fn colors(&self, picture: &Picture, unsure_px: f64) -> Option<ColorModel> {
        let unsure_px = unsure_px.min((0.06 * self.size_px).max(1.0));
        let reach_px = self.size_px.clamp(12.0, 60.0);
        ColorModel::learn(picture, &self.view, &self.points, Band { unsure_px, reach_px })
    }

    /// About how far a step (a turn, then a shift) moves the object's contour, if its middle is so far off.
    pub fn motion_px(&self, step: &[f64; 6], distance_mm: f64, picture: &Picture) -> f64 {
        let [rx, ry, rz, x, y, z] = *step;
        let radius_px = 0.5 * self.size_px;
        let shift_px = picture.camera.focal_px() * x.hypot(y) / distance_mm;
        shift_px + radius_px * (DVec3::new(rx, ry, rz).length() + (z / distance_mm).abs())
    }

    /// `None` where too little of the object is in the picture.
    pub fn score(&self, picture: &Picture) -> Option<SnapScore> {
        let colors = self.colors(picture, 1.0)?;
        Some(score(picture, &self.view, &colors, &self.points))
    }
}

pub fn is_before_camera(pose: &Pose, model: &ContourModel) -> bool {
    let center = pose.transform_point(model.center_mm());
    center.is_finite() && center.z > 0.5 * model.diameter_mm() + NEAR_MM
}

/// Around the object's box in the photo; `None` where a corner is not before the camera.
pub fn object_rect(camera: &Intrinsics, model: &ContourModel, pose: &Pose) -> Option<ImageRect> {
    let corners = model.mesh().bounds().corners();
    let pixels: Option<Vec<_>> =
        corners.into_iter().map(|corner| camera.project(pose.transform_point(corner))).collect();
    ImageRect::around(pixels?)
}
