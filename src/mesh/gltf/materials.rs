//! Base colours and base colour textures of a glTF's materials.

use std::borrow::Cow;
use std::collections::BTreeMap;

use ::gltf::json;
use glam::{Mat2, Vec2};

use super::Gltf;
use super::accessor::view_bytes;
use super::container::data_uri;
use crate::mesh::companions::percent_decoded;
use crate::mesh::paint::srgb_from_linear;
use crate::mesh::textures::Textures;
use crate::mesh::{FindCompanion, Material, Paint};

/// The looks of a scene while it is walked through: materials are read when the first triangles show them.
pub(super) struct Look<'a> {
    textures: Textures<'a>,
    /// By their numbers in the file; `None` is the default material.
    known: BTreeMap<Option<usize>, (u32, Option<TextureMap>)>,
    paint: Paint,
    current_material: u32,
    has_file_materials: bool,
}

/// Which set of texture coordinates a material takes, and how they are moved (`KHR_texture_transform`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TextureMap {
    pub set: u32,
    linear: Mat2,
    offset: Vec2,
}

impl TextureMap {
    fn new(info: &json::texture::Info) -> Self {
        let plain = Self { set: info.tex_coord, linear: Mat2::IDENTITY, offset: Vec2::ZERO };
        let Some(transform) =
            info.extensions.as_ref().and_then(|extensions| extensions.texture_transform.as_ref())
        else {
            return plain;
        };
        // The extension's rotation is counter-clockwise as seen with v down.
        let (sin, cos) = transform.rotation.0.sin_cos();
        let rotation = Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos));
        Self {
            set: transform.tex_coord.unwrap_or(info.tex_coord),
            linear: rotation * Mat2::from_diagonal(Vec2::from_array(transform.scale.0)),
            offset: Vec2::from_array(transform.offset.0),
        }
    }

    pub fn apply(&self, uv: Vec2) -> Vec2 {
        self.linear * uv + self.offset
    }
}

impl<'a> Look<'a> {
    pub fn new(gltf: &Gltf<'_>, find: FindCompanion<'a>) -> Self {
        Self {
            textures: Textures::new(find),
            known: BTreeMap::new(),
            paint: Paint::default(),
            current_material: 0,
            has_file_materials: !gltf.root.materials.is_empty(),
        }
    }

    /// The triangles that follow are of this material; how its texture lies on them, if it has one.
    pub fn begin_primitive(&mut self, gltf: &Gltf<'_>, material: Option<usize>) -> Option<TextureMap> {
        if let Some(&(number, map)) = self.known.get(&material) {
            self.current_material = number;
            return map;
        }
        let found = material.and_then(|number| gltf.root.materials.get(number));
        let (material_read, map) = found.map_or_else(Default::default, |material| self.read(gltf, material));
        self.current_material = self.paint.materials.len() as u32;
        self.paint.materials.push(material_read);
        self.known.insert(material, (self.current_material, map));
        map
    }

    /// Where the corners of the triangles that follow lie on the texture.
    pub fn add_uvs(&mut self, corner_uvs: impl Iterator<Item = [Vec2; 3]>) {
        // Triangles before the first textured ones have none.
        self.paint.corner_uvs.resize(self.paint.material_of_triangle.len(), [Vec2::ZERO; 3]);
        self.paint.corner_uvs.extend(corner_uvs);
    }

    pub fn end_primitive(&mut self, triangles: usize) {
        self.paint.material_of_triangle.resize(triangles, self.current_material);
    }

    pub fn into_paint(self, warnings: &mut Vec<String>) -> Option<Paint> {
        let (textures, texture_warnings) = self.textures.finish();
        warnings.extend(texture_warnings);
        let mut paint = Paint { textures, ..self.paint };
        if !paint.textures.is_empty() {
            paint.corner_uvs.resize(paint.material_of_triangle.len(), [Vec2::ZERO; 3]);
        }
        self.has_file_materials.then_some(paint)
    }

    fn read(&mut self, gltf: &Gltf<'_>, material: &json::Material) -> (Material, Option<TextureMap>) {
        let surface = &material.pbr_metallic_roughness;
        // Linear, and its alpha is not taken: silhouettes are the geometry's.
        let [r, g, b, _] =
            surface.base_color_factor.0.map(|value| (srgb_from_linear(value) * 255.0).round() as u8);
        let info = surface.base_color_texture.as_ref();
        let texture = info.and_then(|info| self.texture(gltf, info.index.value()));
        let map = info.filter(|_| texture.is_some()).map(TextureMap::new);
        (Material { base_color: [r, g, b, 255], texture }, map)
    }

    fn texture(&mut self, gltf: &Gltf<'_>, number: usize) -> Option<u32> {
        // An image that only an extension names has no number here.
        let image_number = gltf.root.textures.get(number)?.source.value();
        let what = format!("image {image_number}");
        let image = gltf.root.images.get(image_number);
        match image.map(|image| (&image.buffer_view, &image.uri)) {
            Some((Some(view), _)) => self.textures.embedded(&what, || {
                Cow::Borrowed(view_bytes(gltf, view.value()).map_or(&[][..], |(bytes, _)| bytes))
            }),
            Some((None, Some(uri))) if !uri.starts_with("data:") => {
                self.textures.in_file(&percent_decoded(uri))
            }
            Some((None, Some(uri))) => {
                self.textures.embedded(&what, || Cow::Owned(data_uri(uri).unwrap_or_default()))
            }
            Some((None, None)) | None => self.textures.embedded(&what, Cow::default),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texture_coordinates_are_scaled_turned_and_moved_in_this_order() {
        // The extension's own example: turned by 90° and then moved down by the image's height.
        let json = r#"{"index":0,"texCoord":1,"extensions":{"KHR_texture_transform":
            {"offset":[0,1],"rotation":1.57079632679,"scale":[0.5,0.25],"texCoord":2}}}"#;
        let map = TextureMap::new(&json::deserialize::from_str(json).unwrap());
        assert_eq!(map.set, 2);
        // offset · rotation · scale: (1, 1) → (0.5, 0.25) → (0.25, -0.5) → (0.25, 0.5).
        assert!(map.apply(Vec2::ONE).distance(Vec2::new(0.25, 0.5)) < 1e-6, "{}", map.apply(Vec2::ONE));
    }
}
