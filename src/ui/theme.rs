//! Colours, sizes and spacing: one calm dark theme, one accent.

use egui::{
    Color32, CornerRadius, FontFamily, FontId, Frame, Margin, RichText, Stroke, TextStyle, Theme, Vec2,
};

use crate::scene::Rgb;

pub const PANEL_WIDTH: f32 = 272.0;

/// Around the photo; the same as the renderer's own.
pub const VIEWPORT_BACKGROUND: Color32 = Color32::from_rgb(24, 26, 31);
pub const ACCENT: Color32 = Color32::from_rgb(76, 154, 255);
pub const WARNING: Color32 = Color32::from_rgb(240, 180, 60);
pub const ERROR: Color32 = Color32::from_rgb(255, 110, 100);
pub const GOOD: Color32 = Color32::from_rgb(90, 200, 130);

const PANEL: Color32 = Color32::from_rgb(32, 35, 42);
const BAR: Color32 = Color32::from_rgb(27, 29, 35);
const WIDGET: Color32 = Color32::from_rgb(47, 51, 61);
const WIDGET_HOVERED: Color32 = Color32::from_rgb(58, 64, 77);
const FIELD: Color32 = Color32::from_rgb(20, 22, 27);
const TEXT: Color32 = Color32::from_rgb(222, 226, 233);
const WEAK_TEXT: Color32 = Color32::from_rgb(146, 153, 166);
const LINE: Color32 = Color32::from_rgb(50, 54, 64);

/// Puts the theme on a context.
pub fn apply_theme(ctx: &egui::Context) {
    ctx.set_theme(Theme::Dark);
    // As long as on most desktops; egui's own 0.3 s is too short for some hands.
    ctx.options_mut(|options| options.input_options.max_double_click_delay = 0.5);
    ctx.all_styles_mut(|style| {
        let proportional = |size| FontId::new(size, FontFamily::Proportional);
        style.text_styles = [
            (TextStyle::Small, proportional(11.5)),
            (TextStyle::Body, proportional(13.5)),
            (TextStyle::Button, proportional(13.5)),
            (TextStyle::Heading, proportional(21.0)),
            (TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace)),
        ]
        .into();
        style.spacing.item_spacing = Vec2::new(8.0, 6.0);
        style.spacing.button_padding = Vec2::new(9.0, 4.0);
        style.spacing.interact_size.y = 24.0;
        style.spacing.slider_width = 120.0;
        style.interaction.tooltip_delay = 0.35;
        style.visuals = visuals();
    });
}

fn visuals() -> egui::Visuals {
    let mut visuals = egui::Visuals::dark();
    visuals.panel_fill = PANEL;
    visuals.window_fill = Color32::from_rgb(38, 41, 49);
    visuals.window_stroke = Stroke::new(1.0, LINE);
    visuals.window_corner_radius = CornerRadius::same(10);
    visuals.menu_corner_radius = CornerRadius::same(8);
    visuals.extreme_bg_color = FIELD;
    visuals.faint_bg_color = Color32::from_rgb(37, 40, 48);
    visuals.hyperlink_color = ACCENT;
    visuals.warn_fg_color = WARNING;
    visuals.error_fg_color = ERROR;
    visuals.weak_text_color = Some(WEAK_TEXT);
    visuals.selection.bg_fill = Color32::from_rgb(38, 84, 150);
    visuals.selection.stroke = Stroke::new(1.0, Color32::WHITE);
    let radius = CornerRadius::same(6);
    let widgets = &mut visuals.widgets;
    for state in [
        &mut widgets.noninteractive,
        &mut widgets.inactive,
        &mut widgets.hovered,
        &mut widgets.active,
        &mut widgets.open,
    ] {
        state.corner_radius = radius;
        state.expansion = 0.0;
    }
    widgets.noninteractive.fg_stroke = Stroke::new(1.0, TEXT);
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, LINE);
    widgets.inactive.fg_stroke = Stroke::new(1.0, TEXT);
    widgets.inactive.bg_fill = WIDGET;
    widgets.inactive.weak_bg_fill = WIDGET;
    widgets.hovered.fg_stroke = Stroke::new(1.0, Color32::WHITE);
    widgets.hovered.bg_fill = WIDGET_HOVERED;
    widgets.hovered.weak_bg_fill = WIDGET_HOVERED;
    widgets.hovered.bg_stroke = Stroke::NONE;
    widgets.active.bg_fill = ACCENT;
    widgets.active.weak_bg_fill = WIDGET_HOVERED;
    widgets.active.bg_stroke = Stroke::NONE;
    visuals
}

pub fn bar_frame() -> Frame {
    Frame::NONE.fill(BAR).inner_margin(Margin::symmetric(8, 5))
}

pub fn panel_frame() -> Frame {
    Frame::NONE.fill(PANEL).inner_margin(Margin { left: 12, right: 4, top: 4, bottom: 4 })
}

/// Room inside dialogs.
pub fn dialog_frame(ctx: &egui::Context) -> Frame {
    Frame::popup(&ctx.global_style()).inner_margin(Margin::same(18))
}

/// A quiet box over the viewport.
pub fn overlay_frame() -> Frame {
    Frame::NONE
        .fill(Color32::from_black_alpha(170))
        .corner_radius(CornerRadius::same(6))
        .inner_margin(Margin::symmetric(8, 4))
}

pub fn color32(Rgb([red, green, blue]): Rgb) -> Color32 {
    Color32::from_rgb(red, green, blue)
}

/// A button that stands out: the one thing to do next.
pub fn primary_button(text: &str) -> egui::Button<'static> {
    egui::Button::new(RichText::new(text.to_owned()).strong().color(Color32::WHITE))
        .fill(Color32::from_rgb(38, 100, 190))
}
