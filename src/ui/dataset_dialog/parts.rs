//! The parts of a data set, to be ticked.

use std::collections::BTreeSet;

use egui::{Align, Layout, RichText, ScrollArea, Ui};

use super::{DatasetRequest, DatasetView};
use crate::formats::dataset::Choice;
use crate::ui::scenes_dialog::words::size_text;
use crate::ui::theme;

const ROW_HEIGHT: f32 = 20.0;
/// More rows scroll; fewer on a low screen.
const MOST_ROWS: f32 = 7.0;
const LEAST_ROWS: f32 = 2.0;
/// What the rest of the dialog needs.
const ROOM_FOR_THE_REST: f32 = 500.0;
/// From so many on there are buttons for all and none.
const MANY: usize = 4;

/// Draws the parts, where there is more than one to choose from.
pub fn draw(ui: &mut Ui, view: &DatasetView<'_>, requests: &mut Vec<DatasetRequest>) {
    let choices = &view.recognised.choices;
    if choices.len() < 2 {
        return;
    }
    ui.horizontal(|ui| {
        ui.vertical(|ui| {
            theme::group_title(ui, &format!("Parts ({} of {})", view.chosen.len(), choices.len()));
        });
        if choices.len() >= MANY {
            ui.with_layout(Layout::right_to_left(Align::Max), |ui| {
                if ui.small_button("None").clicked() {
                    requests.push(DatasetRequest::Choose(BTreeSet::new()));
                }
                if ui.small_button("All").clicked() {
                    requests.push(DatasetRequest::Choose((0..choices.len()).collect()));
                }
            });
        }
    });
    let spacing = ui.spacing().item_spacing.y;
    let row_height = ROW_HEIGHT + spacing;
    let fitting = (ui.ctx().content_rect().height() - ROOM_FOR_THE_REST) / row_height;
    let rows = fitting.floor().clamp(LEAST_ROWS, MOST_ROWS);
    let area = ScrollArea::vertical().id_salt("parts").max_height(row_height * rows);
    area.auto_shrink([false, true]).show_rows(ui, ROW_HEIGHT, choices.len(), |ui, rows| {
        for (index, choice) in choices.iter().enumerate().skip(rows.start).take(rows.len()) {
            row(ui, index, choice, view.chosen, requests);
        }
    });
}

fn row(
    ui: &mut Ui,
    index: usize,
    choice: &Choice,
    chosen: &BTreeSet<usize>,
    requests: &mut Vec<DatasetRequest>,
) {
    ui.horizontal(|ui| {
        ui.set_height(ROW_HEIGHT);
        let mut is_chosen = chosen.contains(&index);
        if ui.checkbox(&mut is_chosen, &choice.label).clicked() {
            let mut wanted = chosen.clone();
            if is_chosen {
                wanted.insert(index);
            } else {
                wanted.remove(&index);
            }
            requests.push(DatasetRequest::Choose(wanted));
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.add_space(8.0);
            ui.label(RichText::new(contents_text(choice)).weak());
        });
    });
}

/// "16 photos, 6.1 MB".
fn contents_text(choice: &Choice) -> String {
    let plural = if choice.photos == 1 { "" } else { "s" };
    let photos = format!("{} photo{plural}", grouped(choice.photos));
    // The browser does not say how large the files of a very large folder are.
    if choice.bytes == 0 { photos } else { format!("{photos}, {}", size_text(choice.bytes)) }
}

/// "12,345".
pub fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (position, digit) in digits.chars().enumerate() {
        if position > 0 && (digits.len() - position).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_and_sizes_in_words() {
        assert_eq!([0, 999, 1000, 1_234_567].map(grouped), ["0", "999", "1,000", "1,234,567"]);
        let choice = |photos, bytes| Choice { label: String::new(), photos, bytes };
        assert_eq!(contents_text(&choice(1, 0)), "1 photo");
        assert_eq!(contents_text(&choice(1200, 6_100_000)), "1,200 photos, 6.1 MB");
    }
}
