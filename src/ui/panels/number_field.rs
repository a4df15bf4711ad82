//! One number with its label and unit: dragged, or clicked and typed.

use egui::{Align, Align2, Atom, AtomExt as _, DragValue, Layout, Response, Ui, Vec2};

pub const FIELD_HEIGHT: f32 = 22.0;

/// What is written beside a number, and how it moves under the mouse.
#[derive(Debug, Clone, Copy)]
pub struct NumberField<'a> {
    /// Short, to the left of the field.
    pub label: &'a str,
    /// The field's name for those who do not see what is around it.
    pub name: &'a str,
    pub unit: &'a str,
    pub tooltip: &'a str,
    /// Per point of a drag.
    pub speed: f64,
    /// At most so many are shown; while it is edited, all that there are.
    pub decimals: usize,
    /// While it is typed; else when the field is left.
    pub live: bool,
}

impl Default for NumberField<'_> {
    fn default() -> Self {
        Self { label: "", name: "", unit: "", tooltip: "", speed: 0.1, decimals: 3, live: false }
    }
}

impl NumberField<'_> {
    /// Fills `width`; the label takes `label_width` of it, in every field the same, so that fields stand under one another.
    pub fn show(&self, ui: &mut Ui, width: f32, label_width: f32, value: &mut f64) -> Response {
        let size = Vec2::new(width, FIELD_HEIGHT);
        let response = ui
            .allocate_ui_with_layout(size, Layout::right_to_left(Align::Center), |ui| {
                ui.spacing_mut().button_padding.x = 4.0;
                ui.spacing_mut().interact_size.y = FIELD_HEIGHT;
                let rect = ui.max_rect();
                let color =
                    if ui.is_enabled() { ui.visuals().text_color() } else { ui.visuals().weak_text_color() };
                let font = egui::TextStyle::Body.resolve(ui.style());
                ui.painter().text(rect.left_center(), Align2::LEFT_CENTER, self.label, font, color);
                // A field that is left as it was must not round what it shows: while it is edited it has every digit.
                let id = ui.next_auto_id();
                let is_edited = ui.memory(|memory| memory.has_focus(id));
                let format = move |value: f64, decimals: std::ops::RangeInclusive<usize>| {
                    let shown = egui::emath::format_with_decimals_in_range(value, decimals);
                    if is_edited { (value + 0.0).to_string() } else { without_negative_zero(shown) }
                };
                let field = DragValue::new(value)
                    .custom_formatter(format)
                    .speed(self.speed)
                    .max_decimals(self.decimals)
                    .update_while_editing(self.live)
                    .clip_text(true)
                    .min_size(Vec2::new(width - label_width, FIELD_HEIGHT))
                    // The number goes to the right end, where its unit is.
                    .prefix(Atom::grow());
                let field = if self.unit.is_empty() {
                    field
                } else {
                    field.suffix(egui::RichText::new(self.unit).weak().atom_shrink(false))
                };
                ui.add(field)
            })
            .inner;
        // What is selected by the click is as long as what was shown; now there are all the digits.
        if response.clicked() {
            select_characters(ui, &response, value.to_string().len());
        }
        ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(self.name));
        if self.tooltip.is_empty() { response } else { response.on_hover_text(self.tooltip) }
    }
}

/// "-0.00" is 0: what is left of a number after rounding has no sign.
fn without_negative_zero(shown: String) -> String {
    let digits = shown.trim_start_matches(['-', '−']);
    if digits.chars().all(|c| matches!(c, '0' | '.')) { digits.to_owned() } else { shown }
}

/// Selects so many characters of a text field from its start.
pub fn select_characters(ui: &Ui, response: &Response, count: usize) {
    use egui::text::{CCursor, CCursorRange};
    let mut state = egui::text_edit::TextEditState::load(ui.ctx(), response.id).unwrap_or_default();
    state.cursor.set_char_range(Some(CCursorRange::two(CCursor::new(0), CCursor::new(count))));
    state.store(ui.ctx(), response.id);
}

/// The width of each of so many fields in a line.
pub fn column_width(ui: &Ui, columns: usize) -> f32 {
    let gaps = ui.spacing().item_spacing.x * (columns as f32 - 1.0);
    ((ui.available_width() - gaps) / columns as f32).floor()
}

/// A line of text under a field: why what was typed is not taken.
pub fn refusal(ui: &mut Ui, text: &str) {
    let color = ui.visuals().error_fg_color;
    ui.add(egui::Label::new(egui::RichText::new(text).small().color(color)).wrap());
}

/// A quiet line, or one that wants to be read.
pub fn note(ui: &mut Ui, text: &str, is_warning: bool) {
    let text = egui::RichText::new(text).small();
    let text = if is_warning { text.color(ui.visuals().warn_fg_color) } else { text.weak() };
    ui.add(egui::Label::new(text).wrap());
}
