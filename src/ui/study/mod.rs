//! What a participant of a study sees: one screen after the other, each with one thing to do next.

mod allowed_keys;
mod finish;
mod page;
mod practice;
mod questionnaire;
mod questions;
mod rehearsal;
mod replay;
mod text;
mod trial;

use std::collections::BTreeMap;

use egui::{CentralPanel, Frame, Panel};

use super::{Asked, Surroundings, UiState, theme, viewport};
use crate::session::Session;
use crate::study::questionnaire::TlxScale;
use crate::study::{Answer, AnswerValue, Condition, Feedback, Item, PairChoice, Questionnaire, Tool};

pub use finish::{FinishView, Sending};
pub use practice::FEEDBACK_PICTURES;
pub use rehearsal::Rehearsal;
pub use replay::ReplayView;
pub use text::Pictures;
pub use trial::TrialView;

/// Which screen is shown, and what it needs.
#[derive(Debug, Clone, Copy)]
pub enum StudyScreen<'a> {
    /// Files are on their way: how many of how many.
    Loading {
        done: usize,
        all: usize,
    },
    /// It cannot go on: a sentence that says why, and what the researcher needs to know.
    Problem {
        text: &'a str,
        details: &'a str,
        can_retry: bool,
    },
    /// The link names no participant.
    AskId,
    Consent {
        text: &'a str,
    },
    Declined,
    Instructions {
        text: &'a str,
        condition: &'a Condition,
        practice: usize,
        trials: usize,
    },
    Questions {
        items: &'a [Item],
    },
    Trial(TrialView<'a>),
    Feedback {
        feedback: &'a Feedback,
        may_try_again: bool,
    },
    /// Before a condition's first trial.
    Begin {
        condition: &'a Condition,
        number: usize,
        count: usize,
        trials: usize,
    },
    Rest {
        done: usize,
        all: usize,
    },
    Questionnaire {
        questionnaire: &'a Questionnaire,
        about: Option<&'a str>,
        pairs: &'a [TlxPair],
    },
    Finish(FinishView<'a>),
    Replay(ReplayView<'a>),
}

pub type TlxPair = (&'static TlxScale, &'static TlxScale);

/// A study as its participant sees it now.
#[derive(Debug, Clone, Copy)]
pub struct StudyView<'a> {
    pub title: &'a str,
    pub contact: &'a str,
    pub screen: StudyScreen<'a>,
    pub pictures: &'a Pictures,
    /// Grows with every screen: what was typed on the last one is none of this one's.
    pub page: usize,
    /// A researcher looks at it: there is a way back.
    pub is_preview: bool,
    /// A program may take part in it, to show the report.
    pub can_rehearse: bool,
}

/// What the participant asks for.
#[derive(Debug, Clone, PartialEq)]
pub enum StudyRequest {
    Id(String),
    Agree,
    Decline,
    /// From a screen that asks for nothing.
    GoOn,
    Items(Vec<Answer>),
    Questionnaire(Vec<Answer>, Vec<PairChoice>),
    Confirm,
    TryAgain,
    Pause,
    Resume,
    /// Loading or saving, once more.
    Retry,
    DownloadJson,
    DownloadCsv,
    CopyCode,
    Redirect,
    /// What is kept in this browser goes.
    Forget,
    /// A researcher has seen enough.
    LeavePreview,
    Rehearse(Rehearsal),
    WatchTrial(usize),
    Play(bool),
    /// Milliseconds since the trial was shown.
    PlayAt(f64),
    Speed(f64),
}

/// What is typed and chosen, until it is sent on.
#[derive(Debug, Default)]
pub struct State {
    page: usize,
    id: String,
    consent: bool,
    answers: BTreeMap<String, AnswerValue>,
    pairs: Vec<PairChoice>,
    /// Somebody tried to go on with answers missing: these are marked.
    asks_for_missing: bool,
    help_is_open: bool,
    /// The next frame shows what is below.
    turn_over: bool,
    /// The dialog of a rehearsal is open.
    rehearsal: Option<Rehearsal>,
}

impl State {
    /// A key is the screen's own, not the viewport's.
    pub fn help_is_open(&self) -> bool {
        self.help_is_open
    }
}

/// Draws a whole frame of a study.
pub fn draw(
    ui: &mut egui::Ui,
    session: &Session,
    view: &StudyView<'_>,
    around: &Surroundings<'_>,
    state: &mut UiState,
    requests: &mut Vec<StudyRequest>,
) -> Asked {
    let mut asked = Asked::default();
    ui.ctx().set_theme(state.preferences.theme.preference());
    state.preferences.keymap.put_on(ui.ctx());
    if state.study.page != view.page {
        state.study = State { page: view.page, id: std::mem::take(&mut state.study.id), ..State::default() };
    }
    if let StudyScreen::Trial(trial) = &view.screen {
        let visuals = ui.ctx().global_style().visuals.clone();
        Panel::top("trial bar").frame(theme::bar_frame(&visuals)).show(ui, |ui| {
            trial::bar(ui, session, view, trial, &mut state.study, &mut asked, requests);
        });
        let ground = Frame::NONE.fill(theme::VIEWPORT_BACKGROUND);
        CentralPanel::default().frame(ground).show(ui, |ui| {
            theme::use_dark(ui);
            if trial.is_paused {
                (state.viewport, state.scene_viewport) = (None, None);
                trial::paused(ui, requests);
            } else {
                viewport::draw_for_study(ui, session, around, state, &mut asked, trial.tools);
            }
        });
        if state.study.help_is_open {
            state.study.help_is_open = trial::help(ui.ctx(), view, trial);
        }
    } else if let StudyScreen::Replay(replay) = &view.screen {
        let visuals = ui.ctx().global_style().visuals.clone();
        Panel::top("replay bar").frame(theme::bar_frame(&visuals)).show(ui, |ui| {
            replay::bar(ui, replay, requests);
        });
        CentralPanel::default().frame(Frame::NONE.fill(theme::VIEWPORT_BACKGROUND)).show(ui, |ui| {
            theme::use_dark(ui);
            viewport::draw_for_study(ui, session, around, state, &mut asked, &[]);
        });
    } else {
        (state.viewport, state.scene_viewport) = (None, None);
        let fill = ui.visuals().panel_fill;
        CentralPanel::default().frame(Frame::NONE.fill(fill)).show(ui, |ui| {
            page::draw(ui, view, &mut state.study, requests);
        });
    }
    state.toasts.draw(ui.ctx());
    asked
}

/// Is a command's tool among those that may be used? For the bar, which shows no others.
fn has(tools: &[Tool], tool: Tool) -> bool {
    tools.contains(&tool)
}
