//! Why bytes are not a mesh: which format, where in the file, and what was expected there.

use std::fmt;

use thiserror::Error;

/// The file formats that this version reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    Ply,
    Obj,
    Gltf,
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ply => "PLY",
            Self::Obj => "OBJ",
            Self::Gltf => "glTF",
        })
    }
}

/// Where in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// Counted from 1, as editors do.
    Line(usize),
    /// Counted from 0, as hex viewers do.
    Byte(usize),
    /// A named part, such as "accessor 3".
    Part(String),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Part(part) => f.write_str(part),
        }
    }
}

/// Why bytes, or the parts of a mesh, are not a mesh.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MeshError {
    #[error("not a mesh this version reads: PLY, OBJ, GLB expected")]
    UnknownFormat,
    #[error("{format}, {place}: {problem}")]
    Malformed { format: Format, place: Place, problem: String },
    #[error("{format}: {feature} cannot be read by this version; {advice}")]
    Unsupported { format: Format, feature: String, advice: &'static str },
    #[error("no faces: {vertices} vertices and no polygon of three or more")]
    NoFaces { vertices: usize },
    #[error("more than {limit} {what}")]
    TooLarge { what: &'static str, limit: usize },
    #[error("vertex {vertex} (counted from 0) is at {position:?}, expected finite numbers within ±1e9")]
    BadPosition { vertex: usize, position: [f32; 3] },
    #[error("triangle {triangle} (counted from 0) names vertex {index}, but there are {vertices} vertices")]
    IndexOutOfRange { triangle: usize, index: u32, vertices: usize },
    #[error("{count} {attribute} for {vertices} vertices, expected one each")]
    AttributeCount { attribute: &'static str, count: usize, vertices: usize },
    #[error("{count} {attribute} for {triangles} triangles, expected one each")]
    TriangleAttributeCount { attribute: &'static str, count: usize, triangles: usize },
    #[error("{what}")]
    BadPaint { what: &'static str },
}
