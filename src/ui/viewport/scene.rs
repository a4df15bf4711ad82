//! Photo and objects from anywhere: the photo as a plane in its camera's frustum, the other cameras around it.

use egui::{Rect, Ui};
use glam::{DVec2, DVec3};

use super::{ViewportPlace, corners, cursor_icon, gizmo, orientation, paint};
use crate::interact::{Pane, image_distance_mm, other_cameras, plane_corners};
use crate::math::{ImageRect, Intrinsics, Pose};
use crate::render::{self, Line3, PhotoPlane, Picture, Subject, ViewSlot, picture_of};
use crate::scene::{Look, Rgb};
use crate::session::Session;
use crate::ui::{Asked, Surroundings};

const FRUSTUM: Rgb = Rgb([150, 190, 240]);
const OTHER_FRUSTUM: Rgb = Rgb([120, 126, 138]);

/// Of the photo's distance: how long the camera's axes and the other photos' frusta are drawn.
const AXES_LENGTH: f64 = 0.06;
const OTHER_FRUSTUM_LENGTH: f64 = 0.12;

/// A lens bends the photo's edges; straight pieces of each.
const EDGE_STEPS: u32 = 12;

pub fn draw(
    ui: &mut Ui,
    available: Rect,
    session: &Session,
    around: &Surroundings<'_>,
    asked: &mut Asked,
) -> ViewportPlace {
    let (place, response) = super::place(ui, available, "Scene view");
    if let (Some(renderer), Some(picture)) =
        (around.renderer, picture(session, around, place.pixels_per_point))
    {
        paint::picture(ui, renderer, ViewSlot::Scene, picture, place);
    }
    gizmo::draw(ui, &place, Pane::Scene, &around.hands.scene_view, session, around);
    cursor_icon(ui, &response, Pane::Scene, session, around);
    corners::scene(ui, place.rect, session, around);
    orientation::draw(ui, &place, &around.hands.scene_view, asked);
    place
}

fn picture(session: &Session, around: &Surroundings<'_>, pixels_per_point: f32) -> Option<Picture> {
    let photo = session.photo()?;
    // Wipe and difference compare pixels of the photo, which lie elsewhere here.
    let look = Look { wipe: None, difference: false, ..session.look() };
    let subject = Subject {
        selected: session.selected(),
        look,
        pixels_per_point,
        ..Subject::new(session.scene(), photo.id, around.pixels.clone())
    };
    let mut picture = picture_of(&subject)?;
    let view = &around.hands.scene_view;
    let distance_mm = image_distance_mm(session);
    picture.camera = view.intrinsics();
    picture.eye_from_camera = view.eye_from_camera();
    picture.rect = ImageRect::of_photo(picture.camera.width, picture.camera.height);
    let opacity = if photo.visible { photo.opacity } else { 0.0 };
    let plane = PhotoPlane { camera: photo.camera, distance_mm, opacity };
    picture.surroundings = Some(render::Surroundings {
        plane: Some(plane),
        lines: lines(session, &photo.camera, distance_mm, pixels_per_point),
    });
    Some(picture)
}

fn lines(session: &Session, camera: &Intrinsics, distance_mm: f64, pixels_per_point: f32) -> Vec<Line3> {
    let mut lines = frustum(camera, &Pose::IDENTITY, distance_mm, FRUSTUM, 1.25 * pixels_per_point);
    let axes = DVec3::AXES.into_iter().zip(super::colors::AXES);
    lines.extend(axes.map(|(axis, color)| {
        let color = Rgb([color.r(), color.g(), color.b()]);
        let width_px = 2.0 * pixels_per_point;
        Line3::solid(DVec3::ZERO, axis * AXES_LENGTH * distance_mm, color, width_px)
    }));
    for (other, camera_from_other) in other_cameras(session) {
        let length_mm = distance_mm * OTHER_FRUSTUM_LENGTH;
        lines.extend(frustum(&other.camera, &camera_from_other, length_mm, OTHER_FRUSTUM, pixels_per_point));
    }
    lines
}

/// A camera's four edges, the photo's frame at a distance, and a mark above it: there is up.
fn frustum(
    camera: &Intrinsics,
    a_from_camera: &Pose,
    distance_mm: f64,
    color: Rgb,
    width_px: f32,
) -> Vec<Line3> {
    let line = |from: DVec3, to: DVec3| {
        let (from, to) = (a_from_camera.transform_point(from), a_from_camera.transform_point(to));
        Line3::solid(from, to, color, width_px)
    };
    let corners = plane_corners(camera, distance_mm);
    let mut lines: Vec<Line3> = corners.iter().map(|corner| line(DVec3::ZERO, *corner)).collect();
    let border = border(camera).map(|pixel| camera.unproject(pixel) * distance_mm);
    let border: Vec<DVec3> = border.collect();
    lines.extend(border.windows(2).map(|ends| line(ends[0], ends[1])));
    let (left, right) = (corners[0].lerp(corners[1], 0.42), corners[0].lerp(corners[1], 0.58));
    let above = corners[0].lerp(corners[1], 0.5) + (corners[0] - corners[3]) * 0.06;
    lines.extend([line(left, above), line(above, right)]);
    lines
}

/// Around the photo, back to the start.
fn border(camera: &Intrinsics) -> impl Iterator<Item = DVec2> {
    let ImageRect { min, max } = ImageRect::of_photo(camera.width, camera.height);
    let corners = [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y), min];
    (0..4 * EDGE_STEPS + 1).map(move |step| {
        let (side, part) =
            ((step / EDGE_STEPS) as usize, f64::from(step % EDGE_STEPS) / f64::from(EDGE_STEPS));
        let next = corners[(side + 1).min(4)];
        corners[side].lerp(next, part)
    })
}
