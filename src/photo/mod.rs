//! Photographs: encoded bytes to upright 8-bit RGBA, with what the file says of its lens.

mod decode;
mod depth;
mod encode;
mod exif_focal;
mod kind;
mod mip;
mod stored;
mod stripped;
mod thumbnail;

pub use decode::{MAX_PIXELS, PhotoError, decode, read_header};
pub use depth::{DepthPixels, decode_depth, is_depth_like};
pub use encode::{png_gray8, png_gray16, png_rgba};
pub use exif_focal::{ExifFocal, ExifFocalSource};
pub use kind::{foreign_kind, is_picture};
pub use mip::half_size;
pub use stored::{is_grey, plain_extension};
pub use stripped::{Stripped, without_metadata};
pub use thumbnail::thumbnail;

/// A decoded photo: RGBA rows from the top, 8 bits a channel, sRGB, upright (EXIF orientation applied).
#[derive(Debug, Clone, PartialEq)]
pub struct Pixels {
    pub width: u32,
    pub height: u32,
    /// `4 * width * height` bytes.
    pub rgba: Vec<u8>,
}

/// What [`decode`] returns.
#[derive(Debug, Clone, PartialEq)]
pub struct DecodedPhoto {
    pub pixels: Pixels,
    /// The focal length that the EXIF data gives.
    pub exif_focal: Option<ExifFocal>,
}

/// What [`read_header`] returns.
#[derive(Debug, Clone, PartialEq)]
pub struct PhotoHeader {
    /// In pixels, upright (EXIF orientation applied).
    pub width: u32,
    pub height: u32,
    /// As in [`DecodedPhoto`].
    pub exif_focal: Option<ExifFocal>,
}
