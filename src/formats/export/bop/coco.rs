//! `scene_gt_coco.json`: instance masks in COCO's format, without compression.

use serde::Serialize;

use super::frames::TruthInfo;
use crate::raster::Mask;

/// An object of which less is visible is left out of COCO scores.
const LEAST_VISIBLE_FRACTION: f64 = 0.1;

#[derive(Debug, Serialize)]
pub(in super::super) struct Coco {
    info: Info,
    licenses: [(); 0],
    pub categories: Vec<Category>,
    images: Vec<Image>,
    annotations: Vec<Annotation>,
}

#[derive(Debug, Serialize)]
struct Info {
    description: String,
    contributor: &'static str,
}

#[derive(Debug, Serialize)]
pub(in super::super) struct Category {
    pub id: u32,
    pub name: String,
    pub supercategory: String,
}

#[derive(Debug, Serialize)]
struct Image {
    id: u32,
    file_name: String,
    width: u32,
    height: u32,
}

#[derive(Debug, Serialize)]
struct Annotation {
    id: usize,
    image_id: u32,
    category_id: u32,
    iscrowd: u32,
    /// Of the visible mask.
    area: usize,
    /// Amodal: of the whole silhouette. x, y, width, height.
    bbox: [i64; 4],
    segmentation: Rle,
    width: u32,
    height: u32,
    ignore: bool,
}

#[derive(Debug, Serialize)]
struct Rle {
    counts: Vec<u32>,
    /// Height, width.
    size: [u32; 2],
}

impl Coco {
    pub fn new(description: &str) -> Self {
        Self {
            info: Info { description: description.to_owned(), contributor: "PinPose" },
            licenses: [],
            categories: Vec::new(),
            images: Vec::new(),
            annotations: Vec::new(),
        }
    }

    /// `file_name` is relative to the scene's folder.
    pub fn add_image(&mut self, id: u32, file_name: String, width: u32, height: u32) {
        self.images.push(Image { id, file_name, width, height });
    }

    /// An object of which nothing is visible has no mask, and so no place here.
    pub fn add_object(&mut self, image_id: u32, category_id: u32, visible: &Mask, info: &TruthInfo) {
        if info.px_count_visib == 0 {
            return;
        }
        self.annotations.push(Annotation {
            id: self.annotations.len() + 1,
            image_id,
            category_id,
            iscrowd: 0,
            area: info.px_count_visib,
            bbox: info.bbox_obj,
            segmentation: Rle {
                counts: visible.column_major_runs(),
                size: [visible.height(), visible.width()],
            },
            width: visible.width(),
            height: visible.height(),
            ignore: info.visib_fract < LEAST_VISIBLE_FRACTION,
        });
    }
}
