//! One scene of the list, in columns.

use egui::{
    Align, Align2, Layout, Rect, Response, Sense, TextEdit, TextStyle, TextWrapMode, Ui, UiBuilder, Vec2,
    WidgetText,
};

use super::words;
use crate::platform::SceneSummary;
use crate::ui::theme;

const HEIGHT: f32 = 30.0;
const MARGIN: f32 = 10.0;

/// Columns from the right: size, when it was changed, what is in it.
const SIZE_WIDTH: f32 = 70.0;
const CHANGED_WIDTH: f32 = 120.0;
const COUNTS_WIDTH: f32 = 150.0;

pub fn draw(ui: &mut Ui, scene: &SceneSummary, now_ms: f64, is_selected: bool, is_open: bool) -> Response {
    let (rect, response) = ui.allocate_exact_size(Vec2::new(ui.available_width(), HEIGHT), Sense::click());
    let heading = &scene.heading;
    let columns = [
        words::counts_text(heading.photo_count, heading.object_count),
        words::when_text(heading.changed_at_ms, now_ms),
        words::size_text(scene.bytes),
    ];
    response.widget_info(|| {
        let open = if is_open { ", open" } else { "" };
        let label = format!("{}{open}, {}", heading.title(), columns.join(", "));
        egui::WidgetInfo::selected(egui::Role::Button, true, is_selected, label)
    });
    if is_selected || response.hovered() {
        let visuals = ui.visuals();
        let fill = if is_selected { visuals.selection.bg_fill } else { visuals.widgets.hovered.bg_fill };
        ui.painter().rect_filled(rect, 6.0, fill.gamma_multiply(if is_selected { 0.7 } else { 0.5 }));
    }
    let weak = ui.visuals().weak_text_color();
    let mut right = rect.right() - MARGIN;
    for (text, width) in columns.iter().zip([COUNTS_WIDTH, CHANGED_WIDTH, SIZE_WIDTH]).rev() {
        let at = egui::pos2(right, rect.center().y);
        ui.painter().text(at, Align2::RIGHT_CENTER, text, TextStyle::Body.resolve(ui.style()), weak);
        right -= width;
    }
    title(
        ui,
        Rect::from_x_y_ranges(rect.left() + MARGIN..=right - MARGIN, rect.y_range()),
        heading.title(),
        is_open,
    );
    response
}

/// The name, cut off where it is too long, and a mark if the scene is open.
fn title(ui: &Ui, rect: Rect, text: &str, is_open: bool) {
    let room_for_mark = if is_open { 50.0 } else { 0.0 };
    let wrap = Some(TextWrapMode::Truncate);
    let width = rect.width() - room_for_mark;
    let galley = WidgetText::from(text).into_galley(ui, wrap, width, TextStyle::Body);
    let at = egui::pos2(rect.left(), rect.center().y - galley.size().y / 2.0);
    let end = at.x + galley.size().x;
    ui.painter().galley(at, galley, ui.visuals().text_color());
    if is_open {
        let at = egui::pos2(end + 10.0, rect.center().y);
        let font = TextStyle::Small.resolve(ui.style());
        ui.painter().text(at, Align2::LEFT_CENTER, "open", font, theme::ACCENT);
    }
}

/// The row while its name is being typed.
pub fn name_field(ui: &mut Ui, name: &mut String) -> Response {
    let (_, rect) = ui.allocate_space(Vec2::new(ui.available_width(), HEIGHT));
    let layout = Layout::left_to_right(Align::Center);
    let mut inside =
        ui.new_child(UiBuilder::new().max_rect(rect.shrink2(Vec2::new(6.0, 2.0))).layout(layout));
    let field = inside.add(TextEdit::singleline(name).desired_width(rect.width() - 20.0));
    field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "New name"));
    field
}
