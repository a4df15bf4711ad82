//! The views: photo, scene or both, and what lies quietly over them.

mod chooser;
mod corners;
mod gizmo;
mod hints;
mod orientation;
mod paint;
mod photo;
mod pins;
mod scene;
mod unit_question;

use egui::{CursorIcon, Id, Rect, Response, Sense, Ui, Vec2};

use super::{Asked, Surroundings, UiState, theme};
use crate::interact::Pane;
use crate::session::{Arrangement, Session, Tool};

pub use paint::SharedRenderer;

/// Between two views.
const DIVIDER_WIDTH: f32 = 6.0;

/// A view is never narrower than this part of both.
const LEAST_PART: f32 = 0.15;

/// Where a view is on the page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewportPlace {
    /// In points, whole physical pixels.
    pub rect: Rect,
    pub pixels_per_point: f32,
    pub layer: egui::LayerId,
}

impl ViewportPlace {
    /// The size in physical pixels.
    pub fn size_px(&self) -> [u32; 2] {
        [self.rect.width(), self.rect.height()]
            .map(|points| (points * self.pixels_per_point).round().max(1.0) as u32)
    }

    fn corner_px(&self) -> [u32; 2] {
        [self.rect.left(), self.rect.top()]
            .map(|points| (points * self.pixels_per_point).round().max(0.0) as u32)
    }

    /// From physical pixels of the view to the page.
    fn position(&self, viewport_pixel: glam::DVec2) -> egui::Pos2 {
        let offset = viewport_pixel / f64::from(self.pixels_per_point);
        self.rect.min + Vec2::new(offset.x as f32, offset.y as f32)
    }
}

/// How two views share the room.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SplitState {
    photo_part: f32,
}

impl Default for SplitState {
    fn default() -> Self {
        Self { photo_part: 0.5 }
    }
}

pub fn draw(
    ui: &mut Ui,
    session: &Session,
    around: &Surroundings<'_>,
    state: &mut UiState,
    asked: &mut Asked,
) {
    let whole = ui.max_rect();
    let places = views(ui, whole, session, around, state, asked);
    chooser::draw(ui, whole, session, chooser::Choices::ALL, &mut asked.commands);
    corners::errors(ui, whole, session);
    hints::draw(
        ui,
        places.into_iter().flatten().next().map_or(whole, |place| place.rect),
        session,
        around,
        asked,
    );
    unit_question::draw(ui, whole, session, &mut asked.commands);
    if around.files_hover {
        let stroke = egui::Stroke::new(3.0, theme::ACCENT);
        ui.painter().rect_stroke(whole.shrink(6.0), 10.0, stroke, egui::StrokeKind::Inside);
    }
}

/// The same for a participant of a study: only what may be used, and no numbers that a pose could be compared with.
pub fn draw_for_study(
    ui: &mut Ui,
    session: &Session,
    around: &Surroundings<'_>,
    state: &mut UiState,
    asked: &mut Asked,
    tools: &[crate::study::Tool],
) {
    use crate::study::Tool as Allowed;
    let whole = ui.max_rect();
    let places = views(ui, whole, session, around, state, asked);
    let choices = chooser::Choices {
        views: tools.contains(&Allowed::SceneView),
        modes: tools.contains(&Allowed::Looks),
    };
    chooser::draw(ui, whole, session, choices, &mut asked.commands);
    let rect = places.into_iter().flatten().next().map_or(whole, |place| place.rect);
    hints::draw(ui, rect, session, around, asked);
}

/// The views that are on screen, each with what lies in it.
fn views(
    ui: &mut Ui,
    whole: Rect,
    session: &Session,
    around: &Surroundings<'_>,
    state: &mut UiState,
    asked: &mut Asked,
) -> [Option<ViewportPlace>; 2] {
    // Without a photo there is no camera to place anything by.
    let arrangement = match session.photo() {
        Some(_) => session.panes().arrangement,
        None => Arrangement::Photo,
    };
    let (photo_rect, scene_rect) = match arrangement {
        Arrangement::Photo => (Some(whole), None),
        Arrangement::Scene => (None, Some(whole)),
        Arrangement::Split => {
            let (photo, scene) = split(ui, whole, &mut state.split);
            (Some(photo), Some(scene))
        }
    };
    state.viewport = photo_rect.map(|rect| photo::draw(ui, rect, session, around));
    state.scene_viewport = scene_rect.map(|rect| scene::draw(ui, rect, session, around, asked));
    [state.viewport, state.scene_viewport]
}

/// Two rectangles side by side, and between them a divider that can be dragged.
fn split(ui: &mut Ui, whole: Rect, state: &mut SplitState) -> (Rect, Rect) {
    let middle = |part: f32| whole.left() + whole.width() * part;
    let strip =
        |x: f32| Rect::from_x_y_ranges(x - DIVIDER_WIDTH / 2.0..=x + DIVIDER_WIDTH / 2.0, whole.y_range());
    let id = Id::unique("view divider");
    let response = ui.interact(strip(middle(state.photo_part)), id, Sense::drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Splitter, true, "Divide the views"));
    if let Some(position) = response.interact_pointer_pos() {
        let part = (position.x - whole.left()) / whole.width().max(1.0);
        state.photo_part = part.clamp(LEAST_PART, 1.0 - LEAST_PART);
    }
    let lit = response.hovered() || response.dragged();
    if lit {
        ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    let strip = strip(middle(state.photo_part));
    let visuals = ui.visuals();
    let fill = if lit { theme::ACCENT } else { visuals.widgets.noninteractive.bg_stroke.color };
    ui.painter().rect_filled(strip.shrink2(Vec2::new(2.0, 0.0)), 0.0, fill);
    let photo = Rect::from_min_max(whole.min, strip.left_bottom());
    let scene = Rect::from_min_max(strip.right_top(), whole.max);
    (photo, scene)
}

/// A view's widget, on whole pixels, so that one texel of the picture is one pixel of the screen.
fn place(ui: &mut Ui, available: Rect, label: &'static str) -> (ViewportPlace, Response) {
    let pixels_per_point = ui.ctx().pixels_per_point();
    let snap = |position: egui::Pos2| {
        egui::pos2((position.x * pixels_per_point).round(), (position.y * pixels_per_point).round())
            / pixels_per_point
    };
    let rect = Rect::from_min_max(snap(available.min), snap(available.max));
    let response = ui.allocate_rect(rect, Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, label));
    (ViewportPlace { rect, pixels_per_point, layer: ui.layer_id() }, response)
}

fn cursor_icon(ui: &Ui, response: &Response, pane: Pane, session: &Session, around: &Surroundings<'_>) {
    let hands = around.hands;
    if hands.is_dragging_object() {
        ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
    } else if !response.hovered() {
    } else if pane == Pane::Photo && hands.wipe_is_lit(session) {
        ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    } else if session.tool() == Tool::Pin && hands.hovered_pin(session).is_none() {
        ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
    } else if hands.hovered_handle(pane, session).is_some() || hands.hit_under_pointer(session).is_some() {
        ui.ctx().set_cursor_icon(CursorIcon::Grab);
    }
}

/// Colours of what lies over a view: dark grounds and light text in either theme, for photos know none.
mod colors {
    use egui::Color32;

    /// x, y, z: as the renderer draws them.
    pub const AXES: [Color32; 3] =
        [Color32::from_rgb(244, 72, 72), Color32::from_rgb(84, 208, 96), Color32::from_rgb(88, 148, 255)];
    pub const VIEW_HANDLES: Color32 = Color32::from_rgb(235, 238, 243);
    pub const SHADE: Color32 = Color32::from_black_alpha(110);
    /// Light on dark photos, told from the light ones by its dark rim; a misclick has an exclamation mark too.
    pub const PIN: Color32 = Color32::from_rgb(255, 209, 71);
    pub const PIN_OFF: Color32 = Color32::from_rgb(176, 180, 188);
    pub const MISCLICK: Color32 = Color32::from_rgb(255, 110, 84);
    pub const OVERLAY: Color32 = Color32::from_black_alpha(170);
    pub const TEXT: Color32 = Color32::from_rgb(222, 226, 233);
}
