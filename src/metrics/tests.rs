//! Errors of known motions, and of truth against itself.

use std::f64::consts::PI;

use glam::DVec3;

use super::*;
use crate::math::{Intrinsics, Pose};
use crate::mesh::{Mesh, test_shapes};

fn camera() -> Intrinsics {
    Intrinsics::pinhole(600.0, 610.0, 330.0, 235.0, 640, 480)
}

/// A box of 80 × 60 × 40 mm.
fn cuboid() -> Mesh {
    let scale = glam::DAffine3::from_scale(DVec3::new(40.0, 30.0, 20.0));
    test_shapes::cube().transformed(&scale).unwrap()
}

fn truth() -> Pose {
    Pose::exp(DVec3::new(0.4, -0.3, 0.2), DVec3::new(5.0, -6.0, 700.0))
}

fn view(camera: &Intrinsics) -> View<'_> {
    View { camera, depth_mm: None }
}

#[test]
fn truth_against_itself_is_zero_in_every_error() {
    let camera = camera();
    let wall = vec![2000.0_f32; 640 * 480];
    let half_turn = Pose::exp(DVec3::Z * PI, DVec3::ZERO);
    for mesh in [cuboid(), test_shapes::sphere(40.0, 12, 20)] {
        for symmetries in [Vec::new(), vec![half_turn]] {
            let model = Model::new(&mesh, symmetries).unwrap();
            for depth_mm in [None, Some(wall.as_slice())] {
                let errors = model.errors(&truth(), &truth(), View { camera: &camera, depth_mm });
                for metric in Metric::ALL {
                    let error = (metric.of)(&errors).unwrap();
                    // RᵀR is the identity but for the rounding of nine products.
                    let bound = if metric.name == "rotation_deg" { 1e-13 } else { 0.0 };
                    assert!(error.abs() <= bound, "{}: {error:e}", metric.name);
                }
                assert_eq!(errors.vsd, [0.0; VSD_TAUS.len()]);
            }
        }
    }
}

#[test]
fn a_shift_is_the_same_for_every_vertex() {
    let (camera, mesh) = (camera(), cuboid());
    let model = Model::new(&mesh, Vec::new()).unwrap();
    let moved = truth().translated(DVec3::new(0.0, 3.0, 4.0));
    let errors = model.errors(&moved, &truth(), view(&camera));
    for (name, found) in [
        ("translation", errors.translation_mm),
        ("ADD", errors.add_mm),
        ("AD", errors.ad_mm),
        ("MSSD", errors.mssd_mm),
        // A shift by less than half the smallest distance of two vertices: the nearest one is the same one.
        ("ADI", errors.adi_mm),
    ] {
        assert!((found - 5.0).abs() < 1e-9, "{name}: {found}");
    }
    assert!((errors.depth_mm - 4.0).abs() < 1e-9);
    assert!(
        (model.diameter_mm() - (80.0_f64.powi(2) + 60.0_f64.powi(2) + 40.0_f64.powi(2)).sqrt()).abs() < 1e-9
    );
}

#[test]
fn symmetries_forgive_what_they_map_onto_itself() {
    let (camera, mesh) = (camera(), cuboid());
    let half_turn = Pose::exp(DVec3::Z * PI, DVec3::ZERO);
    let turned = truth() * half_turn;
    let plain = Model::new(&mesh, Vec::new()).unwrap().errors(&turned, &truth(), view(&camera));
    let model = Model::new(&mesh, vec![Pose::IDENTITY, half_turn]).unwrap();
    let symmetric = model.errors(&turned, &truth(), view(&camera));
    // A corner goes across the diagonal of its face.
    assert!((plain.mssd_mm - 100.0).abs() < 1e-9 && (plain.add_mm - 100.0).abs() < 1e-9);
    assert!(plain.mspd_px.unwrap() > 50.0);
    assert!((plain.rotation_rad - PI).abs() < 1e-6);
    // What is left is the rounding of sin π.
    assert!(symmetric.mssd_mm < 1e-9 && symmetric.mspd_px.unwrap() < 1e-9 && symmetric.ad_mm < 1e-9);
    assert!(model.is_symmetric());
    assert_eq!(symmetric.add_mm, plain.add_mm, "ADD knows no symmetry");
    assert!(symmetric.cus < 1e-3 && symmetric.vsd[0] < 1e-3);
}

#[test]
fn pixels_of_a_wide_photo_are_scaled() {
    let mesh = cuboid();
    let moved = truth().translated(DVec3::X * 7.0);
    let small = camera();
    let large = small.scaled_to(1280, 960);
    let of = |camera: &Intrinsics| {
        let model = Model::new(&mesh, Vec::new()).unwrap();
        let errors = model.errors(&moved, &truth(), view(camera));
        (errors.mspd_px.unwrap(), errors.projection_px.unwrap())
    };
    // MSPD is in pixels of a photo 640 wide; the mean projection error in those of the photo.
    assert!((of(&small).0 - of(&large).0).abs() < 1e-9);
    assert!((2.0 * of(&small).1 - of(&large).1).abs() < 1e-9);
}

#[test]
fn what_is_behind_the_camera_has_no_pixel_error() {
    let (camera, mesh) = (camera(), cuboid());
    let behind = Pose::from_translation(DVec3::new(0.0, 0.0, -500.0));
    let model = Model::new(&mesh, Vec::new()).unwrap();
    for [estimate, reference] in [[behind, truth()], [truth(), behind]] {
        let errors = model.errors(&estimate, &reference, view(&camera));
        assert_eq!((errors.mspd_px, errors.projection_px), (None, None));
        assert!(errors.mssd_mm > 1000.0);
        assert_eq!((errors.cus, errors.vsd), (1.0, [1.0; VSD_TAUS.len()]));
    }
}

#[test]
fn vsd_counts_pixels_by_depth_and_by_mask() {
    let mesh = cuboid();
    let camera = camera();
    let facing = Pose::from_translation(DVec3::new(0.0, 0.0, 720.0));
    let diameter = Model::new(&mesh, Vec::new()).unwrap().diameter_mm();
    let vsd = |estimate: &Pose, depth: Option<&[f32]>| {
        visible_surface_discrepancy(estimate, &facing, &mesh, &camera, depth, diameter)
    };
    // Moved back by 0.12 of the diameter: over the tolerances 0.05 and 0.1, under 0.15; the farther box is the smaller one,
    // so at its edge only the reference is seen.
    let back = facing.translated(DVec3::Z * 0.12 * diameter);
    let errors = vsd(&back, None);
    assert_eq!(errors[..2], [1.0, 1.0]);
    assert!(errors[2] > 0.01 && errors[2] < 0.1, "{errors:?}");
    assert_eq!(errors[2], errors[9]);
    // A hand before the left half: there neither is seen, and the rest is as it was.
    let hand: Vec<f32> = (0..640 * 480).map(|pixel| if pixel % 640 < 330 { 300.0 } else { 0.0 }).collect();
    let half = vsd(&back, Some(&hand));
    assert_eq!(half[..2], [1.0, 1.0]);
    assert!((half[2] - errors[2]).abs() < 0.02, "{half:?}");
    // A hand before everything leaves nothing to compare.
    assert_eq!(vsd(&facing, Some(&vec![300.0; 640 * 480])), [1.0; VSD_TAUS.len()]);
}
