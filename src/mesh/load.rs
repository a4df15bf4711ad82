//! From a dropped file's bytes to a mesh: which format it is, and what the user should be told about it.

use super::{Format, Mesh, MeshData, MeshError, gltf, obj, ply, text};

/// A mesh and what was odd about its file.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedMesh {
    pub mesh: Mesh,
    /// Sentences for the user.
    pub warnings: Vec<String>,
}

/// What a format's parser hands over.
#[derive(Debug, Default)]
pub(super) struct Parsed {
    pub data: MeshData,
    pub warnings: Vec<String>,
}

/// Reads a mesh. The format is recognised by the content, and by the file's extension where the content does not tell.
///
/// PLY and OBJ know no unit: their numbers are taken as they are, and [`Mesh::transformed`] brings them to millimetres
/// where the caller knows better. glTF is in metres and comes out in millimetres. Axes are kept as in the file.
pub fn load(file_name: &str, bytes: &[u8]) -> Result<LoadedMesh, MeshError> {
    let bytes = text::without_byte_order_mark(bytes);
    let Parsed { data, mut warnings } = match recognize(file_name, bytes).ok_or(MeshError::UnknownFormat)? {
        Format::Ply => ply::parse(bytes)?,
        Format::Obj => obj::parse(bytes)?,
        Format::Gltf => gltf::parse(bytes)?,
    };
    let has_file_normals = data.normals.is_some();
    let mesh = Mesh::new(data)?;
    if has_file_normals && mesh.normals().is_none() {
        warnings
            .push("Some of the file's normals are zero or not finite; shading computes its own.".to_owned());
    }
    if mesh.unreferenced_vertices() > 0 {
        let (loose, all) = (mesh.unreferenced_vertices(), mesh.positions_mm().len());
        warnings.push(format!(
            "{loose} of {all} vertices belong to no face: they are not drawn, but metrics count them."
        ));
    }
    Ok(LoadedMesh { mesh, warnings })
}

fn recognize(file_name: &str, bytes: &[u8]) -> Option<Format> {
    recognize_content(bytes).or_else(|| {
        let (_, extension) = file_name.rsplit_once('.')?;
        match extension.to_ascii_lowercase().as_str() {
            "ply" => Some(Format::Ply),
            "obj" => Some(Format::Obj),
            "glb" | "gltf" => Some(Format::Gltf),
            _ => None,
        }
    })
}

fn recognize_content(bytes: &[u8]) -> Option<Format> {
    if bytes.starts_with(b"glTF") {
        return Some(Format::Gltf);
    }
    if matches!(bytes, [b'p', b'l', b'y', b'\n' | b'\r', ..]) {
        return Some(Format::Ply);
    }
    let trimmed = bytes.trim_ascii_start();
    if trimmed.starts_with(b"{") {
        // Our own scene files are JSON too; every glTF has an "asset", near its beginning or its end.
        return trimmed.windows(7).any(|window| window == b"\"asset\"").then_some(Format::Gltf);
    }
    // OBJ has no magic number: its first words are comments, or one of these with something behind it.
    let mut position = 0;
    let first_line = std::iter::from_fn(|| text::next_line(bytes, &mut position))
        .take(1000)
        .map(<[u8]>::trim_ascii)
        .find(|line| !line.is_empty() && !line.starts_with(b"#"))?;
    let mut words = text::words(first_line);
    let keyword = words.next()?;
    let is_obj = match keyword {
        b"v" | b"vn" | b"vt" => words.next().and_then(text::parse_number).is_some(),
        b"mtllib" | b"usemtl" => words.next().is_some(),
        _ => false,
    };
    is_obj.then_some(Format::Obj)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_goes_before_the_extension() {
        assert_eq!(recognize("mesh.obj", b"ply\nformat ascii 1.0\n"), Some(Format::Ply));
        assert_eq!(recognize("mesh.ply", b"glTF...."), Some(Format::Gltf));
        assert_eq!(recognize("mesh.txt", b"# a comment\n\nv 1 2 3\n"), Some(Format::Obj));
        assert_eq!(recognize("mesh.txt", b" {\"asset\": {}}"), Some(Format::Gltf));
        assert_eq!(recognize("MESH.OBJ", b"o thing\n"), Some(Format::Obj));
    }

    #[test]
    fn what_is_no_mesh_is_refused_in_words() {
        for (name, bytes) in
            [("a.stl", b"solid a".as_slice()), ("scene.json", b"{\"photos\": []}"), ("", b"")]
        {
            let error = load(name, bytes).unwrap_err();
            assert_eq!(error.to_string(), "not a mesh this version reads: PLY, OBJ, GLB expected");
        }
    }
}
