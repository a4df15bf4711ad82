//! The photo around the object at one size, with what is before the object in it.

use super::look::object_rect;
use super::picture::Picture;
use super::search::depth_reach;
use super::{SnapHints, SnapOptions, SnapReach};
use crate::math::{Intrinsics, Pose};
use crate::photo::Pixels;
use crate::raster::PixelRegion;
use crate::scene::DepthInMm;
use crate::solve::contour::{ContourModel, Occluders};

#[derive(Debug, Clone)]
pub struct Sight {
    pub picture: Picture,
    pub occluders: Occluders,
}

/// What a snap was given.
pub struct Given<'a> {
    pub photo: &'a Pixels,
    pub camera: &'a Intrinsics,
    pub model: &'a ContourModel,
    pub start: &'a Pose,
    pub hints: &'a SnapHints,
    pub options: &'a SnapOptions,
}

impl Sight {
    /// In a copy of the photo in which the object is at most about so large. `None` where the object is not in the photo.
    pub fn new(given: &Given<'_>, largest_object_px: f64) -> Option<Self> {
        let Given { photo, camera, model, start, hints, options } = given;
        let rect = object_rect(camera, model, start)?;
        let picture = Picture::new(photo, camera, &rect, options.mask.as_ref(), largest_object_px)?;
        let others: Vec<(&ContourModel, Pose)> =
            hints.occluders.iter().map(|(model, pose)| (model.as_ref(), *pose)).collect();
        let region = PixelRegion::of_camera(&picture.camera);
        let mut occluders = Occluders::draw(&picture.camera, &others, region);
        let is_fitting = |depth: &&DepthInMm| (depth.width, depth.height) == (photo.width, photo.height);
        if let Some(depth) = hints.depth.as_deref().filter(is_fitting) {
            let before_mm = nearest_mm(model, start, options.reach);
            occluders.add_measured(region, before_mm, |x, y| picture.measured_mm(depth, x, y));
        }
        Some(Self { picture, occluders })
    }
}

/// What is nearer to the camera than this is not the object, though it be as far off as a start may be.
fn nearest_mm(model: &ContourModel, camera_from_object: &Pose, reach: SnapReach) -> f64 {
    /// Of the object's radius: a tenth of its size.
    const START_ERROR: f64 = 0.2;
    let radius_mm = model.mesh().sphere().radius;
    let center = camera_from_object.transform_point(model.center_mm());
    center.z - radius_mm - f64::max(START_ERROR * radius_mm, depth_reach(reach) * center.z)
}
