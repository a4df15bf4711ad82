//! A photo's file with its pixels and nothing else: no place, no time, no camera, no thumbnail, no comment.

use super::{decode, plain_extension, png_rgba};

/// A picture's file without metadata, and its extension.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stripped {
    pub bytes: Vec<u8>,
    pub extension: &'static str,
}

/// The same upright pixels, bit for bit. JPEG and PNG keep their compression; what is of another format, is not stored upright, or
/// would look different without its tags, is written anew as PNG. `None` where the file cannot be decoded.
pub fn without_metadata(bytes: &[u8]) -> Option<Stripped> {
    let pixels = decode(bytes).ok()?.pixels;
    let extension = plain_extension(bytes);
    let kept = match extension {
        Some("png") => png_pixels(bytes),
        Some("jpg") => jpeg_pixels(bytes),
        _ => None,
    };
    let is_same = |kept: &Vec<u8>| decode(kept).is_ok_and(|again| again.pixels == pixels);
    if let (Some(kept), Some(extension)) = (kept.filter(is_same), extension) {
        return Some(Stripped { bytes: kept, extension });
    }
    Some(Stripped { bytes: png_rgba(&pixels)?, extension: "png" })
}

/// The chunks that pixels are made of.
fn png_pixels(bytes: &[u8]) -> Option<Vec<u8>> {
    const SIGNATURE: usize = 8;
    let mut kept = bytes.get(..SIGNATURE)?.to_vec();
    let mut at = SIGNATURE;
    loop {
        let length = u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?) as usize;
        let kind = bytes.get(at + 4..at + 8)?;
        // Length, kind, data and checksum.
        let chunk = bytes.get(at..at.checked_add(length)?.checked_add(12)?)?;
        if matches!(kind, b"IHDR" | b"PLTE" | b"tRNS" | b"IDAT" | b"IEND") {
            kept.extend_from_slice(chunk);
        }
        if kind == b"IEND" {
            // What comes after the end is none of the picture's.
            return Some(kept);
        }
        at += chunk.len();
    }
}

/// The segments that pixels are made of, up to the end of the image.
fn jpeg_pixels(bytes: &[u8]) -> Option<Vec<u8>> {
    const START_OF_SCAN: u8 = 0xDA;
    const END: u8 = 0xD9;
    let mut kept = bytes.get(..2)?.to_vec();
    let mut at = 2;
    loop {
        let [0xFF, marker] = *bytes.get(at..at + 2)? else { return None };
        match marker {
            // Fill bytes may stand before a marker.
            0xFF => {
                at += 1;
                continue;
            }
            END => {
                kept.extend([0xFF, END]);
                return Some(kept);
            }
            _ => {}
        }
        let length = u16::from_be_bytes(bytes.get(at + 2..at + 4)?.try_into().ok()?) as usize;
        let segment = bytes.get(at..at + 2 + length)?;
        if is_of_pixels(marker, segment) {
            kept.extend_from_slice(segment);
        }
        at += segment.len();
        if marker == START_OF_SCAN {
            let data = scan_length(bytes.get(at..)?);
            kept.extend_from_slice(bytes.get(at..at + data)?);
            at += data;
        }
    }
}

/// Tables, frames and scans; of the application's segments JFIF's without a thumbnail and Adobe's, which say how colours are coded.
fn is_of_pixels(marker: u8, segment: &[u8]) -> bool {
    const JFIF_WITHOUT_THUMBNAIL: usize = 18;
    match marker {
        0xE0 => segment.get(4..9) == Some(b"JFIF\0") && segment.len() == JFIF_WITHOUT_THUMBNAIL,
        0xEE => segment.get(4..9) == Some(b"Adobe"),
        0xE1..=0xEF | 0xFE => false,
        _ => true,
    }
}

/// Coded data end at a marker that is neither a stuffed zero nor a restart.
fn scan_length(data: &[u8]) -> usize {
    let ends = |pair: &[u8]| pair[0] == 0xFF && !matches!(pair[1], 0x00 | 0xD0..=0xD7 | 0xFF);
    data.windows(2).position(ends).unwrap_or(data.len())
}

#[cfg(test)]
mod tests {
    use image::codecs::jpeg::JpegEncoder;
    use image::{ExtendedColorType, ImageEncoder};

    use super::*;
    use crate::photo::Pixels;

    const SECRET: &[u8] = b"GPS 50.1 N 8.7 E";

    fn pixels() -> Pixels {
        let rgba = (0..32 * 24).flat_map(|index| [index as u8, (index / 7) as u8, 90, 255]).collect();
        Pixels { width: 32, height: 24, rgba }
    }

    fn contains(bytes: &[u8], secret: &[u8]) -> bool {
        bytes.windows(secret.len()).any(|window| window == secret)
    }

    #[test]
    fn a_png_loses_its_texts_and_what_follows_it() {
        let png = png_rgba(&pixels()).unwrap();
        let mut chunk = (SECRET.len() as u32).to_be_bytes().to_vec();
        chunk.extend(b"eXIf");
        chunk.extend(SECRET);
        // Decoders leave a broken checksum of a chunk that they skip alone.
        chunk.extend([0; 4]);
        const AFTER_HEADER: usize = 8 + 25;
        let mut tagged = png.clone();
        tagged.splice(AFTER_HEADER..AFTER_HEADER, chunk);
        tagged.extend(SECRET);
        let stripped = without_metadata(&tagged).unwrap();
        assert!(!contains(&stripped.bytes, SECRET));
        assert_eq!(decode(&stripped.bytes).unwrap().pixels, pixels());
        assert_eq!(stripped.extension, "png");
    }

    #[test]
    fn a_jpeg_keeps_its_pixels_bit_for_bit_and_its_compression() {
        let mut jpeg = Vec::new();
        let rgb: Vec<u8> = pixels().rgba.chunks(4).flat_map(|pixel| pixel[..3].to_vec()).collect();
        JpegEncoder::new_with_quality(&mut jpeg, 90)
            .write_image(&rgb, 32, 24, ExtendedColorType::Rgb8)
            .unwrap();
        let plain = decode(&jpeg).unwrap().pixels;
        let mut tagged = jpeg.clone();
        for marker in [0xE1, 0xE2, 0xFE] {
            let mut segment = vec![0xFF, marker];
            segment.extend((SECRET.len() as u16 + 2).to_be_bytes());
            segment.extend(SECRET);
            tagged.splice(2..2, segment);
        }
        tagged.extend(SECRET);
        let stripped = without_metadata(&tagged).unwrap();
        assert!(contains(&tagged, SECRET) && !contains(&stripped.bytes, SECRET));
        assert_eq!(decode(&stripped.bytes).unwrap().pixels, plain);
        assert!(stripped.extension == "jpg" && stripped.bytes.len() <= jpeg.len());
    }

    #[test]
    fn every_truncation_ends() {
        let png = png_rgba(&pixels()).unwrap();
        for length in 0..png.len() {
            // What matters is that it returns.
            let _ = (without_metadata(&png[..length]), jpeg_pixels(&png[..length]));
        }
    }
}
