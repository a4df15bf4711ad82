//! The quiet numbers in the views' corners.

use egui::{Align2, Color32, Pos2, Rect, Ui, Vec2, text::LayoutJob, text::TextFormat};

use super::colors;
use crate::interact::Pane;
use crate::metrics::{LIVE_VERTICES, PoseError};
use crate::scene::reference_color;
use crate::session::Session;
use crate::ui::{Surroundings, theme};

const MARGIN: f32 = 10.0;

/// Zoom, the pixel under the cursor, and how far away and how large it is.
pub fn photo(ui: &Ui, rect: Rect, session: &Session, around: &Surroundings<'_>) {
    let Some(photo) = session.photo() else { return };
    let hands = around.hands;
    let mut text = format!("{:.0} %", hands.photo_view.zoom * 100.0);
    if let Some(pixel) = hands.pixel_under_pointer() {
        text += &format!("    u {:.1}  v {:.1}", pixel.x, pixel.y);
        if let Some(hit) = hands.hit_under_pointer(session) {
            let depth_mm = hit.point_camera_mm.z;
            let mm_per_px = depth_mm / photo.camera.focal_px();
            text += &format!("    depth {depth_mm:.1} mm    1 px = {mm_per_px:.2} mm");
        }
    }
    note(ui, rect.left_bottom() + Vec2::new(MARGIN, -MARGIN), Align2::LEFT_BOTTOM, &text);
    if around.pixels.is_none() {
        note(ui, rect.center(), Align2::CENTER_CENTER, "Decoding the photo…");
    }
}

/// The depth under the cursor, as the photo's camera has it.
pub fn scene(ui: &Ui, rect: Rect, session: &Session, around: &Surroundings<'_>) {
    let hands = around.hands;
    if hands.pointer.is_none_or(|(pane, _)| pane != Pane::Scene) {
        return;
    }
    if let Some(hit) = hands.hit_under_pointer(session) {
        let text = format!("depth {:.1} mm", hit.point_camera_mm.z);
        note(ui, rect.left_bottom() + Vec2::new(MARGIN, -MARGIN), Align2::LEFT_BOTTOM, &text);
    }
}

/// How far the selected object is from where the visible references have it.
pub fn errors(ui: &Ui, whole: Rect, session: &Session) {
    let Some((photo, object, annotation)) = session.selected_annotation() else { return };
    let Some(object) = session.scene().object(object) else { return };
    let mut bottom = whole.right_bottom() - Vec2::splat(MARGIN);
    for reference in session.scene().references.iter().rev().filter(|reference| reference.visible) {
        let Some(pose) = reference.poses.get(&(photo, object.id)) else { continue };
        let (mesh, symmetries) = (&object.mesh.mesh, &object.symmetries);
        let error = PoseError::between(&annotation.camera_from_object, pose, mesh, symmetries, LIVE_VERTICES);
        let mut job = LayoutJob::default();
        let font_id = egui::TextStyle::Small.resolve(ui.style());
        let format = |color: Color32| TextFormat { font_id: font_id.clone(), color, ..TextFormat::default() };
        job.append(&reference.name, 0.0, format(theme::color32(reference_color())));
        let numbers = format!(
            "{:.2}°    {:.2} mm    ADD {:.2} mm",
            error.rotation_rad.to_degrees(),
            error.translation_mm,
            error.add_mm
        );
        job.append(&numbers, 12.0, format(colors::TEXT));
        let frame = note_of(ui, bottom, Align2::RIGHT_BOTTOM, job);
        bottom.y = frame.top() - 4.0;
    }
}

/// A line of small text on a quiet ground.
pub fn note(ui: &Ui, position: Pos2, anchor: Align2, text: &str) {
    let font_id = egui::TextStyle::Small.resolve(ui.style());
    note_of(ui, position, anchor, LayoutJob::simple_singleline(text.to_owned(), font_id, colors::TEXT));
}

fn note_of(ui: &Ui, position: Pos2, anchor: Align2, job: LayoutJob) -> Rect {
    let galley = ui.painter().layout_job(job);
    let frame = anchor.anchor_size(position, galley.size() + Vec2::new(16.0, 8.0));
    ui.painter().rect_filled(frame, 6.0, colors::OVERLAY);
    ui.painter().galley(frame.min + Vec2::new(8.0, 4.0), galley, colors::TEXT);
    frame
}
