//! A rotation in the forms in which people type it.

use glam::{DMat3, DQuat, DVec3, EulerRot};

/// Angles about the fixed x, y and z axes, in this order: R = Rz·Ry·Rx. SciPy calls it `"xyz"`; the same angles about the
/// moving axes are z, y′, x″.
pub fn fixed_xyz_from_rotation(rotation: &DMat3) -> DVec3 {
    let (z, y, x) = rotation.to_euler(EulerRot::ZYX);
    DVec3::new(x, y, z)
}

pub fn rotation_from_fixed_xyz(angles_rad: DVec3) -> DMat3 {
    DMat3::from_euler(EulerRot::ZYX, angles_rad.z, angles_rad.y, angles_rad.x)
}

/// The unit quaternion with w ≥ 0.
pub fn quaternion_from_rotation(rotation: &DMat3) -> DQuat {
    let quaternion = DQuat::from_mat3(rotation).normalize();
    if quaternion.w < 0.0 { -quaternion } else { quaternion }
}

/// `None` for a quaternion that is zero or not finite; any other length is made 1.
pub fn rotation_from_quaternion(quaternion: DQuat) -> Option<DMat3> {
    let length = quaternion.length();
    (length.is_finite() && length > 1e-9).then(|| DMat3::from_quat(quaternion / length))
}

/// The axis times the angle, 0 to π.
pub fn rotation_vector_from_rotation(rotation: &DMat3) -> DVec3 {
    quaternion_from_rotation(rotation).to_scaled_axis()
}

pub fn rotation_from_rotation_vector(rotation_vector_rad: DVec3) -> DMat3 {
    DMat3::from_quat(DQuat::from_scaled_axis(rotation_vector_rad))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn every_form_brings_the_rotation_back(x in -3.0..3.0, y in -1.5..1.5, z in -3.0..3.0) {
            let rotation = rotation_from_fixed_xyz(DVec3::new(x, y, z));
            let by_angles = rotation_from_fixed_xyz(fixed_xyz_from_rotation(&rotation));
            let by_quaternion = rotation_from_quaternion(quaternion_from_rotation(&rotation)).unwrap();
            let by_vector = rotation_from_rotation_vector(rotation_vector_from_rotation(&rotation));
            for back in [by_angles, by_quaternion, by_vector] {
                // Near 90° about y, the angles lose half the digits of f64.
                prop_assert!(back.abs_diff_eq(rotation, 1e-7));
            }
        }
    }

    #[test]
    fn the_convention_is_the_one_that_it_is_called() {
        let angles = DVec3::new(0.3, -0.5, 1.1);
        let product =
            DMat3::from_rotation_z(1.1) * DMat3::from_rotation_y(-0.5) * DMat3::from_rotation_x(0.3);
        assert!(rotation_from_fixed_xyz(angles).abs_diff_eq(product, 1e-15));
        assert_eq!(rotation_from_quaternion(DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0)), None);
    }
}
