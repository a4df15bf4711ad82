//! PNG, JPEG, WebP, BMP and TIFF to pixels, within bounds.

use std::io::Cursor;

use image::metadata::Orientation;
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageError, ImageReader, Limits};
use thiserror::Error;

use super::exif_focal::{ExifFocal, exif_focal};
use super::kind::{PictureKind, picture_kind};
use super::{DecodedPhoto, PhotoHeader, Pixels};

/// Larger photos are refused: a decoded one would fill the memory of a tab.
pub const MAX_PIXELS: u64 = 50_000_000;

#[derive(Debug, Error)]
pub enum PhotoError {
    #[error("not a photo this version reads: PNG, JPEG, WebP, BMP or TIFF expected")]
    UnknownFormat,
    #[error("a {format} picture, which is not read: save it as PNG, JPEG, WebP, BMP or TIFF")]
    Foreign { format: &'static str },
    #[error("the {format} data is damaged or cut short: {reason}")]
    Damaged { format: &'static str, reason: String },
    #[error("this kind of {format} is not read: {reason}")]
    Unsupported { format: &'static str, reason: String },
    #[error("the photo has {width}×{height} pixels, more than {} million", MAX_PIXELS / 1_000_000)]
    TooLarge { width: u32, height: u32 },
    #[error("a depth map is a grey PNG or TIFF of 8 or 16 bits, this is a {format} of {found}")]
    NotDepth { format: &'static str, found: String },
}

/// Decodes a photo's file. The format is read from the content, never from the name. Sixteen bits a channel become eight,
/// evenly: 65535 is white.
pub fn decode(bytes: &[u8]) -> Result<DecodedPhoto, PhotoError> {
    let picture = Picture::open(bytes)?;
    let exif_focal = picture.exif_focal;
    let pixels = picture.decode()?.into_rgba8();
    let pixels = Pixels { width: pixels.width(), height: pixels.height(), rgba: pixels.into_raw() };
    Ok(DecodedPhoto { pixels, exif_focal })
}

/// Reads what a photo's file says of itself, without its pixels: a thousand photos take a moment.
pub fn read_header(bytes: &[u8]) -> Result<PhotoHeader, PhotoError> {
    let picture = Picture::open(bytes)?;
    let (width, height) = picture.upright_size();
    Ok(PhotoHeader { width, height, exif_focal: picture.exif_focal })
}

/// A picture's file whose header was read.
pub(super) struct Picture<D> {
    decoder: D,
    pub(super) format: &'static str,
    orientation: Orientation,
    exif_focal: Option<ExifFocal>,
}

impl<'a> Picture<Box<dyn ImageDecoder + 'a>> {
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, PhotoError> {
        let (format, format_name) = match picture_kind(bytes) {
            Some(PictureKind::Read(format, name)) => (format, name),
            Some(PictureKind::Foreign(format)) => return Err(PhotoError::Foreign { format }),
            None => return Err(PhotoError::UnknownFormat),
        };
        let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
        let mut limits = Limits::default();
        // 16-bit RGBA at the limit of pixels, the worst that is decoded.
        limits.max_alloc = Some(MAX_PIXELS * 8);
        reader.limits(limits);
        let decoder = reader.into_decoder().map_err(|error| refused(format_name, error))?;
        let mut decoder: Box<dyn ImageDecoder + 'a> = Box::new(decoder);
        let (width, height) = decoder.dimensions();
        if u64::from(width) * u64::from(height) > MAX_PIXELS {
            return Err(PhotoError::TooLarge { width, height });
        }
        let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
        let exif = decoder.exif_metadata().ok().flatten();
        let exif_focal = exif.and_then(|exif| exif_focal(exif, (width, height)));
        Ok(Self { decoder, format: format_name, orientation, exif_focal })
    }

    /// Width and height, once the picture stands upright.
    fn upright_size(&self) -> (u32, u32) {
        let (width, height) = self.decoder.dimensions();
        match self.orientation {
            Orientation::Rotate90
            | Orientation::Rotate270
            | Orientation::Rotate90FlipH
            | Orientation::Rotate270FlipH => (height, width),
            _ => (width, height),
        }
    }

    /// What the file holds, before it is expanded to whole bytes.
    pub(super) fn color(&self) -> ExtendedColorType {
        self.decoder.original_color_type()
    }

    /// Reads the pixels and turns them upright.
    pub(super) fn decode(self) -> Result<DynamicImage, PhotoError> {
        let decoded = DynamicImage::from_decoder(self.decoder);
        let mut picture = decoded.map_err(|error| refused(self.format, error))?;
        picture.apply_orientation(self.orientation);
        Ok(picture)
    }
}

fn refused(format: &'static str, error: ImageError) -> PhotoError {
    let reason = error.to_string();
    match error {
        ImageError::Unsupported(_) => PhotoError::Unsupported { format, reason },
        _ => PhotoError::Damaged { format, reason },
    }
}

#[cfg(test)]
mod tests;
