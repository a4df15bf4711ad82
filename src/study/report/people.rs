//! A result file's participant as the report knows them.

use std::collections::BTreeMap;

use super::input::{Answered, ReportInput, ReportParticipant, SusAnswers, TlxAnswers, Trial};
use crate::math::sort_short;
use crate::study::{
    Answer, AnswerValue, Outcome, PairChoice, QuestionnaireResult, Results, Study, TrialResult,
};

/// The scales of NASA-TLX as result files name them, in the report's order.
const TLX_ITEMS: [&str; 6] = ["mental", "physical", "temporal", "performance", "effort", "frustration"];

/// The participant without a label, and how many trials cannot be scored. `sample` and `condition` give indices for ids.
pub(super) fn participant_of(
    results: &Results,
    study: Option<&Study>,
    sample: impl Fn(&str) -> Option<usize>,
    condition: &mut impl FnMut(&str) -> usize,
) -> (ReportParticipant, usize) {
    let mut trials = Vec::new();
    for found in &results.trials {
        trials.extend(sample(&found.sample).and_then(|sample| trial_of(found, sample, condition)));
    }
    let left_out = results.trials.len() - trials.len();
    let mut participant = ReportParticipant {
        label: String::new(),
        id: results.participant.id.clone(),
        simulated: results.is_simulated,
        trials,
        traits: results.items_before.iter().filter_map(|answer| trait_of(answer, study)).collect(),
        tlx: Vec::new(),
        sus: Vec::new(),
    };
    for found in &results.questionnaires {
        let about = found.condition.as_deref().map(&mut *condition);
        match found.kind.as_str() {
            "nasa_tlx" => participant.tlx.push(Answered { condition: about, answers: tlx_of(found) }),
            "sus" => participant.sus.push(Answered { condition: about, answers: sus_of(found) }),
            _ => {}
        }
    }
    (participant, left_out)
}

/// `None` for numbers that are no pose and no time.
fn trial_of(found: &TrialResult, sample: usize, condition: &mut impl FnMut(&str) -> usize) -> Option<Trial> {
    let pose = found.final_pose.to_pose().ok()?;
    let seconds = Some(found.time_s).filter(|seconds| seconds.is_finite() && *seconds >= 0.0)?;
    Some(Trial {
        sample,
        condition: condition(&found.condition),
        repeat: found.repeat as usize,
        pose,
        seconds,
        timed_out: found.outcome == Outcome::TimedOut,
    })
}

/// The question in the study's words, where it is at hand, and the answer.
fn trait_of(answer: &Answer, study: Option<&Study>) -> Option<(String, String)> {
    let text = match answer.value.as_ref()? {
        AnswerValue::Number(number) => number.to_string(),
        AnswerValue::Text(text) => text.clone(),
        AnswerValue::Several(texts) => texts.join(", "),
    };
    let item = study.and_then(|study| study.items_before.iter().find(|item| item.id == answer.item));
    // The id stays in sight: "expertise" is looked for by it.
    let question = item.map_or_else(|| answer.item.clone(), |item| format!("{}: {}", item.id, item.text));
    Some((question, text))
}

fn number_of(found: &QuestionnaireResult, item: &str, range: std::ops::RangeInclusive<f64>) -> Option<f64> {
    let answer = found.answers.iter().find(|answer| answer.item == item)?;
    match answer.value {
        Some(AnswerValue::Number(number)) => Some(number).filter(|number| range.contains(number)),
        _ => None,
    }
}

fn tlx_of(found: &QuestionnaireResult) -> TlxAnswers {
    let ratings = TLX_ITEMS.map(|item| number_of(found, item, 0.0..=super::TLX_TOP));
    let chosen = |item: &str| found.pairs.iter().filter(|pair: &&PairChoice| pair.chosen == item).count();
    let weights = (!found.pairs.is_empty()).then(|| TLX_ITEMS.map(|item| chosen(item) as f64));
    TlxAnswers { ratings, weights }
}

fn sus_of(found: &QuestionnaireResult) -> SusAnswers {
    let answers = std::array::from_fn(|at| number_of(found, &format!("sus{}", at + 1), 1.0..=5.0));
    SusAnswers { answers }
}

/// Brings participants into the order of their sets, and gives each a letter and a number: "L0" in the set "Linemod".
pub(super) fn sorted_and_labelled(input: &mut ReportInput) {
    let set_of = |participant: &ReportParticipant| {
        let mut sets = participant
            .trials
            .iter()
            .filter_map(|trial| input.samples.get(trial.sample))
            .map(|sample| sample.set);
        let first = sets.next();
        first.filter(|first| sets.all(|other| other == *first))
    };
    let mut people: Vec<(usize, ReportParticipant)> = std::mem::take(&mut input.participants)
        .into_iter()
        .map(|participant| (set_of(&participant).unwrap_or(usize::MAX), participant))
        .collect();
    // Within a set the order is that of their beginning, in which they came.
    sort_short(&mut people, |a, b| a.0.cmp(&b.0));
    let letters = letters(&input.sets);
    let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
    for (set, participant) in &mut people {
        let count = counts.entry(*set).or_default();
        participant.label = format!("{}{count}", letters.get(*set).copied().unwrap_or('P'));
        *count += 1;
    }
    input.participants = people.into_iter().map(|(_, participant)| participant).collect();
}

/// The sets' first letters; where two are the same or a set has no name, letters from the alphabet. P alone is for a study
/// without sets.
fn letters(sets: &[String]) -> Vec<char> {
    if let [only] = sets
        && only.is_empty()
    {
        return vec!['P'];
    }
    let firsts: Vec<char> = sets
        .iter()
        .filter_map(|set| set.chars().find(|c| c.is_alphabetic()))
        .filter_map(|first| first.to_uppercase().next())
        .collect();
    let mut distinct = firsts.clone();
    sort_short(&mut distinct, Ord::cmp);
    distinct.dedup();
    if distinct.len() == sets.len() && !distinct.contains(&'P') {
        firsts
    } else {
        ('A'..='Z').cycle().take(sets.len()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_have_letters_of_their_own() {
        let of = |names: &[&str]| letters(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>());
        assert_eq!(of(&["Linemod", "handal"]), ['L', 'H']);
        assert_eq!(of(&["a", "Ab", "c"]), ['A', 'B', 'C']);
        assert_eq!(of(&[""]), ['P']);
        assert_eq!(of(&["", "x"]), ['A', 'B']);
    }
}
