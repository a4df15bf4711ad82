//! A BOP dataset: `bop/models`, `bop/camera.json`, one scene under `bop/test`, and its poses as a results file.
//!
//! OpenCV camera axes, millimetres, `x_camera = R x_object + t`, matrices row by row; the names are those of bop_toolkit's
//! `docs/bop_datasets_format.md`.

mod coco;
mod frames;
mod models;
mod records;

use super::plan::Plan;
use crate::photo::{decode_depth, png_gray16};
use crate::scene::{DepthMap, Photo};

pub(super) use models::{camera_json, companion_file, model_file, models_info};
pub(super) use records::Records;

/// A file of the dataset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BopStep {
    Camera,
    ModelsInfo,
    /// Index into the plan's models.
    Model(usize),
    /// And into its mesh's companions.
    ModelCompanion(usize, usize),
    /// Indices into the plan's photos, and into what is placed in one.
    Photo(usize),
    Depth(usize),
    Mask(usize, usize),
    VisibleMask(usize, usize),
    SceneCamera,
    SceneGt,
    SceneGtInfo,
    SceneGtCoco,
    Targets,
    Results,
}

/// Every file of the dataset, photos one after the other.
pub(super) fn steps(plan: &Plan) -> Vec<BopStep> {
    let mut steps = vec![BopStep::Camera, BopStep::ModelsInfo];
    for (index, model) in plan.models.iter().enumerate() {
        steps.push(BopStep::Model(index));
        steps.extend(model.mesh.companions().map(|at| BopStep::ModelCompanion(index, at)));
    }
    for (index, planned) in plan.photos.iter().enumerate() {
        steps.push(BopStep::Photo(index));
        let Some(photo) = plan.photo(planned) else { continue };
        if photo.depth.is_some() {
            steps.push(BopStep::Depth(index));
        }
        let placed = plan.placed(photo).len();
        steps.extend((0..placed).flat_map(|at| [BopStep::Mask(index, at), BopStep::VisibleMask(index, at)]));
    }
    steps.extend([
        BopStep::SceneCamera,
        BopStep::SceneGt,
        BopStep::SceneGtInfo,
        BopStep::SceneGtCoco,
        BopStep::Targets,
        BopStep::Results,
    ]);
    steps
}

/// What a BOP dataset cannot hold.
pub(super) fn warnings(plan: &Plan) -> Vec<String> {
    let photos: Vec<&Photo> = plan.photos.iter().filter_map(|planned| plan.photo(planned)).collect();
    let mut warnings = Vec::new();
    if photos.iter().any(|photo| !photo.camera.distortion.is_none()) {
        warnings.push(
            "BOP has no lens distortion: masks are of the distorted picture, K is not enough for it"
                .to_owned(),
        );
    }
    if photos.windows(2).any(|pair| pair[0].camera != pair[1].camera) {
        warnings.push(
            "camera.json is that of the first photo; the photos differ, see scene_camera.json".to_owned(),
        );
    }
    warnings
}

/// Of a photo's depth picture: its values times this are millimetres. BOP's 1 where there is no picture.
fn depth_scale(photo: &Photo) -> f64 {
    photo.depth.as_ref().map_or(1.0, |depth| depth.mm_per_unit)
}

/// The depth picture as it came where it is a PNG, else the same values as one.
pub(super) fn depth_png(depth: &DepthMap) -> Result<Vec<u8>, String> {
    const PNG_MAGIC: &[u8] = b"\x89PNG";
    let pixels = decode_depth(&depth.asset.bytes).map_err(|error| error.to_string())?;
    if depth.asset.bytes.starts_with(PNG_MAGIC) {
        return Ok(depth.asset.bytes.to_vec());
    }
    png_gray16(pixels.width, pixels.height, pixels.raw)
        .ok_or_else(|| "the picture cannot be encoded".to_owned())
}

pub(super) fn scene_path(plan: &Plan, file: &str) -> String {
    format!("bop/test/{:06}/{file}", plan.options.scene_id)
}

/// A file of one object in one photo: `IMID_GTID`.
pub(super) fn mask_path(plan: &Plan, folder: &str, image_id: u32, truth: usize) -> String {
    scene_path(plan, &format!("{folder}/{image_id:06}_{truth:06}.png"))
}

/// A file of one photo.
pub(super) fn image_path(plan: &Plan, folder: &str, image_id: u32, extension: &str) -> String {
    scene_path(plan, &format!("{folder}/{image_id:06}.{extension}"))
}

/// The results file's name: `METHOD_DATASET-SPLIT.csv`, neither of the two with an underscore or a hyphen of its own.
pub(super) fn results_path(plan: &Plan) -> String {
    let letters: String = plan.scene.name.chars().filter(char::is_ascii_alphanumeric).collect();
    format!("bop/pinpose_{}-test.csv", if letters.is_empty() { "scene" } else { &letters })
}
