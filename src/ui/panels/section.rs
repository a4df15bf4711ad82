//! The foldable parts of the side panel.

use egui::collapsing_header::CollapsingState;
use egui::{Align, Id, Layout, Rect, RichText, Sense, Shape, Ui, UiBuilder, Vec2, pos2};

const HEADER_HEIGHT: f32 = 24.0;

/// A quiet caption over several sections.
pub fn caption(ui: &mut Ui, text: &str) {
    ui.add_space(5.0);
    ui.label(RichText::new(text.to_uppercase()).small().weak());
}

/// A title that folds what is under it; the buttons at its right end stay.
pub fn section(
    ui: &mut Ui,
    title: &str,
    is_open_at_first: bool,
    buttons: impl FnOnce(&mut Ui),
    body: impl FnOnce(&mut Ui),
) {
    let (mut buttons, mut body) = (Some(buttons), Some(body));
    section_of_any(
        ui,
        title,
        is_open_at_first,
        &mut |ui| {
            if let Some(buttons) = buttons.take() {
                buttons(ui);
            }
        },
        &mut |ui| {
            if let Some(body) = body.take() {
                body(ui);
            }
        },
    );
}

/// Compiled once for all sections: there are a dozen.
fn section_of_any(
    ui: &mut Ui,
    title: &str,
    is_open_at_first: bool,
    buttons: &mut dyn FnMut(&mut Ui),
    body: &mut dyn FnMut(&mut Ui),
) {
    let id = Id::unique(("side panel section", title));
    let mut state = CollapsingState::load_with_default_open(ui.ctx(), id, is_open_at_first);
    let (rect, _) = ui.allocate_exact_size(Vec2::new(ui.available_width(), HEADER_HEIGHT), Sense::hover());
    let response = ui.interact(rect, id.with("title"), Sense::click());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::DisclosureTriangle, true, title));
    if response.clicked() {
        state.toggle(ui);
    }
    paint_title(ui, rect, title, state.openness(ui.ctx()), response.hovered() || response.has_focus());
    let right = UiBuilder::new().max_rect(rect).layout(Layout::right_to_left(Align::Center));
    // Laid over the title, so that it takes no room of its own.
    let mut over_title = ui.new_child(right);
    over_title.spacing_mut().item_spacing.x = 2.0;
    buttons(&mut over_title);
    let tooltip = if state.is_open() { "Fold" } else { "Unfold" };
    response.on_hover_text(tooltip);
    state.show_body_unindented(ui, |ui| {
        ui.spacing_mut().item_spacing = Vec2::new(6.0, 5.0);
        ui.spacing_mut().interact_size.y = super::number_field::FIELD_HEIGHT;
        body(ui);
        ui.add_space(2.0);
    });
    let below = ui.cursor().top();
    let line = ui.visuals().widgets.noninteractive.bg_stroke;
    ui.painter().hline(rect.x_range(), below, line);
    ui.add_space(1.0);
}

fn paint_title(ui: &Ui, rect: Rect, title: &str, openness: f32, is_lit: bool) {
    let visuals = ui.visuals();
    let color = if is_lit { visuals.strong_text_color() } else { visuals.text_color() };
    let center = pos2(rect.left() + 5.0, rect.center().y);
    let turn = egui::emath::Rot2::from_angle(openness * std::f32::consts::FRAC_PI_2);
    let points = [(-2.0, -3.5), (2.0, 0.0), (-2.0, 3.5)].map(|(x, y)| center + turn * Vec2::new(x, y));
    let stroke = egui::Stroke::new(1.4, visuals.weak_text_color());
    ui.painter().add(Shape::line(points.to_vec(), stroke));
    let font = egui::TextStyle::Body.resolve(ui.style());
    let position = pos2(rect.left() + 15.0, rect.center().y);
    ui.painter().text(position, egui::Align2::LEFT_CENTER, title, font, color);
}
