//! Rigid transforms: SE(3) with its exponential and logarithm, and the way back onto SO(3).

use std::ops::Mul;

use glam::{DMat3, DMat4, DQuat, DVec3};
use thiserror::Error;

/// Below this ‖RᵀR − I‖ a rotation is taken as it is, bit for bit.
const ROTATION_TOLERANCE: f64 = 1e-9;

/// A proper rigid transform `a_from_b`: `point_in_a = rotation * point_in_b + translation_mm`.
///
/// The rotation is kept as a matrix, not as a quaternion, so that a pose read from a file is written back bit for bit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    pub rotation: DMat3,
    pub translation_mm: DVec3,
}

/// Why sixteen numbers are not a pose.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum PoseError {
    #[error("the matrix holds a number that is not finite")]
    NotFinite,
    #[error("the last row of the 4×4 matrix is not 0 0 0 1")]
    NotAffine,
    #[error("the rotation is singular or mirrored (determinant {0:.3}), no rotation is near it")]
    NotARotation(f64),
}

impl Default for Pose {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Pose {
    pub const IDENTITY: Self = Self { rotation: DMat3::IDENTITY, translation_mm: DVec3::ZERO };

    pub fn from_translation(translation_mm: DVec3) -> Self {
        Self { rotation: DMat3::IDENTITY, translation_mm }
    }

    /// The rotation `rotation` about the point `pivot`, which stays where it is.
    pub fn rotation_about(pivot: DVec3, rotation: DMat3) -> Self {
        Self { rotation, translation_mm: pivot - rotation * pivot }
    }

    /// Takes a rotation and a translation from outside. A rotation with ‖RᵀR − I‖ over 1e-9 is projected onto SO(3); the
    /// second value is that defect as it was found.
    pub fn from_parts(rotation: DMat3, translation_mm: DVec3) -> Result<(Self, f64), PoseError> {
        if !rotation.is_finite() || !translation_mm.is_finite() {
            return Err(PoseError::NotFinite);
        }
        let defect = rotation_defect(&rotation);
        let determinant = rotation.determinant();
        if defect <= ROTATION_TOLERANCE && determinant > 0.0 {
            return Ok((Self { rotation, translation_mm }, defect));
        }
        let rotation = nearest_rotation(&rotation).ok_or(PoseError::NotARotation(determinant))?;
        Ok((Self { rotation, translation_mm }, defect))
    }

    /// [`Self::from_parts`] of a row-major 4×4.
    pub fn from_rows(rows: &[[f64; 4]; 4]) -> Result<(Self, f64), PoseError> {
        let [x, y, z, last] = rows;
        if rows.iter().flatten().any(|value| !value.is_finite()) {
            return Err(PoseError::NotFinite);
        }
        if *last != [0.0, 0.0, 0.0, 1.0] {
            return Err(PoseError::NotAffine);
        }
        let rotation_transposed =
            DMat3::from_cols_array(&[x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]]);
        Self::from_parts(rotation_transposed.transpose(), DVec3::new(x[3], y[3], z[3]))
    }

    /// The matrix as a pose, if it is one to within `tolerance`; see [`Self::from_parts`] for what it bounds.
    pub fn from_mat4(matrix: &DMat4, tolerance: f64) -> Option<Self> {
        let rotation = DMat3::from_mat4(*matrix);
        let (pose, defect) = Self::from_parts(rotation, matrix.w_axis.truncate()).ok()?;
        (defect < tolerance).then_some(pose)
    }

    /// The row-major 4×4.
    pub fn to_rows(&self) -> [[f64; 4]; 4] {
        let [x, y, z] = self.rotation_rows();
        let t = self.translation_mm;
        [[x[0], x[1], x[2], t.x], [y[0], y[1], y[2], t.y], [z[0], z[1], z[2], t.z], [0.0, 0.0, 0.0, 1.0]]
    }

    /// The rotation, row by row.
    pub fn rotation_rows(&self) -> [[f64; 3]; 3] {
        self.rotation.transpose().to_cols_array_2d()
    }

    pub fn to_mat4(&self) -> DMat4 {
        DMat4::from_mat3_translation(self.rotation, self.translation_mm)
    }

    pub fn transform_point(&self, point: DVec3) -> DVec3 {
        self.rotation * point + self.translation_mm
    }

    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self { rotation, translation_mm: -(rotation * self.translation_mm) }
    }

    /// The same pose moved by `offset_mm` in the frame it leads to.
    pub fn translated(&self, offset_mm: DVec3) -> Self {
        Self { rotation: self.rotation, translation_mm: self.translation_mm + offset_mm }
    }

    /// Rounding errors of many products leave SO(3) slowly; this goes back onto it.
    pub fn renormalized(&self) -> Self {
        let rotation = nearest_rotation(&self.rotation).unwrap_or(self.rotation);
        Self { rotation, translation_mm: self.translation_mm }
    }

    /// The exponential of the twist (`rotation_vector`, `velocity`). Source: Barfoot, *State Estimation for Robotics*,
    /// section 7.1.3.
    pub fn exp(rotation_vector: DVec3, velocity_mm: DVec3) -> Self {
        let rotation = DMat3::from_quat(DQuat::from_scaled_axis(rotation_vector));
        Self { rotation, translation_mm: left_jacobian(rotation_vector) * velocity_mm }
    }

    /// The twist (`rotation_vector`, `velocity`) with `exp(log(pose)) = pose`, the angle in [0, π].
    pub fn log(&self) -> (DVec3, DVec3) {
        let quaternion = DQuat::from_mat3(&self.rotation).normalize();
        // q and −q are the same rotation; the one with w ≥ 0 has its angle in [0, π].
        let quaternion = if quaternion.w < 0.0 { -quaternion } else { quaternion };
        let rotation_vector = quaternion.to_scaled_axis();
        let velocity_mm = left_jacobian(rotation_vector).inverse() * self.translation_mm;
        (rotation_vector, velocity_mm)
    }

    /// A part of the way to another pose: the turn is even, the origin goes straight.
    pub fn towards(&self, other: &Self, part: f64) -> Self {
        let [from, to] = [self, other].map(|pose| DQuat::from_mat3(&pose.rotation).normalize());
        let rotation = DMat3::from_quat(from.slerp(to, part));
        Self { rotation, translation_mm: self.translation_mm.lerp(other.translation_mm, part) }
    }

    /// The angle in radians between the two rotations.
    pub fn angle_to(&self, other: &Self) -> f64 {
        let relative = DQuat::from_mat3(&(self.rotation.transpose() * other.rotation)).normalize();
        2.0 * relative.xyz().length().atan2(relative.w.abs())
    }
}

impl Mul for Pose {
    type Output = Self;

    /// `a_from_c = a_from_b * b_from_c`.
    fn mul(self, b_from_c: Self) -> Self {
        Self {
            rotation: self.rotation * b_from_c.rotation,
            translation_mm: self.transform_point(b_from_c.translation_mm),
        }
    }
}

/// How far a matrix is from orthonormal: the Frobenius norm of RᵀR − I.
pub fn rotation_defect(matrix: &DMat3) -> f64 {
    let excess = matrix.transpose() * *matrix - DMat3::IDENTITY;
    excess.to_cols_array().iter().map(|value| value * value).sum::<f64>().sqrt()
}

/// The rotation nearest to `matrix` in the Frobenius norm: the orthogonal factor of its polar decomposition, by the scaled
/// Newton iteration (Higham, *Computing the Polar Decomposition*, 1986). `None` where the matrix is singular or mirrors.
pub fn nearest_rotation(matrix: &DMat3) -> Option<DMat3> {
    if !matrix.is_finite() {
        return None;
    }
    let scale = matrix.to_cols_array().iter().fold(0.0_f64, |max, value| max.max(value.abs()));
    if scale == 0.0 {
        return None;
    }
    let mut rotation = *matrix * (1.0 / scale);
    if rotation.determinant() < 1e-9 {
        return None;
    }
    // The iteration converges quadratically; from any matrix that passed the test above, well within this count.
    for _ in 0..64 {
        let inverse_transposed = rotation.inverse().transpose();
        let balance = rotation.determinant().abs().powf(-1.0 / 3.0);
        let next = (rotation * balance + inverse_transposed * (1.0 / balance)) * 0.5;
        let step = (next - rotation).to_cols_array().iter().fold(0.0_f64, |max, d| max.max(d.abs()));
        rotation = next;
        if step < 1e-15 {
            break;
        }
    }
    rotation.is_finite().then_some(rotation)
}

/// The left Jacobian of SO(3): the integral of exp(s·ω) over s in [0, 1].
fn left_jacobian(rotation_vector: DVec3) -> DMat3 {
    let angle_squared = rotation_vector.length_squared();
    let angle = angle_squared.sqrt();
    let hat = skew(rotation_vector);
    // The series below an angle of 1e-3 keeps every digit that the closed form loses to cancellation there.
    let (first, second) = if angle < 1e-3 {
        (0.5 - angle_squared / 24.0, 1.0 / 6.0 - angle_squared / 120.0)
    } else {
        ((1.0 - angle.cos()) / angle_squared, (angle - angle.sin()) / (angle_squared * angle))
    };
    DMat3::IDENTITY + hat * first + hat * hat * second
}

fn skew(v: DVec3) -> DMat3 {
    DMat3::from_cols(DVec3::new(0.0, v.z, -v.y), DVec3::new(-v.z, 0.0, v.x), DVec3::new(v.y, -v.x, 0.0))
}

#[cfg(test)]
mod tests {
    #[test]
    fn half_the_way_is_half_the_turn() {
        let from = Pose::exp(DVec3::new(0.3, -0.2, 0.9), DVec3::ZERO);
        let to = Pose::exp(DVec3::new(-0.1, 0.4, 1.2), DVec3::ZERO).translated(DVec3::new(4.0, -8.0, 20.0));
        let half = from.towards(&to, 0.5);
        assert!((half.angle_to(&from) - half.angle_to(&to)).abs() < 1e-12);
        assert!((half.angle_to(&from) - 0.5 * from.angle_to(&to)).abs() < 1e-12);
        assert_eq!(half.translation_mm, DVec3::new(2.0, -4.0, 10.0));
        assert!(from.towards(&to, 1.0).angle_to(&to) < 1e-12);
    }

    use glam::Vec3Swizzles;
    use proptest::prelude::*;

    use super::*;

    fn vector(range: f64) -> impl Strategy<Value = DVec3> {
        [-range..range, -range..range, -range..range].prop_map(DVec3::from_array)
    }

    fn pose() -> impl Strategy<Value = Pose> {
        (vector(1.8), vector(2000.0)).prop_map(|(w, v)| Pose::exp(w, v))
    }

    /// f64 keeps 16 digits; a few products of numbers below 1e4 mm stay within this.
    const ROUNDING_MM: f64 = 1e-9;

    proptest! {
        #[test]
        fn log_undoes_exp(w in vector(1.8), v in vector(2000.0)) {
            let (rotation_vector, velocity) = Pose::exp(w, v).log();
            prop_assert!(rotation_vector.distance(w) < 1e-9);
            prop_assert!(velocity.distance(v) < 1e-6);
        }

        #[test]
        fn inverse_and_product_agree_with_points(a in pose(), b in pose(), p in vector(500.0)) {
            let there_and_back = a.inverse().transform_point(a.transform_point(p));
            prop_assert!(there_and_back.distance(p) < ROUNDING_MM);
            let in_two_steps = a.transform_point(b.transform_point(p));
            prop_assert!((a * b).transform_point(p).distance(in_two_steps) < ROUNDING_MM);
        }

        #[test]
        fn the_nearest_rotation_of_a_disturbed_one_is_proper_and_near(a in pose(), noise in vector(0.05)) {
            let disturbed = a.rotation + DMat3::from_cols(noise, noise.yzx() * 0.5, noise.zxy());
            let rotation = nearest_rotation(&disturbed).unwrap();
            prop_assert!(rotation_defect(&rotation) < 1e-13);
            prop_assert!(rotation.determinant() > 0.0);
            // The polar factor is the nearest one, so no farther than the rotation that was disturbed.
            let distance = |m: DMat3| (m - disturbed).to_cols_array().iter().map(|d| d * d).sum::<f64>();
            prop_assert!(distance(rotation) <= distance(a.rotation) + 1e-12);
        }

        #[test]
        fn rows_survive_bit_for_bit(a in pose()) {
            let (back, defect) = Pose::from_rows(&a.to_rows()).unwrap();
            prop_assert!(defect < ROTATION_TOLERANCE);
            prop_assert_eq!(back, a);
        }

        #[test]
        fn angles_are_those_of_the_rotation_vector(w in vector(1.8)) {
            let angle = Pose::IDENTITY.angle_to(&Pose::exp(w, DVec3::ZERO));
            let expected = if w.length() > std::f64::consts::PI { std::f64::consts::TAU - w.length() } else { w.length() };
            prop_assert!((angle - expected).abs() < 1e-9);
        }
    }

    #[test]
    fn a_mirror_a_singular_and_an_infinite_matrix_are_refused() {
        let mirror = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
        assert!(matches!(Pose::from_parts(mirror, DVec3::ZERO), Err(PoseError::NotARotation(_))));
        assert!(matches!(Pose::from_parts(DMat3::ZERO, DVec3::ZERO), Err(PoseError::NotARotation(_))));
        let infinite = DVec3::new(f64::INFINITY, 0.0, 0.0);
        assert_eq!(Pose::from_parts(DMat3::IDENTITY, infinite), Err(PoseError::NotFinite));
    }

    #[test]
    fn rotating_about_a_pivot_leaves_it_in_place() {
        let pivot = DVec3::new(10.0, -20.0, 900.0);
        let turn = Pose::rotation_about(pivot, DMat3::from_rotation_z(1.0));
        assert!(turn.transform_point(pivot).distance(pivot) < ROUNDING_MM);
    }
}
