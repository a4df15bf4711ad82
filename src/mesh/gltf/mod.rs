//! glTF 2.0, as GLB or as self-contained JSON: the scene's triangles, flattened into one mesh in millimetres.
//!
//! Only the schema comes from the `gltf` crate. Its checked `Document` panics on some broken files and refuses good ones
//! that lack optional numbers, so every index, type and byte range is checked here before it is used.

mod accessor;
mod container;
mod scene;
#[cfg(test)]
mod tests;

use ::gltf::json;

use super::load::Parsed;
use super::{Format, MeshError, Place};

/// A document and the bytes of its buffers.
struct Gltf<'a> {
    root: json::Root,
    buffers: Vec<std::borrow::Cow<'a, [u8]>>,
}

pub(super) fn parse(bytes: &[u8]) -> Result<Parsed, MeshError> {
    let (json_bytes, binary_chunk) = container::split(bytes)?;
    let root: json::Root = json::deserialize::from_slice(json_bytes).map_err(|error| {
        malformed(format!("JSON line {} column {}", error.line(), error.column()), error.to_string())
    })?;
    refuse_extensions(&root)?;
    let buffers = container::buffers(&root, binary_chunk)?;
    scene::flatten(&Gltf { root, buffers })
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
