//! Photo and objects from anywhere: the photo as a plane in its camera's frustum, the other cameras around it.

use egui::{Rect, Ui};

use super::{ViewportPlace, corners, cursor_icon, gizmo, orientation, paint, pins};
use crate::interact::{Pane, Viewpoint as _, image_distance_mm, other_cameras};
use crate::render::{FreeView, OtherCamera, Picture, Subject, ViewSlot, scene_picture_of};
use crate::scene::{Look, Rgb};
use crate::session::{HalfPin, Session};
use crate::ui::{Asked, Surroundings};

const OTHER_CAMERAS: Rgb = Rgb([120, 126, 138]);

pub fn draw(
    ui: &mut Ui,
    available: Rect,
    session: &Session,
    around: &Surroundings<'_>,
    asked: &mut Asked,
) -> ViewportPlace {
    let (place, response) = super::place(ui, available, "Scene view");
    if let (Some(renderer), Some(mut picture)) =
        (around.renderer, picture(session, around, place.pixels_per_point))
    {
        picture.in_motion |= paint::shows_new_mesh(ui, &picture);
        paint::picture(ui, renderer, ViewSlot::Scene, picture, place);
    }
    gizmo::draw(ui, &place, Pane::Scene, &around.hands.scene_view, session, around);
    half_pin(ui, &place, session, around);
    cursor_icon(ui, &response, Pane::Scene, session, around);
    corners::scene(ui, place.rect, session, around);
    orientation::draw(ui, &place, &around.hands.scene_view, asked);
    place
}

/// The point of the object that waits for its pixel.
fn half_pin(ui: &Ui, place: &ViewportPlace, session: &Session, around: &Surroundings<'_>) {
    let Some(HalfPin::Point(object, point_mm)) = session.half_pin() else { return };
    let (Some(photo), Some(eye)) = (session.photo(), around.hands.scene_view.eye(session)) else { return };
    let Some(annotation) = session.scene().annotation(photo.id, object) else { return };
    if let Some(seen) = eye.project(annotation.camera_from_object.transform_point(point_mm)) {
        pins::draw_waiting(&ui.painter().with_clip_rect(place.rect), place.position(seen));
    }
}

fn picture(session: &Session, around: &Surroundings<'_>, pixels_per_point: f32) -> Option<Picture> {
    let photo = session.photo()?;
    // Wipe and difference compare pixels of the photo, which lie elsewhere here.
    let look = Look { wipe: None, difference: false, ..session.look() };
    let subject = Subject {
        selected: session.selected(),
        look,
        pixels_per_point,
        masks: around.masks.clone(),
        drawn_pose: around.drawn_pose_in(photo.id),
        ..Subject::new(session.scene(), photo.id, around.pixels.clone())
    };
    let view = &around.hands.scene_view;
    let others = other_cameras(session).into_iter().map(|(other, camera_from_other_camera)| OtherCamera {
        camera_from_other_camera,
        camera: other.camera,
        color: OTHER_CAMERAS,
    });
    let free_view = FreeView {
        eye_from_camera: view.eye_from_camera(),
        eye: view.intrinsics(),
        image_distance_mm: image_distance_mm(session),
        photo_opacity: if photo.visible { photo.opacity } else { 0.0 },
        other_cameras: others.collect(),
    };
    let mut picture = scene_picture_of(&subject, &free_view)?;
    picture.in_motion = around.hands.is_moving();
    Some(picture)
}
