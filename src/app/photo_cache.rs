//! Decoded photos: the one that is shown and a few around it; the rest stay encoded.

use std::sync::Arc;

use crate::photo::Pixels;
use crate::scene::Sha256;

/// Photos that are kept decoded, newest first; a 12-megapixel one takes 48 MB.
const KEPT: usize = 4;

#[derive(Debug, Default)]
pub struct PhotoCache {
    kept: Vec<(Sha256, Arc<Pixels>)>,
    /// Being decoded.
    pub wanted: Option<Sha256>,
}

impl PhotoCache {
    pub fn get(&self, sha256: Sha256) -> Option<Arc<Pixels>> {
        self.kept.iter().find(|(kept, _)| *kept == sha256).map(|(_, pixels)| pixels.clone())
    }

    pub fn insert(&mut self, sha256: Sha256, pixels: Arc<Pixels>) {
        self.kept.retain(|(kept, _)| *kept != sha256);
        self.kept.insert(0, (sha256, pixels));
        self.kept.truncate(KEPT);
        if self.wanted == Some(sha256) {
            self.wanted = None;
        }
    }
}
