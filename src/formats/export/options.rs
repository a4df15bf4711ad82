//! What an export is to hold.

use std::collections::BTreeSet;

use super::Convention;
use crate::formats::Keep;
use crate::raster::VISIBILITY_DELTA_MM;
use crate::scene::PhotoId;

#[derive(Debug, Clone, PartialEq, Default)]
pub enum PhotoChoice {
    #[default]
    All,
    These(BTreeSet<PhotoId>),
}

/// One kind of file; an export holds any of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ExportPart {
    /// Our own document.
    Document,
    /// `poses.json`, in the convention that was chosen.
    Poses,
    /// A 4×4 for each pose and a 3×3 for each camera.
    Npy,
    /// One row for each pose.
    Csv,
    /// Each mesh as PLY, in millimetres, in the frame that poses refer to.
    Meshes,
    /// A BOP dataset.
    Bop,
    /// Each photo with its objects over it.
    Overlays,
    /// Silhouettes, each as if its object were alone.
    Masks,
    VisibleMasks,
    /// The objects' depth, 16 bits.
    Depth,
    /// Normalised object coordinates.
    Nocs,
    /// 2D and 3D boxes drawn on the photo.
    Boxes,
}

impl ExportPart {
    /// In the order of the files: the part, its name on the command line, its title, and what it is in a sentence.
    pub const ALL: [(Self, &'static str, &'static str, &'static str); 12] = [
        (
            Self::Document,
            "json",
            "PinPose JSON",
            "Everything about poses and cameras; opens here again, bit for bit",
        ),
        (Self::Poses, "poses", "Poses as JSON", "One 4×4 per pose in the chosen convention"),
        (Self::Npy, "npy", "Poses as .npy", "NumPy files: a 4×4 per pose and K per photo"),
        (Self::Csv, "csv", "Poses as CSV", "A table with one row per pose"),
        (Self::Meshes, "meshes", "Meshes as PLY", "In millimetres, in the frame that the poses refer to"),
        (
            Self::Bop,
            "bop",
            "BOP dataset",
            "scene_gt, scene_camera, scene_gt_info, masks, models, results CSV, COCO",
        ),
        (Self::Overlays, "overlays", "Overlays", "Each photo with its objects over it"),
        (Self::Masks, "masks", "Masks", "Silhouettes of single objects, white on black"),
        (
            Self::VisibleMasks,
            "visible_masks",
            "Visible masks",
            "Without what other objects or the depth map hide",
        ),
        (Self::Depth, "depth", "Depth of the objects", "16-bit PNG, 0 where there is no object"),
        (Self::Nocs, "nocs", "NOCS", "Object coordinates as colours"),
        (Self::Boxes, "boxes", "Boxes", "2D and 3D boxes drawn on the photo"),
    ];

    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(part, ..)| *part == self).map_or("", |(_, name, ..)| name)
    }

    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, candidate, ..)| *candidate == name).map(|(part, ..)| *part)
    }

    /// Does the choice of axes, unit and direction change it?
    pub fn has_convention(self) -> bool {
        matches!(self, Self::Poses | Self::Npy | Self::Csv)
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct ExportOptions {
    pub photos: PhotoChoice,
    pub parts: BTreeSet<ExportPart>,
    /// Of `poses.json`, `.npy` and CSV; our own document and BOP have theirs fixed.
    pub convention: Convention,
    /// Whether untouched and carried poses are exported too.
    pub keep: Keep,
    /// How far behind the measured depth a surface may be and still count as visible.
    pub visibility_delta_mm: f64,
    /// BOP's id of the scene.
    pub scene_id: u32,
}

impl ExportOptions {
    pub fn of(parts: impl IntoIterator<Item = ExportPart>) -> Self {
        Self {
            photos: PhotoChoice::All,
            parts: parts.into_iter().collect(),
            convention: Convention::default(),
            keep: Keep::Annotated,
            visibility_delta_mm: VISIBILITY_DELTA_MM,
            scene_id: 1,
        }
    }
}

impl Default for ExportOptions {
    fn default() -> Self {
        Self::of([ExportPart::Document, ExportPart::Poses, ExportPart::Csv, ExportPart::Meshes])
    }
}
