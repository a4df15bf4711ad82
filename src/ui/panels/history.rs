//! What was done to poses, newest first: to search, to copy from, and to go back to.

use egui::text::{LayoutJob, TextFormat};
use egui::{Button, RichText, TextEdit, Ui};

use super::list;
use crate::formats::{PoseText, write_pose_text};
use crate::platform;
use crate::scene::PoseSource;
use crate::session::{Command, CommandId, LogEntry, Session};
use crate::ui::command_button::command_icon;
use crate::ui::icons::Icon;

const ROW_HEIGHT: f32 = 22.0;

pub fn draw(ui: &mut Ui, session: &Session, search: &mut String, commands: &mut Vec<Command>) {
    let log = session.log();
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let width = (ui.available_width() - 30.0).max(60.0);
        let field = TextEdit::singleline(search)
            .desired_width(width - 8.0)
            .hint_text(RichText::new("Search the history").small())
            .font(egui::TextStyle::Small);
        let response = ui.add(field);
        ui.ctx().accesskit_node_builder(response.id, |node| node.set_label("Search the history"));
        if command_icon(ui, Icon::Trash, CommandId::ClearLog, session).clicked() {
            commands.push(Command::Run(CommandId::ClearLog));
        }
    });
    let found = matching(log, search);
    if found.is_empty() {
        let text = if log.is_empty() { "Every change of a pose is listed here." } else { "Nothing found." };
        ui.label(RichText::new(text).small().weak());
        // The panel keeps the height that it was dragged to.
        ui.take_available_height();
        return;
    }
    ui.spacing_mut().item_spacing.y = 0.0;
    egui::ScrollArea::vertical().id_salt("history").auto_shrink(false).show_rows(
        ui,
        ROW_HEIGHT,
        found.len(),
        |ui, visible| {
            for index in visible {
                if let Some(entry) = found.get(index).and_then(|position| log.get(*position)) {
                    entry_row(ui, session, index, entry, commands);
                }
            }
        },
    );
}

/// Positions of the entries that hold every word of the search, newest first.
fn matching(log: &[LogEntry], search: &str) -> Vec<usize> {
    let words: Vec<String> = search.split_whitespace().map(str::to_lowercase).collect();
    let newest_first = (0..log.len()).rev();
    if words.is_empty() {
        return newest_first.collect();
    }
    let matches = |position: &usize| {
        let text = entry_text(&log[*position]).to_lowercase();
        words.iter().all(|word| text.contains(word.as_str()))
    };
    newest_first.filter(matches).collect()
}

fn entry_text(entry: &LogEntry) -> String {
    let LogEntry { object_name, photo_name, label, .. } = entry;
    let time = time_text(entry.time_ms);
    match &entry.summary {
        Some(summary) => format!("{time} {label} {summary}"),
        None => format!("{time} {object_name} {label} {photo_name} {}", source_text(entry.source)),
    }
}

fn entry_row(ui: &mut Ui, session: &Session, index: usize, entry: &LogEntry, commands: &mut Vec<Command>) {
    ui.push_id(("entry", session.log().len() - index), |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            ui.spacing_mut().interact_size.y = ROW_HEIGHT;
            ui.spacing_mut().button_padding = egui::Vec2::new(3.0, 0.0);
            let is_present = session.selected_annotation().is_some_and(|(photo, object, annotation)| {
                (photo, object) == (entry.photo, entry.object)
                    && annotation.camera_from_object == entry.camera_from_object
            });
            let width = (ui.available_width() - 26.0).max(60.0);
            let size = egui::Vec2::new(width, ROW_HEIGHT);
            let layout = egui::Layout::left_to_right(egui::Align::Center).with_main_justify(true);
            let response = ui
                .allocate_ui_with_layout(size, layout, |ui| {
                    let text = (entry_layout(ui, entry), egui::Atom::grow());
                    ui.add(Button::selectable(is_present, text).truncate())
                })
                .inner;
            ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(entry_text(entry)));
            if response.clicked() {
                commands.push(Command::ReturnTo(Box::new(entry.clone())));
            }
            let name = entry_text(entry);
            list::row_menu(ui, &name, Some(&response), |ui| entry_menu(ui, entry, commands));
            response.on_hover_text(entry_tooltip(entry));
        });
    });
}

fn entry_tooltip(entry: &LogEntry) -> String {
    let LogEntry { label, object_name, photo_name, .. } = entry;
    let time = time_text(entry.time_ms);
    match &entry.summary {
        Some(summary) => format!("{label} at {time}\n{summary}\nClick to see the least sure pose"),
        None => {
            let source = source_text(entry.source);
            format!(
                "{label} at {time}\n{object_name} in {photo_name}, {source}\nClick to return to this pose"
            )
        }
    }
}

fn entry_menu(ui: &mut Ui, entry: &LogEntry, commands: &mut Vec<Command>) {
    if list::item(ui, "Return to this pose", None) {
        commands.push(Command::ReturnTo(Box::new(entry.clone())));
    }
    let styles = [
        ("Copy as matrix", PoseText::Matrix),
        ("Copy as NumPy", PoseText::NumPy),
        ("Copy as JSON", PoseText::Json),
    ];
    for (text, style) in styles {
        if list::item(ui, text, None) {
            ui.ctx().copy_text(write_pose_text(&entry.camera_from_object, style));
        }
    }
}

/// The time, the object and what was done; where there is room, also in which photo and how.
fn entry_layout(ui: &Ui, entry: &LogEntry) -> LayoutJob {
    let small = egui::TextStyle::Small.resolve(ui.style());
    let weak = TextFormat::simple(small.clone(), ui.visuals().weak_text_color());
    let plain = TextFormat::simple(small.clone(), ui.visuals().text_color());
    let digits = egui::FontId::monospace(small.size - 0.5);
    let mut job = LayoutJob::default();
    job.append(&time_text(entry.time_ms), 0.0, TextFormat::simple(digits, ui.visuals().weak_text_color()));
    job.append(entry.label, 7.0, plain);
    let whose = || format!("{} · {} · {}", entry.object_name, entry.photo_name, source_text(entry.source));
    let rest = entry.summary.as_deref().map_or_else(whose, str::to_owned);
    job.append(&rest, 7.0, weak);
    job
}

fn source_text(source: PoseSource) -> &'static str {
    match source {
        PoseSource::Manual => "by hand",
        PoseSource::Pins => "pins",
        PoseSource::Snap => "snap",
        PoseSource::Tracked => "tracked",
        PoseSource::Imported => "imported",
    }
}

/// hh:mm:ss where the user is.
fn time_text(time_ms: f64) -> String {
    let seconds = (time_ms / 1000.0).floor() as i64 + i64::from(platform::utc_offset_minutes()) * 60;
    let of_day = seconds.rem_euclid(86_400);
    format!("{:02}:{:02}:{:02}", of_day / 3600, of_day / 60 % 60, of_day % 60)
}
