//! What the scene's files say of each photo.

use serde::Serialize;

use super::super::pictures::box_numbers;
use crate::math::{Intrinsics, Pose};
use crate::raster::{PixelRegion, Silhouette};

/// An entry of `scene_camera.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(in super::super) struct CameraEntry {
    #[serde(rename = "cam_K")]
    k: [f64; 9],
    /// A depth picture's value times this is millimetres.
    depth_scale: f64,
}

/// An entry of `scene_gt.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(in super::super) struct TruthEntry {
    #[serde(rename = "cam_R_m2c")]
    rotation: [f64; 9],
    #[serde(rename = "cam_t_m2c")]
    translation_mm: [f64; 3],
    pub obj_id: u32,
}

/// An entry of `scene_gt_info.json`. Boxes are x, y, width, height, and −1 four times where nothing is visible.
///
/// Widths and heights count pixels, as COCO's do; bop_toolkit's own script writes one less.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(in super::super) struct TruthInfo {
    pub bbox_obj: [i64; 4],
    pub bbox_visib: [i64; 4],
    px_count_all: usize,
    px_count_valid: usize,
    pub px_count_visib: usize,
    pub visib_fract: f64,
}

impl CameraEntry {
    pub fn new(camera: &Intrinsics, depth_scale: f64) -> Self {
        Self { k: flat(camera.k_rows()), depth_scale }
    }
}

impl TruthEntry {
    pub fn new(obj_id: u32, camera_from_object: &Pose) -> Self {
        Self {
            rotation: flat(camera_from_object.rotation_rows()),
            translation_mm: camera_from_object.translation_mm.to_array(),
            obj_id,
        }
    }

    /// R and t as a results file has them: separated by spaces.
    pub fn result_columns(&self) -> String {
        let joined = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
        format!("{},{}", joined(&self.rotation), joined(&self.translation_mm))
    }
}

impl TruthInfo {
    pub fn new(silhouette: &Silhouette) -> Self {
        let px_count_visib = silhouette.visible.count();
        let numbers =
            |found: Option<PixelRegion>| found.filter(|_| px_count_visib > 0).map_or([-1; 4], box_numbers);
        Self {
            bbox_obj: numbers(silhouette.whole_box),
            bbox_visib: numbers(silhouette.visible.bounding_box()),
            px_count_all: silhouette.whole_count,
            px_count_valid: silhouette.valid_count,
            px_count_visib,
            visib_fract: silhouette.visible_fraction(),
        }
    }
}

fn flat(rows: [[f64; 3]; 3]) -> [f64; 9] {
    let [[a, b, c], [d, e, f], [g, h, i]] = rows;
    [a, b, c, d, e, f, g, h, i]
}
