//! Photo and objects from anywhere: the photo as a plane in its camera's frustum, the other cameras around it.

use egui::{Rect, Ui};

use super::{ViewportPlace, corners, cursor_icon, gizmo, orientation, paint};
use crate::interact::{Pane, image_distance_mm, other_cameras};
use crate::render::{FreeView, OtherCamera, Picture, Subject, ViewSlot, scene_picture_of};
use crate::scene::{Look, Rgb};
use crate::session::Session;
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
        masks: around.masks.clone(),
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
