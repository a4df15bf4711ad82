//! What a PLY file says of textures and of the colours of faces, made a mesh's paint.

use glam::Vec2;

use super::body::{byte_scale, scalar_property};
use super::header::{Element, Header};
use crate::mesh::load::{Parsed, Source};
use crate::mesh::paint::Palette;
use crate::mesh::textures::Textures;
use crate::mesh::{Material, Paint};

/// Texture coordinates as the file has them: with v up, as MeshLab and Blender write them.
#[derive(Debug, Default)]
pub(super) struct Look {
    pub vertex_uvs: Vec<Vec2>,
    /// The list of the face at hand: two numbers for each corner.
    pub face_values: Vec<f32>,
    /// As long as the triangles as soon as one face has a list.
    corner_uvs: Vec<[Vec2; 3]>,
    /// Which of the textures, one per triangle; empty where the file does not say.
    texture_of_triangle: Vec<u32>,
    face_colors: Option<Palette>,
}

/// Properties of faces that are single numbers: a colour, and which texture.
pub(super) struct FaceColors {
    /// The slot of each property: red, green, blue, alpha, texture number, and the rest.
    slot_of_property: Vec<usize>,
    scale: [f64; 4],
    row: [f64; 6],
    has_colors: bool,
    has_texture_numbers: bool,
    palette: Palette,
    texture_of_triangle: Vec<u32>,
}

const FACE_SLOT_NAMES: [&[&str]; 5] = [
    &["red", "diffuse_red", "r"],
    &["green", "diffuse_green", "g"],
    &["blue", "diffuse_blue", "b"],
    &["alpha", "diffuse_alpha", "a"],
    &["texnumber"],
];
const TEXTURE_NUMBER_SLOT: usize = 4;
const UNUSED_SLOT: usize = 5;

impl FaceColors {
    pub fn new(element: &Element) -> Self {
        let found = FACE_SLOT_NAMES.map(|names| scalar_property(element, names));
        let mut slot_of_property = vec![UNUSED_SLOT; element.properties.len()];
        for (slot, (property, _)) in
            found.iter().enumerate().filter_map(|(slot, found)| Some((slot, (*found)?)))
        {
            slot_of_property[property] = slot;
        }
        let [red, green, blue, alpha, texture_number] = found;
        let scale =
            [red, green, blue, alpha].map(|found| found.map_or(1.0, |(_, scalar)| byte_scale(scalar)));
        Self {
            slot_of_property,
            scale,
            row: [0.0; 6],
            has_colors: red.is_some() && green.is_some() && blue.is_some(),
            has_texture_numbers: texture_number.is_some(),
            palette: Palette::default(),
            texture_of_triangle: Vec::new(),
        }
    }

    #[inline]
    pub fn take(&mut self, property: usize, number: f64) {
        self.row[self.slot_of_property[property]] = number;
    }

    pub fn end_face(&mut self, triangles: usize) {
        if self.has_colors {
            let [r, g, b] = [0, 1, 2].map(|slot: usize| (self.row[slot] * self.scale[slot]).round() as u8);
            self.palette.add([r, g, b, 255], triangles);
        }
        if self.has_texture_numbers {
            let length = self.texture_of_triangle.len() + triangles;
            // What is negative, or no number at all, becomes zero.
            self.texture_of_triangle.resize(length, self.row[TEXTURE_NUMBER_SLOT] as u32);
        }
    }
}

impl Look {
    pub fn begin_face(&mut self) {
        self.face_values.clear();
    }

    /// The face has become the triangles from `triangles_before` on, as a fan.
    pub fn end_face(&mut self, triangles_before: usize, triangles_now: usize) {
        if self.face_values.is_empty() && self.corner_uvs.is_empty() {
            return;
        }
        self.corner_uvs.resize(triangles_before, [Vec2::ZERO; 3]);
        let (pairs, _) = self.face_values.as_chunks::<2>();
        let uv = |corner: usize| pairs.get(corner).map_or(Vec2::ZERO, |&pair| Vec2::from_array(pair));
        let fan = (1..=triangles_now - triangles_before).map(|corner| [uv(0), uv(corner), uv(corner + 1)]);
        self.corner_uvs.extend(fan);
    }

    pub fn set_face_colors(&mut self, face_colors: FaceColors) {
        self.texture_of_triangle = face_colors.texture_of_triangle;
        self.face_colors = face_colors.has_colors.then_some(face_colors.palette);
    }

    /// A texture goes before colours, and the colours of vertices go before those of faces, which programs fill with white.
    pub fn paint(self, header: &Header, source: &Source<'_>, parsed: &mut Parsed) {
        let mut textures = Textures::new(source.find);
        let numbers = header.texture_files.iter().map(|name| textures.in_file(name)).collect();
        let is_textured = !textures.is_empty();
        let (textures, warnings) = textures.finish();
        parsed.warnings.extend(warnings);
        if is_textured {
            parsed.data.paint = Some(self.textured(numbers, textures, &parsed.data.triangles));
        } else if parsed.data.colors.is_none() {
            parsed.data.paint = self.face_colors.map(Palette::into_paint);
        }
    }

    fn textured(
        self,
        numbers: Vec<Option<u32>>,
        textures: Vec<std::sync::Arc<crate::photo::Pixels>>,
        triangles: &[[u32; 3]],
    ) -> Paint {
        let corner_uvs: Vec<[Vec2; 3]> = if self.corner_uvs.is_empty() {
            let uv = |vertex: u32| self.vertex_uvs.get(vertex as usize).copied().unwrap_or_default();
            triangles.iter().map(|corners| corners.map(uv)).collect()
        } else {
            self.corner_uvs
        };
        let last = numbers.len().saturating_sub(1) as u32;
        let mut material_of_triangle = self.texture_of_triangle;
        material_of_triangle.resize(triangles.len(), 0);
        material_of_triangle.iter_mut().for_each(|number| *number = (*number).min(last));
        let v_down = |uv: Vec2| Vec2::new(uv.x, 1.0 - uv.y);
        Paint {
            corner_uvs: corner_uvs.into_iter().map(|corners| corners.map(v_down)).collect(),
            material_of_triangle,
            materials: numbers
                .into_iter()
                .map(|texture| Material { texture, ..Material::default() })
                .collect(),
            textures,
        }
    }
}
