//! Items of one's own: scales, choices and texts.

use std::collections::BTreeMap;

use egui::{Checkbox, RichText, TextEdit, Ui};

use super::page::{heading, primary};
use super::{State, StudyRequest};
use crate::study::{Answer, AnswerValue, Item, ItemKind};
use crate::ui::theme;

pub fn draw(ui: &mut Ui, title: &str, items: &[Item], state: &mut State, requests: &mut Vec<StudyRequest>) {
    heading(ui, title);
    if let Some(answers) = ask(ui, items, state) {
        requests.push(StudyRequest::Items(answers));
    }
}

/// The items and the button under them; the answers once it is clicked and nothing is missing.
pub fn ask(ui: &mut Ui, items: &[Item], state: &mut State) -> Option<Vec<Answer>> {
    for item in items {
        question(ui, &item.text, !item.optional && is_missing(state, &item.id));
        ui.push_id(&item.id, |ui| field(ui, item, &mut state.answers));
        ui.add_space(8.0);
    }
    let is_clicked = primary(ui, "Continue");
    let is_complete = items.iter().all(|item| item.optional || state.answers.contains_key(&item.id));
    state.asks_for_missing |= is_clicked && !is_complete;
    if state.asks_for_missing && !is_complete {
        missing_note(ui);
    }
    let answer = |item: &Item| Answer { item: item.id.clone(), value: state.answers.get(&item.id).cloned() };
    (is_clicked && is_complete).then(|| items.iter().map(answer).collect())
}

pub fn missing_note(ui: &mut Ui) {
    let words = "Please answer the marked questions";
    ui.label(RichText::new(words).color(theme::error(ui.visuals())));
}

pub fn is_missing(state: &State, id: &str) -> bool {
    state.asks_for_missing && !state.answers.contains_key(id)
}

pub fn question(ui: &mut Ui, text: &str, is_missing: bool) {
    let words = RichText::new(text).size(15.0).strong();
    ui.label(if is_missing { words.color(theme::error(ui.visuals())) } else { words });
}

fn field(ui: &mut Ui, item: &Item, answers: &mut BTreeMap<String, AnswerValue>) {
    match &item.answer {
        ItemKind::Scale { least, most, low, high } => {
            scale(ui, &item.id, (*least, *most), [low, high], answers);
        }
        ItemKind::Choice { options, several: false } => {
            for option in options {
                let is_chosen =
                    matches!(answers.get(&item.id), Some(AnswerValue::Text(text)) if text == option);
                if ui.radio(is_chosen, option).clicked() {
                    answers.insert(item.id.clone(), AnswerValue::Text(option.clone()));
                }
            }
        }
        ItemKind::Choice { options, several: true } => several(ui, &item.id, options, answers),
        ItemKind::Text { long } => text(ui, item, *long, answers),
    }
}

fn several(ui: &mut Ui, id: &str, options: &[String], answers: &mut BTreeMap<String, AnswerValue>) {
    let mut chosen = match answers.get(id) {
        Some(AnswerValue::Several(chosen)) => chosen.clone(),
        _ => Vec::new(),
    };
    for option in options {
        let mut is_chosen = chosen.contains(option);
        if ui.add(Checkbox::new(&mut is_chosen, option)).changed() {
            chosen.retain(|other| other != option);
            if is_chosen {
                chosen.push(option.clone());
            }
        }
    }
    if chosen.is_empty() {
        answers.remove(id);
    } else {
        answers.insert(id.to_owned(), AnswerValue::Several(chosen));
    }
}

fn text(ui: &mut Ui, item: &Item, long: bool, answers: &mut BTreeMap<String, AnswerValue>) {
    let mut text = match answers.get(&item.id) {
        Some(AnswerValue::Text(text)) => text.clone(),
        _ => String::new(),
    };
    let edit = if long {
        TextEdit::multiline(&mut text).desired_rows(4).desired_width(f32::INFINITY)
    } else {
        TextEdit::singleline(&mut text).desired_width(320.0)
    };
    let field = ui.add(edit.char_limit(10_000));
    field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, &item.text));
    if text.trim().is_empty() {
        answers.remove(&item.id);
    } else {
        answers.insert(item.id.clone(), AnswerValue::Text(text));
    }
}

/// One button for each mark, its ends in words; nothing is chosen at first.
pub fn scale(
    ui: &mut Ui,
    id: &str,
    (least, most): (i32, i32),
    [low, high]: [&str; 2],
    answers: &mut BTreeMap<String, AnswerValue>,
) {
    const GAP: f32 = 2.0;
    let count = (most - least + 1).clamp(1, 101) as f32;
    let width = ((ui.available_width() - GAP * (count - 1.0)) / count).clamp(8.0, 56.0);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = GAP;
        ui.spacing_mut().button_padding.x = 0.0;
        for mark in least..=most {
            let is_chosen = answers.get(id) == Some(&AnswerValue::Number(f64::from(mark)));
            // Numbers where there is room for them; else the place says it.
            let text = if width >= 22.0 { mark.to_string() } else { String::new() };
            let button = egui::Button::new(text).selected(is_chosen).min_size(egui::vec2(width, 30.0));
            let response = ui.add(button);
            response.widget_info(|| {
                egui::WidgetInfo::selected(egui::Role::RadioButton, true, is_chosen, format!("{id} {mark}"))
            });
            if response.clicked() {
                answers.insert(id.to_owned(), AnswerValue::Number(f64::from(mark)));
            }
        }
    });
    let whole = width * count + GAP * (count - 1.0);
    ui.allocate_ui(egui::vec2(whole, 16.0), |ui| {
        ui.horizontal(|ui| {
            ui.label(RichText::new(low).small().weak());
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.label(RichText::new(high).small().weak());
            });
        });
    });
}
