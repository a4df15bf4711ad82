//! What the lists of photos, objects and masks have in common: rows that are named, coloured, dragged and asked for more.

use egui::{
    Align, Button, Color32, DragAndDrop, Key, Layout, Popup, PopupCloseBehavior, Rect, Response, RichText,
    Sense, Slider, TextEdit, Ui, UiBuilder, Vec2,
};

use super::number_field::select_characters;
use crate::scene::{Rgb, object_color};
use crate::ui::icons::{Icon, icon_button};
use crate::ui::theme;

pub const ROW_HEIGHT: f32 = 24.0;

/// With the gap to the next.
const ROW_STRIDE: f32 = ROW_HEIGHT + 1.0;

/// So many rows are shown at once; a longer list scrolls by itself, so that what is under it stays near.
const MOST_ROWS: usize = 9;

/// Objects get their first colours from these.
const PALETTE_SIZE: usize = 7;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum List {
    Photos,
    Objects,
    Masks,
}

/// A row of one of the lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct RowKey {
    pub list: List,
    pub id: u32,
}

/// A name that is being edited.
#[derive(Debug)]
pub struct Rename {
    key: RowKey,
    text: String,
    has_focus: bool,
}

impl Rename {
    pub fn new(key: RowKey, name: &str) -> Self {
        Self { key, text: name.to_owned(), has_focus: false }
    }
}

/// Lays out the rows that can be seen.
///
/// `reveal`: a row that is to come into sight, if it is out of it.
pub fn rows(
    ui: &mut Ui,
    list: List,
    count: usize,
    reveal: Option<usize>,
    mut row: impl FnMut(&mut Ui, usize),
) {
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        if count <= MOST_ROWS {
            (0..count).for_each(|index| row(ui, index));
            return;
        }
        let height = MOST_ROWS as f32 * ROW_STRIDE;
        let id = egui::Id::unique(("list offset", list));
        let offset = ui.data(|data| data.get_temp::<f32>(id)).unwrap_or_default();
        let mut area = egui::ScrollArea::vertical()
            .id_salt(("list", list))
            .max_height(height)
            .min_scrolled_height(height)
            .auto_shrink([false, true]);
        let is_out_of_sight = |top: &f32| *top < offset || *top + ROW_STRIDE > offset + height;
        if let Some(top) = reveal.map(|index| index as f32 * ROW_STRIDE).filter(is_out_of_sight) {
            area = area.vertical_scroll_offset((top - height / 2.0).max(0.0));
        }
        let shown =
            area.show_rows(ui, ROW_HEIGHT, count, |ui, visible| visible.for_each(|index| row(ui, index)));
        ui.data_mut(|data| data.insert_temp(id, shown.state.clamped_offset().y));
    });
}

/// One row. Gives where a row that was dropped here is to go: its id, and the position before which it goes.
pub fn row(ui: &mut Ui, key: RowKey, index: usize, content: impl FnOnce(&mut Ui)) -> Option<(u32, usize)> {
    let (rect, _) = ui.allocate_exact_size(Vec2::new(ui.available_width(), ROW_HEIGHT), Sense::hover());
    let ground = ui.interact(rect, egui::Id::unique(("row", key)), Sense::hover());
    let inside = UiBuilder::new().id_salt(key).max_rect(rect).layout(Layout::left_to_right(Align::Center));
    let mut inner = ui.new_child(inside);
    inner.spacing_mut().item_spacing.x = 4.0;
    content(&mut inner);
    dropped(ui, &ground, rect, key.list, index)
}

fn dropped(ui: &Ui, ground: &Response, rect: Rect, list: List, index: usize) -> Option<(u32, usize)> {
    let dragged = ground.dnd_hover_payload::<RowKey>().filter(|dragged| dragged.list == list)?;
    let pointer = ui.input(|input| input.pointer.hover_pos())?;
    let is_lower_half = pointer.y > rect.center().y;
    let line_y = if is_lower_half { rect.bottom() } else { rect.top() };
    ui.painter().hline(rect.x_range(), line_y, egui::Stroke::new(2.0, ui.visuals().hyperlink_color));
    ground.dnd_release_payload::<RowKey>()?;
    Some((dragged.id, index + usize::from(is_lower_half)))
}

/// How a row's name looks.
#[derive(Debug, Clone, Copy)]
pub struct NameLook<'a> {
    pub name: &'a str,
    pub selected: bool,
    pub weak: bool,
    /// For what stands to the right of it.
    pub room: f32,
    pub tooltip: &'a str,
}

/// What was done with a name.
#[derive(Debug, Default)]
pub struct NameUse {
    pub response: Option<Response>,
    pub renamed: Option<String>,
}

/// A name that fills its row: click to choose, double click to rename, drag to reorder.
pub fn name(ui: &mut Ui, key: RowKey, look: NameLook<'_>, rename: &mut Option<Rename>) -> NameUse {
    let width = (ui.available_width() - look.room).max(40.0);
    if rename.as_ref().is_some_and(|rename| rename.key == key) {
        return NameUse { response: None, renamed: edit_name(ui, width, look.name, rename) };
    }
    let text = RichText::new(look.name);
    let text = if look.weak { text.weak() } else { text };
    let layout = Layout::left_to_right(Align::Center).with_main_justify(true);
    let response = ui
        .allocate_ui_with_layout(Vec2::new(width, ROW_HEIGHT - 2.0), layout, |ui| {
            ui.spacing_mut().button_padding.x = 5.0;
            let button = Button::selectable(look.selected, (text, egui::Atom::grow()));
            ui.add(button.truncate().sense(Sense::click_and_drag()))
        })
        .inner;
    response.dnd_set_drag_payload(key);
    if response.dragged() && DragAndDrop::has_payload_of_type::<RowKey>(ui.ctx()) {
        ui.ctx().set_cursor_icon(egui::CursorIcon::Grabbing);
    }
    if response.double_clicked() {
        *rename = Some(Rename::new(key, look.name));
    }
    NameUse { response: Some(response.on_hover_text(look.tooltip)), renamed: None }
}

/// Enter and leaving the field take the name, Escape does not.
fn edit_name(ui: &mut Ui, width: f32, present: &str, rename: &mut Option<Rename>) -> Option<String> {
    let state = rename.as_mut()?;
    let response = ui.add(TextEdit::singleline(&mut state.text).desired_width(width - 10.0));
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label("New name"));
    if !state.has_focus {
        state.has_focus = true;
        response.request_focus();
        select_characters(ui, &response, state.text.chars().count());
        response.scroll_to_me(None);
    }
    if !response.lost_focus() {
        return None;
    }
    let is_dropped = ui.input(|input| input.key_pressed(Key::Escape));
    let text = rename.take().map(|rename| rename.text.trim().to_owned())?;
    (!is_dropped && !text.is_empty() && text != present).then_some(text)
}

/// A row's menu: by its dots, and by a right click on its name.
pub fn row_menu(
    ui: &mut Ui,
    of: &str,
    name: Option<&Response>,
    mut content: impl FnMut(&mut Ui),
) -> Response {
    row_menu_of_any(ui, of, name, &mut content)
}

/// Compiled once for all that is in such menus.
fn row_menu_of_any(
    ui: &mut Ui,
    of: &str,
    name: Option<&Response>,
    content: &mut dyn FnMut(&mut Ui),
) -> Response {
    let dots = icon_button(ui, Icon::Dots, &format!("More for {of}"), "More (also by right click)", true);
    let mut show = |popup: Popup<'_>| {
        popup.close_behavior(PopupCloseBehavior::CloseOnClickOutside).show(|ui| {
            ui.set_min_width(200.0);
            content(ui);
        });
    };
    show(Popup::menu(&dots));
    if let Some(name) = name {
        show(Popup::context_menu(name));
    }
    dots
}

/// An entry of a row's menu; disabled with the reason.
pub fn item(ui: &mut Ui, text: &str, unavailable: Option<&str>) -> bool {
    let response = ui.add_enabled(unavailable.is_none(), Button::new(text));
    let response = match unavailable {
        Some(reason) => response.on_disabled_hover_text(reason),
        None => response,
    };
    let clicked = response.clicked();
    if clicked {
        ui.close();
    }
    clicked
}

/// "Move up" and "Move down": where a row is to go.
pub fn move_items(ui: &mut Ui, index: usize, count: usize) -> Option<usize> {
    if count < 2 {
        return None;
    }
    let up = item(ui, "Move up", (index == 0).then_some("it is the first"));
    let down = item(ui, "Move down", (index + 1 == count).then_some("it is the last"));
    // A position is where something goes before: one down is before the one after the next.
    if up { Some(index - 1) } else { down.then_some(index + 2) }
}

/// 0 to 1, shown in percent.
pub fn opacity(ui: &mut Ui, name: &str, text: &str, opacity: f32) -> Option<f32> {
    let mut percent = (opacity * 100.0).round();
    let slider = Slider::new(&mut percent, 0.0..=100.0).text(text).suffix(" %").fixed_decimals(0);
    let response = ui.add(slider);
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(name));
    response.changed().then_some(percent / 100.0)
}

/// A colour that can be changed by a click.
pub fn swatch(ui: &mut Ui, of: &str, color: Rgb, strength: f32) -> Option<Rgb> {
    let (rect, response) = ui.allocate_exact_size(Vec2::new(16.0, ROW_HEIGHT), Sense::click());
    let name = format!("Colour of {of}");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ColorWell, true, name.clone()));
    let square = Rect::from_center_size(rect.center(), Vec2::splat(12.0));
    ui.painter().rect_filled(square, 3.0, theme::color32(color).gamma_multiply(strength));
    if response.hovered() || response.has_focus() {
        let stroke = egui::Stroke::new(1.5, ui.visuals().strong_text_color());
        ui.painter().rect_stroke(square, 3.0, stroke, egui::StrokeKind::Outside);
    }
    let mut chosen = None;
    Popup::menu(&response).close_behavior(PopupCloseBehavior::CloseOnClickOutside).show(|ui| {
        chosen = color_choice(ui, color);
    });
    response.on_hover_text("Change the colour");
    chosen
}

/// The colours that are told apart most easily, then any.
fn color_choice(ui: &mut Ui, present: Rgb) -> Option<Rgb> {
    let mut chosen = None;
    ui.horizontal(|ui| {
        for index in 0..PALETTE_SIZE {
            let color = object_color(index);
            let (rect, response) = ui.allocate_exact_size(Vec2::splat(22.0), Sense::click());
            let name = format!("Colour {}", index + 1);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name.clone()));
            ui.painter().rect_filled(rect.shrink(2.0), 4.0, theme::color32(color));
            if color == present || response.hovered() {
                let stroke = egui::Stroke::new(1.5, ui.visuals().strong_text_color());
                ui.painter().rect_stroke(rect, 5.0, stroke, egui::StrokeKind::Inside);
            }
            if response.clicked() {
                chosen = Some(color);
                ui.close();
            }
        }
    });
    ui.separator();
    let mut color = theme::color32(present);
    let alpha = egui::color_picker::Alpha::Opaque;
    if egui::color_picker::color_picker_color32(ui, &mut color, alpha) {
        let [red, green, blue, _] = Color32::to_array(&color);
        chosen = chosen.or(Some(Rgb([red, green, blue])));
    }
    chosen.filter(|chosen| *chosen != present)
}

/// Eye and lock of a row.
pub fn eye(ui: &mut Ui, of: &str, visible: bool) -> bool {
    let (icon, verb) = if visible { (Icon::Eye, "Hide") } else { (Icon::EyeClosed, "Show") };
    toggle_icon(ui, icon, &format!("{verb} {of}"), visible)
}

pub fn lock(ui: &mut Ui, of: &str, locked: bool) -> bool {
    let (icon, verb) = if locked { (Icon::Lock, "Unlock") } else { (Icon::LockOpen, "Lock") };
    toggle_icon(ui, icon, &format!("{verb} {of}"), !locked)
}

/// What is as it usually is stays in the background.
fn toggle_icon(ui: &mut Ui, icon: Icon, label: &str, is_usual: bool) -> bool {
    ui.scope(|ui| {
        if is_usual {
            let weak = ui.visuals().weak_text_color();
            ui.visuals_mut().widgets.inactive.fg_stroke.color = weak;
        }
        icon_button(ui, icon, label, label, true).clicked()
    })
    .inner
}
