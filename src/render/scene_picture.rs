//! The scene from outside: a free eye sees the same objects, the photo in its frustum, and where cameras are.

use glam::{DVec2, DVec3};

use super::{Line3, LineWidths, PhotoPlane, Picture, Subject, Surroundings, picture_of};
use crate::math::{ImageRect, Intrinsics, Pose};
use crate::scene::{ObjectId, Rgb};

/// Pieces of each side of a photo's border: a lens bends it.
const BORDER_PIECES: u32 = 16;

/// Other cameras are drawn so much smaller than the photo's own.
const OTHER_FRUSTUM_SCALE: f64 = 0.35;

/// An axis is so many times as long as the object is large from its middle.
const AXIS_PER_RADIUS: f64 = 0.8;

const CAMERA_COLOR: Rgb = Rgb([226, 230, 240]);

/// Red, green and blue, light enough for a dark background.
const AXIS_COLORS: [Rgb; 3] = [Rgb([244, 72, 72]), Rgb([84, 208, 96]), Rgb([88, 148, 255])];

/// Where a free eye is, and what it sees besides the objects of a photo.
#[derive(Debug, Clone)]
pub struct FreeView {
    /// From the frame of the photo's camera.
    pub eye_from_camera: Pose,
    /// Without distortion; its size is that of the view in pixels.
    pub eye: Intrinsics,
    /// How far before its camera the photo is shown.
    pub image_distance_mm: f64,
    /// 0 to 1.
    pub photo_opacity: f32,
    pub other_cameras: Vec<OtherCamera>,
}

/// Where another photo was taken from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OtherCamera {
    pub camera_from_other_camera: Pose,
    pub camera: Intrinsics,
    pub color: Rgb,
}

/// The photo's objects and references as a free eye sees them, the photo as a plane in its frustum, the cameras, and the
/// selected object's axes.
pub fn scene_picture_of(subject: &Subject<'_>, view: &FreeView) -> Option<Picture> {
    let picture = picture_of(subject)?;
    let plane = PhotoPlane {
        camera: picture.camera,
        distance_mm: view.image_distance_mm,
        opacity: view.photo_opacity,
    };
    let mut lines =
        frustum(&picture.camera, &Pose::IDENTITY, view.image_distance_mm, CAMERA_COLOR, &picture.widths);
    for other in &view.other_cameras {
        let distance_mm = view.image_distance_mm * OTHER_FRUSTUM_SCALE;
        lines.extend(frustum(
            &other.camera,
            &other.camera_from_other_camera,
            distance_mm,
            other.color,
            &picture.widths,
        ));
    }
    if let Some(selected) = subject.selected {
        lines.extend(axes(subject, selected, &picture.widths));
    }
    Some(Picture {
        camera: view.eye,
        eye_from_camera: view.eye_from_camera,
        rect: ImageRect::of_photo(view.eye.width, view.eye.height),
        surroundings: Some(Surroundings { plane: Some(plane), lines }),
        background: Rgb([30, 33, 40]),
        ..picture
    })
}

/// A camera: its optical centre, the border of its photo at a distance, and which side is up.
fn frustum(
    camera: &Intrinsics,
    camera_from_other: &Pose,
    distance_mm: f64,
    color: Rgb,
    widths: &LineWidths,
) -> Vec<Line3> {
    let at = |pixel: DVec2| camera_from_other.transform_point(camera.unproject(pixel) * distance_mm);
    let rect = ImageRect::of_photo(camera.width, camera.height);
    let corners =
        [rect.min, DVec2::new(rect.max.x, rect.min.y), rect.max, DVec2::new(rect.min.x, rect.max.y)];
    let line = |from, to| Line3::solid(from, to, color, widths.edge_px);
    let mut lines = Vec::new();
    for (number, &corner) in corners.iter().enumerate() {
        lines.push(line(camera_from_other.translation_mm, at(corner)));
        let next = corners[(number + 1) % corners.len()];
        let place = |piece: u32| at(corner.lerp(next, f64::from(piece) / f64::from(BORDER_PIECES)));
        lines.extend((0..BORDER_PIECES).map(|piece| line(place(piece), place(piece + 1))));
    }
    // A small roof over the upper side.
    let middle = DVec2::new(rect.center().x, rect.min.y);
    let half_width = DVec2::new(rect.size().x * 0.08, 0.0);
    let top = middle - DVec2::new(0.0, rect.size().y * 0.1);
    lines.push(line(at(middle - half_width), at(top)));
    lines.push(line(at(top), at(middle + half_width)));
    lines
}

/// The axes of an object's own frame, from its origin, over everything.
fn axes(subject: &Subject<'_>, selected: ObjectId, widths: &LineWidths) -> Vec<Line3> {
    let Some(object) = subject.scene.object(selected) else { return Vec::new() };
    let Some(annotation) = subject.scene.annotation(subject.photo, selected) else { return Vec::new() };
    let pose = annotation.camera_from_object;
    let sphere = object.mesh.mesh.sphere();
    // The origin may be outside the object, or far from it: then axes still reach as far as the object is large.
    let length_mm = sphere.radius * AXIS_PER_RADIUS;
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().zip(AXIS_COLORS);
    axes.map(|(axis, color)| Line3 {
        in_front: true,
        ..Line3::solid(
            pose.translation_mm,
            pose.transform_point(axis * length_mm),
            color,
            widths.selected_outline_px,
        )
    })
    .collect()
}
