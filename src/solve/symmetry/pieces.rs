//! Long thin triangles, cut into pieces for the search of nearest points.
//!
//! The boxes around the triangles of a fan lie over one another: a round cap of ten thousand has thousands of them at every
//! place. So corners that are next to each other become one, and what is still long and thin is cut across.

use glam::{DVec3, Vec3};

use crate::mesh::{Bvh, Mesh, MeshData, SurfacePoint, weld};

/// Corners within this part of the diameter are one: a fifth of what a symmetry may be off.
const SAME_PLACE: f64 = 2e-3;
/// A longest side of this part of the diameter is long.
const LONG: f64 = 1.0 / 64.0;
/// A side so many times as long as the triangle is high makes it thin.
const THIN: f64 = 8.0;
/// So few of them at one place are looked through as they are.
const FEW: usize = 1000;
/// As many pieces as a large mesh has triangles.
const MOST_PIECES: f64 = 300_000.0;

/// A surface as near to a mesh's as [`SAME_PLACE`] says.
pub struct Pieces {
    mesh: Mesh,
    tree: Bvh,
    /// Which triangle of the mesh a piece is of.
    whole: Vec<u32>,
}

impl Pieces {
    /// `None` for a mesh that is searched well as it is.
    pub fn of(mesh: &Mesh, diameter_mm: f64) -> Option<Self> {
        let long_mm = LONG * diameter_mm;
        let slivers = mesh.triangles().iter().filter(|triangle| is_sliver(mesh.corners(**triangle), long_mm));
        if slivers.count() <= FEW {
            return None;
        }
        let triangles = joined(mesh, SAME_PLACE * diameter_mm);
        let corners = |(triangle, _): &([u32; 3], u32)| mesh.corners(*triangle);
        let lengths =
            triangles.iter().map(corners).filter(|corners| is_sliver(*corners, long_mm)).map(longest_side);
        // Halving makes pieces of half the length and more.
        let piece_mm = long_mm.max(2.0 * lengths.sum::<f64>() / MOST_PIECES);
        let (mut positions_mm, mut whole) = (Vec::<Vec3>::new(), Vec::new());
        for triangle in &triangles {
            let mut pending = vec![corners(triangle)];
            while let Some(piece) = pending.pop() {
                if is_sliver(piece, piece_mm) {
                    pending.extend(halves(piece));
                } else {
                    positions_mm.extend(piece.map(DVec3::as_vec3));
                    whole.push(triangle.1);
                }
            }
        }
        let numbers = (0..whole.len() as u32).map(|piece| [0, 1, 2].map(|corner| 3 * piece + corner));
        let triangles = numbers.collect();
        let mesh = Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() }).ok()?;
        Some(Self { tree: Bvh::build(&mesh), mesh, whole })
    }

    /// As [`Bvh::nearest`], with the number of the whole triangle.
    pub fn nearest(&self, place: DVec3, within_mm: f64) -> Option<SurfacePoint> {
        let found = self.tree.nearest(&self.mesh, place, within_mm)?;
        Some(SurfacePoint { triangle: *self.whole.get(found.triangle as usize)?, ..found })
    }
}

/// The triangles that are left once corners that are next to each other are one, each with its number.
fn joined(mesh: &Mesh, within_mm: f64) -> Vec<([u32; 3], u32)> {
    let per_mm = 1.0 / within_mm;
    let cells: Vec<Vec3> =
        mesh.positions_mm().iter().map(|position| (position.as_dvec3() * per_mm).round().as_vec3()).collect();
    let (place_of_vertex, places) = weld(&cells);
    // The first vertex at each place stands for all: it is on the surface, as their middle need not be.
    let mut first = vec![u32::MAX; places];
    for (vertex, place) in (0_u32..).zip(&place_of_vertex) {
        if let Some(first) = first.get_mut(*place as usize) {
            *first = vertex.min(*first);
        }
    }
    let stands_for = |vertex: u32| first[place_of_vertex[vertex as usize] as usize];
    (0_u32..)
        .zip(mesh.triangles())
        .map(|(number, triangle)| (triangle.map(stands_for), number))
        .filter(|([a, b, c], _)| a != b && b != c && c != a)
        .collect()
}

fn is_sliver(corners: [DVec3; 3], long_mm: f64) -> bool {
    let [a, b, c] = corners;
    let longest = longest_side(corners);
    // Twice the area is the longest side times the height on it.
    longest > long_mm && longest * longest > THIN * (b - a).cross(c - a).length()
}

fn longest_side([a, b, c]: [DVec3; 3]) -> f64 {
    a.distance(b).max(b.distance(c)).max(c.distance(a))
}

/// Cut through the middle of the longest side.
fn halves([a, b, c]: [DVec3; 3]) -> [[DVec3; 3]; 2] {
    let sides = [[a, b, c], [b, c, a], [c, a, b]];
    let longest = |one: &[DVec3; 3], other: &[DVec3; 3]| {
        one[0].distance_squared(one[1]).total_cmp(&other[0].distance_squared(other[1]))
    };
    let [from, to, across] = sides.into_iter().max_by(longest).unwrap_or([a, b, c]);
    let middle = from.midpoint(to);
    [[from, middle, across], [middle, to, across]]
}
