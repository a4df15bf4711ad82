//! Questions before the study, and questionnaires after it.

use egui::{ComboBox, DragValue, RichText, TextEdit, Ui};

use crate::study::{Item, ItemKind, Questionnaire, QuestionnaireKind, QuestionnaireTime, Study};

pub fn draw(ui: &mut Ui, study: &mut Study) {
    ui.label(RichText::new("Before the study").strong());
    items(ui, "before", &mut study.items_before);
    ui.separator();
    ui.label(RichText::new("Questionnaires").strong());
    let several = study.conditions.len() > 1;
    let mut removed = None;
    for (index, questionnaire) in study.questionnaires.iter_mut().enumerate() {
        ui.push_id(("questionnaire", index), |ui| {
            if one(ui, questionnaire, several) {
                removed = Some(index);
            }
        });
        ui.separator();
    }
    if let Some(index) = removed {
        study.questionnaires.remove(index);
    }
    ui.horizontal(|ui| {
        ui.label("Add");
        let own = QuestionnaireKind::Own { title: "A few questions".to_owned(), items: Vec::new() };
        for (title, id, kind) in [
            ("NASA-TLX", "tlx", QuestionnaireKind::NasaTlx { weighted: false }),
            ("SUS", "sus", QuestionnaireKind::Sus),
            ("Own questions", "own", own),
        ] {
            if ui.button(title).clicked() {
                let id = free_id(id, study.questionnaires.iter().map(|one| one.id.as_str()));
                study.questionnaires.push(Questionnaire { id, when: QuestionnaireTime::End, kind });
            }
        }
    });
}

/// What no other is called: in results, an id names one thing.
fn free_id<'a>(wanted: &str, taken: impl Iterator<Item = &'a str>) -> String {
    let taken: Vec<&str> = taken.collect();
    let numbered = (2..1000).map(|number| format!("{wanted}{number}"));
    std::iter::once(wanted.to_owned())
        .chain(numbered)
        .find(|id| !taken.contains(&id.as_str()))
        .unwrap_or_else(|| wanted.to_owned())
}

/// True if it is to be removed.
fn one(ui: &mut Ui, questionnaire: &mut Questionnaire, several_conditions: bool) -> bool {
    let is_removed = ui
        .horizontal(|ui| {
            let title = match &questionnaire.kind {
                QuestionnaireKind::NasaTlx { .. } => "NASA-TLX",
                QuestionnaireKind::Sus => "SUS",
                QuestionnaireKind::Own { .. } => "Own questions",
            };
            ui.label(RichText::new(title).strong());
            if several_conditions {
                ui.radio_value(&mut questionnaire.when, QuestionnaireTime::End, "at the end");
                let each = QuestionnaireTime::EachCondition;
                ui.radio_value(&mut questionnaire.when, each, "after each condition");
            }
            ui.button("Remove").clicked()
        })
        .inner;
    match &mut questionnaire.kind {
        QuestionnaireKind::NasaTlx { weighted } => {
            ui.checkbox(weighted, "Weighted, by fifteen choices between two scales");
        }
        QuestionnaireKind::Sus => {}
        QuestionnaireKind::Own { title, items: list } => {
            ui.horizontal(|ui| {
                ui.label("Title");
                ui.add(TextEdit::singleline(title).desired_width(300.0));
            });
            items(ui, "own", list);
        }
    }
    is_removed
}

fn items(ui: &mut Ui, salt: &str, items: &mut Vec<Item>) {
    let mut removed = None;
    for (index, item) in items.iter_mut().enumerate() {
        ui.push_id((salt, index), |ui| {
            ui.horizontal(|ui| {
                let text = TextEdit::singleline(&mut item.text).desired_width(380.0);
                ui.add(text.hint_text("The question"));
                kind(ui, &mut item.answer);
                ui.checkbox(&mut item.optional, "optional");
                if ui.button("Remove").clicked() {
                    removed = Some(index);
                }
            });
            details(ui, &mut item.answer);
        });
    }
    if let Some(index) = removed {
        items.remove(index);
    }
    if ui.button("Add a question").clicked() {
        let id = free_id("q1", items.iter().map(|item| item.id.as_str()));
        let answer = ItemKind::Text { long: false };
        items.push(Item { id, text: String::new(), optional: false, answer });
    }
}

fn kind(ui: &mut Ui, answer: &mut ItemKind) {
    let kinds = [
        (
            ItemKind::Scale { least: 1, most: 7, low: "Not at all".to_owned(), high: "Very".to_owned() },
            "Scale",
        ),
        (ItemKind::Choice { options: vec!["Yes".to_owned(), "No".to_owned()], several: false }, "Choice"),
        (ItemKind::Text { long: false }, "Text"),
    ];
    let is_same = |kind: &ItemKind| std::mem::discriminant(kind) == std::mem::discriminant(answer);
    let shown = kinds.iter().find(|(kind, _)| is_same(kind)).map_or("", |(_, title)| *title);
    let mut chosen = None;
    let combo = ComboBox::from_id_salt("kind").selected_text(shown).width(80.0).show_ui(ui, |ui| {
        for (kind, title) in &kinds {
            if ui.selectable_label(is_same(kind), *title).clicked() && !is_same(kind) {
                chosen = Some(kind.clone());
            }
        }
    });
    combo.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Kind of answer"));
    if let Some(chosen) = chosen {
        *answer = chosen;
    }
}

fn details(ui: &mut Ui, answer: &mut ItemKind) {
    ui.horizontal(|ui| {
        ui.add_space(24.0);
        match answer {
            ItemKind::Scale { least, most, low, high } => {
                ui.add(DragValue::new(least).range(-100..=100));
                ui.add(TextEdit::singleline(low).desired_width(120.0));
                ui.label("to");
                let first = *least;
                ui.add(DragValue::new(most).range(first + 1..=first + 100));
                ui.add(TextEdit::singleline(high).desired_width(120.0));
            }
            ItemKind::Choice { options, several } => {
                let mut text = options.join("; ");
                let field = TextEdit::singleline(&mut text).desired_width(340.0);
                if ui.add(field).on_hover_text("Separated by semicolons").changed() {
                    *options = text.split(';').map(|option| option.trim_start().to_owned()).collect();
                }
                ui.checkbox(several, "several");
            }
            ItemKind::Text { long } => {
                ui.checkbox(long, "long");
            }
        }
    });
}
