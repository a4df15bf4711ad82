//! Poses for four points and more, in general position or in a plane, without a start.
//!
//! The cost, the elimination of the translation and the starts are those of Terzakis and Lourakis (*A Consistently Fast and
//! Globally Optimal Solution to the Perspective-n-Point Problem*, 2020). From each start we go down on SO(3) itself with
//! Newton steps on the rotation vector instead of by sequential quadratic programming over nine constrained numbers.

use glam::{DMat3, DVec2, DVec3};

use super::super::least_squares::{Limits, NormalEquations, levenberg_marquardt};
use super::super::linear::{Matrix, symmetric_eigen};
use crate::math::{Pose, rotation_from_rotation_vector, sort_short};

/// A point of the object and the ray (x, y, 1) on which it is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sighting {
    pub point_mm: DVec3,
    pub normalized: DVec2,
    pub weight: f64,
}

/// Eigenvectors of the cost that are tried. The cost has rank 6 or more for points in general position and their null space
/// holds the solution; a plane adds three dimensions.
const STARTS: usize = 6;

/// The local minima of the sum of squared distances (weighted by depth) of points from their rays, the lowest first. Some
/// may be behind the camera.
pub fn sqpnp(sightings: &[Sighting]) -> Vec<Pose> {
    let Some(problem) = Problem::new(sightings) else { return Vec::new() };
    let (values, vectors) = symmetric_eigen(&problem.omega);
    let mut minima: Vec<(f64, DMat3)> = Vec::new();
    for (value, vector) in values.iter().zip(&vectors).take(STARTS) {
        // No rotation (of squared length 3) costs less than this in the space that is left. What is zero but for rounding
        // does not count: a plane has its solution and its mirror image behind the camera there.
        if minima.iter().any(|(cost, _)| cost + 1e-9 * values[8] < 3.0 * value) {
            break;
        }
        for sign in [1.0, -1.0] {
            let start = closest_rotation(&matrix_of(&vector.map(|x| x * sign)));
            let Some((cost, rotation)) = problem.descend(start) else { continue };
            if minima.iter().all(|(_, other)| !is_same(other, &rotation)) {
                minima.push((cost, rotation));
            }
        }
    }
    sort_short(&mut minima, |a, b| a.0.total_cmp(&b.0));
    minima.into_iter().map(|(_, rotation)| problem.pose(&rotation)).collect()
}

fn is_same(a: &DMat3, b: &DMat3) -> bool {
    a.abs_diff_eq(*b, 1e-5)
}

/// Rows one after the other.
fn matrix_of(rows: &[f64; 9]) -> DMat3 {
    DMat3::from_cols_array(rows).transpose()
}

/// The rotation closest to any matrix, also to one that mirrors or is singular.
fn closest_rotation(matrix: &DMat3) -> DMat3 {
    let (_, vectors) = symmetric_eigen(&(matrix.transpose() * *matrix).to_cols_array_2d());
    let [_, second, first] = vectors.map(DVec3::from_array);
    let u1 = (*matrix * first).try_normalize().unwrap_or(DVec3::X);
    let seen = *matrix * second;
    let u2 = (seen - u1 * u1.dot(seen)).try_normalize().unwrap_or_else(|| u1.any_orthonormal_vector());
    // The third pair of axes follows from the other two: that is what makes it a rotation.
    let u = DMat3::from_cols(u1, u2, u1.cross(u2));
    u * DMat3::from_cols(first, second, first.cross(second)).transpose()
}

/// The cost rᵀ Ω r of a rotation whose rows make up r, with the best translation for it.
struct Problem {
    omega: Matrix<9>,
    /// t = P r for points about their middle; three rows.
    translation: [[f64; 9]; 3],
    middle_mm: DVec3,
    size_mm: f64,
}

impl Problem {
    fn new(sightings: &[Sighting]) -> Option<Self> {
        let weight_sum: f64 = sightings.iter().map(|sighting| sighting.weight).sum();
        let middle_mm =
            sightings.iter().map(|sighting| sighting.point_mm * sighting.weight).sum::<DVec3>() / weight_sum;
        let size_mm =
            sightings.iter().map(|sighting| sighting.point_mm.distance(middle_mm)).fold(0.0, f64::max);
        if !(size_mm > 0.0 && size_mm.is_finite()) {
            return None;
        }
        // Points of size one, so that the numbers of the cost are alike.
        let scaled: Vec<(DVec3, DMat3)> = sightings
            .iter()
            .map(|sighting| ((sighting.point_mm - middle_mm) / size_mm, misfit_form(sighting)))
            .collect();
        let form_sum = scaled.iter().fold(DMat3::ZERO, |sum, (_, form)| sum + *form);
        let inverse = form_sum.inverse();
        if !inverse.is_finite() {
            return None;
        }
        let mut sum = [[0.0; 9]; 3];
        for (point, form) in &scaled {
            for (total, part) in
                sum.as_flattened_mut().iter_mut().zip(times_point(form, *point).as_flattened())
            {
                *total += part;
            }
        }
        let translation = [0, 1, 2].map(|row| {
            std::array::from_fn(|k| -(0..3).map(|i| inverse.col(i)[row] * sum[i][k]).sum::<f64>())
        });
        let omega = cost_matrix(&scaled, &translation);
        Some(Self { omega, translation, middle_mm, size_mm })
    }

    /// The rotation at the bottom of the valley that `start` is in, and its cost.
    fn descend(&self, start: DMat3) -> Option<(f64, DMat3)> {
        let limits = Limits { iterations: 30, relative_decrease: 1e-9, good_enough: 1e-28 };
        let moved = |rotation: &DMat3, step: &[f64; 3]| {
            rotation_from_rotation_vector(DVec3::from_array(*step)) * *rotation
        };
        let (rotation, equations) =
            levenberg_marquardt(start, limits, |rotation| Some(self.equations(rotation)), moved)?;
        Some((equations.cost, rotation))
    }

    fn equations(&self, rotation: &DMat3) -> NormalEquations<3> {
        let r = rotation.transpose().to_cols_array();
        let omega_r = self.omega.map(|row| row.iter().zip(&r).map(|(o, r)| o * r).sum::<f64>());
        // exp(ω) R moves each column of R by ω × it.
        let by_axis = DMat3::IDENTITY.to_cols_array_2d().map(|axis| {
            let axis = DVec3::from_array(axis);
            let [x, y, z] =
                [rotation.x_axis, rotation.y_axis, rotation.z_axis].map(|column| axis.cross(column));
            DMat3::from_cols(x, y, z).transpose().to_cols_array()
        });
        let dot = |a: &[f64; 9], b: &[f64; 9]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let omega_by_axis =
            by_axis.map(|j| self.omega.map(|row| row.iter().zip(&j).map(|(o, j)| o * j).sum::<f64>()));
        // The second derivative of exp(ω) R, ½ (ω ωᵀ − |ω|²) R, against Ω r: what makes these steps Newton's.
        let bend = *rotation * matrix_of(&omega_r).transpose();
        let bend = (bend + bend.transpose()) * 0.5;
        let trace = bend.x_axis.x + bend.y_axis.y + bend.z_axis.z;
        let mut equations = NormalEquations { cost: dot(&r, &omega_r), ..NormalEquations::ZERO };
        let curvature = (bend - DMat3::from_diagonal(DVec3::splat(trace))).to_cols_array_2d();
        equations.g = by_axis.map(|row| dot(&row, &omega_r));
        for ((h_row, row), curvature) in equations.h.iter_mut().zip(&by_axis).zip(curvature) {
            let columns = omega_by_axis.iter().zip(curvature);
            h_row
                .iter_mut()
                .zip(columns)
                .for_each(|(h, (column, curvature))| *h = dot(row, column) + curvature);
        }
        equations
    }

    fn pose(&self, rotation: &DMat3) -> Pose {
        let r = rotation.transpose().to_cols_array();
        let shift = self.translation.map(|row| row.iter().zip(&r).map(|(p, r)| p * r).sum::<f64>());
        Pose {
            rotation: *rotation,
            translation_mm: DVec3::from_array(shift) * self.size_mm - *rotation * self.middle_mm,
        }
    }
}

/// The Q of XᵀQX = weight · ((X − xZ)² + (Y − yZ)²).
fn misfit_form(sighting: &Sighting) -> DMat3 {
    let DVec2 { x, y } = sighting.normalized;
    let columns = [DVec3::new(1.0, 0.0, -x), DVec3::new(0.0, 1.0, -y), DVec3::new(-x, -y, x * x + y * y)];
    DMat3::from_cols(columns[0], columns[1], columns[2]) * sighting.weight
}

/// Q A, where A r = R p.
fn times_point(form: &DMat3, point: DVec3) -> [[f64; 9]; 3] {
    [0, 1, 2].map(|row| std::array::from_fn(|k| form.col(k / 3)[row] * point[k % 3]))
}

/// Ω = Σ (A + P)ᵀ Q (A + P).
fn cost_matrix(scaled: &[(DVec3, DMat3)], translation: &[[f64; 9]; 3]) -> Matrix<9> {
    let mut omega = [[0.0; 9]; 9];
    for (point, form) in scaled {
        let mut position = *translation;
        for k in 0..9 {
            position[k / 3][k] += point[k % 3];
        }
        let weighted: [[f64; 9]; 3] = [0, 1, 2]
            .map(|row| std::array::from_fn(|k| (0..3).map(|i| form.col(i)[row] * position[i][k]).sum()));
        for (i, omega_row) in omega.iter_mut().enumerate() {
            for (j, value) in omega_row.iter_mut().enumerate() {
                *value += (0..3).map(|row| position[row][i] * weighted[row][j]).sum::<f64>();
            }
        }
    }
    omega
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn vector(range: f64) -> impl Strategy<Value = DVec3> {
        [-range..range, -range..range, -range..range].prop_map(DVec3::from_array)
    }

    fn sightings(points: &[DVec3], pose: &Pose) -> Vec<Sighting> {
        let normalized = |point: DVec3| {
            let seen = pose.transform_point(point);
            seen.truncate() / seen.z
        };
        points
            .iter()
            .map(|&point| Sighting { point_mm: point, normalized: normalized(point), weight: 1.0 })
            .collect()
    }

    fn nearest(poses: &[Pose], pose: &Pose) -> f64 {
        poses.iter().map(|found| found.angle_to(pose)).fold(f64::INFINITY, f64::min)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]

        #[test]
        fn exact_points_give_the_exact_pose(
            points in prop::collection::vec(vector(80.0), 6..12), w in vector(1.8), v in vector(100.0),
        ) {
            let pose = Pose::exp(w, DVec3::ZERO).translated(v + DVec3::Z * 700.0);
            let spread = super::super::spread::Spread::of(&points).unwrap();
            prop_assume!(spread.sizes_mm[2] > 15.0);
            let found = sqpnp(&sightings(&points, &pose));
            // The descent ends when the cost, quadratic in the angle, falls by less than 1e-9 of it or is 1e-28.
            prop_assert!(nearest(&found[..1], &pose) < 1e-6, "{}", nearest(&found, &pose));
        }

        #[test]
        fn points_in_a_plane_give_the_exact_pose(
            points in prop::collection::vec(vector(80.0), 4..9), w in vector(1.8), v in vector(100.0),
        ) {
            let flat: Vec<DVec3> = points.iter().map(|point| DVec3::new(point.x, point.y, 20.0)).collect();
            let pose = Pose::exp(w, DVec3::ZERO).translated(v + DVec3::Z * 700.0);
            let spread = super::super::spread::Spread::of(&flat).unwrap();
            prop_assume!(spread.sizes_mm[1] > 20.0 && (pose.rotation.z_axis.z).abs() > 0.2);
            let found = sqpnp(&sightings(&flat, &pose));
            prop_assert!(nearest(&found, &pose) < 1e-5, "{}", nearest(&found, &pose));
        }
    }

    #[test]
    fn what_says_nothing_gives_nothing() {
        let one = Sighting { point_mm: DVec3::ONE, normalized: DVec2::ZERO, weight: 1.0 };
        assert!(sqpnp(&[one; 5]).is_empty());
        assert!(sqpnp(&[]).is_empty());
    }
}
