//! The photo with the meshes over it, through the camera that took it.

use egui::{Color32, Rect, Stroke, Ui, Vec2};

use super::{ViewportPlace, corners, cursor_icon, gizmo, paint, pins};
use crate::interact::{Pane, Viewpoint as _};
use crate::render::{Item, Picture, Subject, ViewSlot, picture_of};
use crate::scene::Rgb;
use crate::session::Session;
use crate::solve::pins::PinPose;
use crate::ui::{Surroundings, theme};

pub fn draw(ui: &mut Ui, available: Rect, session: &Session, around: &Surroundings<'_>) -> ViewportPlace {
    let (place, response) = super::place(ui, available, "Viewport");
    let mut picture = picture(session, around, place.pixels_per_point);
    if let (Some(renderer), Some(picture)) = (around.renderer, &mut picture) {
        picture.in_motion |= paint::shows_new_mesh(ui, picture);
        paint::picture(ui, renderer, ViewSlot::Photo, picture.clone(), place);
    }
    wipe_grip(ui, &place, session, around);
    gizmo::draw(ui, &place, Pane::Photo, &around.hands.photo_view, session, around);
    pins::draw(ui, &place, session, around, picture.as_ref());
    cursor_icon(ui, &response, Pane::Photo, session, around);
    corners::photo(ui, place.rect, session, around);
    place
}

fn picture(session: &Session, around: &Surroundings<'_>, pixels_per_point: f32) -> Option<Picture> {
    let photo = session.photo()?;
    let subject = Subject {
        selected: session.selected(),
        look: session.look(),
        pixels_per_point,
        masks: around.masks.clone(),
        drawn_pose: around.drawn_pose_in(photo.id),
        depth: around.depth.clone(),
        ..Subject::new(session.scene(), photo.id, around.pixels.clone())
    };
    let mut picture = picture_of(&subject)?;
    picture.ghosts.extend(other_fits(session));
    picture.rect = around.hands.photo_view.visible_rect();
    picture.in_motion = around.hands.is_moving();
    Some(picture)
}

/// What else the pins allow, outlined in the pins' colour.
fn other_fits(session: &Session) -> Vec<Item> {
    let object = session.selected_annotation().and_then(|(_, object, _)| session.scene().object(object));
    let (Some(object), Some(report)) = (object, session.pin_report()) else { return Vec::new() };
    let [red, green, blue, _] = super::colors::PIN.to_array();
    let fit = |(number, other): (usize, &PinPose)| Item {
        mesh: object.mesh.clone(),
        camera_from_object: other.camera_from_object,
        color: Rgb([red, green, blue]),
        opacity: 0.0,
        // Apart from the references' numbers, which go up from 1.
        id: 127 - (number % 8) as u8,
        selected: false,
    };
    report.alternatives.iter().enumerate().map(fit).collect()
}

/// The line where the overlay ends, with something to hold it by.
fn wipe_grip(ui: &Ui, place: &ViewportPlace, session: &Session, around: &Surroundings<'_>) {
    let Some(line_px) = around.hands.photo_view.wipe_px(session) else { return };
    let painter = ui.painter().with_clip_rect(place.rect);
    let x = place.position(glam::DVec2::new(line_px, 0.0)).x;
    let color = if around.hands.wipe_is_lit(session) { theme::ACCENT } else { Color32::WHITE };
    painter.vline(x, place.rect.y_range(), Stroke::new(3.5, super::colors::SHADE));
    painter.vline(x, place.rect.y_range(), Stroke::new(1.5, color));
    // Low, where objects seldom are.
    let grip = Rect::from_center_size(
        egui::pos2(x, place.rect.bottom() - 0.2 * place.rect.height()),
        Vec2::new(14.0, 34.0),
    );
    painter.rect_filled(grip.expand(1.5), 7.0, super::colors::SHADE);
    painter.rect_filled(grip, 6.0, color);
    for offset in [-2.5, 2.5] {
        painter.vline(x + offset, grip.shrink(10.0).y_range(), Stroke::new(1.5, Color32::from_gray(60)));
    }
}
