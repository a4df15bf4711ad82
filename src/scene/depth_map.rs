//! Depth maps: how far what a photo shows is away, pixel by pixel.

use std::sync::Arc;

use super::PhotoAsset;
use crate::photo::{PhotoError, decode_depth};

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

/// A depth map in numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthInMm {
    pub width: u32,
    pub height: u32,
    /// z along the optical axis, row by row; 0 where nothing was measured.
    pub mm: Vec<f32>,
}

impl DepthMap {
    /// Decodes the file.
    pub fn in_mm(&self) -> Result<DepthInMm, PhotoError> {
        let depth = decode_depth(&self.asset.bytes)?;
        let mm = depth.raw.iter().map(|&raw| (f64::from(raw) * self.mm_per_unit) as f32).collect();
        Ok(DepthInMm { width: depth.width, height: depth.height, mm })
    }
}
