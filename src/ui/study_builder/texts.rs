//! What participants read, and the pictures in it.

use egui::{RichText, TextEdit, Ui};

use crate::study::pack::Draft;
use crate::ui::Asked;

pub fn draw(ui: &mut Ui, draft: &mut Draft, asked: &mut Asked) {
    let hint = "Markdown: # headings, **bold**, *italic*, - lists, [links](https://…), ![pictures](name.png)";
    ui.label(RichText::new(hint).weak());
    pictures(ui, draft, asked);
    let texts = &mut draft.study.texts;
    for (title, text, hint) in [
        ("Consent", &mut texts.consent, "Asked to be agreed to; empty: nothing is asked"),
        ("Instructions", &mut texts.instructions, "The allowed mouse gestures and keys are shown below them"),
        ("Thanks", &mut texts.thanks, "On the last screen"),
    ] {
        ui.label(RichText::new(title).strong());
        let edit = TextEdit::multiline(text).desired_rows(5).desired_width(f32::INFINITY).hint_text(hint);
        let field = ui.add(edit);
        field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, title));
    }
}

/// Pictures are shown where a text names them.
fn pictures(ui: &mut Ui, draft: &mut Draft, asked: &mut Asked) {
    let mut removed = None;
    for (index, (name, bytes)) in draft.pictures.iter().enumerate() {
        ui.horizontal(|ui| {
            ui.label(name);
            ui.label(RichText::new(format!("{:.0} kB", bytes.len() as f64 / 1e3)).weak());
            if ui.small_button("Put into the instructions").clicked() {
                let text = &mut draft.study.texts.instructions;
                let gap = if text.is_empty() { "" } else { "\n\n" };
                *text = format!("{}{gap}![]({name})\n", text.trim_end());
            }
            if ui.small_button("Remove").clicked() {
                removed = Some(index);
            }
        });
    }
    if let Some(index) = removed {
        draft.pictures.remove(index);
    }
    ui.horizontal(|ui| {
        asked.study_pictures |= ui.button("Add pictures…").clicked();
        let words = "What cameras write into them, such as place and time, is taken out";
        ui.label(RichText::new(words).weak());
    });
}
