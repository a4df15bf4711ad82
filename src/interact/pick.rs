//! What is under the cursor.

use glam::{DVec2, DVec3};

use crate::math::{ImageRect, Ray, sort_short};
use crate::scene::{ObjectId, PhotoId, Scene};

/// A surface point under a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    pub object: ObjectId,
    /// Index of the triangle in the mesh.
    pub face: u32,
    /// In the `object` frame, millimetres.
    pub point_object_mm: DVec3,
    /// In the `camera` frame, millimetres; z is the depth.
    pub point_camera_mm: DVec3,
}

/// The visible objects under a pixel of the photo, each where the view ray first meets it, the nearest one first.
pub fn pick_all(scene: &Scene, photo: PhotoId, pixel: DVec2) -> Vec<Hit> {
    let Some(camera) = scene.photo(photo).map(|photo| photo.camera) else { return Vec::new() };
    pick_along(scene, photo, &camera.ray(pixel))
}

/// The visible objects of a photo along a ray of its camera's frame, the nearest one first.
pub fn pick_along(scene: &Scene, photo: PhotoId, ray_camera: &Ray) -> Vec<Hit> {
    let visible = scene.objects_in(photo).filter(|(object, _)| object.visible);
    let mut hits: Vec<Hit> = visible
        .filter_map(|(object, annotation)| {
            let camera_from_object = annotation.camera_from_object;
            let ray_object = ray_camera.transformed(&camera_from_object.inverse());
            let hit = object.mesh.tree()?.cast(&object.mesh.mesh, &ray_object)?;
            Some(Hit {
                object: object.id,
                face: hit.triangle,
                point_object_mm: hit.point,
                point_camera_mm: camera_from_object.transform_point(hit.point),
            })
        })
        .collect();
    let distance = |hit: &Hit| (hit.point_camera_mm - ray_camera.origin).dot(ray_camera.direction);
    sort_short(&mut hits, |a, b| distance(a).total_cmp(&distance(b)));
    hits
}

/// The rectangle of the photo that an object's bounding box covers; `None` where it is not in front of the camera.
pub fn object_rect(scene: &Scene, photo: PhotoId, object: ObjectId) -> Option<ImageRect> {
    let camera = scene.photo(photo)?.camera;
    let camera_from_object = scene.annotation(photo, object)?.camera_from_object;
    let corners = scene.object(object)?.mesh.mesh.bounds().corners();
    let pixels: Option<Vec<DVec2>> =
        corners.iter().map(|corner| camera.project(camera_from_object.transform_point(*corner))).collect();
    ImageRect::around(pixels?)
}
