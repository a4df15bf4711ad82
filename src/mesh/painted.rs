//! Gives shaded vertices the colours and texture coordinates of a mesh's paint.

use super::normals::{ShadingGroup, ShadingMesh, ShadingVertex};
use super::paint::{Paint, product};

/// As many variants of a vertex are compared with before another is made: a fan whose every triangle is painted
/// otherwise would take quadratic time.
const MOST_COMPARED: usize = 16;
const NONE: u32 = u32::MAX;

/// Splits vertices where texture coordinates or material colours differ, and sorts the triangles by texture. `plain`'s
/// triangles are in the order of the mesh's.
pub(super) fn painted(plain: ShadingMesh, paint: &Paint) -> ShadingMesh {
    let (order, groups) = triangles_by_texture(paint);
    let mut variants = Variants::new(&plain);
    let mut indices = Vec::with_capacity(plain.indices.len());
    for &triangle in &order {
        let triangle = triangle as usize;
        let base_color = paint.material(triangle).base_color;
        let uvs = paint.corner_uvs.get(triangle).copied().unwrap_or_default();
        for (corner, uv) in uvs.into_iter().enumerate() {
            let vertex = plain.indices[3 * triangle + corner];
            let unpainted = plain.vertices[vertex as usize];
            let color = product([unpainted.color, base_color]);
            indices
                .push(variants.find_or_add(vertex, ShadingVertex { color, uv: uv.to_array(), ..unpainted }));
        }
    }
    ShadingMesh { vertices: variants.vertices, indices, groups }
}

/// The triangles' numbers by a counting sort, those without texture first.
fn triangles_by_texture(paint: &Paint) -> (Vec<u32>, Vec<ShadingGroup>) {
    let bin_of = |triangle: usize| paint.material(triangle).texture.map_or(0, |texture| texture as usize + 1);
    let triangles = paint.material_of_triangle.len();
    let mut counts = vec![0_u32; paint.textures.len() + 1];
    for triangle in 0..triangles {
        counts[bin_of(triangle)] += 1;
    }
    let mut groups = Vec::new();
    let mut next_slot = Vec::with_capacity(counts.len());
    let mut start = 0;
    for (texture, &count) in (NONE..=NONE).chain(0..).zip(&counts) {
        next_slot.push(start);
        if count > 0 {
            let texture = Some(texture).filter(|&texture| texture != NONE);
            groups.push(ShadingGroup { texture, indices: 3 * start..3 * (start + count) });
        }
        start += count;
    }
    let mut order = vec![0; triangles];
    for triangle in 0..triangles {
        let slot = &mut next_slot[bin_of(triangle)];
        order[*slot as usize] = triangle as u32;
        *slot += 1;
    }
    (order, groups)
}

/// The painted vertices that came of each plain one, as linked lists.
struct Variants {
    vertices: Vec<ShadingVertex>,
    newest_of_plain: Vec<u32>,
    /// For each painted vertex the one made before it of the same plain one.
    older: Vec<u32>,
}

impl Variants {
    fn new(plain: &ShadingMesh) -> Self {
        let count = plain.vertices.len();
        Self {
            vertices: Vec::with_capacity(count),
            newest_of_plain: vec![NONE; count],
            older: Vec::with_capacity(count),
        }
    }

    fn find_or_add(&mut self, plain: u32, painted: ShadingVertex) -> u32 {
        let newest = self.newest_of_plain[plain as usize];
        let mut candidate = newest;
        for _ in 0..MOST_COMPARED {
            if candidate == NONE {
                break;
            }
            if self.vertices[candidate as usize] == painted {
                return candidate;
            }
            candidate = self.older[candidate as usize];
        }
        let number = self.vertices.len() as u32;
        self.vertices.push(painted);
        self.older.push(newest);
        self.newest_of_plain[plain as usize] = number;
        number
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{Vec2, Vec3};

    use super::*;
    use crate::mesh::{Material, Mesh, MeshData, shading_vertices};
    use crate::photo::Pixels;

    /// Two triangles of a square, in the plane.
    fn square(paint: Paint) -> Mesh {
        Mesh::new(MeshData {
            positions_mm: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            paint: Some(paint),
            ..MeshData::default()
        })
        .unwrap()
    }

    fn pixel() -> Arc<Pixels> {
        Arc::new(Pixels { width: 1, height: 1, rgba: vec![255; 4] })
    }

    #[test]
    fn vertices_are_split_only_at_seams() {
        let [a, b, c, d] = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
        let textured = |corner_uvs| Paint {
            corner_uvs,
            material_of_triangle: vec![0, 0],
            materials: vec![Material { texture: Some(0), ..Material::default() }],
            textures: vec![pixel()],
        };
        let whole = shading_vertices(&square(textured(vec![[a, b, c], [a, c, d]])));
        assert_eq!((whole.vertices.len(), whole.indices.as_slice()), (4, [0, 1, 2, 0, 2, 3].as_slice()));
        assert_eq!(whole.vertices[2].uv, [1.0, 1.0]);
        assert_eq!(whole.groups, [ShadingGroup { texture: Some(0), indices: 0..6 }]);
        let seam = shading_vertices(&square(textured(vec![[a, b, c], [b, c, d]])));
        assert_eq!(seam.vertices.len(), 5);
    }

    #[test]
    fn triangles_are_sorted_by_texture_and_colors_are_baked() {
        let paint = Paint {
            corner_uvs: vec![[Vec2::ZERO; 3]; 2],
            material_of_triangle: vec![1, 0],
            materials: vec![
                Material { base_color: [255, 0, 0, 255], texture: None },
                Material { texture: Some(0), ..Material::default() },
            ],
            textures: vec![pixel()],
        };
        let shading = shading_vertices(&square(paint));
        assert_eq!(
            shading.groups,
            [ShadingGroup { texture: None, indices: 0..3 }, ShadingGroup { texture: Some(0), indices: 3..6 },]
        );
        let of_first = shading.vertices[shading.indices[0] as usize];
        assert_eq!((of_first.color, of_first.position), ([255, 0, 0, 255], [0.0; 3]));
        assert_eq!(shading.vertices.len(), 6);
    }

    #[test]
    fn a_mirrored_mesh_keeps_its_texture_in_place() {
        let paint = Paint {
            corner_uvs: vec![[Vec2::ZERO, Vec2::X, Vec2::ONE], [Vec2::ZERO, Vec2::ONE, Vec2::Y]],
            material_of_triangle: vec![0, 0],
            materials: vec![Material { texture: Some(0), ..Material::default() }],
            textures: vec![pixel()],
        };
        let mesh = square(paint);
        let mirror = glam::DAffine3::from_scale(glam::DVec3::new(-1.0, 1.0, 1.0));
        let mirrored = mesh.transformed(&mirror).unwrap();
        for vertex in shading_vertices(&mirrored).vertices {
            assert_eq!(vertex.uv, [-vertex.position[0], vertex.position[1]]);
        }
        assert!(Arc::ptr_eq(&mirrored.paint().unwrap().textures[0], &mesh.paint().unwrap().textures[0]));
    }
}
