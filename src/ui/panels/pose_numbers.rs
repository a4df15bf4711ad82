//! A pose as the numbers of one of its forms, and back.

use glam::{DQuat, DVec3};

use crate::math::{
    Pose, fixed_xyz_from_rotation, quaternion_from_rotation, rotation_from_fixed_xyz,
    rotation_from_quaternion, rotation_from_rotation_vector, rotation_vector_from_rotation,
};

/// In which form the numbers of a rotation are given.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RotationForm {
    #[default]
    Matrix,
    Euler,
    Quaternion,
    AxisAngle,
}

impl RotationForm {
    /// Each with its title and what it means.
    pub const ALL: [(Self, &'static str, &'static str); 4] = [
        (Self::Matrix, "Matrix", "The 4×4, row by row, as text"),
        (Self::Euler, "Euler xyz", "Angles about the fixed x, y, z axes: R = Rz·Ry·Rx (SciPy's \"xyz\")"),
        (Self::Quaternion, "Quaternion", "w x y z; any length, made 1"),
        (Self::AxisAngle, "Axis-angle", "The rotation vector: axis × angle, in degrees"),
    ];

    pub fn title(self) -> &'static str {
        Self::ALL[self as usize].1
    }

    /// The names of the rotation's numbers.
    pub fn names(self) -> &'static [&'static str] {
        match self {
            Self::Matrix => &[],
            Self::Euler => &["rx", "ry", "rz"],
            Self::Quaternion => &["qw", "qx", "qy", "qz"],
            Self::AxisAngle => &["ax", "ay", "az"],
        }
    }

    pub fn is_in_degrees(self) -> bool {
        matches!(self, Self::Euler | Self::AxisAngle)
    }

    /// Up to four numbers; those that a form does not have are 0.
    pub fn numbers_of(self, pose: &Pose) -> [f64; 4] {
        let degrees = |v: DVec3| [v.x.to_degrees(), v.y.to_degrees(), v.z.to_degrees(), 0.0];
        match self {
            Self::Matrix => [0.0; 4],
            Self::Euler => degrees(fixed_xyz_from_rotation(&pose.rotation)),
            Self::Quaternion => {
                let q = quaternion_from_rotation(&pose.rotation);
                [q.w, q.x, q.y, q.z]
            }
            Self::AxisAngle => degrees(rotation_vector_from_rotation(&pose.rotation)),
        }
    }

    /// The rotation of such numbers with this translation; `None` where they are no rotation.
    pub fn pose_of(self, numbers: [f64; 4], translation_mm: DVec3, present: &Pose) -> Option<Pose> {
        let [a, b, c, d] = numbers;
        let radians = DVec3::new(a.to_radians(), b.to_radians(), c.to_radians());
        let rotation = match self {
            Self::Matrix => present.rotation,
            Self::Euler => rotation_from_fixed_xyz(radians),
            Self::Quaternion => rotation_from_quaternion(DQuat::from_xyzw(b, c, d, a))?,
            Self::AxisAngle => rotation_from_rotation_vector(radians),
        };
        (rotation.is_finite() && translation_mm.is_finite()).then_some(Pose { rotation, translation_mm })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_brings_the_pose_back() {
        let pose = Pose::exp(DVec3::new(0.3, -0.8, 1.2), DVec3::new(10.0, -20.0, 800.0));
        for (form, title, _) in RotationForm::ALL {
            assert_eq!(form.title(), title);
            let back = form.pose_of(form.numbers_of(&pose), pose.translation_mm, &pose).unwrap();
            assert!(back.rotation.abs_diff_eq(pose.rotation, 1e-12), "{title}");
        }
        assert_eq!(RotationForm::Quaternion.pose_of([0.0; 4], DVec3::ZERO, &pose), None);
    }
}
