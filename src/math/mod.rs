//! Frames, rigid transforms, the camera and rays: the numbers everything above is made of.
//!
//! Spaces are in the names (`camera_from_object`), so that a product reads `a_from_b * b_from_c`. Lengths are
//! millimetres, angles radians, pixels are in the `image` frame: (0, 0) is the *centre* of the top-left pixel.

mod bounds;
mod camera;
mod frames;
mod order;
mod pose;
mod ray;
mod rotation;

pub use bounds::{BoundingSphere, Bounds};
pub use camera::{CameraError, Distortion, Intrinsics};
pub use frames::{ImageRect, NEAR_MM, clip_from_camera};
pub use order::sort_short;
pub use pose::{Pose, PoseError, nearest_rotation, rotation_defect};
pub use ray::Ray;
pub use rotation::{
    fixed_xyz_from_rotation, quaternion_from_rotation, rotation_from_fixed_xyz, rotation_from_quaternion,
    rotation_from_rotation_vector, rotation_vector_from_rotation,
};
