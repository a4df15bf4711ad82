//! glTF 2.0, as GLB or as JSON: the scene's triangles, flattened into one mesh in millimetres.
//!
//! Only the schema comes from the `gltf` crate. Its checked `Document` panics on some broken files and refuses good ones
//! that lack optional numbers, so every index, type and byte range is checked here before it is used.

mod accessor;
mod container;
mod materials;
mod scene;
#[cfg(test)]
mod tests;

use ::gltf::json;

use super::companions::percent_decoded;
use super::load::{Parsed, Source};
use super::{Format, MeshError, Place};

/// A document and the bytes of its buffers.
struct Gltf<'a> {
    root: json::Root,
    buffers: Vec<container::Buffer<'a>>,
}

pub(super) fn parse(source: &Source<'_>) -> Result<Parsed, MeshError> {
    let (root, binary_chunk) = open(source.bytes)?;
    refuse_extensions(&root)?;
    let buffers = container::buffers(&root, binary_chunk, source.find)?;
    scene::flatten(&Gltf { root, buffers }, source.find)
}

/// The buffers and images that are files of their own.
pub(super) fn companion_names(source: &Source<'_>) -> Vec<String> {
    let Ok((root, _)) = open(source.bytes) else { return Vec::new() };
    let buffers = root.buffers.iter().map(|buffer| &buffer.uri);
    let uris = buffers.chain(root.images.iter().map(|image| &image.uri)).flatten();
    uris.filter(|uri| !uri.starts_with("data:")).map(|uri| percent_decoded(uri)).collect()
}

fn open(bytes: &[u8]) -> Result<(json::Root, Option<&[u8]>), MeshError> {
    let (json_bytes, binary_chunk) = container::split(bytes)?;
    let root = json::deserialize::from_slice(json_bytes).map_err(|error| {
        malformed(format!("JSON line {} column {}", error.line(), error.column()), error.to_string())
    })?;
    Ok((root, binary_chunk))
}

/// Extensions of materials, textures and lights leave the shape alone; any other that a file *requires* changes what its
/// bytes mean.
fn refuse_extensions(root: &json::Root) -> Result<(), MeshError> {
    let is_about_looks = |name: &str| {
        ["KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_", "KHR_lights_"]
            .iter()
            .any(|prefix| name.starts_with(prefix))
    };
    match root.extensions_required.iter().find(|name| !is_about_looks(name)) {
        Some(name) => Err(unsupported_extension(name)),
        None => Ok(()),
    }
}

fn unsupported_extension(name: &str) -> MeshError {
    let feature = match name {
        "KHR_draco_mesh_compression" => "Draco compression".to_owned(),
        "EXT_meshopt_compression" | "KHR_meshopt_compression" => "meshopt compression".to_owned(),
        "KHR_mesh_quantization" => "quantised positions".to_owned(),
        "EXT_mesh_gpu_instancing" => "instancing".to_owned(),
        _ => format!("the required extension “{name}”"),
    };
    unsupported(feature, "export the mesh again without it")
}

fn unsupported(feature: String, advice: &'static str) -> MeshError {
    MeshError::Unsupported { format: Format::Gltf, feature, advice }
}

fn malformed(part: impl Into<String>, problem: impl Into<String>) -> MeshError {
    MeshError::Malformed { format: Format::Gltf, place: Place::Part(part.into()), problem: problem.into() }
}
