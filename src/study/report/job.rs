//! The analysis as a job that is done in parts, so that a page stays awake.

use crate::math::sort_short;
use std::collections::BTreeMap;

use super::analysis::{AgreementErrors, Analysis, PairErrors, ReportOptions, TrialErrors};
use super::contrast::{contrast, contrast_tasks};
use super::measure::Model;
use super::{Quantity, ReportInput, ReportParticipant, Trial};

/// Each participant is compared with so many others after it at the most (the last ones go on with the first), so that all
/// count the same and the work does not grow with the square of their number. Up to 21 participants these are all pairs.
pub const PARTNERS: usize = 10;

/// How a job stands.
#[derive(Debug)]
pub enum ReportProgress<T> {
    /// The part that is done, 0 to 1.
    Working(f64),
    Done(Box<T>),
}

/// Compares every trial with the truth, with its repeats, and with the other participants' best.
#[derive(Debug)]
pub struct AnalysisJob {
    analysis: Analysis,
    /// Sample by sample; `None` for a mesh without vertices, whose trials are left out.
    models: Vec<Option<Model>>,
    stage: Stage,
    /// What the stage has still to do, the next one last.
    tasks: Vec<Task>,
    done: usize,
    expected: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Stage {
    Models,
    Trials,
    Pairs,
    Agreement,
    Contrasts,
}

/// One comparison; numbers are indices of participants and of their trials.
#[derive(Debug, Clone, Copy)]
enum Task {
    Model { sample: usize },
    Trial { participant: usize, trial: usize },
    Pair { participant: usize, trials: [usize; 2] },
    Agreement { participants: [usize; 2], trials: [usize; 2] },
    Contrast { conditions: [usize; 2], quantity: Quantity },
}

impl AnalysisJob {
    pub fn new(input: ReportInput, options: ReportOptions) -> Self {
        let simulated = input.is_simulated();
        let ReportInput { title, sets, samples, conditions, mut participants, remarks } = input;
        for participant in &mut participants {
            let is_known = |trial: &Trial| trial.sample < samples.len() && trial.condition < conditions.len();
            participant.trials.retain(is_known);
        }
        let tasks: Vec<Task> = (0..samples.len()).rev().map(|sample| Task::Model { sample }).collect();
        let trials: usize = participants.iter().map(|participant| participant.trials.len()).sum();
        // As many pairs as trials where there are three repeats, and ten pairs for each best one.
        let expected = tasks.len() + 5 * trials;
        let analysis = Analysis {
            title,
            simulated,
            remarks,
            sets,
            samples,
            conditions,
            participants,
            diameters_mm: Vec::new(),
            trials: Vec::new(),
            pairs: Vec::new(),
            agreement: Vec::new(),
            contrasts: Vec::new(),
            options,
        };
        Self { analysis, models: Vec::new(), stage: Stage::Models, tasks, done: 0, expected }
    }

    /// Works while `go_on` says so, but for one comparison at least. What is done is handed over once: later calls find
    /// nothing.
    pub fn step(&mut self, go_on: &mut dyn FnMut() -> bool) -> ReportProgress<Analysis> {
        loop {
            if let Some(task) = self.tasks.pop() {
                self.work(task);
                self.done += 1;
            } else if !self.next_stage() {
                self.analysis.select_kept();
                return ReportProgress::Done(Box::new(std::mem::take(&mut self.analysis)));
            }
            if !go_on() {
                let all = self.expected.max(self.done + self.tasks.len()).max(1);
                return ReportProgress::Working(self.done as f64 / all as f64);
            }
        }
    }

    /// To the end, however long it takes.
    pub fn run(mut self) -> Analysis {
        loop {
            if let ReportProgress::Done(analysis) = self.step(&mut || true) {
                return *analysis;
            }
        }
    }

    fn work(&mut self, task: Task) {
        match task {
            Task::Model { sample } => {
                let model = self.analysis.samples.get(sample).and_then(Model::new);
                self.analysis.diameters_mm.push(model.as_ref().map_or(0.0, Model::diameter_mm));
                self.models.push(model);
            }
            Task::Trial { participant, trial } => {
                let row = self.trial_errors(participant, trial);
                self.analysis.trials.extend(row);
            }
            Task::Pair { participant, trials } => {
                let row = self.pair_errors(participant, trials);
                self.analysis.pairs.extend(row);
            }
            Task::Agreement { participants, trials } => {
                let row = self.agreement_errors(participants, trials);
                self.analysis.agreement.extend(row);
            }
            Task::Contrast { conditions, quantity } => {
                let row = contrast(&self.analysis, conditions, quantity);
                self.analysis.contrasts.extend(row);
            }
        }
    }

    /// `false` after the last one.
    fn next_stage(&mut self) -> bool {
        let participants = &self.analysis.participants;
        (self.stage, self.tasks) = match self.stage {
            Stage::Models => (Stage::Trials, trial_tasks(participants)),
            Stage::Trials => {
                self.analysis.select_best();
                (Stage::Pairs, pair_tasks(&self.analysis.participants))
            }
            Stage::Pairs => (Stage::Agreement, agreement_tasks(&self.analysis)),
            Stage::Agreement => {
                let all = contrast_tasks(self.analysis.conditions.len());
                let task = |(conditions, quantity)| Task::Contrast { conditions, quantity };
                (Stage::Contrasts, all.map(task).collect())
            }
            Stage::Contrasts => return false,
        };
        self.tasks.reverse();
        true
    }

    fn trial(&self, participant: usize, trial: usize) -> Option<&Trial> {
        self.analysis.participants.get(participant)?.trials.get(trial)
    }

    fn model(&self, sample: usize) -> Option<&Model> {
        self.models.get(sample)?.as_ref()
    }

    fn trial_errors(&self, participant: usize, trial: usize) -> Option<TrialErrors> {
        let &Trial { sample, condition, repeat, pose, seconds, .. } = self.trial(participant, trial)?;
        let truth = self.analysis.samples.get(sample)?.truth;
        let errors = self.model(sample)?.errors(&pose, &truth);
        let (is_best, is_kept) = (false, false);
        Some(TrialErrors { participant, trial, sample, condition, repeat, seconds, errors, is_best, is_kept })
    }

    fn pair_errors(&self, participant: usize, [first, second]: [usize; 2]) -> Option<PairErrors> {
        let (first, second) = (self.trial(participant, first)?, self.trial(participant, second)?);
        let differences = self.model(first.sample)?.difference(&second.pose, &first.pose);
        Some(PairErrors {
            participant,
            sample: first.sample,
            condition: first.condition,
            repeats: [first.repeat, second.repeat],
            differences,
            is_kept: false,
        })
    }

    fn agreement_errors(
        &self,
        participants: [usize; 2],
        [first, second]: [usize; 2],
    ) -> Option<AgreementErrors> {
        let (first, second) = (self.trial(participants[0], first)?, self.trial(participants[1], second)?);
        let differences = self.model(first.sample)?.difference(&second.pose, &first.pose);
        Some(AgreementErrors { sample: first.sample, condition: first.condition, participants, differences })
    }
}

fn trial_tasks(participants: &[ReportParticipant]) -> Vec<Task> {
    let of_one = |(participant, one): (usize, &ReportParticipant)| {
        (0..one.trials.len()).map(move |trial| Task::Trial { participant, trial }).collect::<Vec<_>>()
    };
    participants.iter().enumerate().flat_map(of_one).collect()
}

/// All pairs of a participant's trials of the same sample under the same condition, the earlier repeat first.
fn pair_tasks(participants: &[ReportParticipant]) -> Vec<Task> {
    let mut tasks = Vec::new();
    for (participant, one) in participants.iter().enumerate() {
        let mut groups: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
        for (at, trial) in one.trials.iter().enumerate() {
            groups.entry([trial.sample, trial.condition]).or_default().push(at);
        }
        for mut group in groups.into_values() {
            let repeat = |at: usize| one.trials.get(at).map(|trial| trial.repeat);
            sort_short(&mut group, |a, b| repeat(*a).cmp(&repeat(*b)));
            for (place, first) in group.iter().enumerate() {
                let later = group.iter().skip(place + 1);
                tasks.extend(later.map(|second| Task::Pair { participant, trials: [*first, *second] }));
            }
        }
    }
    tasks
}

/// The best trials of each sample and condition, each participant's with those of the next [`PARTNERS`].
fn agreement_tasks(analysis: &Analysis) -> Vec<Task> {
    let mut groups: BTreeMap<[usize; 2], Vec<[usize; 2]>> = BTreeMap::new();
    for row in analysis.trials.iter().filter(|row| row.is_best) {
        groups.entry([row.sample, row.condition]).or_default().push([row.participant, row.trial]);
    }
    let mut tasks = Vec::new();
    for group in groups.into_values() {
        for [first, second] in ring_pairs(group.len()) {
            if let (Some(first), Some(second)) = (group.get(first), group.get(second)) {
                let (participants, trials) = ([first[0], second[0]], [first[1], second[1]]);
                tasks.push(Task::Agreement { participants, trials });
            }
        }
    }
    tasks
}

/// Each of `count` places on a ring with up to [`PARTNERS`] after it, no two twice.
fn ring_pairs(count: usize) -> Vec<[usize; 2]> {
    let mut pairs = Vec::new();
    for step in 1..=PARTNERS.min(count / 2) {
        // Half round an even ring, each pair would come from both of its ends.
        let starts = if 2 * step == count { step } else { count };
        pairs.extend((0..starts).map(|start| {
            let end = (start + step) % count;
            [start.min(end), start.max(end)]
        }));
    }
    pairs
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::sync::Arc;

    use glam::DVec3;

    use super::*;
    use crate::math::Pose;
    use crate::mesh::test_shapes;
    use crate::scene::Symmetries;
    use crate::study::report::{Measure, ReportCondition, ReportSample, Rows};

    /// Three people who pose two cubes three times, the third time best and the first time worst.
    fn input() -> ReportInput {
        let mesh = Arc::new(test_shapes::cube());
        let sample = |at: u32| ReportSample {
            label: format!("S{at}"),
            set: 0,
            name: "cube".to_owned(),
            mesh: mesh.clone(),
            symmetries: Symmetries::default(),
            truth: Pose::from_translation(DVec3::new(0.0, f64::from(at), 500.0)),
            view: None,
        };
        let samples = vec![sample(0), sample(1)];
        let person = |number: usize| {
            let trial = |at: usize| {
                let (sample, repeat) = (at % 2, at / 2);
                let offset_mm = DVec3::X * (10 * number + 3 - repeat) as f64;
                let pose = samples[sample].truth.translated(offset_mm);
                Trial { sample, condition: 0, repeat, pose, seconds: 10.0, timed_out: false }
            };
            ReportParticipant { trials: (0..6).map(trial).collect(), ..ReportParticipant::default() }
        };
        ReportInput {
            sets: vec![String::new()],
            conditions: vec![ReportCondition { id: "all".to_owned(), title: "All".to_owned() }],
            participants: (0..3).map(person).collect(),
            samples,
            ..ReportInput::default()
        }
    }

    #[test]
    fn a_page_may_draw_after_every_comparison() {
        let mut job = AnalysisJob::new(input(), ReportOptions::default());
        let mut parts = Vec::new();
        let analysis = loop {
            match job.step(&mut || false) {
                ReportProgress::Working(part) => parts.push(part),
                ReportProgress::Done(analysis) => break analysis,
            }
        };
        // Two models, 18 trials, three pairs of each person's repeats of a sample, three pairs of people for a sample.
        assert!(parts.len() >= 2 + 18 + 18 + 6, "{}", parts.len());
        assert!(parts.is_sorted() && parts.iter().all(|part| (0.0..=1.0).contains(part)), "{parts:?}");
        let counts = [analysis.trials.len(), analysis.pairs.len(), analysis.agreement.len()];
        assert_eq!(counts, [18, 18, 6]);
        let at_once = AnalysisJob::new(input(), ReportOptions::default()).run();
        assert_eq!((&at_once.trials, &at_once.pairs), (&analysis.trials, &analysis.pairs));
    }

    #[test]
    fn the_third_trials_are_best_and_the_worst_tenth_is_not_kept() {
        let analysis = AnalysisJob::new(input(), ReportOptions::default()).run();
        let best: Vec<&TrialErrors> = analysis.best_of_set(0, Rows::All).collect();
        assert!(best.len() == 6 && best.iter().all(|row| row.repeat == 2));
        let add = |row: &&TrialErrors| row.errors.get(Measure::Add);
        // The offsets are 1, 11 and 21 mm; five of six rows are kept.
        assert!((best.iter().map(add).sum::<f64>() - 66.0).abs() < 1e-9);
        let kept: Vec<&TrialErrors> = analysis.best_of_set(0, Rows::Best90).collect();
        assert!(kept.len() == 5 && (kept.iter().map(add).sum::<f64>() - 45.0).abs() < 1e-9);
        assert_eq!(analysis.pairs_of(1, 0, Rows::Best90).count(), 5);
        assert!(analysis.agreement.iter().all(|row| row.differences.get(Measure::Add) > 9.9));
    }

    #[test]
    fn everybody_meets_as_many_others() {
        for count in [0, 1, 2, 5, 6, 21] {
            let pairs = ring_pairs(count);
            let distinct: BTreeSet<_> = pairs.iter().collect();
            assert_eq!((pairs.len(), distinct.len()), (count * count.saturating_sub(1) / 2, pairs.len()));
        }
        let pairs = ring_pairs(100);
        assert_eq!(pairs.len(), 1_000);
        for one in 0..100 {
            assert_eq!(pairs.iter().filter(|pair| pair.contains(&one)).count(), 20);
        }
    }
}
