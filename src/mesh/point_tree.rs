//! A k-d tree over points: which of them is nearest to a place, and which farthest, both exactly.

use glam::{DVec3, Vec3};

/// So few points are looked through one by one.
const LEAF_POINTS: usize = 8;

/// Bounds are rounded like everything else; a branch is left out only where it is worse by more than that.
const ROUNDING: f64 = 1.0 + 1e-12;

/// Points in the order of the tree, each with its number in the list that the tree was built from.
#[derive(Debug, Clone)]
pub struct PointTree {
    points: Vec<(DVec3, u32)>,
    nodes: Vec<Node>,
    /// Of the box around all points; radii and cones of nodes are about it.
    center: DVec3,
}

/// A box around some points, and the spherical shell sector about the tree's centre that holds them.
#[derive(Debug, Clone, Copy)]
struct Node {
    min: DVec3,
    max: DVec3,
    /// The largest distance from the centre.
    radius: f64,
    /// The middle direction from the centre, and the largest angle to it; π where the points are all around.
    axis: DVec3,
    half_angle: f64,
    first: u32,
    end: u32,
    /// Zero in a leaf. The first child follows its parent.
    second_child: u32,
}

impl PointTree {
    /// `None` for an empty list. At most 2³² points.
    pub fn build(points: &[Vec3]) -> Option<Self> {
        let points: Vec<(DVec3, u32)> =
            (0_u32..).zip(points).map(|(index, point)| (point.as_dvec3(), index)).collect();
        let (min, max) = box_around(&points)?;
        let mut tree = Self { points, nodes: Vec::new(), center: (min + max) * 0.5 };
        tree.add_node(0, tree.points.len());
        Some(tree)
    }

    fn add_node(&mut self, first: usize, end: usize) {
        let points = &mut self.points[first..end];
        let (min, max) = box_around(points).unwrap_or_default();
        let size = max - min;
        let at = self.nodes.len();
        let (axis, half_angle, radius) = sector(points, self.center);
        self.nodes.push(Node {
            min,
            max,
            radius,
            axis,
            half_angle,
            first: first as u32,
            end: end as u32,
            second_child: 0,
        });
        if points.len() <= LEAF_POINTS || size.max_element() == 0.0 {
            return;
        }
        let widest = size.max_position();
        let middle = points.len() / 2;
        points.select_nth_unstable_by(middle, |(a, _), (b, _)| a[widest].total_cmp(&b[widest]));
        self.add_node(first, first + middle);
        self.nodes[at].second_child = self.nodes.len() as u32;
        self.add_node(first + middle, end);
    }

    /// The number of the point nearest to `place`; of several at one distance, any.
    pub fn nearest(&self, place: DVec3) -> usize {
        let mut best = (f64::INFINITY, 0);
        self.search_nearest(0, place, &mut best);
        best.1 as usize
    }

    fn search_nearest(&self, node: usize, place: DVec3, best: &mut (f64, u32)) {
        let Node { first, end, second_child, .. } = self.nodes[node];
        if second_child == 0 {
            for &(point, index) in &self.points[first as usize..end as usize] {
                let distance = point.distance_squared(place);
                if distance < best.0 {
                    *best = (distance, index);
                }
            }
            return;
        }
        let mut children =
            [node + 1, second_child as usize].map(|child| (self.nodes[child].least(place), child));
        if children[1].0 < children[0].0 {
            children.swap(0, 1);
        }
        for (least, child) in children {
            if least <= best.0 * ROUNDING {
                self.search_nearest(child, place, best);
            }
        }
    }

    /// The largest distance between any two of the points.
    pub fn diameter(&self) -> f64 {
        let mut by_radius: Vec<DVec3> = self.points.iter().map(|(point, _)| *point).collect();
        by_radius.sort_by(|a, b| b.distance_squared(self.center).total_cmp(&a.distance_squared(self.center)));
        let largest_radius = self.nodes[0].radius;
        let mut best = 0.0_f64;
        for place in by_radius {
            let radius = place.distance(self.center);
            // Two points are no farther from one another than both from the centre together.
            if (radius + largest_radius).powi(2) * ROUNDING <= best {
                break;
            }
            self.search_farthest(0, place, radius, &mut best);
        }
        best.sqrt()
    }

    fn search_farthest(&self, node: usize, place: DVec3, radius: f64, best: &mut f64) {
        let Node { first, end, second_child, .. } = self.nodes[node];
        if second_child == 0 {
            for (point, _) in &self.points[first as usize..end as usize] {
                *best = best.max(point.distance_squared(place));
            }
            return;
        }
        let bound = |child: usize| self.nodes[child].most(place, self.center, radius);
        let mut children = [node + 1, second_child as usize].map(|child| (bound(child), child));
        if children[1].0 > children[0].0 {
            children.swap(0, 1);
        }
        for (most, child) in children {
            if most * ROUNDING > *best {
                self.search_farthest(child, place, radius, best);
            }
        }
    }
}

impl Node {
    /// No point of the box is nearer than this, squared.
    fn least(&self, place: DVec3) -> f64 {
        place.clamp(self.min, self.max).distance_squared(place)
    }

    /// No point of the node is farther than this, squared: by its box, and by its sector, which is the sharper one where
    /// all points are about equally far from the centre.
    fn most(&self, place: DVec3, center: DVec3, radius: f64) -> f64 {
        let by_box = (place - self.min).abs().max((place - self.max).abs()).length_squared();
        if radius == 0.0 {
            return by_box;
        }
        let away = (center - place) / radius;
        let angle = (away.dot(self.axis).clamp(-1.0, 1.0).acos() - self.half_angle).max(0.0);
        // |p − q|² for a q in the sector: convex in |q|, so largest at the rim or at the centre.
        let at_rim = self.radius * (self.radius + 2.0 * radius * angle.cos());
        let by_sector = radius * radius + at_rim.max(0.0);
        by_box.min(by_sector)
    }
}

fn box_around(points: &[(DVec3, u32)]) -> Option<(DVec3, DVec3)> {
    let (first, _) = points.first()?;
    Some(points.iter().fold((*first, *first), |(min, max), (point, _)| (min.min(*point), max.max(*point))))
}

/// Middle direction, largest angle to it, and largest distance of points from a centre.
fn sector(points: &[(DVec3, u32)], center: DVec3) -> (DVec3, f64, f64) {
    let radius = points.iter().map(|(point, _)| point.distance_squared(center)).fold(0.0, f64::max).sqrt();
    let sum: DVec3 = points.iter().map(|(point, _)| (*point - center).normalize_or_zero()).sum();
    let Some(axis) = sum.try_normalize() else { return (DVec3::Z, std::f64::consts::PI, radius) };
    let least_cosine =
        points.iter().map(|(point, _)| (*point - center).normalize_or_zero().dot(axis)).fold(1.0, f64::min);
    // acos loses half the digits near 1.
    (axis, least_cosine.acos() + 1e-7, radius)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The f64 of both ways differ by rounding alone.
    const ROUNDING_MM: f64 = 1e-9;

    fn all_pairs_diameter(points: &[Vec3]) -> f64 {
        let farthest =
            |a: &Vec3| points.iter().map(|b| b.as_dvec3().distance_squared(a.as_dvec3())).fold(0.0, f64::max);
        points.iter().map(farthest).fold(0.0, f64::max).sqrt()
    }

    fn check(points: &[Vec3], places: &[Vec3]) {
        let tree = PointTree::build(points).unwrap();
        assert!((tree.diameter() - all_pairs_diameter(points)).abs() < ROUNDING_MM);
        for place in places.iter().map(|place| place.as_dvec3()) {
            let found = points[tree.nearest(place)].as_dvec3().distance(place);
            let least = points.iter().map(|p| p.as_dvec3().distance(place)).fold(f64::INFINITY, f64::min);
            assert!((found - least).abs() < ROUNDING_MM, "{found} {least}");
        }
    }

    fn cloud(most: usize) -> impl Strategy<Value = Vec<Vec3>> {
        let point = [-90.0_f32..90.0, -90.0_f32..90.0, -20.0_f32..20.0].prop_map(Vec3::from_array);
        proptest::collection::vec(point, 1..most)
    }

    proptest! {
        #[test]
        fn nearest_and_farthest_are_those_of_all_pairs(points in cloud(300), places in cloud(20)) {
            check(&points, &places);
            // On a sphere every point is nearly as far from another one as can be: the hard case of the diameter.
            let on_sphere: Vec<Vec3> = points.iter().map(|p| p.normalize_or(Vec3::X) * 50.0).collect();
            check(&on_sphere, &places);
            // Whole numbers: many equal coordinates, many equal points.
            let rounded: Vec<Vec3> = points.iter().map(|p| (*p / 30.0).round()).collect();
            check(&rounded, &places);
        }
    }

    #[test]
    fn degenerate_clouds() {
        assert!(PointTree::build(&[]).is_none());
        check(&[Vec3::ONE], &[Vec3::ZERO]);
        check(&[Vec3::ONE; 50], &[Vec3::ZERO]);
        let line: Vec<Vec3> = (0..100).map(|i| Vec3::X * i as f32).collect();
        check(&line, &[Vec3::Y, Vec3::X * 44.4]);
    }

    #[test]
    fn a_sphere_of_a_hundred_thousand_points_is_no_hard_case() {
        let sphere = crate::mesh::test_shapes::sphere(50.0, 251, 401);
        let points = sphere.positions_mm();
        let start = web_time::Instant::now();
        let diameter = PointTree::build(points).unwrap().diameter();
        let duration = start.elapsed();
        println!("{} points: {diameter} mm in {duration:?}", points.len());
        // Odd counts: the poles are opposite, so the diameter is known.
        assert!((diameter - 100.0).abs() < 1e-5);
        // All pairs are 10¹⁰, a minute's work; this is a hundredth of it, in an unoptimised build too.
        assert!(duration.as_secs_f64() < 5.0, "{duration:?}");
    }
}
