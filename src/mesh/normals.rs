//! Vertices as the GPU draws them: with a normal and a colour each, split where the surface has an edge.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use super::Mesh;
use super::painted::painted;
use super::weld::weld;

/// Faces that meet at a larger angle than this are shaded as two surfaces.
const CREASE_ANGLE_DEG: f32 = 40.0;

const WHITE: [u8; 4] = [255; 4];

/// A vertex in the `object` frame: millimetres, unit normal.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct ShadingVertex {
    pub position: [f32; 3],
    pub normal: [f32; 3],
    /// sRGB and alpha: the vertex colour times that of the material, to be multiplied by the texture's.
    pub color: [u8; 4],
    /// On the group's texture; (0, 0) is its top left corner. Zero where there is none.
    pub uv: [f32; 2],
}

/// Triangles for the GPU, three indices each: group by group, and within a group in the order of [`Mesh::triangles`].
#[derive(Debug, Clone, PartialEq)]
pub struct ShadingMesh {
    pub vertices: Vec<ShadingVertex>,
    pub indices: Vec<u32>,
    /// What is drawn at once: one group per texture that is shown, and one for all triangles without.
    pub groups: Vec<ShadingGroup>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShadingGroup {
    /// An index into the textures of [`Mesh::paint`].
    pub texture: Option<u32>,
    /// Within [`ShadingMesh::indices`].
    pub indices: Range<u32>,
}

/// The mesh with the file's normals, or else with computed ones: the mean over the faces around a place, weighted by the
/// angle at it, within each part of the fan that no crease cuts off.
///
/// Vertices are split further where a texture has a seam or the material changes.
pub fn shading_vertices(mesh: &Mesh) -> ShadingMesh {
    let plain = match mesh.normals() {
        Some(normals) => {
            let vertices =
                (0..normals.len()).map(|vertex| shading_vertex(mesh, vertex, normals[vertex])).collect();
            ShadingMesh::of_one_group(vertices, mesh.triangles().as_flattened().to_vec())
        }
        None => with_computed_normals(mesh),
    };
    match mesh.paint() {
        Some(paint) => painted(plain, paint),
        None => plain,
    }
}

impl ShadingMesh {
    fn of_one_group(vertices: Vec<ShadingVertex>, indices: Vec<u32>) -> Self {
        let groups = vec![ShadingGroup { texture: None, indices: 0..indices.len() as u32 }];
        Self { vertices, indices, groups }
    }
}

fn shading_vertex(mesh: &Mesh, vertex: usize, normal: Vec3) -> ShadingVertex {
    ShadingVertex {
        position: mesh.positions_mm()[vertex].to_array(),
        normal: normal.to_array(),
        color: mesh.colors().map_or(WHITE, |colors| colors[vertex]),
        uv: [0.0; 2],
    }
}

fn with_computed_normals(mesh: &Mesh) -> ShadingMesh {
    let (place_of_vertex, place_count) = weld(mesh.positions_mm());
    let fans = CornersByPlace::new(mesh, &place_of_vertex, place_count);
    let face_normals: Vec<Vec3> =
        mesh.triangles().iter().map(|&triangle| face_normal(mesh, triangle)).collect();
    let mut shading = ShadingMesh::of_one_group(
        Vec::with_capacity(mesh.positions_mm().len()),
        vec![0; mesh.triangles().len() * 3],
    );
    let mut fan = Fan::default();
    for place in 0..place_count {
        fan.shade(mesh, &face_normals, &place_of_vertex, fans.corners_at(place), &mut shading);
    }
    shading
}

/// Zero where the triangle has no area. In f64, for the product of tiny edges underflows an f32.
fn face_normal(mesh: &Mesh, triangle: [u32; 3]) -> Vec3 {
    let [a, b, c] = mesh.corners(triangle);
    (b - a).cross(c - a).normalize_or_zero().as_vec3()
}

/// The corners of all triangles, sorted by the place they are at. Corner `3 t + k` is the `k`th of triangle `t`.
struct CornersByPlace {
    start: Vec<u32>,
    corners: Vec<u32>,
}

impl CornersByPlace {
    fn new(mesh: &Mesh, place_of_vertex: &[u32], place_count: usize) -> Self {
        let vertices = mesh.triangles().as_flattened();
        let place = |vertex: u32| place_of_vertex[vertex as usize] as usize;
        // A counting sort: first how many, then where each place's begin, then each to its own.
        let mut start = vec![0_u32; place_count + 1];
        for &vertex in vertices {
            start[place(vertex)] += 1;
        }
        let mut end = 0;
        for count in &mut start {
            end += *count;
            *count = end;
        }
        let mut corners = vec![0; vertices.len()];
        for (corner, &vertex) in vertices.iter().enumerate().rev() {
            let slot = &mut start[place(vertex)];
            *slot -= 1;
            corners[*slot as usize] = corner as u32;
        }
        Self { start, corners }
    }

    fn corners_at(&self, place: usize) -> &[u32] {
        &self.corners[self.start[place] as usize..self.start[place + 1] as usize]
    }
}

#[derive(Debug, Clone, Copy)]
struct FanCorner {
    corner: u32,
    vertex: u32,
    normal: Vec3,
    /// The triangle's angle here.
    angle_rad: f32,
}

/// The triangles around one place, and which of them are shaded as one surface. Kept from place to place to save the
/// allocations.
#[derive(Debug, Default)]
struct Fan {
    corners: Vec<FanCorner>,
    /// Each triangle's two edges at this place: the place at the edge's other end, and the triangle's number in the fan.
    edges: Vec<(u32, u32)>,
    /// A forest over the fan: triangles of one surface lead to the same root.
    parent: Vec<u32>,
    normal_sums: Vec<Vec3>,
    /// Root, vertex of the file, number in the fan.
    order: Vec<(u32, u32, u32)>,
}

impl Fan {
    /// The vertices of one place.
    ///
    /// A call of its own, for a browser replaces hastily compiled WebAssembly by proper code from one call to the next only.
    #[inline(never)]
    fn shade(
        &mut self,
        mesh: &Mesh,
        face_normals: &[Vec3],
        place_of_vertex: &[u32],
        corners: &[u32],
        shading: &mut ShadingMesh,
    ) {
        self.gather(mesh, face_normals, corners);
        if let Some(vertex) = self.only_vertex() {
            self.emit_as_one(mesh, vertex, shading);
        } else {
            self.gather_edges(mesh, place_of_vertex);
            self.join_across_smooth_edges();
            self.emit(mesh, shading);
        }
    }

    fn gather(&mut self, mesh: &Mesh, face_normals: &[Vec3], corners: &[u32]) {
        self.corners.clear();
        for &corner in corners {
            let (triangle, k) = (corner as usize / 3, corner as usize % 3);
            let vertices = mesh.triangles()[triangle];
            let [at, to_next, to_previous] =
                [0, 1, 2].map(|step| mesh.positions_mm()[vertices[(k + step) % 3] as usize]);
            let angle_rad = (to_next - at).angle_between(to_previous - at);
            let angle_rad = if angle_rad.is_finite() { angle_rad } else { 0.0 };
            self.corners.push(FanCorner {
                corner,
                vertex: vertices[k],
                normal: face_normals[triangle],
                angle_rad,
            });
        }
    }

    /// The vertex of the file that all triangles share here, if they also face so much the same way that no two of them have
    /// a crease between them: of most meshes nearly every place. Whether they hang together is not asked then; parts that
    /// touch in a point and lie as flat as this are shaded as one.
    fn only_vertex(&self) -> Option<u32> {
        let first = self.corners.first()?;
        let smallest_cosine = (CREASE_ANGLE_DEG / 2.0).to_radians().cos();
        let is_alike = |corner: &FanCorner| {
            corner.vertex == first.vertex && corner.normal.dot(first.normal) >= smallest_cosine
        };
        self.corners.iter().all(is_alike).then_some(first.vertex)
    }

    fn emit_as_one(&self, mesh: &Mesh, vertex: u32, shading: &mut ShadingMesh) {
        let sum: Vec3 = self.corners.iter().map(|corner| corner.normal * corner.angle_rad).sum();
        let number = shading.vertices.len() as u32;
        shading.vertices.push(shading_vertex(mesh, vertex as usize, sum.normalize_or(Vec3::Z)));
        for corner in &self.corners {
            shading.indices[corner.corner as usize] = number;
        }
    }

    fn gather_edges(&mut self, mesh: &Mesh, place_of_vertex: &[u32]) {
        self.edges.clear();
        for (number, corner) in (0_u32..).zip(&self.corners) {
            let (triangle, k) = (corner.corner as usize / 3, corner.corner as usize % 3);
            let vertices = mesh.triangles()[triangle];
            for step in [1, 2] {
                let other_end = vertices[(k + step) % 3];
                self.edges.push((place_of_vertex[other_end as usize], number));
            }
        }
    }

    fn join_across_smooth_edges(&mut self) {
        let smallest_cosine = CREASE_ANGLE_DEG.to_radians().cos();
        self.parent.clear();
        self.parent.extend(0..self.corners.len() as u32);
        self.edges.sort_unstable();
        for pair in 0..self.edges.len().saturating_sub(1) {
            let ((end, a), (other_end, b)) = (self.edges[pair], self.edges[pair + 1]);
            let is_smooth =
                self.corners[a as usize].normal.dot(self.corners[b as usize].normal) >= smallest_cosine;
            if end == other_end && is_smooth {
                let (root_a, root_b) = (self.root(a), self.root(b));
                self.parent[root_a.max(root_b) as usize] = root_a.min(root_b);
            }
        }
    }

    fn root(&mut self, mut number: u32) -> u32 {
        while self.parent[number as usize] != number {
            let grandparent = self.parent[self.parent[number as usize] as usize];
            self.parent[number as usize] = grandparent;
            number = grandparent;
        }
        number
    }

    /// Makes one vertex for each surface and vertex of the file that meet here.
    fn emit(&mut self, mesh: &Mesh, shading: &mut ShadingMesh) {
        self.order.clear();
        self.normal_sums.clear();
        self.normal_sums.resize(self.corners.len(), Vec3::ZERO);
        for number in 0..self.corners.len() {
            let root = self.root(number as u32);
            let FanCorner { vertex, normal, angle_rad, .. } = self.corners[number];
            self.normal_sums[root as usize] += normal * angle_rad;
            self.order.push((root, vertex, number as u32));
        }
        self.order.sort_unstable();
        let mut previous = None;
        for &(root, vertex, number) in &self.order {
            if previous != Some((root, vertex)) {
                previous = Some((root, vertex));
                // A triangle without area has no normal and is not seen; any will do.
                let normal = self.normal_sums[root as usize].normalize_or(Vec3::Z);
                shading.vertices.push(shading_vertex(mesh, vertex as usize, normal));
            }
            shading.indices[self.corners[number as usize].corner as usize] =
                shading.vertices.len() as u32 - 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshData;
    use crate::mesh::test_shapes::{cube, sphere};

    #[test]
    fn a_cube_is_split_at_its_edges() {
        let shading = shading_vertices(&cube());
        assert_eq!((shading.vertices.len(), shading.indices.len()), (24, 36));
        for vertex in &shading.vertices {
            let normal = Vec3::from_array(vertex.normal);
            // One axis, the one that points away from the middle.
            assert_eq!(normal.abs().max_element(), 1.0);
            assert!(normal.dot(Vec3::from_array(vertex.position)) > 0.0);
        }
    }

    #[test]
    fn a_sphere_stays_whole_even_as_a_soup() {
        let whole = sphere(50.0, 24, 48);
        let soup = Mesh::new(MeshData {
            positions_mm: whole
                .triangles()
                .as_flattened()
                .iter()
                .map(|&i| whole.positions_mm()[i as usize])
                .collect(),
            triangles: (0..whole.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
            ..MeshData::default()
        })
        .unwrap();
        assert_eq!(shading_vertices(&whole).vertices.len(), whole.positions_mm().len());
        for vertex in shading_vertices(&soup).vertices {
            let radial = Vec3::from_array(vertex.position) / 50.0;
            // Facets of 7.5° and the asymmetry of their fan around the poles bound this.
            assert!(Vec3::from_array(vertex.normal).angle_between(radial) < 2.0_f32.to_radians());
        }
    }

    #[test]
    fn triangles_without_area_do_no_harm() {
        let mut data = MeshData { positions_mm: vec![Vec3::ZERO, Vec3::X, Vec3::Y], ..MeshData::default() };
        data.triangles = vec![[0, 1, 2], [0, 0, 1], [2, 2, 2]];
        let shading = shading_vertices(&Mesh::new(data).unwrap());
        assert_eq!(shading.indices.len(), 9);
        let first = shading.vertices[shading.indices[0] as usize];
        assert_eq!(first.normal, [0.0, 0.0, 1.0]);
    }

    #[test]
    fn a_fan_of_very_many_triangles_is_linear() {
        let count = 200_000_u32;
        let rim = (0..count).map(|i| Vec3::new((i as f32 * 3e-5).cos(), (i as f32 * 3e-5).sin(), 0.2));
        let mesh = Mesh::new(MeshData {
            positions_mm: std::iter::once(Vec3::ZERO).chain(rim).collect(),
            triangles: (1..count).map(|i| [0, i, i + 1]).collect(),
            ..MeshData::default()
        })
        .unwrap();
        assert_eq!(shading_vertices(&mesh).vertices.len(), count as usize + 1);
    }
}
