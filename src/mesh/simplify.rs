//! A mesh of fewer triangles with the same outline, for solvers that look at it many times.
//!
//! Edge collapse by quadric error (Garland and Heckbert, *Surface Simplification Using Quadric Error Metrics*, 1997), each
//! new vertex held to the plane that leaves the volume as it was (Lindstrom and Turk, *Fast and Memory Efficient Polygonal
//! Simplification*, 1998): clustering vertices, or leaving some out, would make a round outline smaller.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::{DMat3, DVec3, Vec3};

use super::weld::weld;
use super::{Mesh, MeshData, PointTree};

/// The mesh with vertices at the same place made one, and at most about `max_triangles` triangles. Vertex colours are
/// those of the nearest vertex; materials are left out. So few are not always reached: a collapse that would fold the surface or change how it is connected is not
/// made. `None` where no triangle has three different corners.
pub fn simplified(mesh: &Mesh, max_triangles: usize) -> Option<Mesh> {
    let mut surface = Surface::new(mesh);
    let mut heap: BinaryHeap<Candidate> =
        surface.edges().filter_map(|edge| surface.candidate(edge)).collect();
    while surface.triangle_count > max_triangles {
        let Some(candidate) = heap.pop() else { break };
        let [kept, gone] = candidate.edge.map(|vertex| vertex as usize);
        let is_current =
            candidate.versions == [surface.vertices[kept].version, surface.vertices[gone].version];
        // The surroundings may have moved since: they say where the new vertex goes, and what it costs now.
        let Some(fresh) = surface.candidate(candidate.edge).filter(|_| is_current) else { continue };
        if fresh.cost > 1.5 * candidate.cost {
            heap.push(fresh);
            continue;
        }
        let candidate = fresh;
        if !surface.can_collapse(&candidate) {
            continue;
        }
        surface.collapse(&candidate);
        for neighbor in surface.neighbors(candidate.edge[0]) {
            heap.extend(surface.candidate([candidate.edge[0], neighbor]));
        }
    }
    with_colors_of(mesh, surface.into_mesh()?)
}

/// The mesh with the colour that the nearest vertex of `colored` has at each vertex, if it has any.
fn with_colors_of(colored: &Mesh, mesh: Mesh) -> Option<Mesh> {
    let Some(colors) = colored.colors() else { return Some(mesh) };
    let tree = PointTree::build(colored.positions_mm())?;
    let nearest = |position: &Vec3| colors.get(tree.nearest(position.as_dvec3())).copied();
    let colors = mesh.positions_mm().iter().map(nearest).collect();
    Mesh::new(MeshData { colors, ..mesh.data().clone() }).ok()
}

/// A symmetric quadratic function of a point: pᵀAp − 2bᵀp + c.
#[derive(Debug, Clone, Copy)]
struct Quadric {
    a: DMat3,
    b: DVec3,
    c: f64,
}

impl Quadric {
    const ZERO: Self = Self { a: DMat3::ZERO, b: DVec3::ZERO, c: 0.0 };

    /// The squared distance to a plane, times a weight.
    fn plane(normal: DVec3, point: DVec3, weight: f64) -> Self {
        let offset = normal.dot(point);
        let a = DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z) * weight;
        Self { a, b: normal * (offset * weight), c: offset * offset * weight }
    }

    fn plus(&self, other: &Self) -> Self {
        Self { a: self.a + other.a, b: self.b + other.b, c: self.c + other.c }
    }

    fn at(&self, point: DVec3) -> f64 {
        point.dot(self.a * point) - 2.0 * self.b.dot(point) + self.c
    }
}

#[derive(Debug, Clone)]
struct Vertex {
    position: DVec3,
    quadric: Quadric,
    /// Counts changes, so that candidates from before are known to be stale.
    version: u32,
    triangles: Vec<u32>,
}

/// An edge that may become a vertex at `position`. The second vertex of the edge goes.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    cost: f64,
    edge: [u32; 2],
    versions: [u32; 2],
    position: DVec3,
}

impl Ord for Candidate {
    /// The cheapest is the greatest: it comes out of the heap first. Ties go by number, so that results repeat.
    fn cmp(&self, other: &Self) -> Ordering {
        other.cost.total_cmp(&self.cost).then_with(|| other.edge.cmp(&self.edge))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

/// A mesh that can be changed.
struct Surface {
    origin: DVec3,
    vertices: Vec<Vertex>,
    /// `None` for those that collapsed.
    triangles: Vec<Option<[u32; 3]>>,
    triangle_count: usize,
}

/// How much more an open edge's own plane counts than a triangle: edges of holes keep their place.
const BORDER_WEIGHT: f64 = 10.0;
/// A collapse may turn a triangle by no more than about 75°.
const SMALLEST_COSINE: f64 = 0.25;

impl Surface {
    fn new(mesh: &Mesh) -> Self {
        let (place_of_vertex, place_count) = weld(mesh.positions_mm());
        let origin = mesh.bounds().center();
        let empty =
            Vertex { position: DVec3::ZERO, quadric: Quadric::ZERO, version: 0, triangles: Vec::new() };
        let mut vertices = vec![empty; place_count];
        for (&place, position) in place_of_vertex.iter().zip(mesh.positions_mm()) {
            vertices[place as usize].position = position.as_dvec3() - origin;
        }
        let mut triangles = Vec::with_capacity(mesh.triangles().len());
        for triangle in mesh.triangles() {
            let [a, b, c] = triangle.map(|vertex| place_of_vertex[vertex as usize]);
            if a != b && b != c && c != a {
                [a, b, c].iter().for_each(|&v| vertices[v as usize].triangles.push(triangles.len() as u32));
                triangles.push(Some([a, b, c]));
            }
        }
        let mut surface = Self { origin, triangle_count: triangles.len(), vertices, triangles };
        surface.add_quadrics();
        surface
    }

    fn add_quadrics(&mut self) {
        for number in 0..self.triangles.len() {
            let Some(triangle) = self.triangles[number] else { continue };
            let doubled = self.doubled_area(triangle);
            let area = doubled.length() / 2.0;
            let Some(normal) = doubled.try_normalize() else { continue };
            let plane = Quadric::plane(normal, self.position(triangle[0]), area / 3.0);
            for (k, from) in triangle.into_iter().enumerate() {
                self.add_quadric(from, &plane);
                let to = triangle[(k + 1) % 3];
                if self.triangles_at_edge([from, to]).count() == 1 {
                    let side = self.position(to) - self.position(from);
                    let Some(upright) = side.cross(normal).try_normalize() else { continue };
                    let border =
                        Quadric::plane(upright, self.position(from), BORDER_WEIGHT * side.length_squared());
                    self.add_quadric(from, &border);
                    self.add_quadric(to, &border);
                }
            }
        }
    }

    fn add_quadric(&mut self, vertex: u32, quadric: &Quadric) {
        let vertex = &mut self.vertices[vertex as usize];
        vertex.quadric = vertex.quadric.plus(quadric);
    }

    fn position(&self, vertex: u32) -> DVec3 {
        self.vertices[vertex as usize].position
    }

    fn doubled_area(&self, [a, b, c]: [u32; 3]) -> DVec3 {
        let a = self.position(a);
        (self.position(b) - a).cross(self.position(c) - a)
    }

    fn triangles_at(&self, vertex: u32) -> impl Iterator<Item = [u32; 3]> {
        self.vertices[vertex as usize].triangles.iter().filter_map(|&number| self.triangles[number as usize])
    }

    fn triangles_at_edge(&self, [from, to]: [u32; 2]) -> impl Iterator<Item = [u32; 3]> {
        self.triangles_at(from).filter(move |triangle| triangle.contains(&to))
    }

    fn neighbors(&self, vertex: u32) -> Vec<u32> {
        let mut neighbors: Vec<u32> =
            self.triangles_at(vertex).flatten().filter(|&other| other != vertex).collect();
        neighbors.sort_unstable();
        neighbors.dedup();
        neighbors
    }

    fn edges(&self) -> impl Iterator<Item = [u32; 2]> {
        (0..self.vertices.len() as u32).flat_map(|vertex| {
            self.neighbors(vertex)
                .into_iter()
                .filter(move |&other| other > vertex)
                .map(move |other| [vertex, other])
        })
    }

    /// What a collapse of this edge would cost, and where the new vertex would be.
    fn candidate(&self, edge: [u32; 2]) -> Option<Candidate> {
        let edge = [edge[0].min(edge[1]), edge[0].max(edge[1])];
        let [p, q] = edge.map(|vertex| self.position(vertex));
        let [a, b] = edge.map(|vertex| &self.vertices[vertex as usize]);
        let quadric = a.quadric.plus(&b.quadric);
        let middle = (p + q) / 2.0;
        let position = self.best_position(edge, &quadric, middle, p.distance(q));
        let cost = quadric.at(position).max(0.0) + 1e-9 * p.distance_squared(q);
        cost.is_finite().then_some(Candidate { cost, edge, versions: [a.version, b.version], position })
    }

    /// The lowest point of the quadric in the plane that keeps the volume.
    fn best_position(&self, edge: [u32; 2], quadric: &Quadric, middle: DVec3, length: f64) -> DVec3 {
        // Σ n·x = Σ n·v over the triangles around: the volume under them does not change.
        let around = self
            .triangles_at(edge[0])
            .chain(self.triangles_at(edge[1]).filter(|triangle| !triangle.contains(&edge[0])));
        let (normal, offset) = around.fold((DVec3::ZERO, 0.0), |(normal, offset), triangle| {
            let doubled = self.doubled_area(triangle);
            (normal + doubled, offset + doubled.dot(self.position(triangle[0])))
        });
        // A little pull to the middle settles what flat surroundings leave open.
        let trace = quadric.a.x_axis.x + quadric.a.y_axis.y + quadric.a.z_axis.z;
        let pull = 1e-6 * trace + f64::MIN_POSITIVE;
        let inverse = (quadric.a + DMat3::from_diagonal(DVec3::splat(pull))).inverse();
        let free = inverse * (quadric.b + middle * pull);
        let onto_plane = |point: DVec3, towards: DVec3| {
            point + towards * ((offset - normal.dot(point)) / normal.dot(towards))
        };
        // A new vertex far from its edge would be a spike: rather straight above or below the middle.
        let is_near = |point: &DVec3| point.distance(middle) <= length;
        let candidates = [onto_plane(free, inverse * normal), onto_plane(middle, normal), middle];
        candidates.into_iter().find(is_near).unwrap_or(middle)
    }

    /// Would the surface stay the same kind of surface, without folds?
    fn can_collapse(&self, candidate: &Candidate) -> bool {
        let [kept, gone] = candidate.edge;
        let at_edge = self.triangles_at_edge(candidate.edge).count();
        let of_gone = self.neighbors(gone);
        let shared = self.neighbors(kept).iter().filter(|other| of_gone.contains(other)).count();
        if !(1..=2).contains(&at_edge) || shared != at_edge {
            return false;
        }
        let turns_little = |vertex: u32, other: u32| {
            self.triangles_at(vertex).filter(|triangle| !triangle.contains(&other)).all(|triangle| {
                let before = self.doubled_area(triangle);
                let [a, b, c] =
                    triangle.map(|v| if v == vertex { candidate.position } else { self.position(v) });
                let after = (b - a).cross(c - a);
                after.dot(before) >= SMALLEST_COSINE * after.length() * before.length()
                    && after.length() > 1e-12 * before.length()
            })
        };
        turns_little(kept, gone) && turns_little(gone, kept)
    }

    fn collapse(&mut self, candidate: &Candidate) {
        let [kept, gone] = candidate.edge;
        let moved = std::mem::take(&mut self.vertices[gone as usize].triangles);
        for number in moved {
            let Some(triangle) = &mut self.triangles[number as usize] else { continue };
            if triangle.contains(&kept) {
                self.triangles[number as usize] = None;
                self.triangle_count -= 1;
            } else {
                triangle.iter_mut().filter(|v| **v == gone).for_each(|v| *v = kept);
                self.vertices[kept as usize].triangles.push(number);
            }
        }
        let gone_quadric = self.vertices[gone as usize].quadric;
        self.vertices[gone as usize].version += 1;
        let triangles = &self.triangles;
        let kept = &mut self.vertices[kept as usize];
        kept.triangles.retain(|&number| triangles[number as usize].is_some());
        kept.position = candidate.position;
        kept.quadric = kept.quadric.plus(&gone_quadric);
        kept.version += 1;
    }

    fn into_mesh(self) -> Option<Mesh> {
        let mut number_of: Vec<Option<u32>> = vec![None; self.vertices.len()];
        let mut positions_mm = Vec::new();
        let mut number = |vertex: u32| {
            *number_of[vertex as usize].get_or_insert_with(|| {
                positions_mm.push((self.vertices[vertex as usize].position + self.origin).as_vec3());
                positions_mm.len() as u32 - 1
            })
        };
        let triangles = self.triangles.iter().flatten().map(|triangle| triangle.map(&mut number)).collect();
        Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() }).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::mesh_edges;
    use crate::mesh::test_shapes::{cube, sphere};

    fn volume(mesh: &Mesh) -> f64 {
        let corners = mesh.triangles().iter().map(|&triangle| mesh.corners(triangle));
        corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    #[test]
    fn a_sphere_keeps_its_volume_and_its_roundness() {
        let fine = sphere(100.0, 100, 200);
        let coarse = simplified(&fine, 4000).unwrap();
        assert!((3900..=4000).contains(&coarse.triangles().len()), "{}", coarse.triangles().len());
        // Each collapse keeps the volume exactly; what is left is f32.
        assert!(
            (volume(&coarse) / volume(&fine) - 1.0).abs() < 1e-5,
            "{} {}",
            volume(&coarse),
            volume(&fine)
        );
        for position in coarse.positions_mm() {
            // Facets of 4000 triangles have a sagitta of about 0.08 mm; corners lie outside by as much.
            assert!((position.length() - 100.0).abs() < 0.2, "{}", position.length());
        }
        assert!(mesh_edges(&coarse).features.is_empty());
    }

    #[test]
    fn the_edges_of_a_box_and_of_a_hole_stay() {
        // A cube cut into 12 · 4⁴ triangles in the planes of its faces.
        let mut fine = cube();
        for _ in 0..4 {
            fine = split_in_four(&fine);
        }
        let coarse = simplified(&fine, 100).unwrap();
        assert!((volume(&coarse) - 8.0).abs() < 1e-4);
        let size = coarse.bounds().size();
        assert!((size - DVec3::splat(2.0)).abs().max_element() < 1e-5, "{size}");

        let mut open = fine.data().clone();
        open.triangles.retain(|triangle| triangle.iter().any(|&v| fine.positions_mm()[v as usize].z < 1.0));
        let open = simplified(&Mesh::new(open).unwrap(), 100).unwrap();
        let size = open.bounds().size();
        // The rim may be cut into the corners by a little, but it stays where it is.
        assert!((size - DVec3::splat(2.0)).abs().max_element() < 0.02, "{size}");
    }

    fn split_in_four(mesh: &Mesh) -> Mesh {
        let mut positions_mm = mesh.positions_mm().to_vec();
        let mut triangles = Vec::new();
        for &[a, b, c] in mesh.triangles() {
            let mut middle = |u: u32, v: u32| {
                positions_mm.push((positions_mm[u as usize] + positions_mm[v as usize]) / 2.0);
                positions_mm.len() as u32 - 1
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() }).unwrap()
    }

    #[test]
    fn what_is_small_enough_stays_and_what_is_broken_does_no_harm() {
        let same = simplified(&cube(), 12).unwrap();
        // Vertices may be numbered anew; whole numbers keep the volume exact.
        assert_eq!((same.triangles().len(), same.positions_mm().len(), volume(&same)), (12, 8, 8.0));
        // A fan of doubled and degenerate triangles: whatever comes out is a mesh.
        let positions_mm = (0..40).map(|i| glam::Vec3::new(i as f32 % 5.0, (i / 5) as f32, 0.0)).collect();
        let triangles = (0..200_u32).map(|i| [i % 40, i * 7 % 40, i * 13 % 40]).collect();
        let broken = Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() }).unwrap();
        let result = simplified(&broken, 10).unwrap();
        assert!(result.triangles().len() < 200);
    }
}
