//! Material libraries (MTL): diffuse colours and the images that go with them.

use std::collections::BTreeMap;

use crate::mesh::text::{next_line, parse_number, without_byte_order_mark, words};

/// What is drawn of a material.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct LibraryMaterial {
    /// `Kd`, or else `Ka`: red, green, blue from 0 to 1. Programs write them as the screen shows them, in sRGB.
    pub diffuse: Option<[f64; 3]>,
    ambient: Option<[f64; 3]>,
    /// The file that `map_Kd` names.
    pub texture: Option<String>,
}

#[derive(Debug, Default)]
pub(super) struct Library {
    pub materials: BTreeMap<Vec<u8>, LibraryMaterial>,
    /// The images of all kinds.
    pub images: Vec<String>,
}

impl LibraryMaterial {
    /// sRGB and alpha. The opacity of a file is not taken: silhouettes are the geometry's.
    pub fn color(&self) -> [u8; 4] {
        let [r, g, b] =
            self.diffuse.or(self.ambient).unwrap_or([1.0; 3]).map(|value| (value * 255.0).round() as u8);
        [r, g, b, 255]
    }
}

/// Never fails: lines that make no sense are left out, for what a broken library costs is the colours alone.
pub(super) fn parse(bytes: &[u8]) -> Library {
    let bytes = without_byte_order_mark(bytes);
    let mut library = Library::default();
    let mut current: Option<Vec<u8>> = None;
    let mut position = 0;
    while let Some(line) = next_line(bytes, &mut position) {
        let Some((keyword, rest)) = keyword_and_rest(line) else { continue };
        if keyword == b"newmtl" {
            // The first of two of one name is kept, as in most programs.
            let is_new = !library.materials.contains_key(rest);
            library.materials.entry(rest.to_vec()).or_default();
            current = is_new.then(|| rest.to_vec());
            continue;
        }
        let image = is_image(&keyword).then(|| image_name(rest)).filter(|name| !name.is_empty());
        library.images.extend(image.clone());
        let Some(material) = current.as_ref().and_then(|name| library.materials.get_mut(name)) else {
            continue;
        };
        match keyword.as_slice() {
            b"kd" => material.diffuse = color(rest),
            b"ka" => material.ambient = color(rest),
            b"map_kd" => material.texture = image,
            _ => {}
        }
    }
    library
}

/// A line's first word in lower case, and what follows it without space around.
pub(super) fn keyword_and_rest(line: &[u8]) -> Option<(Vec<u8>, &[u8])> {
    let line = line.trim_ascii();
    let length = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
    let (keyword, rest) = line.split_at_checked(length).filter(|(keyword, _)| !keyword.is_empty())?;
    Some((keyword.to_ascii_lowercase(), rest.trim_ascii()))
}

/// One number is a grey; the format's spectral colours are not read.
fn color(rest: &[u8]) -> Option<[f64; 3]> {
    let numbers: Option<Vec<f64>> = words(rest).take(3).map(parse_number).collect();
    match *numbers?.as_slice() {
        [grey] => Some([grey; 3]),
        [r, g, b] => Some([r, g, b]),
        _ => None,
    }
}

fn is_image(keyword: &[u8]) -> bool {
    keyword.starts_with(b"map_") || matches!(keyword, b"bump" | b"disp" | b"decal" | b"refl" | b"norm")
}

/// The file's name behind the options: it may hold spaces, and the options have one word each or up to three numbers.
fn image_name(rest: &[u8]) -> String {
    let mut rest = rest;
    while rest.starts_with(b"-") {
        let Some((option, mut behind)) = keyword_and_rest(rest) else { break };
        let most_words = match option.as_slice() {
            b"-o" | b"-s" | b"-t" => 3,
            b"-mm" => 2,
            _ => 1,
        };
        for number in 0..most_words {
            let Some((word, after_word)) = keyword_and_rest(behind) else { break };
            if number > 0 && parse_number(&word).is_none() {
                break;
            }
            behind = after_word;
        }
        rest = behind;
    }
    String::from_utf8_lossy(rest).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_and_images_are_found_behind_options_and_spaces() {
        let library = parse(
            b"# a comment\nKd 9 9 9\n  newmtl red one\n\tKd 1 0.5 0 \nmap_Kd -o 0.1 -blendu on -s 1 2 3 my tex.png \n\
              map_Bump -bm 2 bumps.png\nnewmtl grey\nKa 0.2\nKd spectral x.rfl\n",
        );
        let red = &library.materials[b"red one".as_slice()];
        assert_eq!((red.color(), red.texture.as_deref()), ([255, 128, 0, 255], Some("my tex.png")));
        assert_eq!(library.materials[b"grey".as_slice()].color(), [51, 51, 51, 255]);
        assert_eq!(library.images, ["my tex.png", "bumps.png"]);
    }
}
