//! Where each file of an export is, so that they can name one another.

use super::meshes::companion_name;
use super::plan::{PhotoPlan, Plan};
use crate::scene::CompanionFile;

pub(super) fn mesh(plan: &Plan, object: usize) -> String {
    format!("meshes/{}.ply", plan.object_name(object))
}

/// Beside the meshes that name it.
pub(super) fn companion(file: &CompanionFile) -> String {
    format!("meshes/{}", companion_name(file))
}

/// The convention is in the name: a matrix of its own says nothing.
pub(super) fn pose_npy(plan: &Plan, photo: &PhotoPlan, object: usize) -> String {
    let suffix = plan.options.convention.file_suffix();
    format!("npy/{}-{}-{suffix}.npy", photo.name, plan.object_name(object))
}

pub(super) fn camera_npy(photo: &PhotoPlan) -> String {
    format!("npy/{}-K.npy", photo.name)
}

pub(super) fn picture(plan: &Plan, photo: &PhotoPlan, folder: &str, object: Option<usize>) -> String {
    match object {
        Some(object) => format!("{folder}/{}-{}.png", photo.name, plan.object_name(object)),
        None => format!("{folder}/{}.png", photo.name),
    }
}
