//! What a picture's first bytes say it is, among the kinds that are read and those that are only known by name.

use image::ImageFormat;

/// A file that is a picture by its first bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PictureKind {
    /// One that [`super::decode`] reads, with its name.
    Read(ImageFormat, &'static str),
    /// Any other, by its name.
    Foreign(&'static str),
}

/// Is this a picture, of a kind that is read or at least known by name? A few bytes decide, never a file's name.
pub fn is_picture(bytes: &[u8]) -> bool {
    picture_kind(bytes).is_some()
}

/// The kind of a picture that is known by name only, and that a browser may read.
pub fn foreign_kind(bytes: &[u8]) -> Option<&'static str> {
    match picture_kind(bytes)? {
        PictureKind::Foreign(name) => Some(name),
        PictureKind::Read(..) => None,
    }
}

pub(super) fn picture_kind(bytes: &[u8]) -> Option<PictureKind> {
    let read = |format, name| Some(PictureKind::Read(format, name));
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => read(ImageFormat::Png, "PNG"),
        [0xff, 0xd8, 0xff, ..] => read(ImageFormat::Jpeg, "JPEG"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => read(ImageFormat::WebP, "WebP"),
        _ if is_bmp(bytes) => read(ImageFormat::Bmp, "BMP"),
        // Canon's raw files begin as TIFF does; read as one, they would show their thumbnail.
        [b'I', b'I', 42, 0, _, _, _, _, b'C', b'R', ..] => Some(PictureKind::Foreign("camera raw")),
        // The second of each is BigTIFF.
        [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => read(ImageFormat::Tiff, "TIFF"),
        _ => foreign_name(bytes).map(PictureKind::Foreign),
    }
}

/// "BM" alone begins many a text. The four bytes after the size are zero, and the second header's size is one of a few.
fn is_bmp(bytes: &[u8]) -> bool {
    let has_mark = bytes.starts_with(b"BM") && bytes.get(6..10) == Some(&[0; 4]);
    let header_size = bytes.get(14..18).and_then(|size| size.try_into().ok()).map(u32::from_le_bytes);
    has_mark && matches!(header_size, Some(12 | 16 | 40 | 52 | 56 | 64 | 108 | 124))
}

fn foreign_name(bytes: &[u8]) -> Option<&'static str> {
    const MARKS: [(&[u8], &str); 11] = [
        (b"GIF8", "GIF"),
        (b"8BPS", "Photoshop"),
        (b"v/1\x01", "OpenEXR"),
        (b"#?RADIANCE", "Radiance HDR"),
        (b"qoif", "QOI"),
        (b"\xff\x0a", "JPEG XL"),
        (b"\0\0\0\x0cJXL ", "JPEG XL"),
        (b"\0\0\0\x0cjP  ", "JPEG 2000"),
        (b"\xff\x4f\xff\x51", "JPEG 2000"),
        (b"IIU\0", "camera raw"),
        (b"FUJIFILMCCD-RAW", "camera raw"),
    ];
    if let Some((_, name)) = MARKS.iter().find(|(mark, _)| bytes.starts_with(mark)) {
        return Some(name);
    }
    // ISO's media file: the size of the first box, "ftyp", and who wrote it.
    if bytes.get(4..8)? != b"ftyp" {
        return None;
    }
    match bytes.get(8..12)? {
        b"avif" | b"avis" => Some("AVIF"),
        b"heic" | b"heix" | b"hevc" | b"heim" | b"heis" | b"mif1" | b"msf1" => Some("HEIC"),
        b"crx " => Some("camera raw"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_known_by_their_first_bytes() {
        let name = |bytes: &[u8]| match picture_kind(bytes) {
            Some(PictureKind::Read(_, name) | PictureKind::Foreign(name)) => name,
            None => "none",
        };
        assert_eq!(name(b"\x89PNG\r\n"), "PNG");
        assert_eq!(name(b"RIFF\x10\0\0\0WEBPVP8 "), "WebP");
        assert_eq!(name(b"RIFF\x10\0\0\0AVI "), "none");
        assert_eq!(name(b"BM\x10\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0"), "BMP");
        assert_eq!(name(b"BMW drives by, a text"), "none");
        assert_eq!(name(b"II*\0\x08\0\0\0\x0d\0"), "TIFF");
        assert_eq!(name(b"II*\0\x10\0\0\0CR\x02\0"), "camera raw");
        assert_eq!(name(b"\0\0\0\x1cftypheic"), "HEIC");
        assert_eq!(name(b"\0\0\0\x1cftypisom"), "none");
        assert_eq!(name(b""), "none");
    }
}
