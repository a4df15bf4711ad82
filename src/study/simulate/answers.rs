//! What simulated people answer.

use super::person::Person;
use crate::study::questionnaire::{
    SUS_ITEMS, TLX_MOST, TLX_SCALES, sus_id, sus_scores, tlx_pairs, tlx_scores,
};
use crate::study::{
    Answer, AnswerValue, Item, ItemKind, PairChoice, Plan, Questionnaire, QuestionnaireKind,
    QuestionnaireResult, QuestionnaireTime,
};

/// About where people put the six scales of NASA-TLX, 0 to 20.
const USUAL_RATINGS: [f64; 6] = [9.0, 5.0, 7.0, 6.0, 9.0, 6.0];
/// And how far they are from that.
const SPREAD_OF_RATINGS: f64 = 3.5;
/// How much those agree to a good sentence of SUS, 1 to 5.
const USUAL_AGREEMENT: f64 = 4.0;

/// Any answer that the questions allow; free texts are left out.
pub fn items(items: &[Item], person: &mut Person) -> Vec<Answer> {
    let answer = |item: &Item| {
        let value = match &item.answer {
            ItemKind::Scale { least, most, .. } => {
                let middle = f64::from(*least + *most) / 2.0;
                let reach = f64::from(*most - *least) / 5.0;
                Some(whole(middle + reach * person.normal(), [*least, *most]))
            }
            ItemKind::Choice { options, several } => {
                let chosen = options.get(person.chance().below(options.len())).cloned();
                chosen.map(|text| match several {
                    true => AnswerValue::Several(vec![text]),
                    false => AnswerValue::Text(text),
                })
            }
            ItemKind::Text { .. } => None,
        };
        Answer { item: item.id.clone(), value }
    };
    items.iter().map(answer).collect()
}

/// Once, or once for each condition.
pub fn questionnaire(
    asked: &Questionnaire,
    plan: &Plan,
    person: &mut Person,
    answered_at: &str,
) -> Vec<QuestionnaireResult> {
    let about: Vec<Option<String>> = match asked.when {
        QuestionnaireTime::End => vec![None],
        QuestionnaireTime::EachCondition => plan.conditions.iter().cloned().map(Some).collect(),
    };
    let result = |condition: Option<String>| {
        let mut result = QuestionnaireResult {
            id: asked.id.clone(),
            kind: String::new(),
            condition,
            answers: Vec::new(),
            pairs: Vec::new(),
            scores: std::collections::BTreeMap::new(),
            answered_at: answered_at.to_owned(),
        };
        match &asked.kind {
            QuestionnaireKind::NasaTlx { weighted } => tlx(&mut result, *weighted, plan.seed, person),
            QuestionnaireKind::Sus => sus(&mut result, person),
            QuestionnaireKind::Own { items: own, .. } => {
                result.kind = "own".to_owned();
                result.answers = items(own, person);
            }
        }
        result
    };
    about.into_iter().map(result).collect()
}

fn tlx(result: &mut QuestionnaireResult, weighted: bool, seed: u64, person: &mut Person) {
    result.kind = "nasa_tlx".to_owned();
    for (scale, usual) in TLX_SCALES.iter().zip(USUAL_RATINGS) {
        let rating = usual - 2.0 * person.mood + SPREAD_OF_RATINGS * person.normal();
        let value = Some(whole(rating, [0, TLX_MOST]));
        result.answers.push(Answer { item: scale.id.to_owned(), value });
    }
    if weighted {
        for (left, right) in tlx_pairs(seed, &result.id) {
            let chosen = if person.normal() < 0.0 { left } else { right };
            let [left, right, chosen] = [left, right, chosen].map(|scale| scale.id.to_owned());
            result.pairs.push(PairChoice { left, right, chosen });
        }
    }
    result.scores = tlx_scores(&result.answers, &result.pairs);
}

fn sus(result: &mut QuestionnaireResult, person: &mut Person) {
    result.kind = "sus".to_owned();
    for index in 0..SUS_ITEMS.len() {
        let agreement = USUAL_AGREEMENT + person.mood + 0.7 * person.normal();
        // Every second sentence speaks against the system.
        let answer = if index % 2 == 0 { agreement } else { 6.0 - agreement };
        result.answers.push(Answer { item: sus_id(index), value: Some(whole(answer, [1, 5])) });
    }
    result.scores = sus_scores(&result.answers);
}

/// The nearest whole number within two.
fn whole(value: f64, [least, most]: [i32; 2]) -> AnswerValue {
    AnswerValue::Number(value.round().clamp(f64::from(least), f64::from(most)))
}
