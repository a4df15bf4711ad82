//! Results as tidy tables: CSV with one row per trial, and one per answer.

use super::time::file_time;
use super::{AnswerValue, Results, TrialResult};

/// One row per trial, practice included (`phase`).
pub fn trials_csv(results: &Results) -> String {
    const HEAD: &str = "study,participant,simulated,phase,index,attempt,sample,set,repeat,condition,photo,object,outcome,\
        shown_at,confirmed_at,time_s,active_s,idle_s,paused_s,hidden_s,closed_s,gestures,\
        r11,r12,r13,r21,r22,r23,r31,r32,r33,tx_mm,ty_mm,tz_mm\n";
    let practice = results.practice.iter().map(|one| ("practice", one.attempt, &one.trial));
    let trials = results.trials.iter().map(|trial| ("trial", 0, trial));
    let rows = practice.chain(trials).map(|(phase, attempt, trial)| row(results, phase, attempt, trial));
    std::iter::once(HEAD.to_owned()).chain(rows).collect()
}

fn row(results: &Results, phase: &str, attempt: u32, trial: &TrialResult) -> String {
    let outcome = match trial.outcome {
        super::Outcome::Confirmed => "confirmed",
        super::Outcome::TimedOut => "timed_out",
    };
    let mut fields = vec![
        field(&results.study.id),
        field(&results.participant.id),
        results.is_simulated.to_string(),
        phase.to_owned(),
        trial.index.to_string(),
        attempt.to_string(),
        field(&trial.sample),
        field(trial.set.as_deref().unwrap_or_default()),
        trial.repeat.to_string(),
        field(&trial.condition),
        field(&trial.photo.name),
        field(&trial.object.name),
        outcome.to_owned(),
        trial.shown_at.clone(),
        trial.confirmed_at.clone(),
    ];
    let times = [trial.time_s, trial.active_s, trial.idle_s, trial.paused_s, trial.hidden_s, trial.closed_s];
    fields.extend(times.map(|seconds| format!("{seconds:.3}")));
    fields.push(trial.gestures.values().sum::<u32>().to_string());
    let pose = trial.final_pose;
    fields.extend(pose.rotation.as_flattened().iter().chain(&pose.translation_mm).map(f64::to_string));
    fields.join(",") + "\n"
}

/// One row per answer, of the questions before the study too.
pub fn answers_csv(results: &Results) -> String {
    const HEAD: &str = "study,participant,simulated,questionnaire,condition,item,value\n";
    let mut table = HEAD.to_owned();
    let who = [field(&results.study.id), field(&results.participant.id), results.is_simulated.to_string()]
        .join(",");
    let mut add = |questionnaire: &str, condition: &str, item: &str, value: &str| {
        let fields = [questionnaire, condition, item, value].map(field).join(",");
        table += &format!("{who},{fields}\n");
    };
    for answer in &results.items_before {
        add("before", "", &answer.item, &value_text(answer.value.as_ref()));
    }
    for result in &results.questionnaires {
        let condition = result.condition.as_deref().unwrap_or_default();
        for answer in &result.answers {
            add(&result.id, condition, &answer.item, &value_text(answer.value.as_ref()));
        }
        for pair in &result.pairs {
            add(&result.id, condition, &format!("{} or {}", pair.left, pair.right), &pair.chosen);
        }
        for (score, value) in &result.scores {
            add(&result.id, condition, &format!("score {score}"), &value.to_string());
        }
    }
    table
}

fn value_text(value: Option<&AnswerValue>) -> String {
    match value {
        None => String::new(),
        Some(AnswerValue::Number(number)) => number.to_string(),
        Some(AnswerValue::Text(text)) => text.clone(),
        Some(AnswerValue::Several(several)) => several.join("; "),
    }
}

/// A text as a field of CSV (RFC 4180).
fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// A JSON object of texts, for services that want one around a file.
pub fn json_object(entries: &[(&str, &str)]) -> String {
    let object: std::collections::BTreeMap<&str, &str> = entries.iter().copied().collect();
    // Texts have a form in JSON, whatever is in them.
    serde_json::to_string(&object).unwrap_or_default()
}

/// The name of a participant's file: study, participant and time are in it, and nothing that a file system refuses.
pub fn results_name(study: &str, participant: &str, at_ms: f64) -> String {
    const MOST: usize = 40;
    let plain = |text: &str| -> String {
        let kept = text.chars().take(MOST);
        kept.map(|c| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' }).collect()
    };
    format!("{}_{}_{}", plain(study), plain(participant), file_time(at_ms))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_fields_survive_any_text() {
        assert_eq!(results_name("demo", "A b/../ü", 0.0), "demo_A_b______19700101T000000Z");
        assert_eq!(field("a,\"b\""), "\"a,\"\"b\"\"\"");
        assert_eq!(field("plain"), "plain");
    }
}
