//! A coarser copy of a mesh of very many triangles, for pictures of things that move.
//!
//! Vertex clustering (Rossignac and Borrel, "Multi-resolution 3D approximations for rendering complex scenes", 1993): all
//! vertices within a cell of a grid become one, at their mean; triangles that collapse are gone. It is linear in time,
//! takes every mesh however broken, and moves no point farther than across a cell.

use glam::{DVec3, IVec3};
use rustc_hash::FxHashMap;

use super::{Mesh, MeshData, Paint};

/// Below so many triangles every GPU, also one in software, draws the mesh itself.
const FROM_TRIANGLES: usize = 150_000;

/// Cells along the largest side: a closed surface of any shape has some ten times their square of triangles at most.
const CELLS: f64 = 150.0;

#[derive(Debug, Clone, PartialEq)]
pub struct CoarseMesh {
    pub mesh: Mesh,
    /// The side of a cell.
    pub cell_mm: f64,
}

/// The copy; `None` where the mesh is small enough, or where little would be gained.
pub fn coarse_mesh(mesh: &Mesh) -> Option<CoarseMesh> {
    if mesh.triangles().len() < FROM_TRIANGLES {
        return None;
    }
    let cell_mm = mesh.bounds().size().max_element() / CELLS;
    if cell_mm <= 0.0 {
        return None;
    }
    let clusters = Clusters::new(mesh, cell_mm);
    let data = clusters.apply(mesh);
    // A mesh that hardly shrinks is a cloud of crumbs; drawing it coarser would show.
    if data.triangles.is_empty() || data.triangles.len() > mesh.triangles().len() / 2 {
        return None;
    }
    Some(CoarseMesh { mesh: Mesh::new(data).ok()?, cell_mm })
}

/// Which vertices become one.
struct Clusters {
    cluster_of_vertex: Vec<u32>,
    sums: Vec<DVec3>,
    counts: Vec<u32>,
    first_vertices: Vec<u32>,
}

impl Clusters {
    fn new(mesh: &Mesh, cell_mm: f64) -> Self {
        let origin = mesh.bounds().min;
        // The cells are our own grid's: nobody chose them to collide.
        let mut number_of_cell: FxHashMap<IVec3, u32> = FxHashMap::default();
        let mut clusters = Self {
            cluster_of_vertex: Vec::with_capacity(mesh.positions_mm().len()),
            sums: Vec::new(),
            counts: Vec::new(),
            first_vertices: Vec::new(),
        };
        for position in mesh.positions_mm() {
            let position = position.as_dvec3();
            let cell = ((position - origin) / cell_mm).floor().as_ivec3();
            let next = clusters.sums.len() as u32;
            clusters.add(position, *number_of_cell.entry(cell).or_insert(next));
        }
        clusters
    }

    /// Adds the next vertex to a cluster, which may be the next one.
    fn add(&mut self, position: DVec3, cluster: u32) {
        if cluster as usize == self.sums.len() {
            self.sums.push(DVec3::ZERO);
            self.counts.push(0);
            self.first_vertices.push(self.cluster_of_vertex.len() as u32);
        }
        self.sums[cluster as usize] += position;
        self.counts[cluster as usize] += 1;
        self.cluster_of_vertex.push(cluster);
    }

    /// The triangles that do not collapse, with their paint. Normals are computed anew from the coarser faces.
    fn apply(&self, mesh: &Mesh) -> MeshData {
        let triangles = mesh
            .triangles()
            .iter()
            .map(|triangle| triangle.map(|vertex| self.cluster_of_vertex[vertex as usize]));
        let kept: Vec<(usize, [u32; 3])> =
            triangles.enumerate().filter(|(_, [a, b, c])| a != b && b != c && c != a).collect();
        let mean = |(sum, &count): (&DVec3, &u32)| (*sum / f64::from(count)).as_vec3();
        let colors = mesh
            .colors()
            .map(|colors| self.first_vertices.iter().map(|&vertex| colors[vertex as usize]).collect());
        let paint = mesh.paint().map(|paint| Paint {
            corner_uvs: kept
                .iter()
                .filter_map(|(number, _)| paint.corner_uvs.get(*number).copied())
                .collect(),
            material_of_triangle: kept
                .iter()
                .map(|(number, _)| paint.material_of_triangle[*number])
                .collect(),
            ..paint.clone()
        });
        MeshData {
            positions_mm: self.sums.iter().zip(&self.counts).map(mean).collect(),
            triangles: kept.into_iter().map(|(_, triangle)| triangle).collect(),
            normals: None,
            colors,
            paint,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::test_shapes::{cube, sphere};

    #[test]
    fn small_meshes_are_left_as_they_are() {
        assert!(coarse_mesh(&cube()).is_none());
    }

    #[test]
    fn a_fine_sphere_stays_a_sphere_with_far_fewer_triangles() {
        let fine = sphere(100.0, 500, 1000);
        let coarse = coarse_mesh(&fine).unwrap();
        assert!(coarse.mesh.triangles().len() < fine.triangles().len() / 5);
        for position in coarse.mesh.positions_mm() {
            // The mean of points of a sphere within a cell, whose diagonal is √3 of its side, lies within it.
            let off_mm = f64::from((position.length() - 100.0).abs());
            assert!(off_mm <= coarse.cell_mm * 3.0_f64.sqrt(), "{off_mm} mm off");
        }
        // It is still closed: no open edge, which would show as a hole.
        let edges = crate::mesh::mesh_edges(&coarse.mesh);
        assert!(
            edges.features.len() < edges.all.len() / 20,
            "{} of {}",
            edges.features.len(),
            edges.all.len()
        );
    }
}
