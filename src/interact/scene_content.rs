//! What there is to see from outside: the photo's plane, the objects, the cameras of other photos.

use glam::{DVec2, DVec3};

use crate::math::{ImageRect, Intrinsics, Pose};
use crate::scene::{AnnotationState, ObjectId, Photo, PhotoId, Scene};
use crate::session::Session;

/// The photo's plane is behind the farthest object by a little.
const BEHIND_OBJECTS: f64 = 1.15;

/// Where there are no objects.
const EMPTY_DISTANCE_MM: f64 = 1000.0;

/// How far from its camera the photo's plane is: as it was set, else behind all objects.
pub fn image_distance_mm(session: &Session) -> f64 {
    if let Some(distance_mm) = session.panes().image_distance_mm {
        return distance_mm.max(1.0);
    }
    let reach = spheres(session).map(|(center, radius)| center.z + radius).fold(0.0, f64::max);
    if reach > 0.0 { reach * BEHIND_OBJECTS } else { EMPTY_DISTANCE_MM }
}

/// The corners of a photo's plane, in its camera's frame, clockwise from the top left.
pub fn plane_corners(camera: &Intrinsics, distance_mm: f64) -> [DVec3; 4] {
    let ImageRect { min, max } = ImageRect::of_photo(camera.width, camera.height);
    [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)]
        .map(|pixel| camera.unproject(pixel) * distance_mm)
}

/// Points around all that is to be seen: the camera, its photo's plane, the objects' boxes.
pub fn content_points(session: &Session) -> Vec<DVec3> {
    let Some(photo) = session.photo() else { return Vec::new() };
    let mut points = vec![DVec3::ZERO];
    points.extend(plane_corners(&photo.camera, image_distance_mm(session)));
    for (object, annotation) in session.scene().objects_in(photo.id).filter(|(object, _)| object.visible) {
        let corners = object.mesh.mesh.bounds().corners();
        points.extend(corners.map(|corner| annotation.camera_from_object.transform_point(corner)));
    }
    points
}

/// The corners of one object's box.
pub fn object_points(session: &Session, object: ObjectId) -> Vec<DVec3> {
    let annotation = session.photo().and_then(|photo| session.scene().annotation(photo.id, object));
    let (Some(annotation), Some(object)) = (annotation, session.scene().object(object)) else {
        return Vec::new();
    };
    let corners = object.mesh.mesh.bounds().corners();
    corners.map(|corner| annotation.camera_from_object.transform_point(corner)).to_vec()
}

/// What an eye orbits: the selected object's centre, else the middle of all objects, else of the photo's plane.
pub fn orbit_pivot_mm(session: &Session) -> DVec3 {
    if let Some((_, object, annotation)) = session.selected_annotation()
        && let Some(object) = session.scene().object(object)
    {
        return annotation.camera_from_object.transform_point(object.mesh.mesh.sphere().center);
    }
    let centers: Vec<DVec3> = spheres(session).map(|(center, _)| center).collect();
    if centers.is_empty() {
        return DVec3::Z * image_distance_mm(session);
    }
    centers.iter().sum::<DVec3>() / centers.len() as f64
}

/// Where the cameras of the other photos are before this one, as far as an object that is annotated in both tells it:
/// `camera_from_other`.
pub fn other_cameras(session: &Session) -> Vec<(&Photo, Pose)> {
    let Some(shown) = session.photo() else { return Vec::new() };
    let scene = session.scene();
    let others = scene.photos.iter().filter(|photo| photo.id != shown.id);
    let placed = |photo, other, object| {
        let camera_from_object = known_pose(scene, photo, object)?;
        Some(camera_from_object * known_pose(scene, other, object)?.inverse())
    };
    let candidates: Vec<ObjectId> =
        session.selected().into_iter().chain(scene.objects.iter().map(|object| object.id)).collect();
    others
        .filter_map(|other| {
            let pose = candidates.iter().find_map(|object| placed(shown.id, other.id, *object))?;
            Some((other, pose))
        })
        .collect()
}

fn known_pose(scene: &Scene, photo: PhotoId, object: ObjectId) -> Option<Pose> {
    let annotation = scene.annotation(photo, object)?;
    (annotation.state != AnnotationState::Untouched).then_some(annotation.camera_from_object)
}

/// Centres and radii of the visible objects, in the camera frame.
fn spheres(session: &Session) -> impl Iterator<Item = (DVec3, f64)> {
    let objects = session.photo().into_iter().flat_map(|photo| session.scene().objects_in(photo.id));
    objects.filter(|(object, _)| object.visible).map(|(object, annotation)| {
        let sphere = object.mesh.mesh.sphere();
        (annotation.camera_from_object.transform_point(sphere.center), sphere.radius)
    })
}
