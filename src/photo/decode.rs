//! PNG and JPEG to pixels, within bounds.

use std::io::Cursor;

use image::metadata::Orientation;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use thiserror::Error;

use super::{DecodedPhoto, Pixels};

/// Larger photos are refused: a decoded one would fill the memory of a tab.
pub const MAX_PIXELS: u64 = 50_000_000;

/// The width in millimetres of the 36 × 24 mm frame that EXIF's 35 mm equivalent focal length refers to.
const FULL_FRAME_WIDTH_MM: f64 = 36.0;

#[derive(Debug, Error)]
pub enum PhotoError {
    #[error("not a photo this version reads: PNG or JPEG expected")]
    UnknownFormat,
    #[error("the {format} data is damaged or cut short: {reason}")]
    Damaged { format: &'static str, reason: String },
    #[error("the photo has {width}×{height} pixels, more than {} million", MAX_PIXELS / 1_000_000)]
    TooLarge { width: u32, height: u32 },
}

/// Decodes a PNG or JPEG file. The format is read from the content, never from the name.
pub fn decode(bytes: &[u8]) -> Result<DecodedPhoto, PhotoError> {
    let (format, format_name) = match image::guess_format(bytes) {
        Ok(ImageFormat::Png) => (ImageFormat::Png, "PNG"),
        Ok(ImageFormat::Jpeg) => (ImageFormat::Jpeg, "JPEG"),
        _ => return Err(PhotoError::UnknownFormat),
    };
    let damaged =
        |error: image::ImageError| PhotoError::Damaged { format: format_name, reason: error.to_string() };

    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    // 16-bit RGBA at the limit of pixels, the worst that is decoded.
    limits.max_alloc = Some(MAX_PIXELS * 8);
    reader.limits(limits);
    let mut decoder = reader.into_decoder().map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(PhotoError::TooLarge { width, height });
    }
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    let exif = decoder.exif_metadata().ok().flatten();

    let mut picture = DynamicImage::from_decoder(decoder).map_err(damaged)?;
    picture.apply_orientation(orientation);
    let picture = picture.into_rgba8();
    let pixels = Pixels { width: picture.width(), height: picture.height(), rgba: picture.into_raw() };
    // The equivalent focal length is defined along the sensor's long side, however the camera was held.
    let long_side_px = f64::from(pixels.width.max(pixels.height));
    let exif_focal_px =
        exif.and_then(focal_35mm).map(|focal_mm| focal_mm / FULL_FRAME_WIDTH_MM * long_side_px);
    Ok(DecodedPhoto { pixels, exif_focal_px })
}

/// EXIF's `FocalLengthIn35mmFilm`, where it is there and not zero ("unknown").
fn focal_35mm(exif: Vec<u8>) -> Option<f64> {
    let exif = exif::Reader::new().read_raw(exif).ok()?;
    let field = exif.get_field(exif::Tag::FocalLengthIn35mmFilm, exif::In::PRIMARY)?;
    field.value.get_uint(0).filter(|&focal_mm| focal_mm > 0).map(f64::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(width: u32, height: u32) -> Vec<u8> {
        let mut bytes = Vec::new();
        let picture = image::RgbImage::from_fn(width, height, |x, y| image::Rgb([x as u8, y as u8, 7]));
        picture.write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png).unwrap();
        bytes
    }

    #[test]
    fn a_png_keeps_its_pixels() {
        let photo = decode(&png(5, 3)).unwrap();
        assert_eq!((photo.pixels.width, photo.pixels.height), (5, 3));
        assert_eq!(photo.pixels.rgba[4 * 7..4 * 8], [2, 1, 7, 255]);
        assert_eq!(photo.exif_focal_px, None);
    }

    #[test]
    fn every_truncation_is_an_error_or_a_picture() {
        let whole = png(40, 30);
        for length in 0..whole.len() {
            if let Ok(photo) = decode(&whole[..length]) {
                assert_eq!(photo.pixels.rgba.len(), 40 * 30 * 4);
            }
        }
        assert!(matches!(decode(&[]), Err(PhotoError::UnknownFormat)));
        assert!(matches!(decode(&whole[..60]), Err(PhotoError::Damaged { .. })));
    }
}
