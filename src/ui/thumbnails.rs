//! Small pictures of photos, as textures: made for those that are seen, and kept within a bound.

use std::collections::HashMap;

use egui::{ColorImage, TextureHandle, TextureOptions};

use crate::photo::Pixels;
use crate::scene::Sha256;

/// Their longer side at most, in pixels.
pub const MOST_SIDE_PX: u32 = 160;

/// All textures together; a thumbnail of 160 × 120 takes 77 kB.
const MOST_BYTES: usize = 32 << 20;

#[derive(Default)]
pub struct Thumbnails {
    kept: HashMap<Sha256, Kept>,
    bytes: usize,
    /// Counts frames: what was seen least recently goes first.
    now: u64,
    /// Seen in the last frame and not there, the first of them first.
    wanted: Vec<Sha256>,
}

struct Kept {
    /// `None`: it cannot be made, and is not asked for again.
    texture: Option<TextureHandle>,
    bytes: usize,
    seen: u64,
}

impl std::fmt::Debug for Thumbnails {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{} thumbnails, {} bytes", self.kept.len(), self.bytes)
    }
}

impl Thumbnails {
    pub(super) fn begin_frame(&mut self) {
        self.now += 1;
        self.wanted.clear();
    }

    /// The texture of a photo that is seen now; where it is not there, it is asked for.
    pub(super) fn get(&mut self, photo: Sha256) -> Option<&TextureHandle> {
        let now = self.now;
        match self.kept.get_mut(&photo) {
            Some(kept) => {
                kept.seen = now;
                kept.texture.as_ref()
            }
            None => {
                self.wanted.push(photo);
                None
            }
        }
    }

    /// The photos whose thumbnails are to be made, the most urgent first.
    pub fn wanted(&self) -> &[Sha256] {
        &self.wanted
    }

    /// Keeps a thumbnail; `None` if it could not be made.
    pub fn insert(&mut self, ctx: &egui::Context, photo: Sha256, pixels: Option<&Pixels>) {
        let texture = pixels.map(|pixels| {
            let size = [pixels.width as usize, pixels.height as usize];
            let image = ColorImage::from_rgba_unmultiplied(size, &pixels.rgba);
            ctx.load_texture("thumbnail", image, TextureOptions::LINEAR)
        });
        let bytes = pixels.map_or(0, |pixels| pixels.rgba.len());
        self.bytes += bytes;
        if let Some(before) = self.kept.insert(photo, Kept { texture, bytes, seen: self.now }) {
            self.bytes -= before.bytes;
        }
        self.drop_surplus();
    }

    fn drop_surplus(&mut self) {
        while self.bytes > MOST_BYTES {
            let oldest = self.kept.iter().min_by_key(|(_, kept)| kept.seen).map(|(photo, _)| *photo);
            let Some(dropped) = oldest.and_then(|photo| self.kept.remove(&photo)) else { break };
            self.bytes -= dropped.bytes;
        }
    }
}
