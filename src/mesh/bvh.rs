//! A tree of boxes over a mesh's triangles, for ray casts and nearest points.
//!
//! Triangles are sorted along a space-filling curve, and the tree follows the bits of their places on it (Lauterbach et al.,
//! *Fast BVH Construction on GPUs*, 2009). A tree that weighs the areas of boxes is cast through faster, but takes ten times
//! as long to build, and a mesh of a million triangles that was just dropped is waited for; casts are one a frame.

use bytemuck::{Pod, Zeroable};
use glam::{DAffine3, DVec3, UVec3, Vec3};

use super::Mesh;
use super::nearest::{SurfacePoint, box_distance_squared, on_triangle};
use super::ray_cast::{RayCaster, RayHit};
use crate::math::Ray;

const LARGEST_LEAF: usize = 4;
/// Of each axis, in a place on the curve.
const AXIS_BITS: u32 = 10;
/// A level for each bit of the curve, and for triangles at the same place one for each bit of their count.
const STACK_SIZE: usize = 3 * AXIS_BITS as usize + 32;

/// A tree of boxes over the triangles of one mesh, which it does not keep.
#[derive(Debug, Clone)]
pub struct Bvh {
    nodes: Vec<Node>,
    /// Triangle numbers, so ordered that each leaf's are side by side.
    triangles: Vec<u32>,
}

#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Node {
    min: Vec3,
    /// A leaf's first triangle, or an inner node's first child; the second one follows it.
    first: u32,
    max: Vec3,
    /// Zero for an inner node.
    triangle_count: u32,
}

#[derive(Debug, Clone, Copy)]
struct Box3 {
    min: Vec3,
    max: Vec3,
}

impl Box3 {
    const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    fn grow(&mut self, min: Vec3, max: Vec3) {
        self.min = self.min.min(min);
        self.max = self.max.max(max);
    }
}

impl Bvh {
    /// Builds the tree in O(n log n).
    pub fn build(mesh: &Mesh) -> Self {
        let places = sorted_places(mesh);
        // Leaves are half full or so.
        let mut nodes = Vec::with_capacity(places.len());
        nodes.push(leaf(0, places.len()));
        let mut pending = vec![0_usize];
        while let Some(node) = pending.pop() {
            if let Some(first_child) = part(&mut nodes, node, &places) {
                pending.extend([first_child, first_child + 1]);
            }
        }
        let mut tree = Self { nodes, triangles: places.into_iter().map(|place| place.triangle).collect() };
        tree.fit(mesh);
        tree
    }

    /// Draws the boxes around what is in them. Children come after their parents, so backwards every child is done first.
    fn fit(&mut self, mesh: &Mesh) {
        for number in (0..self.nodes.len()).rev() {
            let around = self.around(number, mesh);
            (self.nodes[number].min, self.nodes[number].max) = (around.min, around.max);
        }
    }

    /// The box around what is in a node whose children have theirs. A call of its own, as [`part`] is.
    #[inline(never)]
    fn around(&self, number: usize, mesh: &Mesh) -> Box3 {
        let node = self.nodes[number];
        let (first, count) = (node.first as usize, node.triangle_count as usize);
        let mut around = Box3::EMPTY;
        if count == 0 {
            self.nodes[first..first + 2].iter().for_each(|child| around.grow(child.min, child.max));
            return around;
        }
        for &triangle in &self.triangles[first..first + count] {
            for vertex in mesh.triangles()[triangle as usize] {
                let position = mesh.positions_mm()[vertex as usize];
                around.grow(position, position);
            }
        }
        around
    }

    /// The tree as bytes, to hand it from the worker that built it to the page: nodes, and the order of triangles.
    pub fn to_parts(&self) -> (&[u8], &[u32]) {
        (bytemuck::cast_slice(&self.nodes), &self.triangles)
    }

    /// The tree that [`Self::to_parts`] took apart, for the same mesh; `None` where the parts are not whole.
    pub fn from_parts(nodes: &[u8], triangles: Vec<u32>) -> Option<Self> {
        let nodes = bytemuck::allocation::pod_collect_to_vec::<u8, Node>(nodes);
        (!nodes.is_empty()).then_some(Self { nodes, triangles })
    }

    /// The tree of the mesh after a transform that keeps boxes boxes; `None` for any other. Exact, and a hundredth of the work
    /// of building it: a number rounds no farther than the larger one beside it.
    pub fn transformed(&self, transform: &DAffine3) -> Option<Self> {
        let columns = [transform.matrix3.x_axis, transform.matrix3.y_axis, transform.matrix3.z_axis];
        let is_aligned =
            |column: &DVec3| column.to_array().iter().filter(|number| **number != 0.0).count() == 1;
        if !columns.iter().all(is_aligned) {
            return None;
        }
        let moved = |corner: Vec3| transform.transform_point3(corner.as_dvec3()).as_vec3();
        let mut tree = self.clone();
        for node in &mut tree.nodes {
            let (a, b) = (moved(node.min), moved(node.max));
            (node.min, node.max) = (a.min(b), a.max(b));
        }
        Some(tree)
    }

    /// The nearest point of `mesh` on the ray, from either side. The mesh is the one that the tree was built for, the ray
    /// is in its frame. Of triangles at the same distance the one of the lowest number is hit.
    pub fn cast(&self, mesh: &Mesh, ray: &Ray) -> Option<RayHit> {
        let caster = RayCaster::new(ray);
        let mut nearest: Option<RayHit> = None;
        let mut stack = [0_u32; STACK_SIZE];
        let mut stack_length = 1;
        while stack_length > 0 {
            stack_length -= 1;
            let node = &self.nodes[stack[stack_length] as usize];
            let limit = nearest.map_or(f64::INFINITY, |hit| hit.distance_mm);
            if caster.box_entry(node.min, node.max).is_none_or(|entry| entry > limit) {
                continue;
            }
            if node.triangle_count > 0 {
                let first = node.first as usize;
                for &triangle in &self.triangles[first..first + node.triangle_count as usize] {
                    let corners = mesh.corners(mesh.triangles()[triangle as usize]);
                    if let Some(hit) =
                        caster.hit(corners, triangle).filter(|hit| hit.is_nearer_than(nearest.as_ref()))
                    {
                        nearest = Some(hit);
                    }
                }
            } else {
                let [left, right] = [node.first, node.first + 1];
                let entry = |child: u32| {
                    let node = &self.nodes[child as usize];
                    caster.box_entry(node.min, node.max).unwrap_or(f64::INFINITY)
                };
                // The nearer child goes on top, so that the farther one is often skipped.
                let far_and_near = if entry(left) <= entry(right) { [right, left] } else { [left, right] };
                for child in far_and_near {
                    stack[stack_length] = child;
                    stack_length += 1;
                }
            }
        }
        nearest
    }

    /// The point of `mesh` nearest to a place, if it is not farther away than `within_mm`. The mesh is the one that the tree
    /// was built for, the place is in its frame. Of several at one distance, any.
    pub fn nearest(&self, mesh: &Mesh, place: DVec3, within_mm: f64) -> Option<SurfacePoint> {
        let mut nearest: Option<SurfacePoint> = None;
        let mut least_squared = within_mm * within_mm;
        let mut stack = [(0.0, 0_u32); STACK_SIZE];
        let mut stack_length = 1;
        while stack_length > 0 {
            stack_length -= 1;
            let (distance_squared, node) = stack[stack_length];
            if distance_squared > least_squared {
                continue;
            }
            let node = &self.nodes[node as usize];
            if node.triangle_count > 0 {
                let first = node.first as usize;
                for &triangle in &self.triangles[first..first + node.triangle_count as usize] {
                    let point = on_triangle(mesh.corners(mesh.triangles()[triangle as usize]), place);
                    let distance_squared = point.distance_squared(place);
                    if distance_squared <= least_squared {
                        least_squared = distance_squared;
                        nearest =
                            Some(SurfacePoint { point, triangle, distance_mm: distance_squared.sqrt() });
                    }
                }
            } else {
                let mut children = [node.first, node.first + 1].map(|child| {
                    let bounds = &self.nodes[child as usize];
                    (box_distance_squared(bounds.min, bounds.max, place), child)
                });
                // The nearer child goes on top, so that the farther one is often skipped.
                if children[0].0 < children[1].0 {
                    children.swap(0, 1);
                }
                for child in children {
                    stack[stack_length] = child;
                    stack_length += 1;
                }
            }
        }
        nearest
    }
}

/// Without a box as yet.
fn leaf(start: usize, end: usize) -> Node {
    Node { min: Vec3::ZERO, first: start as u32, max: Vec3::ZERO, triangle_count: (end - start) as u32 }
}

/// Gives a node that is too large for a leaf two children, still as leaves; the number of the first.
///
/// A call of its own, for a browser replaces hastily compiled WebAssembly by proper code from one call to the next only.
#[inline(never)]
fn part(nodes: &mut Vec<Node>, node: usize, places: &[Place]) -> Option<usize> {
    let Node { first, triangle_count, .. } = nodes[node];
    let (start, end) = (first as usize, (first + triangle_count) as usize);
    if end - start <= LARGEST_LEAF {
        return None;
    }
    let middle = start + split(&places[start..end]);
    let first_child = nodes.len();
    nodes.push(leaf(start, middle));
    nodes.push(leaf(middle, end));
    (nodes[node].first, nodes[node].triangle_count) = (first_child as u32, 0);
    Some(first_child)
}

/// A triangle, and where its centre is on the curve.
#[derive(Debug, Clone, Copy, Default)]
struct Place {
    code: u32,
    triangle: u32,
}

/// The triangles in the order of the curve; those at one place in the order of their numbers.
fn sorted_places(mesh: &Mesh) -> Vec<Place> {
    // Three times the centre; the factor does not matter.
    let centers = mesh.triangles().iter().map(|corners| {
        let [a, b, c] = corners.map(|vertex| mesh.positions_mm()[vertex as usize]);
        a + b + c
    });
    let mut around = Box3::EMPTY;
    centers.clone().for_each(|center| around.grow(center, center));
    let cells = (1_u32 << AXIS_BITS) as f32;
    // Cells are cubes. A mesh whose centres coincide has one cell.
    let cells_per_unit = cells / (around.max - around.min).max_element().max(f32::MIN_POSITIVE);
    let code = |center: Vec3| {
        let cell = ((center - around.min) * cells_per_unit).min(Vec3::splat(cells - 1.0)).as_uvec3();
        interleaved(cell)
    };
    sorted((0_u32..).zip(centers).map(|(triangle, center)| Place { code: code(center), triangle }).collect())
}

/// The bits of the three numbers in turn (Morton order).
fn interleaved(cell: UVec3) -> u32 {
    let [x, y, z] = cell.to_array().map(spread);
    (x << 2) | (y << 1) | z
}

/// The number's lowest ten bits with two zeros before each. Every step moves half of each group up.
fn spread(number: u32) -> u32 {
    let number = number & 0x3ff;
    let number = (number | (number << 16)) & 0x0300_00ff;
    let number = (number | (number << 8)) & 0x0300_f00f;
    let number = (number | (number << 4)) & 0x030c_30c3;
    (number | (number << 2)) & 0x0924_9249
}

/// By code, a digit of ten bits at a time: several times as fast as by comparison.
fn sorted(mut places: Vec<Place>) -> Vec<Place> {
    const DIGIT_BITS: u32 = AXIS_BITS;
    let mut moved = vec![Place::default(); places.len()];
    for shift in [0, DIGIT_BITS, 2 * DIGIT_BITS] {
        let digit = |place: &Place| ((place.code >> shift) & ((1 << DIGIT_BITS) - 1)) as usize;
        let mut starts = [0_u32; 1 << DIGIT_BITS];
        places.iter().for_each(|place| starts[digit(place)] += 1);
        let mut before = 0;
        for start in &mut starts {
            (*start, before) = (before, before + *start);
        }
        for place in &places {
            let start = &mut starts[digit(place)];
            moved[*start as usize] = *place;
            *start += 1;
        }
        std::mem::swap(&mut places, &mut moved);
    }
    places
}

/// How many of the sorted places go to the left: those whose code lacks the first bit in which the codes differ, or else half.
fn split(places: &[Place]) -> usize {
    let (Some(first), Some(last)) = (places.first(), places.last()) else { return 0 };
    let differing = first.code ^ last.code;
    if differing == 0 {
        return places.len() / 2;
    }
    let bit = 1_u32 << differing.ilog2();
    places.partition_point(|place| place.code & bit == 0)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::mesh::MeshData;
    use crate::mesh::test_shapes::{cube, sphere};

    fn brute_force(mesh: &Mesh, ray: &Ray) -> Option<RayHit> {
        let caster = RayCaster::new(ray);
        let mut nearest = None;
        for (number, &triangle) in (0..).zip(mesh.triangles()) {
            if let Some(hit) =
                caster.hit(mesh.corners(triangle), number).filter(|hit| hit.is_nearer_than(nearest.as_ref()))
            {
                nearest = Some(hit);
            }
        }
        nearest
    }

    fn vector(range: f64) -> impl Strategy<Value = DVec3> {
        [-range..range, -range..range, -range..range].prop_map(DVec3::from_array)
    }

    fn soup() -> impl Strategy<Value = Mesh> {
        // Small whole coordinates bring coinciding, degenerate and axis-parallel triangles.
        let position = [-4_i8..5, -4_i8..5, -4_i8..5].prop_map(|p| Vec3::from_array(p.map(f32::from)));
        prop::collection::vec(position, 3..120).prop_map(|positions_mm| {
            let triangles =
                (0..positions_mm.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() }).unwrap()
        })
    }

    proptest! {
        #[test]
        fn a_cast_finds_what_brute_force_finds(mesh in soup(), origin in vector(6.0), target in vector(4.0)) {
            prop_assume!(origin.distance(target) > 1e-3);
            let bvh = Bvh::build(&mesh);
            let ray = Ray { origin, direction: (target - origin).normalize() };
            prop_assert_eq!(bvh.cast(&mesh, &ray), brute_force(&mesh, &ray));
            // Rays along an axis from whole coordinates run within the sides of boxes.
            let along_axis = Ray { origin: origin.round(), direction: DVec3::Y };
            prop_assert_eq!(bvh.cast(&mesh, &along_axis), brute_force(&mesh, &along_axis));
        }

        #[test]
        fn the_nearest_point_is_that_of_all_triangles(mesh in soup(), place in vector(8.0), within in 0.0..9.0) {
            let found = Bvh::build(&mesh).nearest(&mesh, place, within);
            let distances = mesh.triangles().iter().map(|&triangle| {
                let corners = mesh.corners(triangle);
                let nearest = on_triangle(corners, place);
                // A fine net over the triangle has no point that is nearer.
                for (u, v) in (0..=8).flat_map(|u| (0..=8 - u).map(move |v| (u, v))) {
                    let [a, b, c] = corners;
                    let on_net = a + (b - a) * (f64::from(u) / 8.0) + (c - a) * (f64::from(v) / 8.0);
                    assert!(nearest.distance(place) < on_net.distance(place) + 1e-9);
                }
                nearest.distance(place)
            });
            let least = distances.fold(f64::INFINITY, f64::min);
            prop_assert_eq!(found.is_some(), least <= within);
            // The same numbers in another order of triangles.
            prop_assert!(found.is_none_or(|found| (found.distance_mm - least).abs() < 1e-12));
        }

        #[test]
        fn no_ray_slips_into_a_sphere(from in vector(300.0), vertex in 0_usize..1000) {
            prop_assume!(from.length() > 60.0);
            let mesh = sphere(50.0, 16, 32);
            // Aimed at a vertex, so at edges and corners where a careless test leaves gaps; from inside the hull of the
            // front, the ray has to meet it.
            let target = mesh.positions_mm()[vertex % mesh.positions_mm().len()].as_dvec3() * 0.9;
            let ray = Ray { origin: from, direction: (target - from).normalize() };
            let hit = Bvh::build(&mesh).cast(&mesh, &ray).expect("the target is inside");
            // 16 facets over a half circle: the inscribed sphere's radius is 50 cos(π/16)².
            prop_assert!(hit.point.length() > 48.0 && hit.point.length() < 50.0 + 1e-4);
            prop_assert!(ray.at(hit.distance_mm).distance(hit.point) < 1e-9);
        }
    }

    #[test]
    fn both_sides_are_hit_and_nothing_behind() {
        let mesh = cube();
        let bvh = Bvh::build(&mesh);
        let from_outside = Ray { origin: DVec3::new(0.25, 0.5, -5.0), direction: DVec3::Z };
        assert_eq!(bvh.cast(&mesh, &from_outside).unwrap().distance_mm, 4.0);
        let from_inside = Ray { origin: DVec3::new(0.25, 0.5, 0.0), direction: DVec3::Z };
        assert_eq!(bvh.cast(&mesh, &from_inside).unwrap().point, DVec3::new(0.25, 0.5, 1.0));
        let away = Ray { origin: DVec3::new(0.25, 0.5, 5.0), direction: DVec3::Z };
        assert_eq!(bvh.cast(&mesh, &away), None);
    }

    #[test]
    fn coinciding_triangles_do_not_deepen_the_tree() {
        let mesh = Mesh::new(MeshData {
            positions_mm: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            triangles: vec![[0, 1, 2]; 100_000],
            ..MeshData::default()
        })
        .unwrap();
        let ray = Ray { origin: DVec3::new(0.2, 0.2, 1.0), direction: DVec3::NEG_Z };
        assert_eq!(Bvh::build(&mesh).cast(&mesh, &ray).map(|hit| hit.triangle), Some(0));
    }
}
