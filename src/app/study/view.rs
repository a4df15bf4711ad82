//! What the participant's screen shows, from where the participation is.

use super::words::Trouble;
use super::{Participating, Ready, Running, State};
use crate::platform;
use crate::study::{RunningTrial, Step};
use crate::ui::study::{FinishView, StudyScreen, StudyView, TrialView};

impl Participating {
    pub fn view<'a>(&'a self, busy: Option<&'a str>) -> StudyView<'a> {
        let screen = match &self.state {
            State::Loading(ready) => loading(ready.as_deref()),
            State::LookingBack { ready, .. } => loading(Some(ready)),
            State::ToChange(_) => loading(None),
            State::Problem(Trouble { text, details, can_retry }) => {
                StudyScreen::Problem { text, details, can_retry: *can_retry }
            }
            State::AskId(_) => StudyScreen::AskId,
            State::Running(running) => running.screen(busy),
            State::Watching(watching) => StudyScreen::Replay(watching.view()),
        };
        StudyView {
            title: &self.title,
            contact: &self.contact,
            screen,
            pictures: &self.pictures,
            page: self.page,
            is_preview: self.link.is_none(),
            can_rehearse: self.can_rehearse(),
        }
    }

    /// The page's API says which screen is shown, so that an embedding page can follow.
    pub fn screen_name(&self) -> &'static str {
        match self.view(None).screen {
            StudyScreen::Loading { .. } => "loading",
            StudyScreen::Problem { .. } => "problem",
            StudyScreen::AskId => "participant",
            StudyScreen::Consent { .. } => "consent",
            StudyScreen::Declined => "declined",
            StudyScreen::Instructions { .. } => "instructions",
            StudyScreen::Questions { .. } => "questions",
            StudyScreen::Trial(trial) if trial.is_practice => "practice",
            StudyScreen::Trial(_) => "trial",
            StudyScreen::Feedback { .. } => "feedback",
            StudyScreen::Begin { .. } => "begin",
            StudyScreen::Rest { .. } => "rest",
            StudyScreen::Questionnaire { .. } => "questionnaire",
            StudyScreen::Finish(_) => "finish",
            StudyScreen::Replay(_) => "replay",
        }
    }
}

/// How far the files have come.
fn loading(ready: Option<&Ready>) -> StudyScreen<'static> {
    let (done, all) = ready.map_or((0, 0), Ready::progress);
    StudyScreen::Loading { done, all }
}

impl Running {
    fn screen<'a>(&'a self, busy: Option<&'a str>) -> StudyScreen<'a> {
        let study = &self.ready.files.study;
        let plan = &self.participation.plan;
        if let Some(text) = &self.problem {
            return StudyScreen::Problem { text, details: "", can_retry: false };
        }
        if self.waits {
            return loading(Some(&self.ready));
        }
        if self.participation.has_declined() {
            return StudyScreen::Declined;
        }
        let condition_of = |trial: usize| {
            let id = plan.trials.get(trial).map(|trial| &trial.condition);
            id.and_then(|id| study.condition(id)).or_else(|| study.conditions.first())
        };
        let nothing =
            StudyScreen::Problem { text: "The study has no such part.", details: "", can_retry: false };
        match self.step() {
            Step::Consent => StudyScreen::Consent { text: &study.texts.consent },
            Step::Instructions => condition_of(0).map_or(nothing, |condition| StudyScreen::Instructions {
                text: &study.texts.instructions,
                condition,
                practice: study.practice.len(),
                trials: plan.trials.len(),
            }),
            Step::Questions => StudyScreen::Questions { items: &study.items_before },
            Step::Practice(index) => match self.participation.feedback() {
                Some(feedback) => {
                    let practice = study.practice.get(index);
                    let may_try_again = practice.is_some_and(|practice| {
                        self.participation.attempts(&practice.sample.id) < practice.most_attempts
                    });
                    StudyScreen::Feedback { feedback, may_try_again }
                }
                None => StudyScreen::Trial(self.trial_view(index, study.practice.len(), true, busy)),
            },
            Step::Begin { trial } => condition_of(trial).map_or(nothing, |condition| {
                let number = plan.conditions.iter().position(|id| *id == condition.id).map_or(1, |at| at + 1);
                let trials = plan.trials.iter().filter(|trial| trial.condition == condition.id).count();
                StudyScreen::Begin { condition, number, count: plan.conditions.len(), trials }
            }),
            Step::Trial(index) => StudyScreen::Trial(self.trial_view(index, plan.trials.len(), false, busy)),
            Step::Rest { trial } => StudyScreen::Rest { done: trial, all: plan.trials.len() },
            Step::Questionnaire { questionnaire, condition } => {
                let about = condition.filter(|_| plan.conditions.len() > 1);
                let about = about.and_then(|place| study.condition(plan.conditions.get(place)?));
                study.questionnaires.get(questionnaire).map_or(nothing, |questionnaire| {
                    let about = about.map(|condition| condition.title.as_str());
                    StudyScreen::Questionnaire { questionnaire, about, pairs: &self.pairs }
                })
            }
            Step::Finish => StudyScreen::Finish(self.finish_view()),
        }
    }

    fn trial_view<'a>(
        &'a self,
        index: usize,
        count: usize,
        is_practice: bool,
        busy: Option<&'a str>,
    ) -> TrialView<'a> {
        let limits = &self.ready.files.study.limits;
        let trial = self.participation.trial();
        let seconds_left = limits
            .trial_seconds
            .filter(|_| !is_practice)
            .map(|seconds| seconds - trial.map_or(0.0, RunningTrial::time_ms) / 1000.0);
        let worked = self.participation.minutes_since_rest(platform::now_ms());
        TrialView {
            number: index + 1,
            count,
            is_practice,
            tools: self.tools(),
            may_pause: limits.may_pause,
            is_paused: trial.is_some_and(RunningTrial::is_paused),
            can_confirm: self.can_confirm(),
            seconds_left,
            suggests_pause: limits.may_pause
                && limits.remind_after_minutes.is_some_and(|minutes| worked >= minutes),
            busy,
        }
    }

    fn finish_view(&self) -> FinishView<'_> {
        let study = &self.ready.files.study;
        let left_ms = self.redirect_at_ms.map(|at_ms| at_ms - platform::now_ms());
        let sending = match self.participation.is_saved {
            true => crate::ui::study::Sending::Arrived,
            false => self.sender.view(),
        };
        FinishView {
            thanks: &study.texts.thanks,
            sending,
            code: study.completion.code.as_deref().filter(|_| self.sender.is_done()),
            can_redirect: study.completion.redirect.is_some() && self.sender.is_done(),
            redirect_in: left_ms
                .filter(|ms| ms.is_finite())
                .map(|ms| (ms.clamp(0.0, 3.6e6) / 1000.0).ceil() as u32),
            is_kept_here: self.keeping.is_kept(),
        }
    }
}
