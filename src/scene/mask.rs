//! Masks: which pixels of a photo show an object, drawn by somebody or something else.

use std::sync::Arc;

use super::{ObjectId, PhotoAsset, PhotoId, Rgb};

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MaskId(pub u32);

/// An image beside a photo; a pixel that is not black (and not transparent) is in the mask.
#[derive(Debug, Clone, PartialEq)]
pub struct Mask {
    pub id: MaskId,
    pub photo: PhotoId,
    /// The object that it shows, where that is known.
    pub object: Option<ObjectId>,
    pub name: String,
    /// Its file; of the photo's size.
    pub asset: Arc<PhotoAsset>,
    pub color: Rgb,
    /// 0 to 1.
    pub opacity: f32,
    pub visible: bool,
}
