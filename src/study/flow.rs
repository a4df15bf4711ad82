//! A participation as a state machine: which screen comes next, and what each leaves behind. All of it can be written down, so
//! that it goes on after a reload.

mod trial;

use serde::{Deserialize, Serialize};

use super::time::rfc3339;
use super::{
    Answer, Environment, Feedback, Participant, Pause, PauseKind, Plan, PracticeResult, QuestionnaireResult,
    QuestionnaireTime, Results, ResumePolicy, Study, StudyRecord, TrialResult,
};

pub use trial::{PinRecord, RunningTrial, TrialPlace};

/// A screen of a participation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    Consent,
    Instructions,
    /// The questions before the study.
    Questions,
    /// A practice sample, by its place.
    Practice(usize),
    /// Before the first trial of a condition: from here on it counts.
    Begin {
        trial: usize,
    },
    Trial(usize),
    /// Between two blocks, before this trial.
    Rest {
        trial: usize,
    },
    /// A questionnaire by its place, about the condition at this place or about all.
    Questionnaire {
        questionnaire: usize,
        condition: Option<usize>,
    },
    /// Results are on their way.
    Finish,
}

/// The whole way of one participant, in order.
pub fn steps(study: &Study, plan: &Plan) -> Vec<Step> {
    let mut steps = Vec::new();
    if !study.texts.consent.trim().is_empty() {
        steps.push(Step::Consent);
    }
    if !study.items_before.is_empty() {
        steps.push(Step::Questions);
    }
    steps.push(Step::Instructions);
    steps.extend((0..study.practice.len()).map(Step::Practice));
    let asked = |when: QuestionnaireTime, condition: Option<usize>| {
        let of_time = study.questionnaires.iter().enumerate().filter(move |(_, one)| one.when == when);
        of_time.map(move |(questionnaire, _)| Step::Questionnaire { questionnaire, condition })
    };
    let mut condition = None;
    for trial in 0..plan.trials.len() {
        if plan.begins_condition(trial) {
            if condition.is_some() {
                steps.extend(asked(QuestionnaireTime::EachCondition, condition));
            }
            condition = Some(condition.map_or(0, |place| place + 1));
            steps.push(Step::Begin { trial });
        } else if rests_before(study, plan, trial) {
            steps.push(Step::Rest { trial });
        }
        steps.push(Step::Trial(trial));
    }
    if condition.is_some() {
        steps.extend(asked(QuestionnaireTime::EachCondition, condition));
    }
    steps.extend(asked(QuestionnaireTime::End, None));
    steps.push(Step::Finish);
    steps
}

/// Every so many trials as the study says; else between two repeats.
fn rests_before(study: &Study, plan: &Plan, trial: usize) -> bool {
    match study.limits.break_after_trials {
        Some(count) => {
            let trials_of_condition = (0..=trial).rev().find(|index| plan.begins_condition(*index));
            let done = trial - trials_of_condition.unwrap_or(0);
            done > 0 && done.is_multiple_of(count.max(1) as usize)
        }
        None => plan.begins_repeat(trial),
    }
}

/// How an interrupted participation comes back.
#[derive(Debug, Clone, PartialEq)]
pub enum Reopened {
    /// In the same place.
    GoesOn(Box<Participation>),
    /// The study is to be begun anew.
    Restarts,
    /// The study takes nobody back.
    Blocked,
    /// It was finished before.
    Done(Box<Participation>),
}

/// One participant on the way through a study. Written down as JSON it goes on wherever it is read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Participation {
    pub plan: Plan,
    /// The place among [`steps`].
    position: usize,
    pub results: Results,
    /// The trial that is under way, practice or not.
    trial: Option<RunningTrial>,
    /// What was said of the last practice pose, until the participant goes on.
    feedback: Option<Feedback>,
    /// When the rest that is taken began.
    resting_since_ms: Option<f64>,
    /// When the last pause of any kind ended: what a reminder counts from.
    worked_since_ms: f64,
    /// The results are where they belong; the way out is shown.
    pub is_saved: bool,
    has_declined: bool,
}

impl Participation {
    pub fn begin(
        study: StudyRecord,
        plan: Plan,
        participant: Participant,
        environment: Environment,
        now_ms: f64,
    ) -> Self {
        let mut results = Results::new(study, participant, environment, plan.seed, rfc3339(now_ms));
        results.conditions.clone_from(&plan.conditions);
        results.sample_sets.clone_from(&plan.sample_sets);
        Self {
            plan,
            position: 0,
            results,
            trial: None,
            feedback: None,
            resting_since_ms: None,
            worked_since_ms: now_ms,
            is_saved: false,
            has_declined: false,
        }
    }

    /// What was written down comes back as the study wants it.
    pub fn reopen(mut self, policy: ResumePolicy, now_ms: f64) -> Reopened {
        if self.results.finished_at.is_some() {
            return Reopened::Done(Box::new(self));
        }
        // Who has begun no trial has nothing to repeat.
        let has_begun = self.trial.is_some() || !self.results.trials.is_empty();
        match policy {
            ResumePolicy::Restart if has_begun => return Reopened::Restarts,
            ResumePolicy::Block if has_begun => return Reopened::Blocked,
            ResumePolicy::Resume | ResumePolicy::Restart | ResumePolicy::Block => {}
        }
        if let Some(pause) = self.trial.as_mut().and_then(|trial| trial.reopen(now_ms)) {
            self.results.pauses.push(pause);
        }
        self.worked_since_ms = now_ms;
        Reopened::GoesOn(Box::new(self))
    }

    /// The screen that is shown.
    pub fn step(&self, study: &Study) -> Step {
        steps(study, &self.plan).get(self.position).copied().unwrap_or(Step::Finish)
    }

    pub fn has_declined(&self) -> bool {
        self.has_declined
    }

    pub fn feedback(&self) -> Option<&Feedback> {
        self.feedback.as_ref()
    }

    pub fn trial(&self) -> Option<&RunningTrial> {
        self.trial.as_ref()
    }

    pub fn trial_mut(&mut self) -> Option<&mut RunningTrial> {
        self.trial.as_mut()
    }

    /// Minutes of work since the last rest.
    pub fn minutes_since_rest(&self, now_ms: f64) -> f64 {
        (now_ms - self.worked_since_ms).max(0.0) / 60_000.0
    }

    fn advance(&mut self, now_ms: f64) {
        self.position += 1;
        self.trial = None;
        self.feedback = None;
        self.resting_since_ms = Some(now_ms);
    }

    pub fn agree(&mut self, now_ms: f64) {
        self.results.consented_at = Some(rfc3339(now_ms));
        self.advance(now_ms);
    }

    /// Nothing of who does not agree is kept.
    pub fn decline(&mut self) {
        self.has_declined = true;
    }

    pub fn answer_items(&mut self, answers: Vec<Answer>, now_ms: f64) {
        self.results.items_before = answers;
        self.advance(now_ms);
    }

    /// From a screen that asks for nothing.
    pub fn go_on(&mut self, study: &Study, now_ms: f64) {
        if let (Step::Rest { trial }, Some(since_ms)) = (self.step(study), self.resting_since_ms) {
            self.results.pauses.push(Pause {
                kind: PauseKind::Break,
                trial: u32::try_from(trial).ok(),
                began_at: rfc3339(since_ms),
                seconds: (now_ms - since_ms).max(0.0) / 1000.0,
            });
            self.worked_since_ms = now_ms;
        }
        self.advance(now_ms);
    }

    /// Puts a sample in front of the participant; its clock starts when it is shown.
    pub fn start_trial(&mut self, trial: RunningTrial) {
        self.trial = Some(trial);
        self.feedback = None;
    }

    /// Keeps a pause that ended.
    pub fn add_pause(&mut self, pause: Pause, now_ms: f64) {
        self.worked_since_ms = now_ms;
        self.results.pauses.push(pause);
    }

    /// The trial is over.
    pub fn finish_trial(&mut self, result: TrialResult, now_ms: f64) {
        self.results.trials.push(result);
        self.advance(now_ms);
    }

    /// How often a practice sample has been tried.
    pub fn attempts(&self, sample: &str) -> u32 {
        let attempts = self.results.practice.iter().filter(|result| result.trial.sample == sample);
        attempts.count() as u32
    }

    /// A practice pose was confirmed; what is said of it stays until the participant goes on or tries again.
    pub fn finish_practice(&mut self, trial: TrialResult, feedback: Feedback) {
        let attempt = self.attempts(&trial.sample);
        self.results.practice.push(PracticeResult { attempt, trial, feedback });
        self.trial = None;
        self.feedback = Some(feedback);
    }

    /// The same practice sample once more.
    pub fn try_again(&mut self) {
        self.feedback = None;
    }

    pub fn answer_questionnaire(&mut self, result: QuestionnaireResult, now_ms: f64) {
        self.results.questionnaires.push(result);
        self.advance(now_ms);
    }

    /// All is done; once.
    pub fn finish(&mut self, now_ms: f64) {
        if self.results.finished_at.is_none() {
            self.results.finished_at = Some(rfc3339(now_ms));
        }
    }

    pub fn to_json(&self) -> String {
        // Nothing in it has no form in JSON.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// `None` for what is none, or of another version.
    pub fn from_json(text: &str) -> Option<Self> {
        serde_json::from_slice(text.as_bytes()).ok()
    }
}

#[cfg(test)]
mod tests;
