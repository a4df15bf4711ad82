//! Whether a photo's file may be handed on as it is.

use std::io::Cursor;

use image::metadata::Orientation;
use image::{ImageDecoder, ImageFormat, ImageReader};

/// The extension under which a file can be handed to a program that reads PNG and JPEG and knows nothing of EXIF; `None`
/// where it has to be written anew: another format, or rows that are not stored upright.
pub fn plain_extension(bytes: &[u8]) -> Option<&'static str> {
    let (format, extension) = match image::guess_format(bytes) {
        Ok(ImageFormat::Png) => (ImageFormat::Png, "png"),
        Ok(ImageFormat::Jpeg) => (ImageFormat::Jpeg, "jpg"),
        _ => return None,
    };
    let mut decoder = ImageReader::with_format(Cursor::new(bytes), format).into_decoder().ok()?;
    let orientation = decoder.orientation().unwrap_or(Orientation::NoTransforms);
    (orientation == Orientation::NoTransforms).then_some(extension)
}
