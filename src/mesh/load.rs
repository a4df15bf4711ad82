//! From a dropped file's bytes to a mesh: which format it is, and what the user should be told about it.

use super::{FindCompanion, Format, Mesh, MeshData, MeshError, gltf, obj, off, ply, stl, text};

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

/// A file that is to be read, and a way to those beside it.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub file_name: &'a str,
    /// Without a byte order mark.
    pub bytes: &'a [u8],
    pub find: FindCompanion<'a>,
}

/// Reads a mesh. The format is recognised by the content, and by the file's extension where the content does not tell.
///
/// `find` looks up the files that the mesh asks for (see [`super::companion_names`]): without its textures a mesh is loaded
/// all the same, with a warning.
///
/// PLY, OBJ, STL and OFF know no unit: their numbers are taken as they are, and [`Mesh::transformed`] brings them to millimetres
/// where the caller knows better. glTF is in metres and comes out in millimetres. Axes are kept as in the file.
pub fn load(file_name: &str, bytes: &[u8], find: FindCompanion<'_>) -> Result<LoadedMesh, MeshError> {
    let bytes = text::without_byte_order_mark(bytes);
    let source = Source { file_name, bytes, find };
    let Parsed { data, mut warnings } = match recognize(file_name, bytes).ok_or(MeshError::UnknownFormat)? {
        Format::Ply => ply::parse(&source)?,
        Format::Obj => obj::parse(&source)?,
        Format::Stl => stl::parse(bytes)?,
        Format::Gltf => gltf::parse(&source)?,
        Format::Off => off::parse(bytes)?,
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

pub(super) fn recognize(file_name: &str, bytes: &[u8]) -> Option<Format> {
    recognize_content(bytes).or_else(|| {
        let (_, extension) = file_name.rsplit_once('.')?;
        match extension.to_ascii_lowercase().as_str() {
            "ply" => Some(Format::Ply),
            "obj" => Some(Format::Obj),
            "stl" => Some(Format::Stl),
            "glb" | "gltf" => Some(Format::Gltf),
            "off" => Some(Format::Off),
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
    if stl::is_certain(bytes) {
        return Some(Format::Stl);
    }
    let trimmed = bytes.trim_ascii_start();
    if trimmed.starts_with(b"{") {
        // Our own scene files are JSON too; every glTF has an "asset", near its beginning or its end.
        return trimmed.windows(7).any(|window| window == b"\"asset\"").then_some(Format::Gltf);
    }
    // OBJ and OFF have no magic number: their first words are comments, or one of these with something behind it.
    let mut position = 0;
    let first_line = std::iter::from_fn(|| text::next_line(bytes, &mut position))
        .take(1000)
        .map(<[u8]>::trim_ascii)
        .find(|line| !line.is_empty() && !line.starts_with(b"#"))?;
    if off::is_header(first_line) {
        return Some(Format::Off);
    }
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
    use crate::mesh::no_companions;

    #[test]
    fn content_goes_before_the_extension() {
        assert_eq!(recognize("mesh.obj", b"ply\nformat ascii 1.0\n"), Some(Format::Ply));
        assert_eq!(recognize("mesh.ply", b"glTF...."), Some(Format::Gltf));
        assert_eq!(recognize("mesh.txt", b"# a comment\n\nv 1 2 3\n"), Some(Format::Obj));
        assert_eq!(recognize("mesh.txt", b" {\"asset\": {}}"), Some(Format::Gltf));
        assert_eq!(recognize("MESH.OBJ", b"o thing\n"), Some(Format::Obj));
        assert_eq!(recognize("mesh.txt", b"# a comment\nCOFF\n3 1 0\n"), Some(Format::Off));
        assert_eq!(recognize("mesh", b"solid a\n facet normal 0 0 1\n"), Some(Format::Stl));
        assert_eq!(recognize("notes.txt", b"solid advice\n"), None);
        assert_eq!(recognize("part.STL", b"solid \x80"), Some(Format::Stl));
    }

    #[test]
    fn what_is_no_mesh_is_refused_in_words() {
        for (name, bytes) in
            [("a.step", b"solid a".as_slice()), ("scene.json", b"{\"photos\": []}"), ("", b"")]
        {
            let error = load(name, bytes, &no_companions).unwrap_err();
            assert_eq!(error, MeshError::UnknownFormat);
        }
    }
}
