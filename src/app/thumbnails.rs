//! Has the thumbnails made that are seen, a few at a time and after what is more urgent.

use std::collections::HashMap;

use super::PinPose;
use crate::scene::Sha256;

/// Small enough that the photo that is to be shown does not wait for them.
const MOST_UNDER_WAY: usize = 2;

/// The jobs that are under way, and for which photo.
pub type ThumbnailJobs = HashMap<u64, Sha256>;

impl PinPose {
    pub(super) fn want_thumbnails(&mut self) {
        if self.photos.wanted.is_some() || self.loading.is_busy() {
            return;
        }
        let under_way = self.loading.thumbnails.len();
        let is_asked = |photo: &Sha256| self.loading.thumbnails.values().any(|asked| asked == photo);
        let wanted = self.ui_state.thumbnails.wanted().iter().copied().filter(|photo| !is_asked(photo));
        let next: Vec<Sha256> = wanted.take(MOST_UNDER_WAY.saturating_sub(under_way)).collect();
        for sha256 in next {
            let photos = &self.session.scene().photos;
            if let Some(photo) = photos.iter().find(|photo| photo.asset.sha256 == sha256) {
                self.loading.make_thumbnail(&photo.asset);
            }
        }
    }
}
