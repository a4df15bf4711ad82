//! What a participant asks for on screens of text.

use super::Running;
use crate::platform;
use crate::study::questionnaire::{sus_scores, tlx_pairs, tlx_scores};
use crate::study::{
    Answer, PairChoice, QuestionnaireKind, QuestionnaireResult, Step, answers_csv, results_name, rfc3339,
    trials_csv,
};
use crate::ui::study::{StudyRequest, TlxPair};

impl Running {
    /// Carries out a request of the screen that is shown; one of another screen does nothing.
    pub(super) fn take_request(
        &mut self,
        request: &StudyRequest,
        ctx: &egui::Context,
        now_ms: f64,
    ) -> Result<(), String> {
        let study = &self.ready.files.study;
        match (self.step(), request) {
            (Step::Consent, StudyRequest::Agree) => self.participation.agree(now_ms),
            (Step::Consent, StudyRequest::Decline) => {
                self.participation.decline();
                self.keeping.forget();
                return Ok(());
            }
            (Step::Questions, StudyRequest::Items(answers)) => {
                self.participation.answer_items(answers.clone(), now_ms);
            }
            (Step::Instructions | Step::Begin { .. } | Step::Rest { .. }, StudyRequest::GoOn) => {
                self.participation.go_on(study, now_ms);
            }
            (Step::Practice(_), StudyRequest::GoOn) if self.participation.feedback().is_some() => {
                self.participation.go_on(study, now_ms);
            }
            (Step::Practice(_), StudyRequest::TryAgain) => self.participation.try_again(),
            (
                Step::Questionnaire { questionnaire, condition },
                StudyRequest::Questionnaire(answers, pairs),
            ) => {
                let result = self.questionnaire_result(questionnaire, condition, answers, pairs, now_ms);
                self.participation.answer_questionnaire(result, now_ms);
            }
            (Step::Trial(_) | Step::Practice(_), request) => {
                self.take_trial_request(request, now_ms);
                return Ok(());
            }
            (Step::Finish, request) => return self.take_last_request(request, ctx, now_ms),
            _ => return Ok(()),
        }
        self.enter(now_ms);
        Ok(())
    }

    fn take_trial_request(&mut self, request: &StudyRequest, now_ms: f64) {
        let index = self.sample().map_or(0, |(_, place)| place.index);
        let is_practice = matches!(self.step(), Step::Practice(_));
        match request {
            StudyRequest::Confirm if self.can_confirm() => {
                self.end_trial(crate::study::Outcome::Confirmed, now_ms);
            }
            StudyRequest::Pause if self.ready.files.study.limits.may_pause => {
                if let Some(trial) = self.participation.trial_mut() {
                    trial.pause(now_ms);
                }
            }
            StudyRequest::Resume => {
                let pause = self.participation.trial_mut().and_then(|trial| trial.go_on(index, now_ms));
                if let Some(mut pause) = pause {
                    pause.trial = pause.trial.filter(|_| !is_practice);
                    self.participation.add_pause(pause, now_ms);
                }
            }
            _ => return,
        }
        self.keeping.changed(&self.participation, now_ms);
    }

    fn take_last_request(
        &mut self,
        request: &StudyRequest,
        ctx: &egui::Context,
        now_ms: f64,
    ) -> Result<(), String> {
        let results = &self.participation.results;
        let name = results_name(&results.study.id, &results.participant.id, now_ms);
        match request {
            StudyRequest::DownloadJson => {
                platform::download(&format!("{name}.json"), results.to_json().as_bytes())?;
            }
            StudyRequest::DownloadCsv => {
                platform::download(&format!("{name}_trials.csv"), trials_csv(results).as_bytes())?;
                platform::download(&format!("{name}_answers.csv"), answers_csv(results).as_bytes())?;
            }
            StudyRequest::CopyCode => {
                ctx.copy_text(self.ready.files.study.completion.code.clone().unwrap_or_default());
            }
            StudyRequest::Retry => self.sender.try_again(),
            StudyRequest::Redirect => self.redirect(),
            StudyRequest::Forget => self.keeping.forget(),
            _ => {}
        }
        Ok(())
    }

    fn questionnaire_result(
        &self,
        questionnaire: usize,
        condition: Option<usize>,
        answers: &[Answer],
        pairs: &[PairChoice],
        now_ms: f64,
    ) -> QuestionnaireResult {
        let asked = self.ready.files.study.questionnaires.get(questionnaire);
        let (kind, scores) = match asked.map(|one| &one.kind) {
            Some(QuestionnaireKind::NasaTlx { .. }) => ("nasa_tlx", tlx_scores(answers, pairs)),
            Some(QuestionnaireKind::Sus) => ("sus", sus_scores(answers)),
            Some(QuestionnaireKind::Own { .. }) | None => ("own", std::collections::BTreeMap::new()),
        };
        QuestionnaireResult {
            id: asked.map(|one| one.id.clone()).unwrap_or_default(),
            kind: kind.to_owned(),
            condition: condition.and_then(|place| self.participation.plan.conditions.get(place).cloned()),
            answers: answers.to_vec(),
            pairs: pairs.to_vec(),
            scores,
            answered_at: rfc3339(now_ms),
        }
    }

    /// The pairs of scales that the step asks about.
    pub(super) fn pairs_of_step(&self) -> Vec<TlxPair> {
        let Step::Questionnaire { questionnaire, condition } = self.step() else { return Vec::new() };
        let asked = self.ready.files.study.questionnaires.get(questionnaire);
        match asked.map(|one| (&one.id, &one.kind)) {
            Some((id, QuestionnaireKind::NasaTlx { weighted: true })) => {
                let words = format!("{id} {}", condition.unwrap_or_default());
                tlx_pairs(self.participation.plan.seed, &words)
            }
            _ => Vec::new(),
        }
    }
}
