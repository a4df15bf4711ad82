//! Triangle meshes: one validated type, a loader per file format, shading normals and ray casts.
//!
//! This room knows nothing of photos, poses in a scene, or the GPU. Nothing here reads a file: loaders take bytes.

mod bvh;
mod coarse;
mod companions;
mod drawn;
mod edges;
mod error;
mod gltf;
mod load;
mod nearest;
mod normals;
mod obj;
mod off;
mod paint;
mod painted;
mod ply;
mod point_tree;
mod ray_cast;
mod search_tree;
mod simplify;
mod stl;
#[cfg(test)]
pub(crate) mod test_shapes;
mod text;
mod textures;
mod unit;
mod weld;
mod write;

use glam::{DAffine3, DVec3, Vec3};

use crate::math::{BoundingSphere, Bounds};

pub use bvh::Bvh;
pub use coarse::{CoarseMesh, coarse_mesh};
pub use companions::{FindCompanion, companion_key, companion_names, no_companions};
pub use drawn::{DrawnAhead, DrawnMesh};
pub use edges::{MeshEdges, mesh_edges};
pub use error::{Format, MeshError, Place};
pub use load::{LoadedMesh, load};
pub use nearest::SurfacePoint;
pub use normals::{ShadingGroup, ShadingMesh, ShadingVertex, shading_vertices};
pub use paint::{Material, Paint};
pub use point_tree::PointTree;
pub use ray_cast::RayHit;
pub use search_tree::SearchTree;
pub use simplify::simplified;
pub use textures::MAX_TEXTURE_SIDE_PX;
pub use unit::{FileUnit, MeshUnit, length_text};
pub use weld::weld;
pub use write::write_ply;

/// A mesh with more triangles, or more vertices, than this is refused: beyond it a browser tab runs out of memory.
pub const MAX_TRIANGLES: usize = 50_000_000;
pub const MAX_VERTICES: usize = 50_000_000;

/// Farther from its origin than this (a thousand kilometres) no object is; squares of it still fit an `f32`.
const MAX_COORDINATE_MM: f32 = 1e9;

/// What a mesh is made of, before anyone has checked it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeshData {
    pub positions_mm: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    /// One per vertex; any length but zero.
    pub normals: Option<Vec<Vec3>>,
    /// One per vertex: red, green, blue in sRGB, and alpha.
    pub colors: Option<Vec<[u8; 4]>>,
    /// Materials and textures.
    pub paint: Option<Paint>,
}

impl MeshData {
    /// For formats that do not say how a texture and vertex colours go together: programs write both, one made from the
    /// other, and the texture is the finer one.
    fn prefer_texture(&mut self) {
        if self.paint.as_ref().is_some_and(|paint| !paint.textures.is_empty()) {
            self.colors = None;
        }
    }
}

/// A triangle mesh in the `object` frame, in millimetres, that everything above can draw and measure without checking.
///
/// Every vertex of the file is here once, in the file's order, also those that no triangle names: metrics average over
/// the vertices, and results have to agree with other people's tools. Bounds are those of what can be seen, so of the
/// vertices that a triangle names. Triangles without area are kept: they draw nothing and no ray hits them.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    data: MeshData,
    bounds: Bounds,
    sphere: BoundingSphere,
    unreferenced_vertices: usize,
}

impl Mesh {
    /// Checks the parts: at least one triangle, indices in range, finite positions, attributes one per vertex.
    ///
    /// Normals are made unit length. If one that is drawn is zero or not finite, all of them are dropped: shading then
    /// computes its own, and half a set would show as spots.
    pub fn new(mut data: MeshData) -> Result<Self, MeshError> {
        check_counts(&data)?;
        check_positions(&data.positions_mm)?;
        let is_referenced = referenced(&data)?;
        let triangles = data.triangles.len();
        data.paint = data.paint.map(|paint| paint.checked(triangles)).transpose()?;
        data.normals = data.normals.and_then(|normals| usable_normals(normals, &is_referenced));

        let drawn_positions: Vec<Vec3> = data
            .positions_mm
            .iter()
            .zip(&is_referenced)
            .filter_map(|(&position, &is_referenced)| is_referenced.then_some(position))
            .collect();
        let vertices = data.positions_mm.len();
        let bounds = Bounds::of(&drawn_positions).ok_or(MeshError::NoFaces { vertices })?;
        let sphere = bounds.sphere_of(&drawn_positions);
        let unreferenced_vertices = vertices - drawn_positions.len();
        Ok(Self { data, bounds, sphere, unreferenced_vertices })
    }

    pub fn positions_mm(&self) -> &[Vec3] {
        &self.data.positions_mm
    }

    /// Vertex numbers, three per triangle, each in range.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.data.triangles
    }

    /// What the mesh is made of.
    pub fn data(&self) -> &MeshData {
        &self.data
    }

    /// Unit normals per vertex, if the file has usable ones.
    pub fn normals(&self) -> Option<&[Vec3]> {
        self.data.normals.as_deref()
    }

    /// sRGB and alpha per vertex.
    pub fn colors(&self) -> Option<&[[u8; 4]]> {
        self.data.colors.as_deref()
    }

    /// Materials and textures, if the file has any.
    pub fn paint(&self) -> Option<&Paint> {
        self.data.paint.as_ref()
    }

    /// Whether the file says of what colour the surface is; if not, it is drawn in a colour of the viewer's choice.
    pub fn has_colors(&self) -> bool {
        self.data.colors.is_some() || self.paint().is_some_and(Paint::has_colors)
    }

    /// The box around what is drawn.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The sphere around what is drawn, about the centre of its box.
    pub fn sphere(&self) -> BoundingSphere {
        self.sphere
    }

    /// Whether triangles turn the other way round than they should, seen from outside: many a program does not care. Of a
    /// sheet, which encloses nothing, it cannot be told.
    pub fn is_inside_out(&self) -> bool {
        const SMALLEST_PART: f64 = 1e-3;
        let (center, size) = (self.bounds().center(), self.bounds().size());
        let volume = |&triangle: &[u32; 3]| {
            let [a, b, c] = self.corners(triangle).map(|corner| corner - center);
            a.dot(b.cross(c)) / 6.0
        };
        let enclosed: f64 = self.triangles().iter().map(volume).sum();
        enclosed < -SMALLEST_PART * size.x * size.y * size.z
    }

    /// How many vertices no triangle names.
    pub fn unreferenced_vertices(&self) -> usize {
        self.unreferenced_vertices
    }

    /// The corners of a triangle that [`Self::triangles`] holds.
    pub fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|vertex| self.data.positions_mm[vertex as usize].as_dvec3())
    }

    /// The mesh after a change of unit, axes or spacing. Where the transform mirrors, the triangles are turned round, so
    /// that their front stays outside.
    pub fn transformed(&self, mesh_from_file: &DAffine3) -> Result<Self, MeshError> {
        let linear = mesh_from_file.matrix3;
        let normal_matrix = linear.inverse().transpose();
        let mut data = self.data.clone();
        for position in &mut data.positions_mm {
            *position = mesh_from_file.transform_point3(position.as_dvec3()).as_vec3();
        }
        for normal in data.normals.iter_mut().flatten() {
            *normal = (normal_matrix * normal.as_dvec3()).normalize_or_zero().as_vec3();
        }
        if linear.determinant() < 0.0 {
            for [_, b, c] in &mut data.triangles {
                std::mem::swap(b, c);
            }
            data.paint.iter_mut().for_each(Paint::mirror);
        }
        Self::new(data)
    }
}

fn check_counts(data: &MeshData) -> Result<(), MeshError> {
    let vertices = data.positions_mm.len();
    if data.triangles.is_empty() {
        return Err(MeshError::NoFaces { vertices });
    }
    if data.triangles.len() > MAX_TRIANGLES {
        return Err(MeshError::TooLarge { what: "triangles", limit: MAX_TRIANGLES });
    }
    if vertices > MAX_VERTICES {
        return Err(MeshError::TooLarge { what: "vertices", limit: MAX_VERTICES });
    }
    let normals = data.normals.as_ref().map(Vec::len);
    let colors = data.colors.as_ref().map(Vec::len);
    for (attribute, count) in [("normals", normals), ("colours", colors)] {
        if let Some(count) = count.filter(|&count| count != vertices) {
            return Err(MeshError::AttributeCount { attribute, count, vertices });
        }
    }
    Ok(())
}

fn check_positions(positions_mm: &[Vec3]) -> Result<(), MeshError> {
    let is_usable =
        |position: &Vec3| position.abs().max_element() <= MAX_COORDINATE_MM && position.is_finite();
    match positions_mm.iter().position(|position| !is_usable(position)) {
        Some(vertex) => Err(MeshError::BadPosition { vertex, position: positions_mm[vertex].to_array() }),
        None => Ok(()),
    }
}

/// Which vertices a triangle names.
fn referenced(data: &MeshData) -> Result<Vec<bool>, MeshError> {
    let vertices = data.positions_mm.len();
    let mut is_referenced = vec![false; vertices];
    for (triangle, corners) in data.triangles.iter().enumerate() {
        for &index in corners {
            *is_referenced.get_mut(index as usize).ok_or(MeshError::IndexOutOfRange {
                triangle,
                index,
                vertices,
            })? = true;
        }
    }
    Ok(is_referenced)
}

fn usable_normals(mut normals: Vec<Vec3>, is_referenced: &[bool]) -> Option<Vec<Vec3>> {
    for (normal, &is_referenced) in normals.iter_mut().zip(is_referenced) {
        // Files hold normals of every length, for instance weighted by area; f64 keeps the square from underflowing.
        let unit = normal.as_dvec3().normalize_or_zero().as_vec3();
        if is_referenced && unit == Vec3::ZERO {
            return None;
        }
        *normal = unit;
    }
    Some(normals)
}

#[cfg(test)]
mod tests {
    use glam::DMat3;

    use super::*;

    fn tetrahedron() -> MeshData {
        MeshData {
            positions_mm: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            ..MeshData::default()
        }
    }

    #[test]
    fn unreferenced_vertices_are_kept_but_not_bounded() {
        let mut data = tetrahedron();
        data.positions_mm.push(Vec3::splat(100.0));
        let mesh = Mesh::new(data).unwrap();
        assert_eq!((mesh.positions_mm().len(), mesh.unreferenced_vertices()), (5, 1));
        assert_eq!(mesh.bounds().max, DVec3::ONE);
        assert!((mesh.sphere().radius - 0.75_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn what_cannot_be_drawn_is_refused() {
        let refused = |change: &dyn Fn(&mut MeshData)| {
            let mut data = tetrahedron();
            change(&mut data);
            Mesh::new(data).unwrap_err()
        };
        let no_faces = refused(&|data| data.triangles.clear());
        assert_eq!(no_faces, MeshError::NoFaces { vertices: 4 });
        let out_of_range = refused(&|data| data.triangles[2][1] = 4);
        assert_eq!(out_of_range, MeshError::IndexOutOfRange { triangle: 2, index: 4, vertices: 4 });
        for bad in [f32::NAN, f32::INFINITY, 1e30] {
            let bad_position = refused(&|data| data.positions_mm[1].y = bad);
            assert!(matches!(bad_position, MeshError::BadPosition { vertex: 1, .. }), "{bad_position}");
        }
        let wrong_count = refused(&|data| data.colors = Some(vec![[0; 4]; 3]));
        assert!(matches!(wrong_count, MeshError::AttributeCount { count: 3, vertices: 4, .. }));
    }

    #[test]
    fn normals_are_made_unit_or_dropped() {
        let with_normals = |normals| Mesh::new(MeshData { normals: Some(normals), ..tetrahedron() }).unwrap();
        let scaled = with_normals(vec![Vec3::X * 5.0, Vec3::Y * 1e-30, Vec3::Z, Vec3::X]);
        assert_eq!(scaled.normals().unwrap()[..2], [Vec3::X, Vec3::Y]);
        assert_eq!(with_normals(vec![Vec3::X, Vec3::ZERO, Vec3::Z, Vec3::X]).normals(), None);
        assert_eq!(with_normals(vec![Vec3::X, Vec3::NAN, Vec3::Z, Vec3::X]).normals(), None);
    }

    #[test]
    fn a_mirrored_mesh_keeps_its_front_outside() {
        let mesh = Mesh::new(tetrahedron()).unwrap();
        let volume = |mesh: &Mesh| -> f64 {
            mesh.triangles()
                .iter()
                .map(|&triangle| {
                    let [a, b, c] = mesh.corners(triangle);
                    a.dot(b.cross(c)) / 6.0
                })
                .sum()
        };
        let mirror = DAffine3::from_mat3(DMat3::from_diagonal(DVec3::new(-2.0, 3.0, 4.0)));
        let mirrored = mesh.transformed(&mirror).unwrap();
        // Whole numbers: exact.
        assert_eq!(volume(&mirrored), 24.0 * volume(&mesh));
        assert_eq!(mirrored.bounds().min, DVec3::new(-2.0, 0.0, 0.0));
    }
}
