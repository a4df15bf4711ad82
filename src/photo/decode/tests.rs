use image::{DynamicImage, ImageFormat, Rgb, RgbImage, RgbaImage};

use super::*;

fn written(picture: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    picture.into().write_to(&mut Cursor::new(&mut bytes), format).unwrap();
    bytes
}

fn gradient(width: u32, height: u32) -> RgbImage {
    RgbImage::from_fn(width, height, |x, y| Rgb([x as u8, y as u8, 7]))
}

const LOSSLESS: [ImageFormat; 4] = [ImageFormat::Png, ImageFormat::WebP, ImageFormat::Bmp, ImageFormat::Tiff];

#[test]
fn lossless_formats_keep_their_pixels() {
    for format in LOSSLESS {
        let photo = decode(&written(gradient(5, 3), format)).unwrap();
        assert_eq!((photo.pixels.width, photo.pixels.height), (5, 3), "{format:?}");
        assert_eq!(photo.pixels.rgba[4 * 7..4 * 8], [2, 1, 7, 255], "{format:?}");
        assert_eq!(photo.exif_focal, None);
    }
}

#[test]
fn grey_transparent_and_deep_pictures_become_eight_bit_rgba() {
    let first = |bytes: Vec<u8>| <[u8; 4]>::try_from(&decode(&bytes).unwrap().pixels.rgba[..4]).unwrap();
    for format in [ImageFormat::Png, ImageFormat::Tiff] {
        let grey = image::GrayImage::from_pixel(2, 2, image::Luma([9]));
        assert_eq!(first(written(grey, format)), [9, 9, 9, 255]);
        let clear = RgbaImage::from_pixel(2, 2, image::Rgba([1, 2, 3, 4]));
        assert_eq!(first(written(clear, format)), [1, 2, 3, 4]);
        let deep = image::ImageBuffer::<Rgb<u16>, _>::from_pixel(2, 2, Rgb([0x1234, 0xffff, 0]));
        assert_eq!(first(written(deep, format)), [0x12, 0xff, 0, 255]);
    }
    let float = image::Rgb32FImage::from_pixel(2, 2, Rgb([0.5, 2.0, -1.0]));
    assert_eq!(first(written(float, ImageFormat::Tiff)), [128, 255, 0, 255]);
}

/// A JPEG with an EXIF segment: one entry in the first directory, orientation 6, so that it has to be turned right.
fn jpeg_on_its_side() -> Vec<u8> {
    let jpeg = written(gradient(8, 4), ImageFormat::Jpeg);
    let tiff = b"II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0";
    let mut segment = vec![0xff, 0xe1, 0, (2 + 6 + tiff.len()) as u8];
    segment.extend(b"Exif\0\0");
    segment.extend(tiff);
    [&jpeg[..2], &segment, &jpeg[2..]].concat()
}

#[test]
fn headers_agree_with_what_is_decoded() {
    let mut files: Vec<Vec<u8>> = LOSSLESS.map(|format| written(gradient(50, 30), format)).into();
    files.push(jpeg_on_its_side());
    for bytes in files {
        let (header, photo) = (read_header(&bytes).unwrap(), decode(&bytes).unwrap());
        assert_eq!((header.width, header.height), (photo.pixels.width, photo.pixels.height));
    }
    let header = read_header(&jpeg_on_its_side()).unwrap();
    assert_eq!((header.width, header.height), (4, 8));
}

#[test]
fn every_truncation_is_an_error_or_a_picture() {
    for format in [ImageFormat::Jpeg].into_iter().chain(LOSSLESS) {
        let whole = written(gradient(40, 30), format);
        for length in 0..whole.len() {
            if let Ok(photo) = decode(&whole[..length]) {
                assert_eq!(photo.pixels.rgba.len(), 40 * 30 * 4);
            }
            // What matters is that it returns.
            let _ = read_header(&whole[..length]);
        }
        assert!(decode(&whole[..24]).is_err(), "{format:?}");
    }
    assert!(matches!(decode(&[]), Err(PhotoError::UnknownFormat)));
    let png = written(gradient(40, 30), ImageFormat::Png);
    assert!(matches!(decode(&png[..60]), Err(PhotoError::Damaged { .. })));
}

#[test]
fn too_many_pixels_are_refused_before_they_are_read() {
    let mut bmp = written(gradient(4, 4), ImageFormat::Bmp);
    bmp[18..22].copy_from_slice(&10_000_u32.to_le_bytes());
    bmp[22..26].copy_from_slice(&6_000_u32.to_le_bytes());
    assert!(matches!(read_header(&bmp), Err(PhotoError::TooLarge { width: 10_000, height: 6_000 })));
    assert!(decode(&bmp).is_err());
}

#[test]
fn pictures_that_are_not_read_are_called_by_their_name() {
    let message = decode(b"\0\0\0\x1cftypheic\0\0\0\0").unwrap_err().to_string();
    assert!(message.contains("HEIC") && message.contains("JPEG"), "{message}");
    let message = decode(b"hello").unwrap_err().to_string();
    assert!(message.contains("WebP, BMP or TIFF expected"), "{message}");
}
