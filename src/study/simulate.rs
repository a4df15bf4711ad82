//! Participants that are a program, so that a researcher sees a report before the study runs.
//!
//! Their poses are the truth with a person's, a trial's and a direction's noise, their times those of people who learn; both
//! have about the size of the paper's. They are a rehearsal of files and figures, and say nothing of people. Every file of
//! them is marked.

mod answers;
mod person;

use std::collections::BTreeMap;
use std::sync::Arc;

use super::{
    AskedFor, Environment, Event, EventKind, FileRecord, Outcome, Participant, Plan, PlannedTrial, Results,
    Study, StudyError, StudyRecord, TrialResult, Truth, rfc3339, start_pose,
};
use crate::math::Pose;
use crate::mesh::Mesh;
use person::Person;

/// How many, and by which chance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Simulation {
    pub participants: usize,
    pub seed: u64,
    /// When the first one begins, in milliseconds since 1970 (UTC); the others follow hour by hour.
    pub began_ms: f64,
}

/// An hour, between two participants' beginnings.
const HOUR_MS: f64 = 3_600_000.0;
/// From the link to the first trial.
const READING_MS: f64 = 180_000.0;
/// From a confirmation to the next photo.
const BETWEEN_TRIALS_MS: f64 = 1_500.0;

/// Results of simulated participants. `sha256` is that of `study.json`; meshes are in the `object` frame, by the objects' ids.
pub fn simulate(
    study: &Study,
    sha256: &str,
    truth: &Truth,
    meshes: &BTreeMap<String, Arc<Mesh>>,
    simulation: Simulation,
) -> Result<Vec<Results>, StudyError> {
    let scene = Setting { study, sha256, truth, meshes };
    (0..simulation.participants).map(|number| scene.participant(number, simulation)).collect()
}

/// What all participants have in common.
struct Setting<'a> {
    study: &'a Study,
    sha256: &'a str,
    truth: &'a Truth,
    meshes: &'a BTreeMap<String, Arc<Mesh>>,
}

impl Setting<'_> {
    fn participant(&self, number: usize, simulation: Simulation) -> Result<Results, StudyError> {
        let id = format!("simulated-{:03}", number + 1);
        let plan = Plan::new(self.study, &id, &AskedFor::default())?;
        let mut person = Person::new(simulation.seed, &id);
        let mut now_ms = simulation.began_ms + HOUR_MS * number as f64;
        let record = StudyRecord {
            id: self.study.id.clone(),
            title: self.study.title.clone(),
            sha256: self.sha256.to_owned(),
        };
        let environment = Environment { browser: "simulated".to_owned(), ..Environment::default() };
        let participant = Participant { id, recruiter: BTreeMap::new() };
        let mut results = Results::new(record, participant, environment, plan.seed, rfc3339(now_ms));
        results.is_simulated = true;
        results.conditions.clone_from(&plan.conditions);
        results.sample_sets.clone_from(&plan.sample_sets);
        results.consented_at = (!self.study.texts.consent.is_empty()).then(|| rfc3339(now_ms));
        results.items_before = answers::items(&self.study.items_before, &mut person);
        now_ms += READING_MS;
        for (index, planned) in plan.trials.iter().enumerate() {
            let trial = self.trial(index, planned, plan.seed, now_ms, &mut person)?;
            now_ms += trial.time_s * 1000.0 + BETWEEN_TRIALS_MS;
            results.trials.push(trial);
        }
        for questionnaire in &self.study.questionnaires {
            let asked = answers::questionnaire(questionnaire, &plan, &mut person, &rfc3339(now_ms));
            results.questionnaires.extend(asked);
        }
        results.finished_at = Some(rfc3339(now_ms + READING_MS));
        Ok(results)
    }

    fn trial(
        &self,
        index: usize,
        planned: &PlannedTrial,
        seed: u64,
        shown_ms: f64,
        person: &mut Person,
    ) -> Result<TrialResult, StudyError> {
        let study = self.study;
        let missing = |what: &str| StudyError::at(planned.sample.clone(), what);
        let sample = study.sample(&planned.sample).ok_or_else(|| missing("no sample of the study"))?;
        let photo = study.photo(&sample.photo).ok_or_else(|| missing("its photo is not in the study"))?;
        let object = study.object(&sample.object).ok_or_else(|| missing("its object is not in the study"))?;
        let mesh = self.meshes.get(&object.id).ok_or_else(|| missing("its mesh is not here"))?;
        let answer = self.truth.sample(&sample.id).ok_or_else(|| missing("it has no truth"))?;
        let pose = answer.pose.ok_or_else(|| missing("its true pose is not known"))?;
        let truth = pose.to_pose().map_err(|error| missing(&error.to_string()))?;
        let camera = photo.camera.to_intrinsics().map_err(|error| missing(&error.to_string()))?;
        let given = sample.start.and_then(|start| start.to_pose().ok());
        let start = start_pose(study, given, &camera, mesh, seed, &format!("trial {index}"))?;
        let symmetries = answer.symmetries.to_symmetries().unwrap_or_default().expanded();
        let tools = study.condition(&planned.condition).map(|found| found.tools.clone()).unwrap_or_default();
        let final_pose = person.pose(&truth, &symmetries, mesh.bounds().center(), &tools);
        let wanted_s = person.seconds(index, &tools);
        let limit_s = study.limits.trial_seconds.unwrap_or(f64::INFINITY);
        // To the millisecond, as clocks have it.
        let time_s = (wanted_s.min(limit_s) * 1000.0).round() / 1000.0;
        let idle_s = (time_s * 100.0).round() / 1000.0;
        let file = |id: &str, asset: &super::Asset| FileRecord {
            id: id.to_owned(),
            name: asset.name.clone(),
            sha256: asset.sha256.clone(),
        };
        let outcome = if wanted_s > limit_s { Outcome::TimedOut } else { Outcome::Confirmed };
        let (events, gestures) = events(&start, &final_pose, time_s, outcome);
        Ok(TrialResult {
            index: index as u32,
            sample: sample.id.clone(),
            set: sample.set.clone(),
            repeat: planned.repeat,
            condition: planned.condition.clone(),
            tools,
            photo: file(&photo.id, &photo.asset),
            object: file(&object.id, &object.mesh),
            start_pose: start.into(),
            final_pose: final_pose.into(),
            outcome,
            shown_at: rfc3339(shown_ms),
            confirmed_at: rfc3339(shown_ms + time_s * 1000.0),
            time_s,
            active_s: time_s - idle_s,
            idle_s,
            paused_s: 0.0,
            hidden_s: 0.0,
            closed_s: 0.0,
            gestures,
            events,
        })
    }
}

/// A few gestures from the start to the final pose, evenly over the time.
fn events(start: &Pose, end: &Pose, time_s: f64, outcome: Outcome) -> (Vec<Event>, BTreeMap<String, u32>) {
    const GESTURES: [(f64, EventKind); 5] = [
        (0.5, EventKind::Move),
        (0.8, EventKind::Rotate),
        (0.9, EventKind::Depth),
        (0.97, EventKind::Rotate),
        (1.0, EventKind::Move),
    ];
    let at_ms = |part: f64| (time_s * 1000.0 * part).round() as u64;
    let mut events = vec![Event::new(0, EventKind::Shown, None)];
    let mut counts: BTreeMap<String, u32> = BTreeMap::new();
    for (place, (part, kind)) in GESTURES.into_iter().enumerate() {
        let pose = if part < 1.0 { start.towards(end, part) } else { *end };
        events.push(Event::new(at_ms((place + 1) as f64 / 6.0), kind, Some(pose)));
        *counts.entry(kind.name()).or_default() += 1;
    }
    let last = match outcome {
        Outcome::Confirmed => EventKind::Confirmed,
        Outcome::TimedOut => EventKind::TimedOut,
    };
    events.push(Event::new(at_ms(1.0), last, None));
    (events, counts)
}

#[cfg(test)]
mod tests;
