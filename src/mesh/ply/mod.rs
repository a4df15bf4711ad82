//! PLY: ASCII and binary, any order of elements and properties. Strict where a wrong guess would make a wrong mesh.

mod body;
mod header;
mod look;
#[cfg(test)]
mod tests;
mod values;

use super::load::{Parsed, Source};
use super::{Format, MeshError, Place};

pub(super) fn parse(source: &Source<'_>) -> Result<Parsed, MeshError> {
    let header = header::parse(source.bytes)?;
    let (mut parsed, look) = body::read(&header, source.bytes)?;
    look.paint(&header, source, &mut parsed);
    parsed.data.prefer_texture();
    Ok(parsed)
}

/// The textures that the header names.
pub(super) fn companion_names(source: &Source<'_>) -> Vec<String> {
    header::parse(source.bytes).map_or_else(|_| Vec::new(), |header| header.texture_files)
}

fn malformed(place: Place, problem: impl Into<String>) -> MeshError {
    MeshError::Malformed { format: Format::Ply, place, problem: problem.into() }
}
