//! The header of a PLY file: which elements follow, how many of each, and how they are written.

use super::malformed;
use crate::mesh::text::{next_line, shown, words};
use crate::mesh::{MeshError, Place};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// What stands behind each `comment TextureFile`.
    pub texture_files: Vec<String>,
    /// Where the data begin.
    pub body_byte: usize,
    pub body_line: usize,
}

impl Scalar {
    /// Both families of names are in use: C's, and those with the size in them.
    fn from_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

impl Header {
    pub fn element(&self, name: &str) -> Option<&Element> {
        self.elements.iter().find(|element| element.name == name)
    }
}

impl Element {
    /// The number of the first property that bears one of these names.
    pub fn property(&self, names: &[&str]) -> Option<usize> {
        self.properties.iter().position(|property| names.contains(&property.name.as_str()))
    }
}

pub(super) fn parse(bytes: &[u8]) -> Result<Header, MeshError> {
    let mut position = 0;
    let mut line_number = 1;
    if next_line(bytes, &mut position) != Some(b"ply") {
        return Err(malformed(Place::Line(1), "expected “ply” and nothing else"));
    }
    // Binary data may begin with a line feed, so a lone CR ends a line only in files that began that way.
    let lines_end_in_cr = bytes.get(3) == Some(&b'\r') && bytes.get(4) != Some(&b'\n');
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut texture_files = Vec::new();
    loop {
        line_number += 1;
        let place = Place::Line(line_number);
        let line_start = position;
        let Some(line) = next_line(bytes, &mut position) else {
            return Err(malformed(place, "the file ends within its header, expected “end_header”"));
        };
        let words: Vec<&[u8]> = words(line).collect();
        match words.as_slice() {
            [b"comment", b"TextureFile", _, ..] => texture_files.extend(texture_file(line)),
            [] | [b"comment" | b"obj_info", ..] => {}
            [b"format", name, ..] => encoding = Some(parse_encoding(name, place)?),
            [b"element", name, count] => elements.push(parse_element(name, count, &elements, place)?),
            [b"property", rest @ ..] => {
                let property = parse_property(rest, place.clone())?;
                let element =
                    elements.last_mut().ok_or_else(|| malformed(place, "a property before any element"))?;
                element.properties.push(property);
            }
            [b"end_header"] => {
                let encoding = encoding.ok_or_else(|| malformed(place, "the header has no “format” line"))?;
                let body_byte = if lines_end_in_cr { line_start + line.len() + 1 } else { position };
                let body_line = line_number + 1;
                return Ok(Header { encoding, elements, texture_files, body_byte, body_line });
            }
            _ => {
                let expected = "expected format, comment, element, property or end_header";
                return Err(malformed(place, format!("{expected}, found {}", shown(line))));
            }
        }
    }
}

/// The name may hold spaces.
fn texture_file(line: &[u8]) -> Option<String> {
    let line = String::from_utf8_lossy(line);
    line.split_once("TextureFile").map(|(_, name)| name.trim().to_owned())
}

fn parse_encoding(name: &[u8], place: Place) -> Result<Encoding, MeshError> {
    match name {
        b"ascii" => Ok(Encoding::Ascii),
        b"binary_little_endian" => Ok(Encoding::LittleEndian),
        b"binary_big_endian" => Ok(Encoding::BigEndian),
        _ => {
            let expected = "expected ascii, binary_little_endian or binary_big_endian";
            Err(malformed(place, format!("{expected}, found {}", shown(name))))
        }
    }
}

fn parse_element(name: &[u8], count: &[u8], before: &[Element], place: Place) -> Result<Element, MeshError> {
    let name = String::from_utf8_lossy(name).into_owned();
    if before.iter().any(|element| element.name == name) {
        return Err(malformed(place, format!("a second element “{name}”")));
    }
    match std::str::from_utf8(count).ok().and_then(|text| text.parse().ok()) {
        Some(count) => Ok(Element { name, count, properties: Vec::new() }),
        None => Err(malformed(place, format!("expected a count, found {}", shown(count)))),
    }
}

fn parse_property(words: &[&[u8]], place: Place) -> Result<Property, MeshError> {
    let scalar = |word: &[u8]| {
        Scalar::from_name(word)
            .ok_or_else(|| malformed(place.clone(), format!("expected a type, found {}", shown(word))))
    };
    let (kind, name) = match words {
        [b"list", count, item, name] => {
            let count = scalar(count)?;
            if matches!(count, Scalar::F32 | Scalar::F64) {
                return Err(malformed(place, "a list is counted by an integer type"));
            }
            (Kind::List { count, item: scalar(item)? }, name)
        }
        [scalar_name, name] => (Kind::Scalar(scalar(scalar_name)?), name),
        _ => return Err(malformed(place, "expected “property TYPE NAME” or “property list TYPE TYPE NAME”")),
    };
    Ok(Property { name: String::from_utf8_lossy(name).into_owned(), kind })
}
