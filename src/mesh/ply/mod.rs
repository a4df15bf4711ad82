//! PLY: ASCII and binary, any order of elements and properties. Strict where a wrong guess would make a wrong mesh.

mod body;
mod header;
#[cfg(test)]
mod tests;
mod values;

use super::load::Parsed;
use super::{Format, MeshError, Place};

pub(super) fn parse(bytes: &[u8]) -> Result<Parsed, MeshError> {
    let header = header::parse(bytes)?;
    body::read(&header, bytes)
}

fn malformed(place: Place, problem: impl Into<String>) -> MeshError {
    MeshError::Malformed { format: Format::Ply, place, problem: problem.into() }
}
