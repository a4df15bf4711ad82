//! The selected pose's pins over the photo: where each belongs, how far its point is from there, and a loupe for the hand.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, StrokeKind, Ui, Vec2, pos2};
use glam::DVec2;

use super::{ViewportPlace, colors, paint};
use crate::interact::{Eye, Viewpoint as _};
use crate::math::ImageRect;
use crate::render::{Picture, ViewSlot};
use crate::scene::{Layers, Look, OverlayMode, Pin};
use crate::session::{HalfPin, PinReport, Session, Tool};
use crate::ui::Surroundings;

const RADIUS: f32 = 6.5;
const LOUPE_SIDE: f32 = 168.0;
/// From the pointer to the loupe.
const LOUPE_GAP: f32 = 34.0;
/// Against the view, and in points per photo pixel at most: beyond that it shows single pixels and nothing around them.
const LOUPE_ZOOM: f64 = 4.0;
const LOUPE_MOST: f64 = 12.0;
const LOUPE_LEAST: f64 = 1.5;
/// A shorter way from a pin to its point is not drawn: it would be inside the ring.
const LEAST_RESIDUAL: f32 = 3.0;

pub fn draw(
    ui: &Ui,
    place: &ViewportPlace,
    session: &Session,
    around: &Surroundings<'_>,
    picture: Option<&Picture>,
) {
    let Some(eye) = around.hands.photo_view.eye(session) else { return };
    let painter = ui.painter().with_clip_rect(place.rect);
    if let Some((_, _, annotation)) = session.selected_annotation() {
        let report = session.pin_report();
        let lit = around.hands.dragged_pin().map(|(number, _)| number);
        let lit = lit.or(around.hands.hovered_pin(session));
        // Without the tool they are only a reminder.
        let strength = if session.tool() == Tool::Pin { 1.0 } else { 0.55 };
        for (number, pin) in annotation.pins.iter().enumerate() {
            let mark = Mark::of(pin, number, report.as_deref(), lit == Some(number));
            let at = place.position(eye.viewport_from_image(pin.pixel));
            let residual = report.as_ref().and_then(|report| *report.residuals_px.get(number)?);
            let point =
                residual.map(|residual| place.position(eye.viewport_from_image(pin.pixel + residual)));
            mark.draw(&painter, at, point, strength);
        }
    }
    draw_half(&painter, place, session, &eye);
    if let (Some((number, pixel)), Some(renderer), Some(picture)) =
        (around.hands.dragged_pin(), around.renderer, picture)
    {
        let at = place.position(eye.viewport_from_image(pixel));
        let most = (LOUPE_MOST * f64::from(place.pixels_per_point)).max(LOUPE_LEAST * eye.zoom);
        let zoom = (LOUPE_ZOOM * eye.zoom).min(most);
        let loupe = Loupe { place: loupe_place(place, at), zoom, pixel };
        paint::picture(ui, renderer, ViewSlot::Loupe, loupe.picture(picture), loupe.place);
        loupe.frame(ui.painter(), number);
    }
}

/// How a pin looks.
struct Mark {
    text: String,
    color: Color32,
    is_lit: bool,
    is_hollow: bool,
}

impl Mark {
    fn of(pin: &Pin, number: usize, report: Option<&PinReport>, is_lit: bool) -> Self {
        let is_misclick = report.is_some_and(|report| report.misclicks.contains(&number));
        let (text, color) = match () {
            () if is_misclick => (format!("{}!", number + 1), colors::MISCLICK),
            () if !pin.enabled => ((number + 1).to_string(), colors::PIN_OFF),
            () => ((number + 1).to_string(), colors::PIN),
        };
        Self { text, color, is_lit, is_hollow: !pin.enabled || is_misclick }
    }

    /// A ring at the pin's pixel, and a line to where the object has its point.
    fn draw(&self, painter: &Painter, at: Pos2, point: Option<Pos2>, strength: f32) {
        let color = self.color.gamma_multiply(strength);
        let shade = colors::SHADE.gamma_multiply(strength);
        if let Some(point) = point.filter(|point| point.distance(at) > LEAST_RESIDUAL) {
            painter.line_segment([at, point], Stroke::new(3.5, shade));
            painter.line_segment([at, point], Stroke::new(1.5, color));
            painter.circle_filled(point, 3.5, shade);
            painter.circle_filled(point, 2.5, color);
        }
        let radius = RADIUS + if self.is_lit { 2.0 } else { 0.0 };
        painter.circle_stroke(at, radius, Stroke::new(4.5, shade));
        painter.circle_stroke(at, radius, Stroke::new(2.0, color));
        if !self.is_hollow {
            painter.circle_filled(at, 1.8, color);
        }
        let font = FontId::proportional(11.0);
        let corner = at + Vec2::new(radius + 3.0, -radius - 1.0);
        painter.text(corner + Vec2::splat(1.0), Align2::LEFT_BOTTOM, &self.text, font.clone(), shade);
        painter.text(corner, Align2::LEFT_BOTTOM, &self.text, font, color);
    }
}

/// The half of a pin that waits for the other.
fn draw_half(painter: &Painter, place: &ViewportPlace, session: &Session, eye: &Eye) {
    let Some(half) = session.half_pin() else { return };
    let seen = match half {
        HalfPin::Pixel(pixel) => Some(eye.viewport_from_image(pixel)),
        HalfPin::Point(object, point_mm) => session.photo().and_then(|photo| {
            let annotation = session.scene().annotation(photo.id, object)?;
            eye.project(annotation.camera_from_object.transform_point(point_mm))
        }),
    };
    let Some(seen) = seen else { return };
    draw_waiting(painter, place.position(seen));
}

/// A pin whose other half is looked for: dashes in place of a ring.
pub fn draw_waiting(painter: &Painter, at: Pos2) {
    for (width, color) in [(4.5, colors::SHADE), (2.0, colors::PIN)] {
        for quarter in 0..4 {
            let arc = (0..=6).map(|step| {
                let angle = (quarter as f32 + step as f32 / 9.0) * std::f32::consts::FRAC_PI_2;
                at + Vec2::angled(angle) * (RADIUS + 1.0)
            });
            painter.line(arc.collect(), Stroke::new(width, color));
        }
    }
    painter.circle_filled(at, 1.8, colors::PIN);
}

/// The surroundings of a pin that is dragged, larger.
struct Loupe {
    place: ViewportPlace,
    /// Physical pixels per photo pixel.
    zoom: f64,
    pixel: DVec2,
}

impl Loupe {
    /// The view's picture around the pin: what counts is the photo, so of the object only its outline.
    fn picture(&self, of_view: &Picture) -> Picture {
        let [width, height] = self.place.size_px().map(f64::from);
        let half = DVec2::new(width, height) / 2.0 / self.zoom;
        let rect = ImageRect { min: self.pixel - half, max: self.pixel + half };
        let look = Look {
            mode: OverlayMode::Outline,
            layers: Layers::Both,
            wipe: None,
            difference: false,
            x_ray: false,
            ..of_view.look
        };
        Picture { rect, look, ..of_view.clone() }
    }

    fn frame(&self, painter: &Painter, number: usize) {
        let rect = self.place.rect;
        painter.rect_stroke(rect, 0.0, Stroke::new(3.0, colors::SHADE), StrokeKind::Outside);
        painter.rect_stroke(rect, 0.0, Stroke::new(1.5, colors::PIN), StrokeKind::Outside);
        // The crosshair leaves its middle free: that is what is looked at.
        let center = rect.center();
        for direction in [Vec2::X, Vec2::Y, -Vec2::X, -Vec2::Y] {
            let arm = [center + direction * 6.0, center + direction * 22.0];
            painter.line_segment(arm, Stroke::new(3.0, colors::SHADE));
            painter.line_segment(arm, Stroke::new(1.25, colors::PIN));
        }
        let text = format!("{}    u {:.1}  v {:.1}", number + 1, self.pixel.x, self.pixel.y);
        let font = FontId::proportional(11.0);
        let at = rect.left_bottom() + Vec2::new(6.0, -4.0);
        painter.text(at + Vec2::splat(1.0), Align2::LEFT_BOTTOM, &text, font.clone(), colors::SHADE);
        painter.text(at, Align2::LEFT_BOTTOM, &text, font, colors::TEXT);
    }
}

/// Above the pointer and to its left, where a right hand is not; where there is no room, on the other side.
fn loupe_place(view: &ViewportPlace, at: Pos2) -> ViewportPlace {
    let side = LOUPE_SIDE.min(view.rect.width() / 2.0).min(view.rect.height() / 2.0);
    let x =
        if at.x - LOUPE_GAP - side > view.rect.left() { at.x - LOUPE_GAP - side } else { at.x + LOUPE_GAP };
    let y =
        if at.y - LOUPE_GAP - side > view.rect.top() { at.y - LOUPE_GAP - side } else { at.y + LOUPE_GAP };
    let snap = |value: f32| (value * view.pixels_per_point).round() / view.pixels_per_point;
    let rect = Rect::from_min_size(pos2(snap(x), snap(y)), Vec2::splat(snap(side)));
    ViewportPlace { rect: rect.intersect(view.rect), ..*view }
}
