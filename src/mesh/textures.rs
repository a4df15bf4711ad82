//! Texture images on their way into a mesh's paint: found, decoded and shrunk within bounds.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use super::companions::{FindCompanion, base_name, companion_key};
use crate::photo::{self, MAX_PIXELS, Pixels};

/// The longest side of a texture, in pixels: every GPU that runs WebGL2 in practice takes it. Larger images are halved.
pub const MAX_TEXTURE_SIDE_PX: u32 = 4096;

/// So many pixels are decoded for one mesh; what does not fit is left out.
const MAX_PIXELS_OF_ALL: u64 = 2 * MAX_PIXELS;
/// So many missing files are named.
const MOST_NAMED: usize = 5;
/// Each texture costs a draw call.
const MAX_TEXTURES: usize = 256;

/// The textures of one mesh while its file is read.
pub(super) struct Textures<'a> {
    find: FindCompanion<'a>,
    textures: Vec<Arc<Pixels>>,
    /// What became of an image that was asked for before, by its key.
    known: BTreeMap<String, Option<u32>>,
    missing: Vec<String>,
    warnings: Vec<String>,
    pixels_left: u64,
}

impl<'a> Textures<'a> {
    pub fn new(find: FindCompanion<'a>) -> Self {
        Self {
            find,
            textures: Vec::new(),
            known: BTreeMap::new(),
            missing: Vec::new(),
            warnings: Vec::new(),
            pixels_left: MAX_PIXELS_OF_ALL,
        }
    }

    /// The texture in a companion file: its number, unless it is missing or cannot be read.
    pub fn in_file(&mut self, name: &str) -> Option<u32> {
        let key = companion_key(name);
        if let Some(known) = self.known.get(&key) {
            return *known;
        }
        let texture = match (self.find)(&key) {
            Some(bytes) => self.decode(base_name(name), &bytes),
            None => {
                self.missing.push(format!("“{}”", shown_name(name)));
                None
            }
        };
        self.known.insert(key, texture);
        texture
    }

    /// A texture within the mesh's own file. `what` names it in a message, and is the same for the same image, whose
    /// bytes are asked for once.
    pub fn embedded<'b>(&mut self, what: &str, bytes: impl FnOnce() -> Cow<'b, [u8]>) -> Option<u32> {
        // No file is named so: a key has no slashes.
        let key = format!("/{what}");
        if let Some(known) = self.known.get(&key) {
            return *known;
        }
        let texture = self.decode(what, &bytes());
        self.known.insert(key, texture);
        texture
    }

    pub fn is_empty(&self) -> bool {
        self.textures.is_empty()
    }

    /// The textures by their numbers, and what the user should know.
    pub fn finish(mut self) -> (Vec<Arc<Pixels>>, Vec<String>) {
        if !self.missing.is_empty() {
            let count = self.missing.len();
            let mut names = self.missing.iter().take(MOST_NAMED).cloned().collect::<Vec<_>>().join(", ");
            if count > MOST_NAMED {
                names += &format!(" and {} more", count - MOST_NAMED);
            }
            let (files, are) = if count == 1 { ("file", "is") } else { ("files", "are") };
            self.warnings.push(format!(
                "The texture {files} {names} did not come with the mesh and {are} left out; load them together."
            ));
        }
        (self.textures, self.warnings)
    }

    fn decode(&mut self, name: &str, bytes: &[u8]) -> Option<u32> {
        if self.textures.len() == MAX_TEXTURES || self.pixels_left == 0 {
            let limit =
                format!("{MAX_TEXTURES} textures or {} million pixels", MAX_PIXELS_OF_ALL / 1_000_000);
            self.warnings.push(format!("The texture “{}” is left out: more than {limit}.", shown_name(name)));
            return None;
        }
        match photo::decode(bytes) {
            Ok(decoded) => {
                let pixels = decoded.pixels;
                let count = u64::from(pixels.width) * u64::from(pixels.height);
                self.pixels_left = self.pixels_left.saturating_sub(count);
                self.textures.push(Arc::new(for_gpu(pixels)));
                Some(self.textures.len() as u32 - 1)
            }
            Err(error) => {
                self.warnings.push(format!("The texture “{}” cannot be read: {error}.", shown_name(name)));
                None
            }
        }
    }
}

fn for_gpu(mut pixels: Pixels) -> Pixels {
    while pixels.width.max(pixels.height) > MAX_TEXTURE_SIDE_PX {
        pixels = photo::half_size(&pixels);
    }
    for pixel in pixels.rgba.chunks_exact_mut(4) {
        if let [_, _, _, alpha] = pixel {
            *alpha = 255;
        }
    }
    pixels
}

/// A name from a file as it can be shown.
pub(super) fn shown_name(name: &str) -> String {
    base_name(name).chars().take(80).flat_map(char::escape_debug).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photo::png_rgba;

    #[test]
    fn each_file_is_decoded_once_and_made_to_fit() {
        let wide = png_rgba(&Pixels { width: 5000, height: 2, rgba: [7, 8, 9, 0].repeat(10_000) }).unwrap();
        let wide: Arc<[u8]> = Arc::from(wide);
        let find = |key: &str| (key == "wide.png").then(|| wide.clone());
        let mut textures = Textures::new(&find);
        assert_eq!(textures.in_file("maps/Wide.png"), Some(0));
        assert_eq!(textures.in_file("wide.PNG"), Some(0));
        assert_eq!((textures.in_file("a.png"), textures.in_file("a.png")), (None, None));
        assert_eq!(textures.embedded("image 0", || b"nothing".into()), None);
        let (textures, warnings) = textures.finish();
        assert_eq!(
            (textures.len(), textures[0].width, &textures[0].rgba[..4]),
            (1, 2500, &[7, 8, 9, 255][..])
        );
        assert!(warnings[0].contains("“image 0”") && warnings[1].contains("“a.png”"), "{warnings:?}");
        assert_eq!(warnings.len(), 2);
    }
}
