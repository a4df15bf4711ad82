//! OFF (Geomview's object file format) as text: polygons, with normals (NOFF) and colours (COFF) of vertices, and colours
//! of faces.

use glam::Vec3;

use super::load::Parsed;
use super::paint::Palette;
use super::text::{next_line, parse_number, shown, words};
use super::{Format, MAX_TRIANGLES, MAX_VERTICES, MeshData, MeshError, Place};

/// A polygon of more corners, or a longer row, is no polygon but a broken file.
const MOST_CORNERS: usize = 100_000;

/// What the first word says that each vertex has, in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
struct Layout {
    normals: bool,
    colors: bool,
    texture_coordinates: bool,
}

/// Whether a file's first line, less comments, begins as OFF does.
pub(super) fn is_header(line: &[u8]) -> bool {
    words(line).next().and_then(|word| layout(word)).is_some()
}

/// `[ST][C][N]OFF`; counts sometimes follow without a space. The variants of four or n dimensions are not read.
fn layout(word: &[u8]) -> Option<(Layout, &[u8])> {
    let texture_coordinates = word.starts_with(b"ST");
    let word = word.strip_prefix(b"ST").unwrap_or(word);
    let colors = word.starts_with(b"C");
    let word = word.strip_prefix(b"C").unwrap_or(word);
    let normals = word.starts_with(b"N");
    let word = word.strip_prefix(b"N").unwrap_or(word);
    let rest = word.strip_prefix(b"OFF")?;
    rest.iter().all(u8::is_ascii_digit).then_some((Layout { normals, colors, texture_coordinates }, rest))
}

pub(super) fn parse(bytes: &[u8]) -> Result<Parsed, MeshError> {
    let mut rows = Rows { bytes, position: 0, line: 0, words: Vec::new() };
    let (layout, [vertices, faces]) = read_header(&mut rows)?;
    check_counts(&rows, vertices, faces)?;
    let mut parsed = Parsed::default();
    read_vertices(&mut rows, layout, vertices, &mut parsed.data)?;
    read_faces(&mut rows, faces, &mut parsed)?;
    Ok(parsed)
}

fn read_header(rows: &mut Rows<'_>) -> Result<(Layout, [usize; 2]), MeshError> {
    rows.next(1)?;
    let mut found = Layout::default();
    // The first word may be left out.
    if let Some((layout, digits)) = rows.words.first().copied().and_then(layout) {
        found = layout;
        match digits {
            [] => drop(rows.words.remove(0)),
            _ => rows.words[0] = digits,
        }
    } else if rows.number(0).is_err() {
        let first = rows.words.first().copied().unwrap_or_default();
        return Err(rows.malformed(format!("expected OFF, COFF, NOFF or CNOFF, found {}", shown(first))));
    }
    match rows.words.as_slice() {
        [b"BINARY", ..] => {
            let advice = "export the mesh again as text";
            return Err(MeshError::Unsupported {
                format: Format::Off,
                feature: "binary data".to_owned(),
                advice,
            });
        }
        [] => rows.next(2)?,
        _ => {}
    }
    Ok((found, [rows.count(0, "vertices")?, rows.count(1, "faces")?]))
}

/// Refuses more than the rest of the file can hold, before anything is allocated for it.
fn check_counts(rows: &Rows<'_>, vertices: usize, faces: usize) -> Result<(), MeshError> {
    let remaining = rows.bytes.len().saturating_sub(rows.position);
    // A vertex takes three digits and the spaces behind them, and a face a digit and one; the last has none.
    let needed = vertices.checked_mul(6).and_then(|size| size.checked_add(faces.checked_mul(2)?));
    if needed.is_none_or(|needed| needed > remaining.saturating_add(1)) {
        let announced = format!("{vertices} vertices and {faces} faces are announced");
        return Err(rows.malformed(format!("{announced}, but only {remaining} bytes follow")));
    }
    if vertices > MAX_VERTICES {
        return Err(MeshError::TooLarge { what: "vertices", limit: MAX_VERTICES });
    }
    Ok(())
}

fn read_vertices(
    rows: &mut Rows<'_>,
    layout: Layout,
    count: usize,
    data: &mut MeshData,
) -> Result<(), MeshError> {
    let mut normals = Vec::new();
    let mut colors = Vec::new();
    let before_color = if layout.normals { 6 } else { 3 };
    for _ in 0..count {
        rows.next(before_color)?;
        data.positions_mm.push(rows.vector(0)?);
        if layout.normals {
            normals.push(rows.vector(3)?);
        }
        if layout.colors {
            let behind = if layout.texture_coordinates { 2 } else { 0 };
            let end = rows.words.len().saturating_sub(behind);
            colors.push(rows.color(before_color..end)?.unwrap_or([255; 4]));
        }
    }
    data.normals = layout.normals.then_some(normals);
    data.colors = layout.colors.then_some(colors);
    Ok(())
}

fn read_faces(rows: &mut Rows<'_>, count: usize, parsed: &mut Parsed) -> Result<(), MeshError> {
    let vertices = parsed.data.positions_mm.len();
    let mut palette = Palette::default();
    let (mut has_face_colors, mut small_faces) = (false, 0_usize);
    for _ in 0..count {
        rows.next(1)?;
        let corners = rows.count(0, "corners")?;
        if corners > MOST_CORNERS {
            return Err(
                rows.malformed(format!("a face of {corners} corners, expected at most {MOST_CORNERS}"))
            );
        }
        rows.extend(corners + 1)?;
        let triangles = &mut parsed.data.triangles;
        let (mut first, mut previous) = (0, 0);
        for corner in 0..corners {
            let index = rows.index(corner + 1, vertices)?;
            match corner {
                0 => first = index,
                1 => {}
                _ => triangles.push([first, previous, index]),
            }
            previous = index;
        }
        small_faces += usize::from(corners < 3);
        let color = rows.color(corners + 1..rows.words.len())?;
        has_face_colors |= color.is_some();
        palette.add(color.unwrap_or([255; 4]), corners.saturating_sub(2));
        if triangles.len() > MAX_TRIANGLES {
            return Err(MeshError::TooLarge { what: "triangles", limit: MAX_TRIANGLES });
        }
    }
    if has_face_colors && parsed.data.colors.is_none() {
        parsed.data.paint = Some(palette.into_paint());
    }
    if small_faces > 0 {
        parsed.warnings.push(format!("{small_faces} faces have fewer than three corners and are left out."));
    }
    Ok(())
}

/// The file row by row: a line without its comment, that may go on over the next ones.
struct Rows<'a> {
    bytes: &'a [u8],
    position: usize,
    line: usize,
    words: Vec<&'a [u8]>,
}

impl Rows<'_> {
    /// The next row that is not empty, of at least so many words.
    fn next(&mut self, least_words: usize) -> Result<(), MeshError> {
        self.words.clear();
        self.extend(least_words)
    }

    fn extend(&mut self, least_words: usize) -> Result<(), MeshError> {
        while self.words.len() < least_words {
            let Some(line) = next_line(self.bytes, &mut self.position) else {
                return Err(self.malformed("the file ends here, expected more numbers".to_owned()));
            };
            self.line += 1;
            let content = line.split(|&byte| byte == b'#').next().unwrap_or_default();
            self.words.extend(words(content).take(MOST_CORNERS + 16));
        }
        Ok(())
    }

    fn number(&self, place: usize) -> Result<f64, MeshError> {
        let word = self.words.get(place).copied().unwrap_or_default();
        parse_number(word).ok_or_else(|| self.malformed(format!("expected a number, found {}", shown(word))))
    }

    fn vector(&self, place: usize) -> Result<Vec3, MeshError> {
        let [x, y, z] = [self.number(place)?, self.number(place + 1)?, self.number(place + 2)?];
        Ok(Vec3::new(x as f32, y as f32, z as f32))
    }

    fn count(&self, place: usize, what: &str) -> Result<usize, MeshError> {
        let word = self.words.get(place).copied().unwrap_or_default();
        std::str::from_utf8(word)
            .ok()
            .and_then(|text| text.parse().ok())
            .ok_or_else(|| self.malformed(format!("expected the number of {what}, found {}", shown(word))))
    }

    fn index(&self, place: usize, vertices: usize) -> Result<u32, MeshError> {
        let index = self.count(place, "a vertex")?;
        u32::try_from(index).ok().filter(|_| index < vertices).ok_or_else(|| {
            self.malformed(format!("a face names vertex {index}, expected a whole number below {vertices}"))
        })
    }

    /// Red, green, blue and perhaps alpha: whole numbers up to 255, or up to 1 with a point. One number alone is an index
    /// into a colour map that nobody has.
    fn color(&self, places: std::ops::Range<usize>) -> Result<Option<[u8; 4]>, MeshError> {
        let words = self.words.get(places.clone()).unwrap_or_default();
        if words.len() < 3 {
            return Ok(None);
        }
        let is_fraction = words.iter().take(4).any(|word| word.contains(&b'.'));
        let scale = if is_fraction { 255.0 } else { 1.0 };
        let mut color = [255; 4];
        for (channel, place) in color.iter_mut().zip(places) {
            *channel = (self.number(place)? * scale).round() as u8;
        }
        Ok(Some(color))
    }

    fn malformed(&self, problem: String) -> MeshError {
        MeshError::Malformed { format: Format::Off, place: Place::Line(self.line), problem }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::mesh::{load, no_companions};

    fn message(text: &str) -> String {
        parse(text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn colors_and_normals_of_vertices_are_read() {
        let coff = parse(b"COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 128\n0 1 0 0 0 255 255\n3 0 1 2\n");
        let colors = coff.unwrap().data.colors.unwrap();
        assert_eq!(colors, [[255, 0, 0, 255], [0, 255, 0, 128], [0, 0, 255, 255]]);
        let cnoff =
            parse(b"CNOFF\n3 1 0\n0 0 0 0 0 1 1. 0.5 0\n1 0 0 0 0 1 1 1 1\n0 1 0 0 0 1 0. 0 0\n3 0 1 2\n");
        let data = cnoff.unwrap().data;
        assert_eq!(data.normals.unwrap(), [Vec3::Z; 3]);
        assert_eq!(data.colors.unwrap()[..2], [[255, 128, 0, 255], [1, 1, 1, 255]]);
    }

    #[test]
    fn polygons_comments_wrapped_rows_and_face_colors() {
        let text = "# a square\n  OFF8 # vertices?\n\n";
        assert!(message(text).contains("expected the number of faces"));
        let text = "OFF4 2 4 # counts\n0 0 0\n1 0 0 # a corner\n1 1\n0\n0 1 0\n4 0 1 2\n3 1.0 0 0\n3 0 1 2\n";
        let data = parse(text.as_bytes()).unwrap().data;
        assert_eq!(data.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
        let paint = data.paint.unwrap();
        assert_eq!(paint.material_of_triangle, [0, 0, 1]);
        assert_eq!(paint.materials[0].base_color, [255, 0, 0, 255]);
        let without_keyword = parse(b"3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2").unwrap().data;
        assert_eq!((without_keyword.triangles.len(), without_keyword.paint), (1, None));
    }

    #[test]
    fn messages_name_the_line() {
        assert_eq!(
            message("OFF\n3 1 0\n0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n"),
            "OFF, line 4: expected a number, found “x”"
        );
        assert!(
            message("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n")
                .starts_with("OFF, line 6: a face names vertex 3")
        );
        assert!(
            message("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n")
                .ends_with("the file ends here, expected more numbers")
        );
        assert!(message("OFF\n99999999999 1 0\n0 0 0\n").contains("only 6 bytes follow"));
        assert!(message("OFF BINARY\n\0\0").contains("binary data cannot be read"));
        assert!(message("4OFF\n1 1 0\n").contains("expected OFF, COFF"));
    }

    proptest! {
        #[test]
        fn no_bytes_panic(text in "(C?N?OFF)?[ \n]([0-9]{1,2}[ \n#.]){0,40}") {
            let _ = load("a.off", text.as_bytes(), &no_companions);
        }
    }
}
