//! The photo with the meshes over it, through the camera that took it.

use egui::{Color32, Rect, Stroke, Ui, Vec2};

use super::{ViewportPlace, corners, cursor_icon, gizmo, paint};
use crate::interact::{Pane, Viewpoint as _};
use crate::render::{Picture, Subject, ViewSlot, picture_of};
use crate::session::Session;
use crate::ui::{Surroundings, theme};

pub fn draw(ui: &mut Ui, available: Rect, session: &Session, around: &Surroundings<'_>) -> ViewportPlace {
    let (place, response) = super::place(ui, available, "Viewport");
    if let (Some(renderer), Some(picture)) =
        (around.renderer, picture(session, around, place.pixels_per_point))
    {
        paint::picture(ui, renderer, ViewSlot::Photo, picture, place);
    }
    wipe_grip(ui, &place, session, around);
    gizmo::draw(ui, &place, Pane::Photo, &around.hands.photo_view, session, around);
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
        depth: around.depth.clone(),
        ..Subject::new(session.scene(), photo.id, around.pixels.clone())
    };
    let mut picture = picture_of(&subject)?;
    picture.rect = around.hands.photo_view.visible_rect();
    picture.in_motion = around.hands.is_moving();
    Some(picture)
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
