//! A mesh as the solvers look at it: fewer triangles, the same outline.

use super::wire::{Reader, Writer};
use crate::formats::{NamedFile, read_mesh_with};
use crate::mesh::{Mesh, MeshData, simplified};
use crate::solve::contour;

/// Of the mesh in the file, before any change of its frame.
pub fn write(file: &NamedFile, companions: &[NamedFile]) -> Result<Vec<u8>, String> {
    let (asset, _) = read_mesh_with(file, companions).map_err(|error| error.to_string())?;
    let mesh = simplified(&asset.mesh, contour::MAX_TRIANGLES)
        .ok_or_else(|| "it has no triangle with three different corners".to_owned())?;
    let mut writer = Writer::default();
    writer.items(mesh.positions_mm());
    writer.items(mesh.triangles());
    writer.items(mesh.colors().unwrap_or_default());
    Ok(writer.finish())
}

pub fn read(reader: &mut Reader<'_>) -> Option<Mesh> {
    let (positions_mm, triangles) = (reader.items()?, reader.items()?);
    let colors: Vec<[u8; 4]> = reader.items()?;
    let colors = (!colors.is_empty()).then_some(colors);
    Mesh::new(MeshData { positions_mm, triangles, colors, ..MeshData::default() }).ok()
}
