//! What has to be true of a participant's results, however they came about.

use std::collections::BTreeSet;

use anyhow::{Context as _, ensure};
use pinpose::study::{EventKind, Outcome, Plan, Results, TrialResult};

/// Times agree with the event log to this.
const MOST_OFF_MS: f64 = 50.0;

/// Nothing is lost or doubled, the order is that of the seed, and the times are those of the events. `worked_s` is what the
/// flow's own clock says of all trials together.
pub fn check(results: &Results, plan: &Plan, participant: &str, worked_s: f64) -> anyhow::Result<()> {
    ensure!(results.participant.id == participant && results.finished_at.is_some() && !results.is_simulated);
    ensure!(results.seed == plan.seed, "The seed is {}, not {}", results.seed, plan.seed);
    let done: Vec<(&str, u32)> =
        results.trials.iter().map(|trial| (trial.sample.as_str(), trial.repeat)).collect();
    let planned: Vec<(&str, u32)> =
        plan.trials.iter().map(|trial| (trial.sample.as_str(), trial.repeat)).collect();
    ensure!(done == planned, "The order was {done:?}, not {planned:?}");
    let distinct: BTreeSet<_> = done.iter().collect();
    ensure!(distinct.len() == done.len(), "A trial is there twice: {done:?}");
    let mut sum_s = 0.0;
    for (index, trial) in results.trials.iter().enumerate() {
        ensure!(trial.index as usize == index && trial.outcome == Outcome::Confirmed);
        check_trial(trial).with_context(|| format!("Trial {index}"))?;
        sum_s += trial.time_s + trial.closed_s;
    }
    ensure!(sum_s <= worked_s, "The trials took {sum_s} s, in {worked_s} s");
    ensure!(sum_s >= 0.1 * worked_s, "The trials took {sum_s} s of {worked_s} s");
    let reopened = results
        .trials
        .iter()
        .filter(|trial| trial.events.iter().any(|event| event.kind == EventKind::Reopened));
    ensure!(reopened.count() == 1, "Not one trial was gone on with");
    ensure!(results.questionnaires.len() == 2 && results.items_before.len() == 1, "Answers are lost");
    Ok(())
}

fn check_trial(trial: &TrialResult) -> anyhow::Result<()> {
    let last = trial.events.iter().rev().find_map(pinpose::study::Event::pose).context("No pose")??;
    ensure!(last == trial.final_pose.to_pose()?, "It does not end as its events do");
    ensure!(trial.gestures.values().sum::<u32>() > 0, "There are no gestures");
    ensure!(trial.events.is_sorted_by_key(|event| event.at_ms), "Events are not in their order");
    let (first, end) = (trial.events.first().context("No event")?, trial.events.last().context("No event")?);
    ensure!(first.kind == EventKind::Shown && first.at_ms == 0, "It begins with {first:?}");
    ensure!(end.kind == EventKind::Confirmed, "It ends with {end:?}");
    // The log's clock is the wall's: all kinds of time are in it.
    let whole_s = trial.time_s + trial.paused_s + trial.hidden_s + trial.closed_s;
    let off_ms = (whole_s * 1000.0 - end.at_ms as f64).abs();
    ensure!(off_ms <= MOST_OFF_MS, "The times are {off_ms} ms off the event log");
    let between_ms = (of_day_ms(&trial.confirmed_at)? - of_day_ms(&trial.shown_at)?).rem_euclid(DAY_MS);
    ensure!((between_ms - whole_s * 1000.0).abs() <= MOST_OFF_MS, "{between_ms} ms lie between its two ends");
    ensure!(
        (trial.active_s + trial.idle_s - trial.time_s).abs() < 1e-6,
        "Active and idle time are not all of it"
    );
    Ok(())
}

const DAY_MS: f64 = 86_400_000.0;

/// Of an RFC 3339 time.
fn of_day_ms(time: &str) -> anyhow::Result<f64> {
    let clock = time.split_once('T').context("No time")?.1.trim_end_matches('Z');
    let parts: Vec<f64> = clock.split(':').map(str::parse).collect::<Result<_, _>>()?;
    let [hours, minutes, seconds] = <[f64; 3]>::try_from(parts).ok().context("No time")?;
    Ok((hours * 3600.0 + minutes * 60.0 + seconds) * 1000.0)
}
