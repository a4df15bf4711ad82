//! What a very large mesh is seen without, but not worked with: its tree, and the vertices of more than its coarse copy.
//! It follows by itself, so that the mesh is on screen before it is there.

use std::sync::Arc;

use super::mesh::{bytes_of, read_data, read_shading, write_data, write_shading};
use super::wire::{Reader, Writer};
use crate::formats::NamedFile;
use crate::mesh::{Bvh, Mesh, MeshData, ShadingMesh, shading_vertices};
use crate::photo::Pixels;
use crate::scene::MeshAsset;

/// Asks for it: the mesh in place of a file.
pub fn request(asset: &MeshAsset) -> NamedFile {
    let data = asset.mesh.data();
    // Vertices need to know which texture is whose, not what is on it.
    let blank = Arc::new(Pixels { width: 1, height: 1, rgba: vec![255; 4] });
    let paint = data.paint.clone().map(|mut paint| {
        paint.textures.fill(blank);
        paint
    });
    let mut writer = Writer::for_bytes(bytes_of(data));
    write_data(&mut writer, data, paint.as_ref());
    NamedFile { name: asset.file_name.clone(), bytes: writer.finish().into() }
}

pub fn write(file: &NamedFile) -> Result<Vec<u8>, String> {
    let data: Option<MeshData> = read_data(&mut Reader::new(&file.bytes));
    let data = data.ok_or_else(|| "the request to the worker was damaged".to_owned())?;
    let mesh = Mesh::new(data).map_err(|error| error.to_string())?;
    let mut writer = Writer::default();
    write_tree(&mut writer, &Bvh::build(&mesh));
    write_shading(&mut writer, &shading_vertices(&mesh));
    Ok(writer.finish())
}

pub fn read(reader: &mut Reader<'_>) -> Option<(Bvh, ShadingMesh)> {
    Some((read_tree(reader)?, read_shading(reader)?))
}

pub(super) fn write_tree(writer: &mut Writer, tree: &Bvh) {
    let (nodes, order) = tree.to_parts();
    writer.bytes(nodes);
    writer.items(order);
}

pub(super) fn read_tree(reader: &mut Reader<'_>) -> Option<Bvh> {
    Bvh::from_parts(reader.bytes()?, reader.items()?)
}
