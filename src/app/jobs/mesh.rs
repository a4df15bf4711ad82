//! A mesh on its way from the worker, with what picking and drawing need of it.

use std::sync::Arc;

use super::mesh_rest::{read_tree, write_tree};
use super::wire::{Reader, Writer};
use super::{Done, read_hash};
use crate::formats::{NamedFile, kept};
use crate::mesh::{
    CoarseMesh, DrawnAhead, DrawnMesh, Material, Mesh, MeshData, Paint, SearchTree, ShadingGroup, ShadingMesh,
};
use crate::photo::Pixels;
use crate::scene::MeshAsset;

/// A material, or a group of triangles, without texture.
const NO_TEXTURE: u32 = u32::MAX;

pub(super) fn write_mesh(asset: &MeshAsset, warnings: &[String]) -> Vec<u8> {
    let data = asset.mesh.data();
    let mut writer = Writer::for_bytes(bytes_of(data));
    writer.bytes(asset.sha256.to_string().as_bytes());
    write_data(&mut writer, data, data.paint.as_ref());
    writer.bytes(warnings.join("\n").as_bytes());
    let drawn = DrawnMesh::ahead_of(&asset.mesh);
    write_drawn(&mut writer, drawn.as_ref());
    // The tree of a mesh that has a coarse copy follows with the rest.
    if !drawn.is_some_and(|drawn| drawn.is_coarse_alone()) {
        asset.tree().into_iter().for_each(|tree| write_tree(&mut writer, tree));
    }
    writer.finish()
}

/// What a mesh without paint takes, about.
pub(super) fn bytes_of(data: &MeshData) -> usize {
    let has = |is_there: bool, bytes: usize| if is_there { bytes } else { 0 };
    let per_vertex = 12 + has(data.normals.is_some(), 12) + has(data.colors.is_some(), 4);
    per_vertex * data.positions_mm.len() + 12 * data.triangles.len() + 1024
}

pub(super) fn write_data(writer: &mut Writer, data: &MeshData, paint: Option<&Paint>) {
    writer.items(&data.positions_mm);
    writer.items(&data.triangles);
    writer.items(data.normals.as_deref().unwrap_or_default());
    writer.items(data.colors.as_deref().unwrap_or_default());
    write_paint(writer, paint.unwrap_or(&Paint::default()));
}

pub(super) fn read_data(reader: &mut Reader<'_>) -> Option<MeshData> {
    Some(MeshData {
        positions_mm: reader.items()?,
        triangles: reader.items()?,
        normals: Some(reader.items()?).filter(|normals| !normals.is_empty()),
        colors: Some(reader.items()?).filter(|colors| !colors.is_empty()),
        paint: Some(read_paint(reader)?).filter(|paint| !paint.materials.is_empty()),
    })
}

fn write_drawn(writer: &mut Writer, drawn: Option<&DrawnMesh>) {
    writer.byte(u8::from(drawn.is_some()));
    let Some(drawn) = drawn else { return };
    writer.byte(u8::from(drawn.shading.is_some()));
    drawn.shading.iter().for_each(|shading| write_shading(writer, shading));
    writer.byte(u8::from(drawn.coarse.is_some()));
    let Some((coarse, shading)) = &drawn.coarse else { return };
    // Its edges are all that is asked of it besides.
    writer.items(coarse.mesh.positions_mm());
    writer.items(coarse.mesh.triangles());
    writer.number(coarse.cell_mm);
    write_shading(writer, shading);
}

pub(super) fn write_shading(writer: &mut Writer, shading: &ShadingMesh) {
    writer.items(&shading.vertices);
    writer.items(&shading.indices);
    let groups = shading.groups.iter();
    let groups: Vec<[u32; 3]> = groups
        .map(|group| [group.texture.unwrap_or(NO_TEXTURE), group.indices.start, group.indices.end])
        .collect();
    writer.items(&groups);
}

/// The outer `None`: what came is not whole.
fn read_drawn(reader: &mut Reader<'_>) -> Option<Option<DrawnMesh>> {
    if reader.byte()? == 0 {
        return Some(None);
    }
    let shading = if reader.byte()? == 1 { Some(read_shading(reader)?) } else { None };
    if reader.byte()? == 0 {
        return Some(Some(DrawnMesh { shading, coarse: None }));
    }
    let (positions_mm, triangles) = (reader.items()?, reader.items()?);
    let mesh = Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() }).ok()?;
    let coarse = CoarseMesh { mesh, cell_mm: reader.number()? };
    let coarse = Some((coarse, read_shading(reader)?));
    Some(Some(DrawnMesh { shading, coarse }))
}

pub(super) fn read_shading(reader: &mut Reader<'_>) -> Option<ShadingMesh> {
    let (vertices, indices) = (reader.items()?, reader.items()?);
    let groups: Vec<[u32; 3]> = reader.items()?;
    let group = |[texture, start, end]: [u32; 3]| ShadingGroup {
        texture: Some(texture).filter(|&texture| texture != NO_TEXTURE),
        indices: start..end,
    };
    Some(ShadingMesh { vertices, indices, groups: groups.into_iter().map(group).collect() })
}

fn write_paint(writer: &mut Writer, paint: &Paint) {
    writer.items(&paint.corner_uvs);
    writer.items(&paint.material_of_triangle);
    let colors: Vec<[u8; 4]> = paint.materials.iter().map(|material| material.base_color).collect();
    let textures: Vec<u32> =
        paint.materials.iter().map(|material| material.texture.unwrap_or(NO_TEXTURE)).collect();
    writer.items(&colors);
    writer.items(&textures);
    writer.number(paint.textures.len() as f64);
    for texture in &paint.textures {
        writer.number(f64::from(texture.width));
        writer.number(f64::from(texture.height));
        writer.bytes(&texture.rgba);
    }
}

fn read_paint(reader: &mut Reader<'_>) -> Option<Paint> {
    let (corner_uvs, material_of_triangle) = (reader.items()?, reader.items()?);
    let (colors, texture_numbers): (Vec<[u8; 4]>, Vec<u32>) = (reader.items()?, reader.items()?);
    let materials = colors.into_iter().zip(texture_numbers).map(|(base_color, texture)| Material {
        base_color,
        texture: Some(texture).filter(|&texture| texture != NO_TEXTURE),
    });
    let texture_count = reader.number()? as usize;
    let mut textures = Vec::new();
    for _ in 0..texture_count {
        let (width, height) = (reader.number()? as u32, reader.number()? as u32);
        textures.push(Arc::new(Pixels { width, height, rgba: reader.bytes()?.to_vec() }));
    }
    Some(Paint { corner_uvs, material_of_triangle, materials: materials.collect(), textures })
}

pub(super) fn read_mesh_reply(
    file: &NamedFile,
    companions: &[NamedFile],
    reader: &mut Reader<'_>,
) -> Option<Done> {
    let sha256 = read_hash(reader)?;
    let data = read_data(reader)?;
    let warnings = String::from_utf8(reader.bytes()?.to_vec()).ok()?;
    let (drawn, search_tree) = match read_drawn(reader)? {
        Some(drawn) if drawn.is_coarse_alone() => (DrawnAhead::promised(drawn), SearchTree::promised()),
        drawn => (DrawnAhead::new(drawn), read_tree(reader)?.into()),
    };
    let asset = MeshAsset {
        file_name: file.name.clone(),
        sha256,
        bytes: file.bytes.clone(),
        companions: kept(companions),
        mesh: Mesh::new(data).ok()?,
        search_tree,
        drawn,
        untransformed: None,
    };
    Some(Done::Mesh(Arc::new(asset), warnings.lines().map(str::to_owned).collect()))
}
