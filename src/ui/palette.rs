//! The command palette: everything that can be done, by its name.

use egui::{Align2, Area, Context, Id, Key, Modifiers, Order, Rect, Sense, TextEdit, TextStyle, Ui, Vec2};

use super::{Keymap, menus, theme};
use crate::math::sort_short;
use crate::scene::{Look, OverlayMode};
use crate::session::{COMMANDS, Command, CommandId, Session};

const WIDTH: f32 = 560.0;
const ROW_HEIGHT: f32 = 28.0;
const MOST_ROWS_SHOWN: usize = 11;

#[derive(Debug, Default)]
pub struct State {
    query: String,
    /// The row that Enter runs.
    chosen: usize,
    was_open: bool,
}

/// A line of the palette.
struct Entry {
    title: String,
    /// Words that are searched too, and shown beside the title.
    details: String,
    shortcut: String,
    unavailable: Option<&'static str>,
    command: Command,
}

/// Draws the palette; true if it is to be closed.
pub fn draw(
    ctx: &Context,
    session: &Session,
    keymap: &Keymap,
    state: &mut State,
    commands: &mut Vec<Command>,
) -> bool {
    if !std::mem::replace(&mut state.was_open, true) {
        *state = State { was_open: true, ..State::default() };
    }
    let rows = ranked(entries(session, keymap), &state.query);
    let (step, is_entered, is_closed) = keys(ctx, keymap);
    state.chosen = state.chosen.saturating_add_signed(step).min(rows.len().saturating_sub(1));
    let screen = ctx.content_rect();
    let width = WIDTH.min(screen.width() - 32.0);
    let query_before = state.query.clone();
    let mut picked = is_entered.then_some(state.chosen);
    let backdrop = Area::new(Id::unique("palette backdrop")).order(Order::Foreground).fixed_pos(screen.min);
    let is_left = backdrop.show(ctx, |ui| ui.allocate_rect(screen, Sense::click()).clicked()).inner;
    Area::new(Id::unique("palette"))
        .order(Order::Foreground)
        .pivot(Align2::CENTER_TOP)
        .fixed_pos(screen.center_top() + Vec2::new(0.0, (screen.height() * 0.14).max(48.0)))
        .show(ctx, |ui| {
            theme::dialog_frame(ctx).inner_margin(8).show(ui, |ui| {
                ui.set_width(width);
                field(ui, &mut state.query);
                ui.add_space(4.0);
                if let Some(row) = list(ui, &rows, state.chosen, step != 0) {
                    picked = Some(row);
                }
            });
        });
    if state.query != query_before {
        state.chosen = 0;
    }
    let run = picked.and_then(|row| rows.get(row)).filter(|entry| entry.unavailable.is_none());
    commands.extend(run.map(|entry| entry.command.clone()));
    let is_done = is_closed || is_left || run.is_some();
    state.was_open = !is_done;
    if is_done {
        // The next key is for the viewport, also where it comes before the next frame.
        ctx.memory_mut(egui::Memory::stop_text_input);
        ctx.request_repaint();
    }
    is_done
}

/// Arrows, Enter, and what closes; taken before the field sees them.
fn keys(ctx: &Context, keymap: &Keymap) -> (isize, bool, bool) {
    ctx.input_mut(|input| {
        let mut pressed = |key| input.count_and_consume_key(Modifiers::NONE, key) as isize;
        let page = MOST_ROWS_SHOWN as isize - 1;
        let step = pressed(Key::ArrowDown) - pressed(Key::ArrowUp)
            + page * (pressed(Key::PageDown) - pressed(Key::PageUp));
        let (is_entered, is_escaped) = (pressed(Key::Enter) > 0, pressed(Key::Escape) > 0);
        let own = keymap.binding(CommandId::TogglePalette);
        let is_toggled = own.is_some_and(|own| {
            let modifiers =
                Modifiers { alt: own.alt, shift: own.shift, command: own.ctrl, ..Modifiers::NONE };
            input.consume_key(modifiers, own.key)
        });
        (step, is_entered, is_escaped || is_toggled)
    })
}

fn field(ui: &mut Ui, query: &mut String) {
    let hint = "Find a command, a photo, an object";
    let field = TextEdit::singleline(query)
        .hint_text(hint)
        .font(egui::FontId::proportional(16.0))
        .margin(egui::Margin::symmetric(8, 6))
        .desired_width(f32::INFINITY);
    let response = ui.add(field);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Find a command"));
    response.request_focus();
}

/// Draws the rows that are in sight; the row that was clicked.
fn list(ui: &mut Ui, rows: &[Entry], chosen: usize, follows: bool) -> Option<usize> {
    if rows.is_empty() {
        ui.add_space(8.0);
        ui.vertical_centered(|ui| ui.weak("Nothing is called that."));
        ui.add_space(8.0);
        return None;
    }
    let mut clicked = None;
    ui.spacing_mut().item_spacing.y = 0.0;
    let room = ui.ctx().content_rect().height() * 0.86 - 120.0;
    let height = (ROW_HEIGHT * rows.len().min(MOST_ROWS_SHOWN) as f32).min(room.max(ROW_HEIGHT * 3.0));
    let mut area = egui::ScrollArea::vertical()
        .max_height(height)
        .min_scrolled_height(height)
        .auto_shrink([false, true]);
    if follows {
        let offset = (chosen as f32 + 0.5) * ROW_HEIGHT - height / 2.0;
        area = area.vertical_scroll_offset(offset.max(0.0));
    }
    area.show_rows(ui, ROW_HEIGHT, rows.len(), |ui, range| {
        for index in range {
            let Some(entry) = rows.get(index) else { continue };
            if draw_row(ui, entry, index == chosen) {
                clicked = Some(index);
            }
        }
    });
    clicked
}

fn draw_row(ui: &mut Ui, entry: &Entry, is_chosen: bool) -> bool {
    let (rect, response) =
        ui.allocate_exact_size(Vec2::new(ui.available_width(), ROW_HEIGHT), Sense::click());
    let enabled = entry.unavailable.is_none();
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, enabled, is_chosen, &entry.title));
    let visuals = ui.visuals();
    if is_chosen {
        ui.painter().rect_filled(rect, 6.0, visuals.selection.bg_fill);
    } else if response.hovered() {
        ui.painter().rect_filled(rect, 6.0, visuals.widgets.hovered.weak_bg_fill.gamma_multiply(0.5));
    }
    let strong = if is_chosen { visuals.selection.stroke.color } else { visuals.text_color() };
    let weak = if is_chosen { strong } else { visuals.weak_text_color() };
    let title_color = if enabled { strong } else { weak };
    let inside = rect.shrink2(Vec2::new(10.0, 0.0));
    let body = TextStyle::Body.resolve(ui.style());
    let small = TextStyle::Small.resolve(ui.style());
    let painter = ui.painter().with_clip_rect(inside.intersect(ui.clip_rect()));
    let right =
        painter.text(inside.right_center(), Align2::RIGHT_CENTER, &entry.shortcut, body.clone(), weak);
    let title = painter.text(inside.left_center(), Align2::LEFT_CENTER, &entry.title, body, title_color);
    let details = entry.unavailable.unwrap_or(&entry.details);
    let between = Rect::from_x_y_ranges(title.right() + 12.0..=right.left() - 12.0, inside.y_range());
    let painter = ui.painter().with_clip_rect(between.intersect(ui.clip_rect()));
    painter.text(between.left_center(), Align2::LEFT_CENTER, details, small, weak);
    response.clicked()
}

fn entries(session: &Session, keymap: &Keymap) -> Vec<Entry> {
    let listed =
        COMMANDS.iter().filter(|info| !matches!(info.id, CommandId::TogglePalette | CommandId::Cancel));
    let mut entries: Vec<Entry> = listed
        .map(|info| Entry {
            title: info.text.trim_end_matches('…').to_owned(),
            details: match menus::menu_of(info.id) {
                Some(menu) => format!("{menu}: {}", info.tooltip),
                None => info.tooltip.to_owned(),
            },
            shortcut: keymap.text(info.id).unwrap_or_default(),
            unavailable: session.unavailable(info.id),
            command: Command::Run(info.id),
        })
        .collect();
    let plain = |title: String, details: &str, command: Command| Entry {
        title,
        details: details.to_owned(),
        shortcut: String::new(),
        unavailable: None,
        command,
    };
    for (mode, _, title) in OverlayMode::ALL {
        let command = Command::SetLook(Look { mode, ..session.look() });
        entries.push(plain(format!("Overlay: {title}"), "Show the meshes like this", command));
    }
    for photo in &session.scene().photos {
        entries.push(plain(format!("Show photo {}", photo.name), "", Command::ShowPhoto(photo.id)));
    }
    for object in &session.scene().objects {
        entries.push(plain(format!("Select {}", object.name), "", Command::Select(Some(object.id))));
    }
    entries
}

/// What fits the query, the best first; all of it in its order where nothing is asked.
fn ranked(entries: Vec<Entry>, query: &str) -> Vec<Entry> {
    let query = query.trim();
    if query.is_empty() {
        return entries;
    }
    let mut scored: Vec<(i32, Entry)> =
        entries.into_iter().filter_map(|entry| Some((score_of(&entry, query)?, entry))).collect();
    // Stable: what fits equally well stays in the menus' order.
    sort_short(&mut scored, |a, b| b.0.cmp(&a.0));
    scored.into_iter().map(|(_, entry)| entry).collect()
}

fn score_of(entry: &Entry, query: &str) -> Option<i32> {
    let title = fuzzy_score(&entry.title, query);
    // In a long text any letters are found; there whole words count alone.
    let is_in_details = || entry.details.to_lowercase().contains(&query.to_lowercase());
    let score = title.or_else(|| is_in_details().then_some(0))?;
    Some(if entry.unavailable.is_some() { score - 5 } else { score })
}

/// How well the query's letters, in their order, fit the text: runs and beginnings of words count, gaps cost. `None` where a
/// letter is missing.
pub fn fuzzy_score(text: &str, query: &str) -> Option<i32> {
    const AT_WORD: i32 = 10;
    const IN_RUN: i32 = 12;
    const AT_START: i32 = 8;
    let text: Vec<char> = text.chars().flat_map(char::to_lowercase).collect();
    let wanted: Vec<char> =
        query.chars().flat_map(char::to_lowercase).filter(|c| !c.is_whitespace()).collect();
    // The best score with the letter so far at each place; the next letter comes after it.
    let mut best: Vec<Option<i32>> = vec![None; text.len()];
    for (number, letter) in wanted.iter().enumerate() {
        let mut next = vec![None; text.len()];
        let mut before: Option<i32> = (number == 0).then_some(0);
        for (place, here) in text.iter().enumerate() {
            if here == letter {
                let at_word = place == 0 || !text[place - 1].is_alphanumeric();
                let bonus = if at_word { AT_WORD } else { 0 } + if place == 0 { AT_START } else { 0 };
                let run = place.checked_sub(1).and_then(|left| best[left]).filter(|_| number > 0);
                next[place] = run.map(|score| score + IN_RUN).max(before).map(|score| score + bonus);
            }
            if number > 0 {
                // A gap costs a little for each letter that is skipped.
                before = before.map(|score| score - 1).max(best[place]);
            }
        }
        best = next;
    }
    let length = i32::try_from(text.len()).unwrap_or(i32::MAX) / 8;
    best.into_iter().flatten().max().map(|score| score - length)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(query: &str) -> String {
        let found = ranked(entries(&Session::default(), &Keymap::default()), query);
        found.first().map(|entry| entry.title.clone()).unwrap_or_default()
    }

    #[test]
    fn what_is_meant_comes_first() {
        assert_eq!(first("undo"), "Undo");
        assert_eq!(first("exp pos"), "Export poses (JSON)");
        assert_eq!(first("nocs"), "Overlay: NOCS");
        assert_eq!(first("np"), "Next photo");
        assert_eq!(first("fit"), "Fit photo");
        assert_eq!(first("light"), "Light or dark");
        assert_eq!(first("qqqqxz"), "");
    }

    #[test]
    fn runs_and_words_beat_scattered_letters() {
        let score = |text: &str, query: &str| fuzzy_score(text, query).unwrap();
        assert!(score("Next photo", "next") > score("New texture", "next"));
        assert!(score("Zoom to object", "zto") > score("Azatao", "zto"));
        assert_eq!(fuzzy_score("Undo", "undx"), None);
        assert!(score("ÄPFEL", "äp") > 0);
    }

    #[test]
    fn a_word_of_the_tooltip_is_found() {
        let found = ranked(entries(&Session::default(), &Keymap::default()), "np.array");
        assert!(found.iter().any(|entry| entry.title == "Copy pose as NumPy"));
    }
}
