//! Whether a photo's file may be handed on as it is.

use std::io::Cursor;

use image::metadata::Orientation;
use image::{ExtendedColorType, ImageDecoder, ImageFormat, ImageReader};

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

/// Does the file hold one channel of brightness, whether or not with transparency? Its header says so.
pub fn is_grey(bytes: &[u8]) -> bool {
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format();
    let decoder = reader.ok().and_then(|reader| reader.into_decoder().ok());
    decoder.is_some_and(|decoder| {
        use ExtendedColorType as Color;
        let color = decoder.original_color_type();
        matches!(
            color,
            Color::L1
                | Color::L2
                | Color::L4
                | Color::L8
                | Color::L16
                | Color::La1
                | Color::La2
                | Color::La4
                | Color::La8
                | Color::La16
        )
    })
}
