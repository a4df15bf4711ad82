//! `models/obj_XXXXXX.ply`, `models_info.json` and `camera.json`.

use std::collections::BTreeMap;

use serde::Serialize;

use super::super::meshes::companion_name;
use super::super::plan::{ModelPlan, Plan};
use super::depth_scale;
use crate::math::{Bounds, Pose};
use crate::mesh::PointTree;

#[derive(Serialize)]
struct ModelInfo {
    diameter: f64,
    min_x: f64,
    min_y: f64,
    min_z: f64,
    size_x: f64,
    size_y: f64,
    size_z: f64,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    symmetries_discrete: Vec<[f64; 16]>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    symmetries_continuous: Vec<ContinuousSymmetry>,
}

#[derive(Serialize)]
struct ContinuousSymmetry {
    axis: [f64; 3],
    offset: [f64; 3],
}

#[derive(Serialize)]
struct Camera {
    cx: f64,
    cy: f64,
    fx: f64,
    fy: f64,
    width: u32,
    height: u32,
    depth_scale: f64,
}

/// Sizes and symmetries of all models, in millimetres; over all vertices, also those that no triangle names.
pub(in super::super) fn models_info(plan: &Plan) -> String {
    let infos: BTreeMap<u32, ModelInfo> =
        plan.models.iter().filter_map(|model| Some((model.id, model_info(plan, model)?))).collect();
    serde_json::to_string_pretty(&infos).unwrap_or_default()
}

fn model_info(plan: &Plan, model: &ModelPlan) -> Option<ModelInfo> {
    let object = plan.scene.objects.get(model.object)?;
    let positions = object.mesh.mesh.positions_mm();
    let (bounds, tree) = (Bounds::of(positions)?, PointTree::build(positions)?);
    let (min, size) = (bounds.min, bounds.size());
    Some(ModelInfo {
        diameter: tree.diameter(),
        min_x: min.x,
        min_y: min.y,
        min_z: min.z,
        size_x: size.x,
        size_y: size.y,
        size_z: size.z,
        symmetries_discrete: object.symmetries.discrete.iter().map(flat).collect(),
        symmetries_continuous: object
            .symmetries
            .continuous
            .iter()
            .map(|symmetry| ContinuousSymmetry {
                axis: symmetry.axis.to_array(),
                offset: symmetry.offset_mm.to_array(),
            })
            .collect(),
    })
}

/// The 4×4 row by row.
fn flat(pose: &Pose) -> [f64; 16] {
    let rows = pose.to_rows();
    std::array::from_fn(|at| rows[at / 4][at % 4])
}

/// The model's mesh in the `object` frame, in millimetres.
pub(in super::super) fn model_file(plan: &Plan, model: usize) -> Option<(String, Vec<u8>)> {
    let model = plan.models.get(model)?;
    let object = plan.scene.objects.get(model.object)?;
    Some((format!("bop/models/obj_{:06}.ply", model.id), model.mesh.file(object)))
}

/// A texture that a model names.
pub(in super::super) fn companion_file(plan: &Plan, model: usize, at: usize) -> Option<(String, Vec<u8>)> {
    let object = plan.scene.objects.get(plan.models.get(model)?.object)?;
    let file = object.mesh.companions.get(at)?;
    Some((format!("bop/models/{}", companion_name(file)), file.bytes.to_vec()))
}

/// The camera of the first photo; `None` where there is none.
pub(in super::super) fn camera_json(plan: &Plan) -> Option<String> {
    let photo = plan.photo(plan.photos.first()?)?;
    let camera = &photo.camera;
    let camera = Camera {
        cx: camera.cx,
        cy: camera.cy,
        fx: camera.fx,
        fy: camera.fy,
        width: camera.width,
        height: camera.height,
        depth_scale: depth_scale(photo),
    };
    serde_json::to_string_pretty(&camera).ok()
}
