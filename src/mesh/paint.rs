//! What a surface is painted with besides vertex colours: materials, textures, and where on them each triangle lies.

use std::sync::Arc;

use glam::Vec2;

use super::MeshError;
use crate::photo::Pixels;

/// Materials and textures of a mesh.
///
/// A texture coordinate (u, v) is (0, 0) at the top left corner of the image and (1, 1) at its bottom right: v runs down,
/// as in the rows of [`Pixels`]. Beyond that the image repeats. Formats whose v runs up are turned at the file's boundary.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Paint {
    /// One for each triangle: where its corners lie on the texture. Empty where no material has a texture.
    pub corner_uvs: Vec<[Vec2; 3]>,
    /// One for each triangle: an index into `materials`.
    pub material_of_triangle: Vec<u32>,
    pub materials: Vec<Material>,
    /// Decoded, opaque (a silhouette is the geometry's alone), and of a size that every GPU takes.
    pub textures: Vec<Arc<Pixels>>,
}

/// The colour of a surface: that of its texture times the vertex colours times its own, all in sRGB.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Material {
    /// sRGB and alpha.
    pub base_color: [u8; 4],
    /// An index into [`Paint::textures`].
    pub texture: Option<u32>,
}

impl Default for Material {
    fn default() -> Self {
        Self { base_color: [255; 4], texture: None }
    }
}

impl Paint {
    /// Whether it shows more than one shade of grey: files full of a default material say nothing of the object's colour.
    pub(super) fn has_colors(&self) -> bool {
        let mut colors = self.materials.iter().map(|material| material.base_color);
        let first = colors.next().unwrap_or([255; 4]);
        let [r, g, b, _] = first;
        !self.textures.is_empty() || r != g || g != b || colors.any(|color| color != first)
    }

    /// The material of a triangle in range.
    pub(super) fn material(&self, triangle: usize) -> Material {
        self.materials[self.material_of_triangle[triangle] as usize]
    }

    /// Turns the triangles round.
    pub(super) fn mirror(&mut self) {
        for [_, b, c] in &mut self.corner_uvs {
            std::mem::swap(b, c);
        }
    }

    /// Checks that there is one of everything for each triangle, and that indices are in range; leaves out what no
    /// triangle shows.
    pub(super) fn checked(mut self, triangles: usize) -> Result<Self, MeshError> {
        let wrong_count =
            |attribute, count| MeshError::TriangleAttributeCount { attribute, count, triangles };
        if self.material_of_triangle.len() != triangles {
            return Err(wrong_count("materials", self.material_of_triangle.len()));
        }
        let is_textured = self.materials.iter().any(|material| material.texture.is_some());
        if !is_textured {
            self.corner_uvs = Vec::new();
            self.textures.clear();
        } else if self.corner_uvs.len() != triangles {
            return Err(wrong_count("texture coordinates", self.corner_uvs.len()));
        }
        let materials = self.materials.len();
        if self.material_of_triangle.iter().any(|&material| material as usize >= materials) {
            return Err(MeshError::BadPaint { what: "a triangle names a material that is not there" });
        }
        let textures = self.textures.len();
        if self
            .materials
            .iter()
            .filter_map(|material| material.texture)
            .any(|texture| texture as usize >= textures)
        {
            return Err(MeshError::BadPaint { what: "a material names a texture that is not there" });
        }
        if !self.textures.iter().all(|texture| is_whole(texture)) {
            return Err(MeshError::BadPaint { what: "a texture's pixels do not fit its size" });
        }
        for uv in self.corner_uvs.as_flattened_mut() {
            *uv = usable_uv(*uv);
        }
        Ok(self)
    }
}

fn is_whole(pixels: &Pixels) -> bool {
    let bytes = u64::from(pixels.width) * u64::from(pixels.height) * 4;
    bytes > 0 && pixels.rgba.len() as u64 == bytes
}

/// Coordinates that are not finite, or so far out that an `f32` no longer tells pixels apart, show the image's corner.
fn usable_uv(uv: Vec2) -> Vec2 {
    const FARTHEST: f32 = 1e4;
    if uv.abs().max_element() <= FARTHEST && uv.is_finite() { uv } else { Vec2::ZERO }
}

/// The product of two sRGB colours, as their light multiplies.
pub(super) fn product([a, b]: [[u8; 4]; 2]) -> [u8; 4] {
    const WHITE: [u8; 4] = [255; 4];
    if a == WHITE || b == WHITE {
        return if a == WHITE { b } else { a };
    }
    let channel = |i: usize| {
        let [a, b] = [a, b].map(|color| linear_from_srgb(f32::from(color[i]) / 255.0));
        (srgb_from_linear(a * b) * 255.0).round() as u8
    };
    let alpha = (u32::from(a[3]) * u32::from(b[3]) + 127) / 255;
    [channel(0), channel(1), channel(2), alpha as u8]
}

/// The transfer function of IEC 61966-2-1.
pub(super) fn srgb_from_linear(value: f32) -> f32 {
    if value <= 0.003_130_8 { value * 12.92 } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
}

fn linear_from_srgb(value: f32) -> f32 {
    if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn textured() -> Paint {
        Paint {
            corner_uvs: vec![[Vec2::ZERO, Vec2::X, Vec2::NAN]],
            material_of_triangle: vec![0],
            materials: vec![Material { texture: Some(0), ..Material::default() }],
            textures: vec![Arc::new(Pixels { width: 1, height: 1, rgba: vec![255; 4] })],
        }
    }

    #[test]
    fn what_does_not_fit_together_is_refused() {
        assert_eq!(textured().checked(1).unwrap().corner_uvs, [[Vec2::ZERO, Vec2::X, Vec2::ZERO]]);
        assert!(textured().checked(2).is_err());
        assert!(Paint { materials: Vec::new(), ..textured() }.checked(1).is_err());
        assert!(Paint { textures: Vec::new(), ..textured() }.checked(1).is_err());
        assert!(Paint { corner_uvs: Vec::new(), ..textured() }.checked(1).is_err());
        let half = vec![Arc::new(Pixels { width: 2, height: 1, rgba: vec![255; 4] })];
        assert!(Paint { textures: half, ..textured() }.checked(1).is_err());
    }

    #[test]
    fn one_shade_of_grey_is_no_color() {
        let plain = |colors: &[[u8; 4]]| Paint {
            materials: colors.iter().map(|&base_color| Material { base_color, texture: None }).collect(),
            ..Paint::default()
        };
        assert!(!plain(&[]).has_colors() && !plain(&[[204, 204, 204, 255]]).has_colors());
        assert!(plain(&[[204, 0, 0, 255]]).has_colors());
        assert!(plain(&[[0, 0, 0, 255], [255; 4]]).has_colors());
        assert!(textured().has_colors());
    }

    #[test]
    fn colors_multiply_as_light_does() {
        assert_eq!(product([[255; 4], [1, 2, 3, 4]]), [1, 2, 3, 4]);
        // Half the light is sRGB 188, a quarter is 137.
        assert_eq!(product([[188, 255, 0, 255], [188, 188, 7, 255]]), [137, 188, 0, 255]);
    }
}
