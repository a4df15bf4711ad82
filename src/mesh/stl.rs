//! STL, as text or binary: single triangles, whose corners at the same place are made one vertex.
//!
//! Many binary files begin with "solid" as only text should; the size tells them apart. Normals are left out: they are
//! those of the triangles, and often zero.

use glam::Vec3;

use super::load::Parsed;
use super::text::{next_line, parse_number, shown, words};
use super::weld::weld;
use super::{Format, MAX_TRIANGLES, MeshData, MeshError, Place};

/// A title and the number of triangles.
const BINARY_HEADER_BYTES: usize = 84;
/// A normal and three corners of three `f32` each, and a number of two bytes.
const BINARY_TRIANGLE_BYTES: usize = 50;

/// Whether the content alone says that it is STL.
pub(super) fn is_certain(bytes: &[u8]) -> bool {
    binary_count(bytes).is_some_and(|count| count > 0 && fits_exactly(bytes, count)) || is_text(bytes)
}

pub(super) fn parse(bytes: &[u8]) -> Result<Parsed, MeshError> {
    match binary_count(bytes) {
        Some(count) if fits_exactly(bytes, count) => welded(read_binary(bytes, count)?, Vec::new()),
        _ if !has_zeros(bytes) => welded(read_text(bytes)?, Vec::new()),
        Some(count) => {
            let corners = read_binary(bytes, count)?;
            let spare = bytes.len() - BINARY_HEADER_BYTES - count * BINARY_TRIANGLE_BYTES;
            welded(corners, vec![format!("{spare} bytes behind the {count} triangles are left out.")])
        }
        None => {
            let problem = format!("the file ends within its header of {BINARY_HEADER_BYTES} bytes");
            Err(malformed(Place::Byte(bytes.len()), problem))
        }
    }
}

/// The number of triangles that a binary file announces.
fn binary_count(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(BINARY_HEADER_BYTES - 4..)?.first_chunk()?;
    usize::try_from(u32::from_le_bytes(*count)).ok()
}

fn fits_exactly(bytes: &[u8], count: usize) -> bool {
    count.checked_mul(BINARY_TRIANGLE_BYTES).and_then(|size| size.checked_add(BINARY_HEADER_BYTES))
        == Some(bytes.len())
}

/// Text holds no zero bytes. A binary file does, at the latest in its number of triangles: more than 2^24 are too many.
fn has_zeros(bytes: &[u8]) -> bool {
    bytes.iter().take(1024).any(|&byte| byte == 0)
}

/// "solid NAME", and then a facet or the end.
fn is_text(bytes: &[u8]) -> bool {
    let mut position = 0;
    let mut lines =
        std::iter::from_fn(|| next_line(bytes, &mut position)).filter_map(|line| words(line).next());
    let is_solid = lines.next().is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    let second = lines.next().unwrap_or_default();
    is_solid && (second.eq_ignore_ascii_case(b"facet") || second.eq_ignore_ascii_case(b"endsolid"))
}

fn read_binary(bytes: &[u8], count: usize) -> Result<Vec<Vec3>, MeshError> {
    if count > MAX_TRIANGLES {
        return Err(MeshError::TooLarge { what: "triangles", limit: MAX_TRIANGLES });
    }
    let body = bytes.get(BINARY_HEADER_BYTES..).unwrap_or_default();
    if count * BINARY_TRIANGLE_BYTES > body.len() {
        let problem = format!("{count} triangles are announced, but only {} bytes follow", body.len());
        return Err(malformed(Place::Byte(BINARY_HEADER_BYTES - 4), problem));
    }
    let mut corners = Vec::with_capacity(count * 3);
    for triangle in body.chunks_exact(BINARY_TRIANGLE_BYTES).take(count) {
        let (numbers, _) = triangle.as_chunks::<4>();
        let numbers = numbers.get(3..).unwrap_or_default();
        for corner in numbers.chunks_exact(3) {
            if let &[x, y, z] = corner {
                corners.push(Vec3::from_array([x, y, z].map(f32::from_le_bytes)));
            }
        }
    }
    Ok(corners)
}

/// Every "vertex" counts, three or more to a loop; what else the lines say does not matter.
fn read_text(bytes: &[u8]) -> Result<Vec<Vec3>, MeshError> {
    let mut corners = Vec::new();
    let mut loop_corners: Vec<Vec3> = Vec::new();
    let mut position = 0;
    let mut line_number = 0;
    while let Some(line) = next_line(bytes, &mut position) {
        line_number += 1;
        let mut words = words(line);
        let keyword = words.next().unwrap_or_default();
        if keyword.eq_ignore_ascii_case(b"vertex") {
            loop_corners.push(read_vertex(words, line_number)?);
        } else if keyword.eq_ignore_ascii_case(b"endloop") || keyword.eq_ignore_ascii_case(b"endfacet") {
            add_loop(&mut loop_corners, &mut corners, line_number)?;
        }
    }
    // A file that was cut off ends within a loop.
    if !loop_corners.is_empty() {
        return Err(malformed(Place::Line(line_number), "the file ends within a facet".to_owned()));
    }
    Ok(corners)
}

fn read_vertex<'a>(mut words: impl Iterator<Item = &'a [u8]>, line: usize) -> Result<Vec3, MeshError> {
    let mut position = Vec3::ZERO;
    for axis in 0..3 {
        let word = words.next().ok_or_else(|| {
            malformed(Place::Line(line), format!("a vertex of {axis} numbers, expected three"))
        })?;
        let number = parse_number(word).ok_or_else(|| {
            malformed(Place::Line(line), format!("expected a number, found {}", shown(word)))
        })?;
        position[axis] = number as f32;
    }
    Ok(position)
}

fn add_loop(loop_corners: &mut Vec<Vec3>, corners: &mut Vec<Vec3>, line: usize) -> Result<(), MeshError> {
    match loop_corners.as_slice() {
        [] => {}
        &[first, ref rest @ ..] if rest.len() >= 2 => {
            corners.extend(rest.windows(2).flat_map(|pair| [first, pair[0], pair[1]]));
        }
        few => {
            let problem = format!("a facet of {} corners, expected three", few.len());
            return Err(malformed(Place::Line(line), problem));
        }
    }
    loop_corners.clear();
    if corners.len() / 3 > MAX_TRIANGLES {
        return Err(MeshError::TooLarge { what: "triangles", limit: MAX_TRIANGLES });
    }
    Ok(())
}

/// A mesh whose vertices are the distinct corners, in the order of their first use.
fn welded(corners: Vec<Vec3>, warnings: Vec<String>) -> Result<Parsed, MeshError> {
    // What is no number equals nothing, not even itself, and would not be found again.
    if let Some(vertex) = corners.iter().position(|corner| !corner.is_finite()) {
        return Err(MeshError::BadPosition { vertex, position: corners[vertex].to_array() });
    }
    let (place_of_corner, place_count) = weld(&corners);
    let mut positions_mm = Vec::with_capacity(place_count);
    for (&place, &corner) in place_of_corner.iter().zip(&corners) {
        if place as usize == positions_mm.len() {
            positions_mm.push(corner);
        }
    }
    let (triangles, _) = place_of_corner.as_chunks::<3>();
    let data = MeshData { positions_mm, triangles: triangles.to_vec(), ..MeshData::default() };
    Ok(Parsed { data, warnings })
}

fn malformed(place: Place, problem: String) -> MeshError {
    MeshError::Malformed { format: Format::Stl, place, problem }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::mesh::{load, no_companions};

    /// Two triangles with a common edge.
    const SQUARE: [[f32; 3]; 6] =
        [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [-0., 0., 0.], [1., 1., 0.], [0., 1., 0.]];

    fn binary(title: &[u8], announced: u32) -> Vec<u8> {
        let mut bytes = title.to_vec();
        bytes.resize(80, b' ');
        bytes.extend(announced.to_le_bytes());
        for triangle in SQUARE.chunks(3) {
            bytes.extend([0; 12]);
            bytes.extend(triangle.as_flattened().iter().flat_map(|value| value.to_le_bytes()));
            bytes.extend([0; 2]);
        }
        bytes
    }

    fn text() -> String {
        let mut text = "solid a square\n".to_owned();
        for triangle in SQUARE.chunks(3) {
            text += " facet normal 0 0 0\n  outer loop\n";
            for [x, y, z] in triangle {
                text += &format!("   VERTEX {x} {y:e} {z}\n");
            }
            text += "  endloop\n endfacet\n";
        }
        text + "endsolid a square\n"
    }

    fn message(bytes: &[u8]) -> String {
        parse(bytes).unwrap_err().to_string()
    }

    #[test]
    fn text_and_binary_make_the_same_welded_mesh() {
        let text = text();
        for bytes in [text.as_bytes(), &binary(b"made by hand", 2), &binary(b"solid but binary", 2)] {
            let mesh = load("square", bytes, &no_companions).unwrap().mesh;
            assert_eq!(mesh.triangles(), [[0, 1, 2], [0, 2, 3]]);
            assert_eq!(mesh.positions_mm()[3], Vec3::Y);
        }
    }

    #[test]
    fn spare_bytes_are_a_warning_and_missing_ones_an_error() {
        let mut long = binary(b"solid", 2);
        long.extend(b"extra");
        assert!(parse(&long).unwrap().warnings[0].starts_with("5 bytes"));
        assert!(
            message(&binary(b"\0", 3)).starts_with("STL, byte 80: 3 triangles are announced, but only 100")
        );
        assert!(message(&binary(b"\0", u32::MAX)).contains("50000000 triangles"));
        assert!(message(b"\0\0").starts_with("STL, byte 2: the file ends within its header"));
    }

    #[test]
    fn messages_name_the_line() {
        let broken = |from: &str, to: &str| message(text().replacen(from, to, 1).as_bytes());
        assert_eq!(broken("VERTEX 1 0e0 0", "vertex 1 x 0"), "STL, line 5: expected a number, found “x”");
        assert_eq!(
            broken("VERTEX 1 0e0 0", "vertex 1"),
            "STL, line 5: a vertex of 1 numbers, expected three"
        );
        assert_eq!(broken("VERTEX 1 0e0 0", ""), "STL, line 7: a facet of 2 corners, expected three");
        assert!(broken("VERTEX 1 0e0 0", "vertex 1 nan 0").contains("NaN"));
        let whole = text();
        let (cut, _) = whole.rsplit_once("  endloop").unwrap();
        assert!(
            message(cut.as_bytes()).ends_with("the file ends within a facet"),
            "{}",
            message(cut.as_bytes())
        );
    }

    proptest! {
        #[test]
        fn broken_files_never_panic(
            flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4),
            kept in any::<prop::sample::Index>(),
            is_binary in any::<bool>(),
        ) {
            let mut bytes = if is_binary { binary(b"title", 2) } else { text().into_bytes() };
            for (at, byte) in &flips {
                let at = at.index(bytes.len());
                bytes[at] = *byte;
            }
            let _ = load("broken.stl", &bytes, &no_companions);
            bytes.truncate(kept.index(bytes.len()));
            let _ = load("broken.stl", &bytes, &no_companions);
        }
    }
}
