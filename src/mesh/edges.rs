//! The edges of a mesh: all of them, and those that a draughtsman would draw.

use glam::DVec3;

use super::Mesh;
use super::weld::weld;

/// Faces that meet at a larger angle than this have a visible edge between them.
const FEATURE_ANGLE_DEG: f64 = 30.0;

/// Edges as pairs of vertices. Vertices at the same place count as one, so each edge is here once, also where a file splits
/// its vertices.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeshEdges {
    pub all: Vec<[u32; 2]>,
    /// Creases of over 30°, open edges, and those where three faces or more meet.
    pub features: Vec<[u32; 2]>,
}

/// Finds a mesh's edges, in linear time but for the sorting around each vertex.
pub fn mesh_edges(mesh: &Mesh) -> MeshEdges {
    let (place_of_vertex, place_count) = weld(mesh.positions_mm());
    let sides = SidesByPlace::new(mesh, &place_of_vertex, place_count);
    let normals: Vec<DVec3> = mesh.triangles().iter().map(|&triangle| face_normal(mesh, triangle)).collect();
    let smallest_cosine = FEATURE_ANGLE_DEG.to_radians().cos();
    let mut edges = MeshEdges::default();
    let mut around: Vec<Side> = Vec::new();
    for place in 0..place_count {
        around.clear();
        around.extend_from_slice(sides.from(place));
        around.sort_unstable_by_key(|side| (side.end_place, side.triangle));
        for side_group in around.chunk_by(|a, b| a.end_place == b.end_place) {
            let edge = side_group[0].vertices;
            edges.all.push(edge);
            if is_feature(side_group, &normals, smallest_cosine) {
                edges.features.push(edge);
            }
        }
    }
    edges
}

/// Zero where the triangle has no area.
fn face_normal(mesh: &Mesh, triangle: [u32; 3]) -> DVec3 {
    let [a, b, c] = mesh.corners(triangle);
    (b - a).cross(c - a).normalize_or_zero()
}

fn is_feature(sides: &[Side], normals: &[DVec3], smallest_cosine: f64) -> bool {
    let [first, second] = sides else { return true };
    let [a, b] = [first, second].map(|side| normals[side.triangle as usize]);
    // A triangle without area, as triangulations leave them, has no direction to differ in.
    if a == DVec3::ZERO || b == DVec3::ZERO {
        return false;
    }
    // Two faces that go along their edge the same way are turned against each other, as in scans that were patched.
    let cosine = if first.is_reversed == second.is_reversed { -a.dot(b) } else { a.dot(b) };
    cosine < smallest_cosine
}

/// A triangle's side, seen from the one of its ends whose place has the lower number.
#[derive(Debug, Clone, Copy, Default)]
struct Side {
    end_place: u32,
    triangle: u32,
    vertices: [u32; 2],
    is_reversed: bool,
}

/// The sides of all triangles, sorted by the place that they are seen from.
struct SidesByPlace {
    start: Vec<u32>,
    sides: Vec<Side>,
}

impl SidesByPlace {
    fn new(mesh: &Mesh, place_of_vertex: &[u32], place_count: usize) -> Self {
        // A counting sort: first how many, then where each place's begin, then each to its own.
        let mut start = vec![0_u32; place_count + 1];
        for_each_side(mesh, place_of_vertex, |place, _| start[place as usize] += 1);
        let mut end = 0;
        for count in &mut start {
            end += *count;
            *count = end;
        }
        let mut sides = vec![Side::default(); end as usize];
        for_each_side(mesh, place_of_vertex, |place, side| {
            let slot = &mut start[place as usize];
            *slot -= 1;
            sides[*slot as usize] = side;
        });
        Self { start, sides }
    }

    fn from(&self, place: usize) -> &[Side] {
        &self.sides[self.start[place] as usize..self.start[place + 1] as usize]
    }
}

fn for_each_side(mesh: &Mesh, place_of_vertex: &[u32], mut take: impl FnMut(u32, Side)) {
    for (number, triangle) in mesh.triangles().iter().enumerate() {
        for k in 0..3 {
            let vertices = [triangle[k], triangle[(k + 1) % 3]];
            let [from, to] = vertices.map(|vertex| place_of_vertex[vertex as usize]);
            // A side without length is no edge.
            if from == to {
                continue;
            }
            let side =
                Side { end_place: from.max(to), triangle: number as u32, vertices, is_reversed: from > to };
            take(from.min(to), side);
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::mesh::MeshData;
    use crate::mesh::test_shapes::{cube, sphere};

    fn mesh(positions_mm: &[[f32; 3]], triangles: &[[u32; 3]]) -> Mesh {
        Mesh::new(MeshData {
            positions_mm: positions_mm.iter().map(|&position| Vec3::from_array(position)).collect(),
            triangles: triangles.to_vec(),
            ..MeshData::default()
        })
        .unwrap()
    }

    #[test]
    fn a_cube_has_twelve_edges_and_six_diagonals() {
        let edges = mesh_edges(&cube());
        assert_eq!((edges.all.len(), edges.features.len()), (18, 12));
        let cube = cube();
        for edge in edges.features {
            let [a, b] = edge.map(|vertex| cube.positions_mm()[vertex as usize]);
            assert_eq!(a.distance(b), 2.0);
        }
    }

    #[test]
    fn a_fine_sphere_has_no_features_also_as_a_soup() {
        let whole = sphere(50.0, 24, 48);
        let corners = whole.triangles().as_flattened();
        let soup = Mesh::new(MeshData {
            positions_mm: corners.iter().map(|&vertex| whole.positions_mm()[vertex as usize]).collect(),
            triangles: (0..whole.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
            ..MeshData::default()
        })
        .unwrap();
        // A closed surface has three edges for every two triangles.
        let expected = whole.triangles().len() * 3 / 2;
        for mesh in [whole, soup] {
            let edges = mesh_edges(&mesh);
            assert_eq!((edges.all.len(), edges.features.len()), (expected, 0));
        }
    }

    #[test]
    fn open_edges_and_edges_of_three_faces_are_features() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        let square = mesh(&corners, &[[0, 1, 2], [1, 3, 2]]);
        let edges = mesh_edges(&square);
        assert_eq!((edges.all.len(), edges.features.len()), (5, 4));
        let mut more = corners.to_vec();
        more.push([0.9, 0.9, 0.01]);
        let fin = mesh(&more, &[[0, 1, 2], [1, 3, 2], [1, 4, 2]]);
        assert_eq!(mesh_edges(&fin).features.len(), 7);
    }

    #[test]
    fn faces_turned_against_each_other_are_still_one_surface() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        let patched = mesh(&corners, &[[0, 1, 2], [1, 2, 3]]);
        assert_eq!(mesh_edges(&patched).features.len(), 4);
    }

    #[test]
    fn triangles_without_area_do_no_harm() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let degenerate = mesh(&corners, &[[0, 1, 2], [0, 0, 1], [2, 2, 2]]);
        assert_eq!(mesh_edges(&degenerate).all.len(), 3);
    }
}
