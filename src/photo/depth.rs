//! Depth maps: grey pictures whose numbers are distances.

use image::{DynamicImage, ExtendedColorType};

use super::PhotoError;
use super::decode::Picture;

/// A depth map as its file has it: `raw` times a number of millimetres, which the data set gives, is the depth along the
/// optical axis in millimetres; 0 is unknown.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DepthPixels {
    pub width: u32,
    pub height: u32,
    /// `width * height` values, row by row from the top.
    pub raw: Vec<u16>,
}

/// Decodes a grey PNG or TIFF of 8 or 16 bits; what is neither is refused, for its numbers would be no depths.
pub fn decode_depth(bytes: &[u8]) -> Result<DepthPixels, PhotoError> {
    let picture = Picture::open(bytes)?;
    let format = picture.format;
    let color = picture.color();
    let is_lossless = matches!(format, "PNG" | "TIFF");
    if !is_lossless || !matches!(color, ExtendedColorType::L8 | ExtendedColorType::L16) {
        return Err(PhotoError::NotDepth { format, found: color_in_words(color) });
    }
    match picture.decode()? {
        DynamicImage::ImageLuma8(grey) => {
            let (width, height) = grey.dimensions();
            Ok(DepthPixels { width, height, raw: grey.into_raw().into_iter().map(u16::from).collect() })
        }
        DynamicImage::ImageLuma16(grey) => {
            let (width, height) = grey.dimensions();
            Ok(DepthPixels { width, height, raw: grey.into_raw() })
        }
        other => Err(PhotoError::NotDepth { format, found: color_in_words(other.color().into()) }),
    }
}

/// Is this most likely a depth map? Nearly nothing else is a grey PNG of 16 bits.
pub fn is_depth_like(bytes: &[u8]) -> bool {
    const GREY_OF_16_BITS: [u8; 2] = [16, 0];
    bytes.starts_with(b"\x89PNG\r\n\x1a\n") && bytes.get(24..26) == Some(&GREY_OF_16_BITS)
}

fn color_in_words(color: ExtendedColorType) -> String {
    let (channels, bits) = (color.channel_count(), color.bits_per_pixel());
    let bits_each = bits / u16::from(channels.max(1));
    match channels {
        1 => format!("one channel of {bits_each} bits"),
        _ => format!("{channels} channels of {bits_each} bits"),
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use image::{ImageBuffer, ImageFormat, Luma, RgbImage};

    use super::*;

    fn written(picture: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Vec::new();
        picture.into().write_to(&mut Cursor::new(&mut bytes), format).unwrap();
        bytes
    }

    fn deep() -> DynamicImage {
        ImageBuffer::<Luma<u16>, _>::from_fn(3, 2, |x, y| Luma([1000 * x as u16 + y as u16])).into()
    }

    #[test]
    fn raw_values_come_through_as_they_are() {
        for format in [ImageFormat::Png, ImageFormat::Tiff] {
            let depth = decode_depth(&written(deep(), format)).unwrap();
            assert_eq!((depth.width, depth.height), (3, 2));
            assert_eq!(depth.raw, [0, 1000, 2000, 1, 1001, 2001]);
        }
        let shallow = image::GrayImage::from_pixel(1, 1, Luma([200]));
        assert_eq!(decode_depth(&written(shallow, ImageFormat::Png)).unwrap().raw, [200]);
    }

    #[test]
    fn colour_and_lossy_pictures_are_no_depth() {
        let message = decode_depth(&written(RgbImage::new(2, 2), ImageFormat::Png)).unwrap_err().to_string();
        assert!(message.contains("PNG of 3 channels of 8 bits"), "{message}");
        let grey = image::GrayImage::new(8, 8);
        assert!(matches!(
            decode_depth(&written(grey, ImageFormat::Jpeg)),
            Err(PhotoError::NotDepth { format: "JPEG", .. })
        ));
    }

    #[test]
    fn every_truncation_is_an_error_or_a_whole_map() {
        let whole = written(deep(), ImageFormat::Png);
        for length in 0..whole.len() {
            if let Ok(depth) = decode_depth(&whole[..length]) {
                assert_eq!(depth.raw.len(), 6);
            }
        }
    }
}
