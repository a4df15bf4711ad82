//! An axis of symmetry over the selected object, while it is pointed at or written.

use egui::{Align2, FontId, Stroke, Ui, Vec2};

use super::{ViewportPlace, colors};
use crate::interact::Viewpoint;
use crate::scene::SymmetryAxis;
use crate::session::Session;

/// How far the line stands out of the object on either side, in its radii.
const REACH: f64 = 1.35;
/// So many parts of it are drawn, so that one that goes behind the eye, or is bent by the lens, is drawn as far as it is seen.
const PARTS: u32 = 24;

pub fn draw(ui: &Ui, place: &ViewportPlace, view: &impl Viewpoint, session: &Session, axis: &SymmetryAxis) {
    let Some((_, object, annotation)) = session.selected_annotation() else { return };
    let (Some(object), Some(eye)) = (session.scene().object(object), view.eye(session)) else { return };
    let sphere = object.mesh.mesh.sphere();
    let foot = axis.through_mm + axis.axis * axis.axis.dot(sphere.center - axis.through_mm);
    let at = |part: u32| {
        let along = (f64::from(part) / f64::from(PARTS) * 2.0 - 1.0) * REACH * sphere.radius;
        let point = annotation.camera_from_object.transform_point(foot + axis.axis * along);
        eye.project(point).map(|pixel| place.position(pixel))
    };
    let points: Vec<_> = (0..=PARTS).filter_map(at).collect();
    let painter = ui.painter().with_clip_rect(place.rect);
    painter.line(points.clone(), Stroke::new(4.0, colors::SHADE));
    painter.line(points.clone(), Stroke::new(1.75, colors::TEXT));
    if let Some(end) = points.last() {
        painter.circle_filled(*end, 3.5, colors::TEXT);
        let (text, font) = (axis.fold.to_string(), FontId::proportional(12.0));
        let corner = *end + Vec2::new(7.0, -3.0);
        painter.text(corner + Vec2::splat(1.0), Align2::LEFT_BOTTOM, &text, font.clone(), colors::SHADE);
        painter.text(corner, Align2::LEFT_BOTTOM, &text, font, colors::TEXT);
    }
}
