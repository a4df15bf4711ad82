//! BOP's files, each by itself: `scene_gt.json`, `scene_camera.json`, `models_info.json`, results in CSV.
//!
//! Millimetres, OpenCV's camera axes, `x_camera = R x_object + t`, matrices row by row.

mod results;
mod scene;

pub(super) use results::{is_results_csv, read_results};
pub(super) use scene::{
    FrameCamera, FramePose, Frames, read_cameras, read_poses, scene_camera_incoming, scene_gt_incoming,
};
