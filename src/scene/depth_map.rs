//! Depth maps: how far what a photo shows is away, pixel by pixel.

use std::sync::Arc;

use super::PhotoAsset;

/// A photo's depth image, of the photo's size.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthMap {
    /// A grey image, mostly of 16 bits; 0 where nothing was measured.
    pub asset: Arc<PhotoAsset>,
    /// Its numbers times this are millimetres along the optical axis. BOP's `depth_scale`.
    pub mm_per_unit: f64,
    /// What is behind it is not shown.
    pub occludes: bool,
}
