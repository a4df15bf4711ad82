//! From an OBJ's material names and texture coordinates to a mesh's paint.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::Vec2;

use super::material::{self, Library};
use crate::mesh::companions::{companion_key, stem};
use crate::mesh::load::Source;
use crate::mesh::text::{shown, words};
use crate::mesh::textures::Textures;
use crate::mesh::{Material, Paint};

/// No texture coordinate at a corner.
pub(super) const NO_UV: u32 = u32::MAX;

/// So many lines and words are looked up as libraries.
const MOST_LIBRARIES: usize = 64;

/// What the lines of a file say of materials and texture coordinates.
#[derive(Debug, Default)]
pub(super) struct Look {
    /// As the file has them, with v up.
    pub file_uvs: Vec<Vec2>,
    /// As long as the triangles as soon as one corner has a coordinate.
    pub uv_numbers: Vec<[u32; 3]>,
    /// As long as the triangles as soon as a material was named.
    pub material_of_triangle: Vec<u32>,
    /// The number of each material name; the first, without a name, is that of triangles before any `usemtl`.
    material_numbers: BTreeMap<Vec<u8>, u32>,
    current_material: u32,
    /// What stands behind each `mtllib`.
    libraries: Vec<Vec<u8>>,
}

impl Look {
    pub fn use_material(&mut self, name: &[u8]) {
        let next_number = self.material_numbers.len() as u32 + 1;
        self.current_material = *self.material_numbers.entry(name.to_vec()).or_insert(next_number);
    }

    pub fn add_library(&mut self, names: &[u8]) {
        // Some programs name the library before every group.
        let is_known = self.libraries.iter().any(|known| known == names);
        if !is_known && !names.is_empty() && self.libraries.len() < MOST_LIBRARIES {
            self.libraries.push(names.to_vec());
        }
    }

    /// The polygon whose triangles make `triangles_before` into `triangles_now`, as a fan.
    pub fn add_polygon(&mut self, uvs: &[u32], triangles_before: usize, triangles_now: usize) {
        if self.current_material != 0 || !self.material_of_triangle.is_empty() {
            self.material_of_triangle.resize(triangles_before, 0);
            self.material_of_triangle.resize(triangles_now, self.current_material);
        }
        let has_uvs = uvs.iter().any(|&uv| uv != NO_UV);
        if has_uvs || !self.uv_numbers.is_empty() {
            self.uv_numbers.resize(triangles_before, [NO_UV; 3]);
            let fan = uvs.windows(2).skip(1);
            self.uv_numbers.extend(fan.map(|pair| [uvs[0], pair[0], pair[1]]));
        }
    }

    /// The paint, if a library was found.
    pub fn into_paint(
        mut self,
        source: &Source<'_>,
        triangles: usize,
        warnings: &mut Vec<String>,
    ) -> Option<Paint> {
        if self.libraries.is_empty() {
            return None;
        }
        let library = self.find_library(source, warnings)?;
        let mut textures = Textures::new(source.find);
        let mut materials = vec![Material::default(); self.material_numbers.len() + 1];
        let mut unknown = Vec::new();
        for (name, &number) in &self.material_numbers {
            match (library.materials.get(name), materials.get_mut(number as usize)) {
                (Some(found), Some(slot)) => {
                    let texture = found.texture.as_ref().and_then(|name| textures.in_file(name));
                    // Programs write any colour beside a texture, often black; it is the texture that is meant.
                    let is_placeholder = found.texture.is_some() && found.color() == [0, 0, 0, 255];
                    let is_white = texture.is_some() || is_placeholder;
                    let base_color = if is_white { [255; 4] } else { found.color() };
                    *slot = Material { base_color, texture };
                }
                _ => unknown.push(shown(name)),
            }
        }
        if !unknown.is_empty() {
            unknown.truncate(5);
            let names = unknown.join(", ");
            warnings
                .push(format!("The material library does not have the materials {names}: drawn in white."));
        }
        self.material_of_triangle.resize(triangles, 0);
        self.uv_numbers.resize(if textures.is_empty() { 0 } else { triangles }, [NO_UV; 3]);
        let corner_uvs = self.uv_numbers.iter().map(|corners| corners.map(|uv| self.uv(uv))).collect();
        let (textures, texture_warnings) = textures.finish();
        warnings.extend(texture_warnings);
        Some(Paint { corner_uvs, material_of_triangle: self.material_of_triangle, materials, textures })
    }

    /// With v down, and zero where the file has none.
    fn uv(&self, number: u32) -> Vec2 {
        self.file_uvs.get(number as usize).map_or(Vec2::ZERO, |uv| Vec2::new(uv.x, 1.0 - uv.y))
    }

    /// All libraries as one; `None`, and a warning, where none is there.
    fn find_library(&self, source: &Source<'_>, warnings: &mut Vec<String>) -> Option<Library> {
        let found = self.found_libraries(source);
        let mut whole = Library::default();
        for bytes in found.values() {
            for (name, material) in material::parse(bytes).materials {
                whole.materials.entry(name).or_insert(material);
            }
        }
        if !found.is_empty() {
            return Some(whole);
        }
        let names = self.libraries.iter().map(|names| shown(names)).collect::<Vec<_>>().join(", ");
        // Renamed meshes keep the old name of their library inside; the library was renamed with them.
        let renamed = renamed_library(source.file_name);
        if let Some(bytes) = (source.find)(&companion_key(&renamed)) {
            let renamed = shown(renamed.as_bytes());
            warnings
                .push(format!("The material library {names} did not come with the mesh; {renamed} is used."));
            return Some(material::parse(&bytes));
        }
        warnings.push(format!(
            "The material library {names} did not come with the mesh, which is drawn in a plain colour; load them together."
        ));
        None
    }

    /// The names of the files that the look comes from, and of every image beside.
    pub fn companion_names(&self, source: &Source<'_>) -> Vec<String> {
        let mut names: Vec<String> = self.libraries.iter().flat_map(|line| candidates(line)).collect();
        let mut libraries = self.found_libraries(source);
        let renamed = companion_key(&renamed_library(source.file_name));
        if libraries.is_empty()
            && !self.libraries.is_empty()
            && let Some(bytes) = (source.find)(&renamed)
        {
            names.push(renamed.clone());
            libraries.insert(renamed, bytes);
        }
        names.extend(libraries.values().flat_map(|bytes| material::parse(bytes).images));
        names
    }

    /// The libraries that are at hand, by their keys.
    fn found_libraries(&self, source: &Source<'_>) -> BTreeMap<String, Arc<[u8]>> {
        let mut found = BTreeMap::new();
        for line in &self.libraries {
            let mut keys = candidates(line).into_iter().map(|name| companion_key(&name));
            let lookup = |key: String| (source.find)(&key).map(|bytes| (key, bytes));
            match keys.next().and_then(lookup) {
                Some(whole) => found.extend([whole]),
                None => found.extend(keys.filter_map(lookup)),
            }
        }
        found
    }
}

fn renamed_library(mesh_name: &str) -> String {
    format!("{}.mtl", stem(mesh_name))
}

/// A line may name one library, with spaces in its name, or several.
fn candidates(names: &[u8]) -> Vec<String> {
    let whole = std::iter::once(names);
    let each = words(names).filter(|word| word.len() < names.len());
    whole.chain(each.take(MOST_LIBRARIES)).map(|name| String::from_utf8_lossy(name).into_owned()).collect()
}
