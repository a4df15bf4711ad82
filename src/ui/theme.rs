//! Colours, sizes and spacing: one calm look, dark and light, with one accent.
//!
//! Sizes and gaps are multiples of 4 points, with 2 inside of small things. Text meets WCAG AA on everything it is put on;
//! the test below computes it.

use egui::{
    Color32, CornerRadius, FontFamily, FontId, Frame, InnerResponse, Margin, RichText, Stroke, TextStyle,
    Theme, Ui, Vec2, Visuals,
};

use crate::scene::Rgb;

pub const PANEL_WIDTH: f32 = 272.0;

/// Around the photo, in both themes: a bright surround would change how the photo is judged. The same as the renderer's.
pub const VIEWPORT_BACKGROUND: Color32 = Color32::from_rgb(24, 26, 31);

/// For marks and lines in both themes, and for text on dark ground; text on panels takes [`accent`] and its like.
pub const ACCENT: Color32 = Color32::from_rgb(70, 140, 242);
pub const WARNING: Color32 = Color32::from_rgb(196, 126, 26);
pub const ERROR: Color32 = Color32::from_rgb(237, 90, 80);
pub const GOOD: Color32 = Color32::from_rgb(60, 160, 100);

/// Under the white text of the one thing to do next.
const PRIMARY: Color32 = Color32::from_rgb(38, 100, 190);

/// What differs between the themes.
struct Palette {
    panel: Color32,
    bar: Color32,
    window: Color32,
    faint: Color32,
    field: Color32,
    widget: Color32,
    widget_hovered: Color32,
    widget_pressed: Color32,
    line: Color32,
    text: Color32,
    weak_text: Color32,
    strong_text: Color32,
    selection: Color32,
    selected_text: Color32,
    accent: Color32,
    warning: Color32,
    error: Color32,
    good: Color32,
}

const DARK: Palette = Palette {
    panel: Color32::from_rgb(32, 35, 42),
    bar: Color32::from_rgb(27, 29, 35),
    window: Color32::from_rgb(38, 41, 49),
    faint: Color32::from_rgb(37, 40, 48),
    field: Color32::from_rgb(20, 22, 27),
    widget: Color32::from_rgb(47, 51, 61),
    widget_hovered: Color32::from_rgb(58, 64, 77),
    widget_pressed: Color32::from_rgb(68, 75, 90),
    line: Color32::from_rgb(54, 58, 69),
    text: Color32::from_rgb(222, 226, 233),
    weak_text: Color32::from_rgb(157, 164, 177),
    strong_text: Color32::WHITE,
    selection: Color32::from_rgb(38, 84, 150),
    selected_text: Color32::WHITE,
    accent: Color32::from_rgb(104, 169, 255),
    warning: Color32::from_rgb(240, 180, 60),
    error: Color32::from_rgb(255, 124, 114),
    good: Color32::from_rgb(90, 200, 130),
};

const LIGHT: Palette = Palette {
    panel: Color32::from_rgb(246, 247, 249),
    bar: Color32::from_rgb(236, 238, 242),
    window: Color32::from_rgb(255, 255, 255),
    faint: Color32::from_rgb(239, 241, 245),
    field: Color32::from_rgb(238, 240, 245),
    widget: Color32::from_rgb(226, 229, 235),
    widget_hovered: Color32::from_rgb(214, 218, 227),
    widget_pressed: Color32::from_rgb(200, 206, 218),
    line: Color32::from_rgb(208, 212, 220),
    text: Color32::from_rgb(33, 37, 45),
    weak_text: Color32::from_rgb(86, 93, 106),
    strong_text: Color32::BLACK,
    selection: Color32::from_rgb(197, 220, 250),
    selected_text: Color32::from_rgb(12, 40, 84),
    accent: Color32::from_rgb(18, 88, 184),
    warning: Color32::from_rgb(130, 78, 0),
    error: Color32::from_rgb(176, 32, 24),
    good: Color32::from_rgb(16, 106, 56),
};

fn palette(visuals: &Visuals) -> &'static Palette {
    if visuals.dark_mode { &DARK } else { &LIGHT }
}

/// Text that stands out, on panels and dialogs.
pub fn accent(visuals: &Visuals) -> Color32 {
    palette(visuals).accent
}

pub fn warning(visuals: &Visuals) -> Color32 {
    palette(visuals).warning
}

pub fn error(visuals: &Visuals) -> Color32 {
    palette(visuals).error
}

pub fn good(visuals: &Visuals) -> Color32 {
    palette(visuals).good
}

/// Puts both themes on a context; [`super::ThemeChoice`] says which one is shown.
pub fn apply_theme(ctx: &egui::Context) {
    // As long as on most desktops; egui's own 0.3 s is too short for some hands.
    ctx.options_mut(|options| options.input_options.max_double_click_delay = 0.5);
    ctx.all_styles_mut(|style| {
        let proportional = |size| FontId::new(size, FontFamily::Proportional);
        style.text_styles = [
            (TextStyle::Small, proportional(11.5)),
            (TextStyle::Body, proportional(13.5)),
            (TextStyle::Button, proportional(13.5)),
            (TextStyle::Heading, proportional(20.0)),
            (TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace)),
        ]
        .into();
        style.spacing.item_spacing = Vec2::new(8.0, 6.0);
        style.spacing.button_padding = Vec2::new(8.0, 4.0);
        style.spacing.menu_margin = Margin::same(6);
        style.spacing.interact_size.y = 24.0;
        style.spacing.slider_width = 120.0;
        style.interaction.tooltip_delay = 0.35;
    });
    ctx.set_visuals_of(Theme::Dark, visuals(&DARK, Visuals::dark()));
    ctx.set_visuals_of(Theme::Light, visuals(&LIGHT, Visuals::light()));
}

/// What is drawn over the photo is light on dark in both themes.
pub fn use_dark(ui: &mut Ui) {
    *ui.visuals_mut() = visuals(&DARK, Visuals::dark());
}

fn visuals(palette: &Palette, mut visuals: Visuals) -> Visuals {
    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.window;
    visuals.window_stroke = Stroke::new(1.0, palette.line);
    visuals.window_corner_radius = CornerRadius::same(10);
    visuals.menu_corner_radius = CornerRadius::same(8);
    visuals.extreme_bg_color = palette.field;
    visuals.text_edit_bg_color = Some(palette.field);
    visuals.faint_bg_color = palette.faint;
    visuals.hyperlink_color = palette.accent;
    visuals.warn_fg_color = palette.warning;
    visuals.error_fg_color = palette.error;
    visuals.weak_text_color = Some(palette.weak_text);
    visuals.selection.bg_fill = palette.selection;
    visuals.selection.stroke = Stroke::new(1.0, palette.selected_text);
    let widgets = &mut visuals.widgets;
    for state in [
        &mut widgets.noninteractive,
        &mut widgets.inactive,
        &mut widgets.hovered,
        &mut widgets.active,
        &mut widgets.open,
    ] {
        state.corner_radius = CornerRadius::same(6);
        state.expansion = 0.0;
        state.fg_stroke = Stroke::new(1.0, palette.text);
        state.bg_stroke = Stroke::NONE;
    }
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, palette.line);
    for (state, fill) in [
        (&mut widgets.inactive, palette.widget),
        (&mut widgets.hovered, palette.widget_hovered),
        (&mut widgets.active, palette.widget_pressed),
        (&mut widgets.open, palette.widget_hovered),
    ] {
        state.bg_fill = fill;
        state.weak_bg_fill = fill;
    }
    widgets.hovered.fg_stroke = Stroke::new(1.0, palette.strong_text);
    widgets.active.fg_stroke = Stroke::new(1.0, palette.strong_text);
    // The keyboard's place has to be seen.
    widgets.active.bg_stroke = Stroke::new(1.0, palette.accent);
    visuals
}

pub fn bar_frame(visuals: &Visuals) -> Frame {
    Frame::NONE.fill(palette(visuals).bar).inner_margin(Margin::symmetric(8, 5))
}

pub fn panel_frame(visuals: &Visuals) -> Frame {
    Frame::NONE.fill(palette(visuals).panel).inner_margin(Margin { left: 12, right: 4, top: 4, bottom: 4 })
}

/// Room inside dialogs.
pub fn dialog_frame(ctx: &egui::Context) -> Frame {
    Frame::popup(&ctx.global_style()).inner_margin(Margin::same(16))
}

/// A message over everything.
pub fn toast_frame(visuals: &Visuals, edge: Color32) -> Frame {
    Frame::NONE
        .fill(palette(visuals).window)
        .stroke(Stroke::new(1.0, edge.gamma_multiply(0.6)))
        .corner_radius(8)
        .inner_margin(Margin::symmetric(12, 8))
}

/// A quiet box over the viewport, dark in both themes, with what is in it.
#[derive(Debug, Clone, Copy)]
pub struct OverlayFrame(Frame);

impl OverlayFrame {
    pub fn show<R>(self, ui: &mut Ui, add_contents: impl FnOnce(&mut Ui) -> R) -> InnerResponse<R> {
        self.0.show(ui, |ui| {
            use_dark(ui);
            add_contents(ui)
        })
    }
}

pub fn overlay_frame() -> OverlayFrame {
    let fill = Color32::from_black_alpha(170);
    OverlayFrame(Frame::NONE.fill(fill).corner_radius(6).inner_margin(Margin::symmetric(8, 4)))
}

/// The title of a group in a sheet, and a little room before it.
pub fn group_title(ui: &mut Ui, title: &str) {
    ui.add_space(10.0);
    let color = ui.visuals().weak_text_color();
    ui.label(RichText::new(title.to_uppercase()).small().strong().color(color));
}

pub fn color32(Rgb([red, green, blue]): Rgb) -> Color32 {
    Color32::from_rgb(red, green, blue)
}

/// A button that stands out: the one thing to do next.
pub fn primary_button(text: &str) -> egui::Button<'static> {
    egui::Button::new(RichText::new(text.to_owned()).strong().color(Color32::WHITE)).fill(PRIMARY)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// WCAG 2: relative luminance, sRGB decoded.
    fn luminance(color: Color32) -> f64 {
        let [red, green, blue] = [color.r(), color.g(), color.b()].map(|channel| {
            let value = f64::from(channel) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        });
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    }

    fn contrast(a: Color32, b: Color32) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn text_meets_wcag_aa_in_both_themes() {
        for (name, palette) in [("dark", DARK), ("light", LIGHT)] {
            let grounds = [palette.panel, palette.bar, palette.window, palette.faint, palette.field];
            let texts = [
                palette.text,
                palette.weak_text,
                palette.accent,
                palette.warning,
                palette.error,
                palette.good,
            ];
            for ground in grounds {
                for text in texts {
                    assert!(contrast(text, ground) >= 4.5, "{name}: {text:?} on {ground:?}");
                }
            }
            for widget in [palette.widget, palette.widget_hovered, palette.widget_pressed] {
                assert!(contrast(palette.text, widget) >= 4.5, "{name}: {widget:?}");
            }
            assert!(contrast(palette.selected_text, palette.selection) >= 4.5, "{name}");
        }
        assert!(contrast(Color32::WHITE, PRIMARY) >= 4.5);
    }

    #[test]
    fn marks_are_seen_in_both_themes() {
        for mark in [ACCENT, WARNING, ERROR, GOOD] {
            assert!(contrast(mark, DARK.panel) >= 4.5, "{mark:?}");
            assert!(contrast(mark, VIEWPORT_BACKGROUND) >= 4.5, "{mark:?}");
            assert!(contrast(mark, LIGHT.panel) >= 3.0, "{mark:?} {}", contrast(mark, LIGHT.panel));
        }
    }
}
