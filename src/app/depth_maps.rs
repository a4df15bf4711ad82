//! Decoded depth maps: the shown photo's and the ones that were used last.

use std::sync::Arc;

use super::PinPose;
use crate::photo::DepthPixels;
use crate::scene::{DepthMap, PhotoId, Sha256};

/// Going back and forth between neighbours decodes nothing anew.
const MOST: usize = 4;

#[derive(Debug, Default)]
pub struct DepthMaps {
    /// What was used last comes first.
    kept: Vec<(Sha256, Arc<DepthPixels>)>,
    wanted: Option<Sha256>,
}

impl DepthMaps {
    fn get(&self, sha256: Sha256) -> Option<Arc<DepthPixels>> {
        self.kept.iter().find(|(kept, _)| *kept == sha256).map(|(_, pixels)| pixels.clone())
    }

    /// `None`: it could not be read, and is not asked for again.
    pub fn insert(&mut self, sha256: Sha256, pixels: Option<Arc<DepthPixels>>) {
        let Some(pixels) = pixels else { return };
        self.kept.retain(|(kept, _)| *kept != sha256);
        self.kept.insert(0, (sha256, pixels));
        self.kept.truncate(MOST);
        if self.wanted == Some(sha256) {
            self.wanted = None;
        }
    }
}

impl PinPose {
    /// The photo's depth map, if it is to be shown and decoded; if it is not decoded, it is sent for.
    pub(super) fn depth_of(&mut self, photo: PhotoId) -> Option<Arc<DepthPixels>> {
        let depth = self.occluding_depth(photo)?;
        let asset = depth.asset.clone();
        let known = self.depth_maps.get(asset.sha256);
        if known.is_none() && self.depth_maps.wanted != Some(asset.sha256) {
            self.depth_maps.wanted = Some(asset.sha256);
            self.loading.decode_depth(&asset);
        }
        known
    }

    /// Is a depth map on its way that this photo's picture needs?
    pub(super) fn waits_for_depth(&mut self, photo: PhotoId) -> bool {
        self.occluding_depth(photo).is_some()
            && self.depth_of(photo).is_none()
            && !self.loading.is_worker_idle()
    }

    fn occluding_depth(&self, photo: PhotoId) -> Option<&DepthMap> {
        self.session.scene().photo(photo)?.depth.as_ref().filter(|depth| depth.occludes)
    }
}
