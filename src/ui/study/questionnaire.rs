//! NASA-TLX, SUS and questionnaires of one's own.

use egui::{Button, RichText, Ui, Vec2};

use super::page::{heading, primary};
use super::questions::{ask, is_missing, missing_note, question, scale};
use super::{State, StudyRequest, TlxPair};
use crate::study::questionnaire::{SUS_ITEMS, TLX_MOST, TLX_SCALES, sus_id};
use crate::study::{Answer, PairChoice, Questionnaire, QuestionnaireKind};

pub fn draw(
    ui: &mut Ui,
    questionnaire: &Questionnaire,
    about: Option<&str>,
    pairs: &[TlxPair],
    state: &mut State,
    requests: &mut Vec<StudyRequest>,
) {
    let answered = match &questionnaire.kind {
        QuestionnaireKind::NasaTlx { .. } => tlx(ui, about, pairs, state),
        QuestionnaireKind::Sus => sus(ui, about, state).map(|answers| (answers, Vec::new())),
        QuestionnaireKind::Own { title, items } => {
            heading(ui, title);
            ask(ui, items, state).map(|answers| (answers, Vec::new()))
        }
    };
    if let Some((answers, pairs)) = answered {
        requests.push(StudyRequest::Questionnaire(answers, pairs));
    }
}

fn introduced(ui: &mut Ui, title: &str, about: Option<&str>) {
    heading(ui, title);
    let about = match about {
        Some(condition) => format!("Please think of the part that you just did: {condition}."),
        None => "Please think of all that you did here.".to_owned(),
    };
    ui.label(about);
    ui.add_space(4.0);
}

/// The pairs come first where they are asked, one by one; then the six scales.
fn tlx(
    ui: &mut Ui,
    about: Option<&str>,
    pairs: &[TlxPair],
    state: &mut State,
) -> Option<(Vec<Answer>, Vec<PairChoice>)> {
    if let Some((left, right)) = pairs.get(state.pairs.len()) {
        introduced(ui, "What made it demanding?", about);
        ui.label("Choose which of the two contributed more to your workload.");
        ui.label(RichText::new(format!("{} of {}", state.pairs.len() + 1, pairs.len())).weak());
        ui.horizontal(|ui| {
            for scale in [left, right] {
                let button =
                    Button::new(RichText::new(scale.title).size(15.0)).min_size(Vec2::new(200.0, 56.0));
                if ui.add(button).on_hover_text(scale.question).clicked() {
                    state.pairs.push(PairChoice {
                        left: left.id.to_owned(),
                        right: right.id.to_owned(),
                        chosen: scale.id.to_owned(),
                    });
                }
            }
        });
        return None;
    }
    introduced(ui, "How demanding was it?", about);
    for one in &TLX_SCALES {
        question(ui, one.title, is_missing(state, one.id));
        ui.label(one.question);
        scale(ui, one.id, (0, TLX_MOST), one.ends, &mut state.answers);
        ui.add_space(8.0);
    }
    let ids: Vec<String> = TLX_SCALES.iter().map(|scale| scale.id.to_owned()).collect();
    finished(ui, &ids, state, true).map(|answers| (answers, state.pairs.clone()))
}

/// Items may be left out: a missing one counts as the middle, and is reported.
fn sus(ui: &mut Ui, about: Option<&str>, state: &mut State) -> Option<Vec<Answer>> {
    introduced(ui, "How usable was it?", about);
    for (index, text) in SUS_ITEMS.iter().enumerate() {
        question(ui, &format!("{}. {text}", index + 1), false);
        scale(ui, &sus_id(index), (1, 5), ["Strongly disagree", "Strongly agree"], &mut state.answers);
        ui.add_space(8.0);
    }
    let ids: Vec<String> = (0..SUS_ITEMS.len()).map(sus_id).collect();
    finished(ui, &ids, state, state.answers.is_empty())
}

/// The answers, once the button is clicked and nothing that has to be there is missing.
fn finished(ui: &mut Ui, ids: &[String], state: &mut State, needs_all: bool) -> Option<Vec<Answer>> {
    let is_clicked = primary(ui, "Continue");
    let is_complete = !needs_all || ids.iter().all(|id| state.answers.contains_key(id));
    state.asks_for_missing |= is_clicked && !is_complete;
    if state.asks_for_missing && !is_complete {
        missing_note(ui);
    }
    let answer = |id: &String| Answer { item: id.clone(), value: state.answers.get(id).cloned() };
    (is_clicked && is_complete).then(|| ids.iter().map(answer).collect())
}
