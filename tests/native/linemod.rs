//! Black-box values on real photographs: where the truth puts the vertices.

use glam::DVec2;
use pinpose::math::ImageRect;
use pinpose::scene::{AnnotationState, Scene, file_stem};

use crate::support::linemod_session;

/// Photo, object, and the pixels between which all its vertices project: u, v.
const EXTENTS: [(&str, &str, [f64; 2], [f64; 2]); 3] = [
    ("000019", "obj_000001", [199.67, 243.11], [157.44, 198.68]),
    ("000057", "obj_000005", [436.78, 512.74], [168.48, 285.82]),
    ("000034", "obj_000015", [297.29, 423.31], [11.42, 163.10]),
];

#[test]
fn vertices_project_to_the_known_pixels() {
    let Some(session) = linemod_session() else { return };
    for (photo, object, u, v) in EXTENTS {
        let rect = projected(session.scene(), photo, object);
        // The values are given to two decimals.
        let near = |a: f64, b: f64| (a - b).abs() <= 0.0051;
        assert!(near(rect.min.x, u[0]) && near(rect.max.x, u[1]), "{object} u {rect:?}");
        assert!(near(rect.min.y, v[0]) && near(rect.max.y, v[1]), "{object} v {rect:?}");
    }
}

#[test]
fn ten_photos_get_their_cameras_and_poses_from_one_ground_truth() {
    let Some(session) = linemod_session() else { return };
    let scene = session.scene();
    assert_eq!((scene.photos.len(), scene.objects.len(), scene.annotations.len()), (10, 10, 10));
    for photo in &scene.photos {
        assert_eq!((photo.camera.fx, photo.camera.fy), (572.4114, 573.57043));
        assert_eq!(scene.objects_in(photo.id).count(), 1);
    }
    assert!(scene.annotations.values().all(|annotation| annotation.state == AnnotationState::Posed));
}

fn projected(scene: &Scene, photo: &str, object: &str) -> ImageRect {
    let photo = scene.photos.iter().find(|candidate| file_stem(&candidate.asset.file_name) == photo).unwrap();
    let object = scene.objects.iter().find(|candidate| candidate.name == object).unwrap();
    let pose = scene.annotation(photo.id, object.id).unwrap().camera_from_object;
    let vertices = object.mesh.mesh.positions_mm().iter();
    let pixels: Vec<DVec2> = vertices
        .map(|vertex| photo.camera.project(pose.transform_point(vertex.as_dvec3())).unwrap())
        .collect();
    ImageRect::around(pixels).unwrap()
}
