//! The poses from which three points are seen in three given directions.
//!
//! Following Persson and Nordberg (*Lambda Twist*, 2018): the distances λ to the points satisfy three quadratic equations;
//! two homogeneous ones follow from them, and a degenerate member of their pencil, found by a cubic, falls into two planes.

use glam::{DMat3, DVec3};

use super::super::linear::symmetric_eigen;
use crate::math::Pose;

/// The poses, at most four, that put each of the points (`object` frame) on its ray: `directions` have length one, in the
/// `camera` frame. None where the points or the rays coincide or the points are on one line.
pub fn p3p(points_mm: [DVec3; 3], directions: [DVec3; 3]) -> Vec<Pose> {
    let [a, b, c] = points_mm;
    let squares = [(b - c).length_squared(), (a - c).length_squared(), (a - b).length_squared()];
    let scale = squares.iter().fold(0.0_f64, |max, &square| max.max(square));
    let doubled_area = (b - a).cross(c - a).length();
    if !(scale > 0.0 && scale.is_finite()) || doubled_area < 1e-9 * scale {
        return Vec::new();
    }
    let equations = Equations::new(squares.map(|square| square / scale), directions);
    let mut poses: Vec<Pose> = Vec::new();
    for distances in equations.solutions() {
        let seen = [0, 1, 2].map(|i| directions[i] * (distances[i] * scale.sqrt()));
        if let Some(pose) = aligned(points_mm, seen)
            && poses.iter().all(|other| differs(other, &pose))
        {
            poses.push(pose);
        }
    }
    poses
}

fn differs(a: &Pose, b: &Pose) -> bool {
    a.angle_to(b) > 1e-7 || a.translation_mm.distance(b.translation_mm) > 1e-6 * a.translation_mm.length()
}

/// The pose that takes one triangle to another of the same shape.
fn aligned(object: [DVec3; 3], camera: [DVec3; 3]) -> Option<Pose> {
    let axes = |[a, b, c]: [DVec3; 3]| {
        let x = (b - a).try_normalize()?;
        let z = (b - a).cross(c - a).try_normalize()?;
        Some(DMat3::from_cols(x, z.cross(x), z))
    };
    let rotation = axes(camera)? * axes(object)?.transpose();
    let middle = |points: [DVec3; 3]| points.into_iter().sum::<DVec3>() / 3.0;
    let pose = Pose { rotation, translation_mm: middle(camera) - rotation * middle(object) }.renormalized();
    (pose.rotation.is_finite() && pose.translation_mm.is_finite()).then_some(pose)
}

/// λᵀ Mᵢ λ = sᵢ: the law of cosines at the camera, for the side opposite point i.
struct Equations {
    forms: [DMat3; 3],
    squares: [f64; 3],
}

impl Equations {
    fn new(squares: [f64; 3], directions: [DVec3; 3]) -> Self {
        let forms = [[1, 2], [0, 2], [0, 1]].map(|[i, j]| {
            let mut form = DMat3::ZERO;
            form.col_mut(i)[i] = 1.0;
            form.col_mut(j)[j] = 1.0;
            let cosine = directions[i].dot(directions[j]);
            form.col_mut(i)[j] = -cosine;
            form.col_mut(j)[i] = -cosine;
            form
        });
        Self { forms, squares }
    }

    /// Distances to the three points, all positive.
    fn solutions(&self) -> Vec<DVec3> {
        let [m0, m1, m2] = self.forms;
        let [s0, s1, s2] = self.squares;
        let first = m2 * s0 - m0 * s2;
        let second = m1 * s0 - m0 * s1;
        // Each real pair of planes holds all solutions; the pair that is farthest from a double plane is the most exact.
        let pairs = degenerate_members(&first, &second).into_iter().filter_map(|[u, v]| {
            // Any other member of the pencil will do to meet the planes: the one at right angles to this.
            planes(&(first * u + second * v)).map(|planes| (planes, first * -v + second * u))
        });
        let Some((planes, other)) = pairs.max_by(|(a, _), (b, _)| a.apart.total_cmp(&b.apart)) else {
            return Vec::new();
        };
        let directions = planes.normals.into_iter().flat_map(|normal| common_directions(&other, normal));
        directions.filter_map(|direction| self.scaled(direction)).collect()
    }

    /// A direction of λ at its length, polished by Newton steps on the three equations; `None` where a distance is not
    /// positive.
    fn scaled(&self, direction: DVec3) -> Option<DVec3> {
        let direction = if direction.element_sum() < 0.0 { -direction } else { direction };
        let form_sum: f64 = self.forms.iter().map(|form| direction.dot(*form * direction)).sum();
        let length = (self.squares.iter().sum::<f64>() / form_sum).sqrt();
        let mut distances = direction * length;
        for _ in 0..3 {
            let gradients = self.forms.map(|form| form * distances);
            let misfit = DVec3::from_array([0, 1, 2].map(|i| distances.dot(gradients[i]) - self.squares[i]));
            let jacobian = DMat3::from_cols(gradients[0], gradients[1], gradients[2]).transpose() * 2.0;
            let step = jacobian.inverse() * misfit;
            // On the danger cylinder the Jacobian is singular: what the planes gave is then as good as it gets.
            if !step.is_finite() || step.length() > 0.1 * distances.length() {
                break;
            }
            distances -= step;
        }
        (distances.is_finite() && distances.min_element() > 1e-9).then_some(distances)
    }
}

/// The (u, v) of unit length with det(u A + v B) = 0: up to three.
fn degenerate_members(a: &DMat3, b: &DMat3) -> Vec<[f64; 2]> {
    let mixed = |m: &DMat3, n: &DMat3| {
        // tr(adj(m) n), column by column of n.
        let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
        n.x_axis.dot(y.cross(z)) + n.y_axis.dot(z.cross(x)) + n.z_axis.dot(x.cross(y))
    };
    let coefficients = [a.determinant(), mixed(a, b), mixed(b, a), b.determinant()];
    // With the larger end as the leading coefficient no root is at infinity.
    let [c0, c1, c2, c3] = coefficients;
    let pairs: Vec<[f64; 2]> = if c3.abs() >= c0.abs() {
        cubic_roots(c2 / c3, c1 / c3, c0 / c3).into_iter().map(|root| [1.0, root]).collect()
    } else {
        cubic_roots(c1 / c0, c2 / c0, c3 / c0).into_iter().map(|root| [root, 1.0]).collect()
    };
    pairs
        .into_iter()
        .map(|[u, v]| [u, v].map(|value| value / u.hypot(v)))
        .filter(|pair| pair.iter().all(|value| value.is_finite()))
        .collect()
}

/// The real roots of x³ + a x² + b x + c, in closed form, then polished.
fn cubic_roots(a: f64, b: f64, c: f64) -> Vec<f64> {
    let third = a / 3.0;
    let p = b / 3.0 - third * third;
    let q = third * (third * third - b / 2.0) + c / 2.0;
    let discriminant = q * q + p * p * p;
    let roots = if discriminant > 0.0 {
        let r = -q.signum() * (q.abs() + discriminant.sqrt()).cbrt();
        vec![r - p / r - third]
    } else if p == 0.0 {
        vec![-third]
    } else {
        let angle = (-q / (-p).powf(1.5)).clamp(-1.0, 1.0).acos();
        let turn = std::f64::consts::TAU / 3.0;
        [0.0, 1.0, 2.0].map(|k| 2.0 * (-p).sqrt() * (angle / 3.0 + k * turn).cos() - third).to_vec()
    };
    roots.into_iter().map(|root| polished(root, a, b, c)).filter(|root| root.is_finite()).collect()
}

fn polished(mut x: f64, a: f64, b: f64, c: f64) -> f64 {
    for _ in 0..3 {
        let value = c + x * (b + x * (a + x));
        let slope = b + x * (2.0 * a + 3.0 * x);
        let step = value / slope;
        if !step.is_finite() || step.abs() > 0.1 * x.abs().max(1e-3) {
            break;
        }
        x -= step;
    }
    x
}

struct Planes {
    normals: [DVec3; 2],
    /// Zero where they coincide.
    apart: f64,
}

/// The two planes that a degenerate form with one positive and one negative eigenvalue falls into.
fn planes(form: &DMat3) -> Option<Planes> {
    let ([negative, _, positive], vectors) = symmetric_eigen(&form.to_cols_array_2d());
    if !(negative < 0.0 && positive > 0.0) {
        return None;
    }
    let low = DVec3::from_array(vectors[0]) * (-negative).sqrt();
    let high = DVec3::from_array(vectors[2]) * positive.sqrt();
    let apart = positive.min(-negative) / positive.max(-negative);
    Some(Planes { normals: [high + low, high - low], apart })
}

/// The directions in a plane on which a quadratic form is zero: none, one or two.
fn common_directions(form: &DMat3, normal: DVec3) -> Vec<DVec3> {
    let Some(normal) = normal.try_normalize() else { return Vec::new() };
    let (u, v) = normal.any_orthonormal_pair();
    // uu c² + 2 uv c s + vv s² = 0 on the circle (c, s).
    let (uu, uv, vv) = (u.dot(*form * u), u.dot(*form * v), v.dot(*form * v));
    let size = uu.abs().max(uv.abs()).max(vv.abs());
    let discriminant = uv * uv - uu * vv;
    // Rounding makes a touching line miss.
    if discriminant < -1e-12 * size * size {
        return Vec::new();
    }
    // The root without cancellation and the other one from the product.
    let sum = -(uv + uv.signum() * discriminant.max(0.0).sqrt());
    [u * sum + v * uu, u * vv + v * sum].into_iter().filter(|d| d.length() > 1e-12 * size).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn vector(range: f64) -> impl Strategy<Value = DVec3> {
        [-range..range, -range..range, -range..range].prop_map(DVec3::from_array)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn the_pose_that_made_the_rays_is_among_the_solutions(
            points in [vector(80.0), vector(80.0), vector(80.0)],
            w in vector(1.8), v in vector(100.0),
        ) {
            let pose = Pose::exp(w, DVec3::ZERO).translated(v + DVec3::Z * 700.0);
            let area = (points[1] - points[0]).cross(points[2] - points[0]).length();
            prop_assume!(area > 500.0);
            let seen = points.map(|point| pose.transform_point(point));
            let poses = p3p(points, seen.map(DVec3::normalize));
            prop_assert!((1..=4).contains(&poses.len()), "{}", poses.len());
            for found in &poses {
                for (point, seen) in points.iter().zip(&seen) {
                    let off = found.transform_point(*point).normalize().distance(seen.normalize());
                    // Each solution puts the points on their rays, to the precision to which a double root is known.
                    prop_assert!(off < 1e-6, "{off}");
                }
            }
            let nearest = poses.iter().map(|found| found.angle_to(&pose)).fold(f64::INFINITY, f64::min);
            // Near the danger cylinder two solutions meet, and rounding of 1e-16 moves them by its root times a condition.
            prop_assert!(nearest < 1e-4, "{nearest}");
        }
    }

    #[test]
    fn a_triangle_seen_from_above_its_middle_has_four_poses() {
        // Equilateral: the classical case.
        let corner = |k: f64| {
            DVec3::new((k * std::f64::consts::TAU / 3.0).cos(), (k * std::f64::consts::TAU / 3.0).sin(), 0.0)
        };
        let points = [0.0, 1.0, 2.0].map(|k| corner(k) * 50.0);
        let pose = Pose::from_translation(DVec3::new(0.0, 0.0, 100.0));
        let poses = p3p(points, points.map(|point| pose.transform_point(point).normalize()));
        assert_eq!(poses.len(), 4);
    }

    #[test]
    fn degenerate_triangles_have_no_pose() {
        let directions =
            [DVec3::Z, DVec3::new(0.1, 0.0, 1.0).normalize(), DVec3::new(0.0, 0.1, 1.0).normalize()];
        assert!(p3p([DVec3::ZERO, DVec3::X, DVec3::X * 2.0], directions).is_empty());
        assert!(p3p([DVec3::ONE; 3], directions).is_empty());
        assert!(p3p([DVec3::ZERO, DVec3::X, DVec3::NAN], directions).is_empty());
    }
}
