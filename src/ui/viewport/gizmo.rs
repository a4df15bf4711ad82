//! The handles over the selected object, drawn.

use egui::{Align2, Color32, Painter, Pos2, Shape, Stroke, Ui, Vec2};
use glam::DVec2;

use super::{ViewportPlace, colors, corners};
use crate::interact::gizmo::{Gizmo, Handle, HandleShape};
use crate::interact::{Pane, Viewpoint};
use crate::session::Session;
use crate::ui::Surroundings;

const WIDTH: f32 = 2.0;
const LIT_WIDTH: f32 = 3.5;

pub fn draw(
    ui: &Ui,
    place: &ViewportPlace,
    pane: Pane,
    view: &impl Viewpoint,
    session: &Session,
    around: &Surroundings<'_>,
) {
    let scale = f64::from(place.pixels_per_point);
    let eye = view.eye(session);
    let Some(gizmo) = eye.and_then(|eye| Gizmo::of(session, &eye, scale)) else { return };
    let held = around.hands.handle_drag(pane);
    // While something else is dragged, handles would only hide it.
    if around.hands.is_dragging_object() && held.is_none() {
        return;
    }
    let lit = held.map(|drag| drag.handle).or(around.hands.hovered_handle(pane, session));
    let painter = ui.painter().with_clip_rect(place.rect);
    for shape in &gizmo.shapes {
        let is_lit = lit == Some(shape.handle);
        let strength = match () {
            () if !gizmo.movable => 0.35,
            () if is_lit => 1.0,
            () if held.is_some() => 0.2,
            () => 0.9,
        };
        draw_shape(&painter, place, shape, is_lit, strength);
    }
    let pointer = around.hands.pointer.map(|(_, position)| place.position(position));
    if let (Some(drag), Some(pointer)) = (held, pointer) {
        corners::note(ui, pointer + Vec2::new(18.0, 18.0), Align2::LEFT_TOP, &drag.read_out());
    }
}

fn draw_shape(painter: &Painter, place: &ViewportPlace, shape: &HandleShape, is_lit: bool, strength: f32) {
    let color = color_of(shape.handle, is_lit).gamma_multiply(strength);
    let shade = colors::SHADE.gamma_multiply(strength);
    let width = if is_lit { LIT_WIDTH } else { WIDTH };
    let points = |line: &[DVec2]| -> Vec<Pos2> { line.iter().map(|point| place.position(*point)).collect() };
    for line in &shape.back {
        painter.line(points(line), Stroke::new(1.0, color.gamma_multiply(0.4)));
    }
    for line in &shape.front {
        painter.line(points(line), Stroke::new(width + 2.0, shade));
    }
    for line in &shape.front {
        painter.line(points(line), Stroke::new(width, color));
    }
    if let Some(head) = &shape.head {
        painter.add(Shape::convex_polygon(points(head), color, Stroke::new(1.0, shade)));
    }
    if let Some((center, radius)) = shape.knob {
        let radius = radius as f32 / place.pixels_per_point + if is_lit { 1.5 } else { 0.0 };
        let center = place.position(center);
        painter.circle_filled(center, radius + 1.5, shade);
        painter.circle_filled(center, radius, color);
        let arrow = Stroke::new(1.5, Color32::from_gray(50).gamma_multiply(strength));
        for direction in [-1.0, 1.0] {
            let tip = center + Vec2::new(0.0, direction * 4.0);
            let side = Vec2::new(2.2, -direction * 2.2);
            painter.line(vec![tip + side, tip, tip + side * Vec2::new(-1.0, 1.0)], arrow);
        }
    }
}

fn color_of(handle: Handle, is_lit: bool) -> Color32 {
    let color = match handle {
        Handle::Move(axis) | Handle::Turn(axis) => colors::AXES[axis as usize],
        Handle::Roll | Handle::Depth => colors::VIEW_HANDLES,
    };
    // Lit handles are lighter, and wider, for those who do not tell colours apart.
    if is_lit { color.lerp_to_gamma(Color32::WHITE, 0.35) } else { color }
}
