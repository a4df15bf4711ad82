//! Decoded photos: the one that is shown and as many others as fit; the rest stay encoded.

use std::sync::Arc;

use super::PinPose;
use crate::photo::Pixels;
use crate::scene::Sha256;

/// All decoded photos together, but for the one that is shown and the one that has just come, which are kept however large
/// they are.
const MOST_BYTES: usize = 256 << 20;

#[derive(Debug, Default)]
pub struct PhotoCache {
    /// What was used last comes first.
    kept: Vec<(Sha256, Arc<Pixels>)>,
    /// The photo that is shown.
    shown: Option<Sha256>,
    /// Being decoded, to be shown.
    pub wanted: Option<Sha256>,
    /// Was decoded ahead, or is being: it is not tried twice, though it may not have fitted.
    pub prefetched: Option<Sha256>,
}

impl PhotoCache {
    pub fn get(&self, sha256: Sha256) -> Option<Arc<Pixels>> {
        self.kept.iter().find(|(kept, _)| *kept == sha256).map(|(_, pixels)| pixels.clone())
    }

    /// This one stays, whatever else comes.
    pub fn show(&mut self, sha256: Sha256) {
        if self.shown != Some(sha256) {
            self.shown = Some(sha256);
            let position = self.kept.iter().position(|(kept, _)| *kept == sha256);
            if let Some(position) = position {
                let used = self.kept.remove(position);
                self.kept.insert(0, used);
            }
        }
    }

    pub fn insert(&mut self, sha256: Sha256, pixels: Arc<Pixels>) {
        self.kept.retain(|(kept, _)| *kept != sha256);
        self.kept.insert(0, (sha256, pixels));
        if self.wanted == Some(sha256) {
            self.wanted = None;
        }
        self.drop_surplus();
    }

    fn drop_surplus(&mut self) {
        let mut bytes: usize = self.kept.iter().map(|(_, pixels)| pixels.rgba.len()).sum();
        while bytes > MOST_BYTES {
            let is_free = |(kept, _): &(Sha256, Arc<Pixels>)| Some(*kept) != self.shown;
            match self.kept.iter().rposition(is_free) {
                Some(oldest) if oldest > 0 => bytes -= self.kept.remove(oldest).1.rgba.len(),
                // Whoever sent for it has to see it once.
                _ => break,
            }
        }
    }
}

impl PinPose {
    /// Makes sure that the shown photo's pixels are there or on their way, and then the next one's.
    pub(super) fn want_pixels(&mut self) {
        let Some(photo) = self.session.photo() else { return };
        let sha256 = photo.asset.sha256;
        self.photos.show(sha256);
        if self.photos.get(sha256).is_none() {
            if self.photos.wanted != Some(sha256) {
                self.photos.wanted = Some(sha256);
                self.loading.decode(&photo.asset);
            }
        } else if !self.loading.is_busy() && self.loading.is_worker_idle() {
            self.decode_next_photo();
        }
    }

    fn decode_next_photo(&mut self) {
        let photos = &self.session.scene().photos;
        let shown = self.session.photo().map(|photo| photo.id);
        let position = photos.iter().position(|photo| Some(photo.id) == shown);
        let Some(next) = position.and_then(|position| photos.get(position + 1)) else { return };
        let sha256 = next.asset.sha256;
        if self.photos.get(sha256).is_none() && self.photos.prefetched != Some(sha256) {
            self.photos.prefetched = Some(sha256);
            self.loading.decode_ahead(&next.asset);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn photo(number: u8, megabytes: usize) -> (Sha256, Arc<Pixels>) {
        let rgba = vec![0; megabytes << 20];
        (Sha256::of(&[number]), Arc::new(Pixels { width: 1, height: 1, rgba }))
    }

    #[test]
    fn photos_fit_a_budget_and_the_shown_one_stays() {
        let mut cache = PhotoCache::default();
        let photos: Vec<_> = (0..5).map(|number| photo(number, 100)).collect();
        cache.show(photos[0].0);
        for (sha256, pixels) in &photos {
            cache.insert(*sha256, pixels.clone());
        }
        let there: Vec<bool> = photos.iter().map(|(sha256, _)| cache.get(*sha256).is_some()).collect();
        assert_eq!(there, [true, false, false, false, true]);
        let (large, pixels) = photo(9, 300);
        cache.show(large);
        cache.insert(large, pixels);
        assert!(cache.get(large).is_some(), "however large");
        let (next, pixels) = photo(10, 300);
        cache.insert(next, pixels);
        assert!(cache.get(next).is_some() && cache.get(large).is_some(), "beside the shown one");
        let (after, pixels) = photo(11, 1);
        cache.insert(after, pixels);
        assert!(cache.get(next).is_none() && cache.get(after).is_some(), "until another comes");
    }
}
