//! The axes of the photo's camera as the scene view sees them: click for a standard view, drag to orbit.

use egui::{Align2, Area, Color32, FontId, Id, Order, Pos2, Rect, Response, Sense, Stroke, Ui, Vec2};
use glam::DVec2;

use super::{ViewportPlace, colors};
use crate::interact::{SceneMove, SceneView, StandardView};
use crate::math::sort_short;
use crate::ui::Asked;

const SIDE: f32 = 92.0;
const ARM: f32 = 33.0;
const END_RADIUS: f32 = 9.0;

/// One end of an axis on screen.
struct End {
    view: StandardView,
    position: Pos2,
    /// Larger is farther away.
    depth: f64,
}

pub fn draw(ui: &Ui, place: &ViewportPlace, view: &SceneView, asked: &mut Asked) {
    Area::new(Id::unique("orientation"))
        .order(Order::Middle)
        .pivot(Align2::RIGHT_TOP)
        .fixed_pos(place.rect.right_top() + Vec2::new(-8.0, 8.0))
        .show(ui.ctx(), |ui| widget(ui, view, asked));
}

fn widget(ui: &mut Ui, view: &SceneView, asked: &mut Asked) {
    let (rect, ball) = ui.allocate_exact_size(Vec2::splat(SIDE), Sense::drag());
    let ball = ball.on_hover_cursor(egui::CursorIcon::Grab);
    if ball.dragged() {
        asked.scene_move = Some(SceneMove::Orbit(orbit_way_px(ball.drag_delta(), view)));
    }
    let ends = ends(rect, view);
    // Later widgets are above earlier ones: the nearest end takes the click.
    let responses: Vec<Response> = ends.iter().map(|end| interact(ui, end)).collect();
    let lit = responses.iter().any(Response::hovered) || ball.hovered() || ball.dragged();
    if lit {
        let fill = colors::OVERLAY.gamma_multiply(0.7);
        ui.painter().circle_filled(rect.center(), SIDE / 2.0, fill);
    }
    for (end, response) in ends.iter().zip(&responses) {
        draw_end(ui, rect.center(), end, response.hovered());
    }
    for (end, response) in ends.iter().zip(responses) {
        if response.clicked() {
            asked.scene_move = Some(SceneMove::LookFrom(end.view));
        }
        response.on_hover_text(end.view.name());
    }
}

/// The ends of the axes, the farthest first.
fn ends(rect: Rect, view: &SceneView) -> Vec<End> {
    let rotation = view.eye_from_camera().rotation;
    let mut ends: Vec<End> = StandardView::ALL
        .into_iter()
        .map(|view| {
            let seen = rotation * view.axis();
            let position = rect.center() + Vec2::new(seen.x as f32, seen.y as f32) * ARM;
            End { view, position, depth: seen.z }
        })
        .collect();
    sort_short(&mut ends, |a, b| b.depth.total_cmp(&a.depth));
    ends
}

fn interact(ui: &Ui, end: &End) -> Response {
    let rect = Rect::from_center_size(end.position, Vec2::splat(2.0 * END_RADIUS));
    let response = ui.interact(rect, ui.scope_id().with(end.view.axis_name()), Sense::click());
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Button, true, format!("View from {}", end.view.axis_name()))
    });
    response
}

fn draw_end(ui: &Ui, center: Pos2, end: &End, hovered: bool) {
    let painter = ui.painter();
    let axis = end.view as usize / 2;
    let is_positive = (end.view as usize).is_multiple_of(2);
    // What points away is fainter.
    let strength = 0.95 - 0.3 * (end.depth as f32 * 0.5 + 0.5);
    let color = colors::AXES[axis].gamma_multiply(strength);
    if is_positive {
        painter.line_segment([center, end.position], Stroke::new(2.5, color));
        painter.circle_filled(end.position, END_RADIUS, color);
    } else {
        painter.circle_filled(end.position, END_RADIUS - 1.0, colors::OVERLAY);
        painter.circle_stroke(end.position, END_RADIUS - 1.0, Stroke::new(1.6, color));
    }
    if hovered {
        painter.circle_stroke(end.position, END_RADIUS + 0.5, Stroke::new(2.0, Color32::WHITE));
    }
    if is_positive || hovered {
        let letter = end.view.axis_name().trim_start_matches('+');
        let text_color = if is_positive { Color32::from_gray(20) } else { colors::TEXT };
        let font = FontId::proportional(if is_positive { 11.5 } else { 9.5 });
        painter.text(end.position, Align2::CENTER_CENTER, letter, font, text_color);
    }
}

/// The ball turns with the hand.
fn orbit_way_px(way: Vec2, view: &SceneView) -> DVec2 {
    let half_turn_px = view.viewport().min_element().max(200.0);
    let angle = DVec2::new(f64::from(way.x), f64::from(way.y)) / f64::from(ARM);
    angle * half_turn_px / std::f64::consts::PI
}
