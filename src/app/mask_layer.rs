//! The shown photo's masks as one tinted image, made anew only where one of them changes.

use std::sync::Arc;

use super::PinPose;
use crate::photo::Pixels;
use crate::scene::{Mask, PhotoId, Rgb, Sha256};

/// The image, and what it was made of.
#[derive(Default)]
pub struct MaskLayer {
    made_of: Key,
    pixels: Option<Arc<Pixels>>,
}

/// The photo, and of each mask in it the content, the colour and the opacity.
#[derive(Debug, Clone, PartialEq, Default)]
struct Key {
    photo: Option<PhotoId>,
    masks: Vec<(Sha256, Rgb, u32)>,
}

impl MaskLayer {
    pub fn pixels(&self) -> Option<Arc<Pixels>> {
        self.pixels.clone()
    }
}

impl PinPose {
    /// Keeps the layer in step with the scene. A mask that is not decoded yet is sent for, and comes with a later frame.
    pub(super) fn update_mask_layer(&mut self) {
        let Some(photo) = self.session.photo() else { return };
        let visible: Vec<&Mask> = self
            .session
            .scene()
            .masks_of(photo.id)
            .filter(|mask| mask.visible && mask.opacity > 0.0)
            .collect();
        let of_mask = |mask: &&Mask| (mask.asset.sha256, mask.color, mask.opacity.to_bits());
        let key = Key { photo: Some(photo.id), masks: visible.iter().map(of_mask).collect() };
        if key == self.mask_layer.made_of {
            return;
        }
        let missing = visible.iter().find(|mask| self.photos.get(mask.asset.sha256).is_none());
        if let Some(asset) = missing.map(|mask| mask.asset.clone()) {
            if self.photos.wanted.is_none() {
                self.photos.wanted = Some(asset.sha256);
                self.loading.decode(&asset);
            }
            return;
        }
        let decoded = visible.iter().filter_map(|mask| Some((*mask, self.photos.get(mask.asset.sha256)?)));
        let decoded: Vec<_> = decoded.collect();
        let pixels = tinted(&decoded, photo.asset.width, photo.asset.height).map(Arc::new);
        self.mask_layer = MaskLayer { made_of: key, pixels };
    }
}

/// All masks over one another, straight alpha; `None` where there is none.
fn tinted(masks: &[(&Mask, Arc<Pixels>)], width: u32, height: u32) -> Option<Pixels> {
    if masks.is_empty() {
        return None;
    }
    let mut rgba = vec![0; width as usize * height as usize * 4];
    for (mask, pixels) in masks {
        let Rgb([red, green, blue]) = mask.color;
        let alpha = (mask.opacity.clamp(0.0, 1.0) * 255.0).round() as u8;
        for (target, source) in rgba.chunks_exact_mut(4).zip(pixels.rgba.chunks_exact(4)) {
            let [r, g, b, a] = [source[0], source[1], source[2], source[3]];
            if a > 0 && (r, g, b) != (0, 0, 0) {
                target.copy_from_slice(&[red, green, blue, alpha]);
            }
        }
    }
    Some(Pixels { width, height, rgba })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{MaskId, PhotoAsset};

    #[test]
    fn what_is_not_black_is_tinted() {
        let asset = Arc::new(PhotoAsset {
            file_name: "mask.png".to_owned(),
            sha256: Sha256::of(b""),
            bytes: Arc::from(&b""[..]),
            width: 2,
            height: 1,
            exif_focal: None,
        });
        let mask = Mask {
            id: MaskId(1),
            photo: PhotoId(1),
            object: None,
            name: String::new(),
            asset,
            color: Rgb([10, 20, 30]),
            opacity: 0.5,
            visible: true,
        };
        let pixels = Arc::new(Pixels { width: 2, height: 1, rgba: vec![0, 0, 0, 255, 0, 1, 0, 255] });
        let layer = tinted(&[(&mask, pixels)], 2, 1).unwrap();
        assert_eq!(layer.rgba, [0, 0, 0, 0, 10, 20, 30, 128]);
        assert!(tinted(&[], 2, 1).is_none());
    }
}
