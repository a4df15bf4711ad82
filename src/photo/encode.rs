//! Pictures as PNG files.

use std::io::Cursor;

use image::{DynamicImage, GrayImage, ImageBuffer, ImageFormat, Luma, RgbaImage};

use super::Pixels;

/// RGBA, 8 bits a channel. `None` where the bytes are not `4 * width * height`.
pub fn png_rgba(pixels: &Pixels) -> Option<Vec<u8>> {
    write(RgbaImage::from_raw(pixels.width, pixels.height, pixels.rgba.clone())?.into())
}

/// Grey, 8 bits.
pub fn png_gray8(width: u32, height: u32, values: Vec<u8>) -> Option<Vec<u8>> {
    write(GrayImage::from_raw(width, height, values)?.into())
}

/// Grey, 16 bits.
pub fn png_gray16(width: u32, height: u32, values: Vec<u16>) -> Option<Vec<u8>> {
    write(ImageBuffer::<Luma<u16>, _>::from_raw(width, height, values)?.into())
}

fn write(picture: DynamicImage) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    picture.write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png).ok()?;
    Some(bytes)
}
