//! Wavefront OBJ: positions, vertex colours, normals and polygons.
//!
//! Own parser, for two reasons. Metrics average over the vertices of the file, in its order and each once, and OBJ
//! libraries hand out one vertex per combination of position, texture coordinate and normal. And a message has to name
//! the line. Everything else of the format (materials, curves, points, lines) is left out.

use std::borrow::Cow;

use glam::Vec3;

use super::load::Parsed;
use super::text::{next_line, parse_number, shown, words};
use super::{Format, MAX_TRIANGLES, MeshData, MeshError, Place};

pub(super) fn parse(bytes: &[u8]) -> Result<Parsed, MeshError> {
    let mut reader = Reader::default();
    let mut position = 0;
    let mut line_number = 0;
    while let Some(line) = next_logical_line(bytes, &mut position, &mut line_number) {
        reader.line = line_number;
        reader.read_line(&line)?;
    }
    reader.finish()
}

/// A line, together with those it continues on: a backslash at its end says so. `line_number` becomes that of its last.
fn next_logical_line<'a>(
    bytes: &'a [u8],
    position: &mut usize,
    line_number: &mut usize,
) -> Option<Cow<'a, [u8]>> {
    let mut line = Cow::Borrowed(next_line(bytes, position)?);
    *line_number += 1;
    while line.ends_with(b"\\") {
        let whole = line.to_mut();
        whole.pop();
        whole.push(b' ');
        let Some(continuation) = next_line(bytes, position) else { break };
        *line_number += 1;
        whole.extend_from_slice(continuation);
    }
    Some(line)
}

#[derive(Debug, Clone, Copy)]
struct Corner {
    vertex: u32,
    normal: Option<u32>,
}

#[derive(Debug, Default)]
struct Reader {
    line: usize,
    positions: Vec<Vec3>,
    /// As long as `positions` as soon as one vertex has a colour.
    colors: Vec<[f64; 3]>,
    file_normals: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// The corners of the face at hand; kept to save the allocation.
    face: Vec<Corner>,
    /// Vertex and normal number of every corner that has both.
    corner_normals: Vec<(u32, u32)>,
    corner_count: usize,
    /// The largest vertex number of a face, and the line it stands in: faces may precede their vertices.
    largest_index: Option<(u32, usize)>,
    faces_of_less_than_three: usize,
    material_library: Option<String>,
}

impl Reader {
    fn read_line(&mut self, line: &[u8]) -> Result<(), MeshError> {
        let mut words = words(line);
        match words.next() {
            Some(b"v") => self.read_vertex(words),
            Some(b"vn") => {
                let normal = self.read_triple(&mut words, "normal")?;
                self.file_normals.push(Vec3::from_array(normal.map(|value| value as f32)));
                Ok(())
            }
            Some(b"f" | b"fo") => self.read_face(words),
            Some(b"mtllib") => {
                self.material_library = words.next().map(|word| String::from_utf8_lossy(word).into_owned());
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// `v x y z`, `v x y z w` (w is for curves, and ignored) or `v x y z r g b`.
    fn read_vertex<'a>(&mut self, mut words: impl Iterator<Item = &'a [u8]>) -> Result<(), MeshError> {
        let position = self.read_triple(&mut words, "vertex")?;
        let position = Vec3::from_array(position.map(|value| value as f32));
        if !position.is_finite() {
            return Err(self.malformed(format!("the vertex is at {position}, expected finite numbers")));
        }
        let mut more = [0.0; 3];
        let mut more_count = 0;
        for (slot, word) in more.iter_mut().zip(words) {
            *slot = self.number(word)?;
            more_count += 1;
        }
        if more_count == 3 {
            self.colors.resize(self.positions.len(), [1.0; 3]);
            self.colors.push(more);
        }
        self.positions.push(position);
        Ok(())
    }

    fn read_triple<'a>(
        &self,
        words: &mut impl Iterator<Item = &'a [u8]>,
        what: &str,
    ) -> Result<[f64; 3], MeshError> {
        let mut triple = [0.0; 3];
        for (found, slot) in triple.iter_mut().enumerate() {
            let word = words
                .next()
                .ok_or_else(|| self.malformed(format!("a {what} of {found} numbers, expected three")))?;
            *slot = self.number(word)?;
        }
        Ok(triple)
    }

    fn number(&self, word: &[u8]) -> Result<f64, MeshError> {
        parse_number(word).ok_or_else(|| self.malformed(format!("expected a number, found {}", shown(word))))
    }

    fn read_face<'a>(&mut self, words: impl Iterator<Item = &'a [u8]>) -> Result<(), MeshError> {
        let mut face = std::mem::take(&mut self.face);
        face.clear();
        for word in words.take_while(|word| !word.starts_with(b"#")) {
            face.push(self.corner(word)?);
        }
        if face.len() < 3 {
            self.faces_of_less_than_three += 1;
        } else {
            self.add_polygon(&face);
        }
        self.face = face;
        if self.triangles.len() > MAX_TRIANGLES {
            return Err(MeshError::TooLarge { what: "triangles", limit: MAX_TRIANGLES });
        }
        Ok(())
    }

    /// A corner: `v`, `v/vt`, `v//vn` or `v/vt/vn`, where a number may also be left out behind its slash.
    fn corner(&self, word: &[u8]) -> Result<Corner, MeshError> {
        let mut parts = word.split(|&byte| byte == b'/');
        let vertex = parts.next().unwrap_or_default();
        let normal = parts.nth(1).filter(|part| !part.is_empty());
        let vertex = self.index(vertex, self.positions.len(), word)?;
        let normal = normal.map(|part| self.index(part, self.file_normals.len(), word)).transpose()?;
        Ok(Corner { vertex, normal })
    }

    /// OBJ counts from 1; a negative number counts back from the latest one.
    fn index(&self, part: &[u8], count_so_far: usize, word: &[u8]) -> Result<u32, MeshError> {
        let number = std::str::from_utf8(part).ok().and_then(|text| text.parse::<i64>().ok());
        let from_zero = match number {
            Some(number) if number > 0 => Some(number - 1),
            Some(number) if number < 0 => {
                i64::try_from(count_so_far).ok().map(|count| count.saturating_add(number))
            }
            _ => None,
        };
        from_zero.and_then(|index| u32::try_from(index).ok()).ok_or_else(|| {
            let expected = format!("expected whole numbers from 1, or from -1 back to -{count_so_far}");
            self.malformed(format!("the face's corner {}: {expected}", shown(word)))
        })
    }

    fn add_polygon(&mut self, face: &[Corner]) {
        for corner in face {
            if self.largest_index.is_none_or(|(largest, _)| corner.vertex > largest) {
                self.largest_index = Some((corner.vertex, self.line));
            }
            self.corner_normals.extend(corner.normal.map(|normal| (corner.vertex, normal)));
        }
        self.corner_count += face.len();
        let fan = face.windows(2).skip(1);
        self.triangles.extend(fan.map(|pair| [face[0].vertex, pair[0].vertex, pair[1].vertex]));
    }

    fn finish(mut self) -> Result<Parsed, MeshError> {
        if let Some((index, line)) =
            self.largest_index.filter(|&(index, _)| index as usize >= self.positions.len())
        {
            self.line = line;
            let (number, vertices) = (u64::from(index) + 1, self.positions.len());
            return Err(
                self.malformed(format!("the face names vertex {number}, but the file has {vertices}"))
            );
        }
        let mut warnings = Vec::new();
        let normals = self.vertex_normals(&mut warnings);
        if self.faces_of_less_than_three > 0 {
            let count = self.faces_of_less_than_three;
            warnings.push(format!("{count} faces have fewer than three corners and are left out."));
        }
        if let Some(library) = &self.material_library {
            warnings.push(format!(
                "The material library “{library}” is not read: its colours and textures are missing."
            ));
        }
        let colors = self.srgb_colors();
        let data = MeshData {
            positions_mm: self.positions,
            triangles: self.triangles,
            normals,
            colors,
            paint: None,
        };
        Ok(Parsed { data, warnings })
    }

    /// The file's normals as one per vertex; `None` where a vertex has several, for then the file has hard edges, which
    /// shading finds by itself.
    fn vertex_normals(&self, warnings: &mut Vec<String>) -> Option<Vec<Vec3>> {
        if self.corner_count == 0 || self.corner_normals.len() < self.corner_count {
            return None;
        }
        let mut normals = vec![Vec3::ZERO; self.positions.len()];
        for &(vertex, normal) in &self.corner_normals {
            let Some(&normal) = self.file_normals.get(normal as usize) else {
                warnings.push(
                    "Faces name normals that the file does not have; shading computes its own.".to_owned(),
                );
                return None;
            };
            let slot = normals.get_mut(vertex as usize)?;
            if *slot != Vec3::ZERO && *slot != normal {
                return None;
            }
            *slot = normal;
        }
        Some(normals)
    }

    /// Vertex colours are no part of the format: most programs write them from 0 to 1, some from 0 to 255.
    fn srgb_colors(&self) -> Option<Vec<[u8; 4]>> {
        if self.colors.is_empty() {
            return None;
        }
        let largest = self.colors.iter().flatten().fold(0.0_f64, |largest, &value| largest.max(value));
        let scale = if largest > 1.0 { 1.0 } else { 255.0 };
        let byte = |value: f64| (value * scale).round() as u8;
        let mut colors: Vec<[u8; 4]> =
            self.colors.iter().map(|&[r, g, b]| [byte(r), byte(g), byte(b), 255]).collect();
        colors.resize(self.positions.len(), [255; 4]);
        Some(colors)
    }

    fn malformed(&self, problem: String) -> MeshError {
        MeshError::Malformed { format: Format::Obj, place: Place::Line(self.line), problem }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    fn parsed(rest: &str) -> Result<Parsed, MeshError> {
        parse(format!("{SQUARE}{rest}").as_bytes())
    }

    fn message(rest: &str) -> String {
        parsed(rest).unwrap_err().to_string()
    }

    #[test]
    fn polygons_become_fans_and_negative_numbers_count_back() {
        let data = parsed("f 1/1 2/2/ 3// 4\nf -4 -3 \\\n -2\n").unwrap().data;
        assert_eq!(data.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
        assert_eq!(data.positions_mm.len(), 4);
    }

    #[test]
    fn vertices_keep_their_number_whatever_the_corners_say() {
        let normals = "vn 0 0 1\nvn 0 0 2\nvn 1 0 0\n";
        let same = parsed(&format!("{normals}f 1//1 2//1 3//1\nf 1//1 3//1 4//2\n")).unwrap().data;
        assert_eq!(
            same.normals.as_deref().and_then(|normals| normals.get(3)),
            Some(&Vec3::new(0.0, 0.0, 2.0))
        );
        let hard_edge = parsed(&format!("{normals}f 1//1 2//1 3//1\nf 1//3 3//1 4//2\n")).unwrap().data;
        assert_eq!((hard_edge.normals, hard_edge.positions_mm.len()), (None, 4));
    }

    #[test]
    fn colors_come_in_both_scales() {
        let unit = parse(b"v 0 0 0 1 0.5 0\nv 1 0 0\nv 0 1 0 nan 0 0\nf 1 2 3").unwrap().data;
        assert_eq!(unit.colors, Some(vec![[255, 128, 0, 255], [255; 4], [0, 0, 0, 255]]));
        let bytes = parse(b"v 0 0 0 255 128 0\nv 1 0 0 0 0 0\nv 0 1 0 0 0 0\nf 1 2 3").unwrap().data;
        assert_eq!(bytes.colors.and_then(|colors| colors.first().copied()), Some([255, 128, 0, 255]));
    }

    #[test]
    fn messages_name_the_line() {
        assert!(message("f 1 2 9\n").starts_with("OBJ, line 5: the face names vertex 9"));
        assert!(message("f 0 1 2\n").starts_with("OBJ, line 5: the face's corner “0”"));
        assert!(message("f -5 1 2\n").contains("back to -4"));
        assert!(message("v 1 2\n").ends_with("a vertex of 2 numbers, expected three"));
        assert!(message("v 1 2 1.#IND\n").contains("“1.#IND”"));
        assert!(message("v 1 2 nan\n").contains("finite"));
    }

    #[test]
    fn small_faces_and_materials_are_warnings() {
        let warnings = parsed("mtllib a.mtl\nf 1 2\nf 1 2 3\n").unwrap().warnings;
        assert!(warnings[0].starts_with("1 faces") && warnings[1].contains("a.mtl"), "{warnings:?}");
    }

    proptest! {
        #[test]
        fn no_bytes_panic(text in "([vf]n? [-0-9/. #\\\\]{0,12}\n){0,12}") {
            let _ = parse(text.as_bytes());
        }
    }
}
