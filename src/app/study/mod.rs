//! Taking part in a study: the participant's steps, one sample at a time, with nothing else of the program around them.

mod allowed;
mod arriving;
mod changing;
mod feedback;
mod frame;
mod keeping;
mod requests;
mod sending;
mod simulating;
mod trial;
mod view;
mod watching;
mod words;

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::rc::Rc;
use std::sync::Arc;

use super::PinPose;
use crate::platform::{self, Storage};
use crate::scene::{MeshAsset, PhotoAsset};
use crate::session::Session;
use crate::study::pack::StudyFiles;
use crate::study::{
    AskedFor, Environment, EventKind, Participant, Participation, Plan, Reopened, Results, Step, Truth,
};
use crate::ui::study::{Pictures, StudyRequest, TlxPair};

use arriving::Arrived;
pub use changing::Opened;
use keeping::Keeping;
pub use keeping::{is_kept_id, newest_kept};
use sending::Sender;
pub use watching::Picked;
use words::Trouble;

/// Of a text's picture, in pixels: twice as wide as the column of text.
const MOST_PICTURE_SIDE: u32 = 1280;

/// A study that somebody takes part in, from its address to the way out.
pub struct Participating {
    ctx: egui::Context,
    /// What the page's address says, or nothing for a preview.
    link: Option<Link>,
    state: State,
    /// The study's, once they are known.
    title: String,
    contact: String,
    /// When files that did not come are asked for again.
    refetch_at_ms: Option<f64>,
    pictures: Pictures,
    /// Grows with every screen.
    page: usize,
    arrived: Rc<RefCell<VecDeque<Arrived>>>,
    storage: Rc<dyn Storage>,
    /// When the tab was hidden and looked at again.
    visibility: Rc<RefCell<VecDeque<(bool, f64)>>>,
    backend: String,
    /// What the researcher had open, to come back to after a preview.
    before: Option<Box<Session>>,
    purpose: Purpose,
    /// Of a study that was just built: what its researcher alone knows.
    truth: Option<Truth>,
}

/// What a study was opened for.
enum Purpose {
    TakePart,
    /// To watch these results.
    Watch(Box<Results>),
    /// To be changed in the builder, with its true poses if they were at hand.
    Change(Option<Box<Truth>>),
}

/// What a participant's address says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Link {
    pub study: String,
}

enum State {
    /// `study.json`, its files, and what is made of them.
    /// Nothing until `study.json` is here.
    Loading(Option<Box<Ready>>),
    Problem(Trouble),
    /// All is here, but not who takes part.
    AskId(Box<Ready>),
    /// What is kept of an earlier visit is on its way; or it is here, and waits for the study's files.
    LookingBack {
        ready: Box<Ready>,
        participant: Participant,
        kept: Option<Box<Participation>>,
    },
    Running(Box<Running>),
    Watching(Box<watching::Watching>),
    /// On its way into the builder.
    ToChange(Box<Opened>),
}

/// A study with what has come of its files, read.
pub struct Ready {
    files: StudyFiles,
    /// By their paths in the study.
    photos: BTreeMap<String, Arc<PhotoAsset>>,
    meshes: BTreeMap<String, Arc<MeshAsset>>,
    /// What the worker has been given.
    submitted: BTreeSet<String>,
}

/// A participation on screen.
struct Running {
    ready: Ready,
    participation: Participation,
    stage: Option<trial::OnStage>,
    /// The pairs of the questionnaire that is shown.
    pairs: Vec<TlxPair>,
    keeping: Keeping,
    sender: Sender,
    /// Why the sample that comes next cannot be shown.
    problem: Option<String>,
    /// It cannot be shown yet: its files are on their way.
    waits: bool,
    /// A practice pose was just confirmed: what was wrong with it is still to be drawn.
    shows_new_feedback: bool,
    /// When the page goes on by itself.
    redirect_at_ms: Option<f64>,
}

impl Running {
    fn step(&self) -> Step {
        self.participation.step(&self.ready.files.study)
    }
}

impl PinPose {
    /// Takes part in the study that the page's address names.
    pub(super) fn start_study(&mut self, link: Link) {
        self.autosave.hold();
        let mut study = self.new_participating(Some(link));
        study.fetch_study();
        self.study = Some(Box::new(study));
    }

    /// Shows a study as its participants will see it; nothing of it is kept or sent.
    pub fn preview_study(&mut self, zip: Arc<[u8]>) {
        let before = std::mem::take(&mut self.session);
        let mut study = self.new_participating(None);
        study.before = Some(Box::new(before));
        study.take_zip(zip);
        self.study = Some(Box::new(study));
        self.hands = crate::interact::Hands::default();
    }

    fn new_participating(&self, link: Option<Link>) -> Participating {
        let visibility: Rc<RefCell<VecDeque<(bool, f64)>>> = Rc::default();
        let (changes, ctx) = (visibility.clone(), self.ctx.clone());
        platform::watch_hidden(move |is_hidden, at_ms| {
            changes.borrow_mut().push_back((is_hidden, at_ms));
            ctx.request_repaint();
        });
        Participating {
            ctx: self.ctx.clone(),
            link,
            state: State::Loading(None),
            title: String::new(),
            contact: String::new(),
            refetch_at_ms: None,
            pictures: Pictures::default(),
            page: 0,
            arrived: Rc::default(),
            storage: self.scenes.storage(),
            visibility,
            backend: self.backend.clone(),
            before: None,
            purpose: Purpose::TakePart,
            truth: None,
        }
    }

    pub(super) fn is_in_study(&self) -> bool {
        self.study.is_some()
    }

    /// Once a frame: what has come, the clock, what is kept and sent.
    pub(super) fn tick_study(&mut self) {
        let Some(mut study) = self.study.take() else { return };
        let now_ms = platform::now_ms();
        study.tick_arriving(&mut self.loading, now_ms);
        if let State::Running(running) = &mut study.state {
            let hidden: Vec<(bool, f64)> = study.visibility.borrow_mut().drain(..).collect();
            running.tick_clock(&hidden, now_ms);
        }
        self.study = Some(study);
        self.draw_feedback();
        self.tick_trial(now_ms);
        self.tick_watching(now_ms);
        self.tick_study_to_change();
        if let Some(study) = &mut self.study
            && let State::Running(running) = &mut study.state
        {
            running.tick_sending(&study.ctx, now_ms);
            running.keeping.tick(&running.participation, now_ms);
        }
    }

    pub(super) fn take_study_request(&mut self, request: StudyRequest) {
        match request {
            StudyRequest::LeavePreview => return self.leave_preview(),
            StudyRequest::Rehearse(wanted) => return self.rehearse(wanted),
            _ => {}
        }
        let Some(study) = &mut self.study else { return };
        let now_ms = platform::now_ms();
        match (&mut study.state, request) {
            (State::AskId(_), StudyRequest::Id(id)) => study.look_back(&id),
            (State::Problem(_), StudyRequest::Retry) => study.fetch_study(),
            (State::Watching(watching), request) => {
                let done = watching.take_request(&request, now_ms);
                if let Err(problem) = done {
                    self.notify(crate::session::Notice::error(problem));
                }
                return;
            }
            (State::Running(running), request) => {
                if let Err(problem) = running.take_request(&request, &study.ctx, now_ms) {
                    self.notify(crate::session::Notice::error(problem));
                }
            }
            _ => {}
        }
        if let Some(study) = &mut self.study {
            study.turn_page();
        }
    }

    fn leave_preview(&mut self) {
        let Some(study) = self.study.take_if(|study| study.before.is_some()) else { return };
        let was_built = study.truth.is_some();
        if let Some(before) = study.before {
            self.session = *before;
            self.hands = crate::interact::Hands::default();
        }
        if was_built {
            self.ui_state.study_builder.show();
        }
    }
}

impl Participating {
    /// Of a preview: its researcher's.
    pub fn know_truth(&mut self, truth: Truth) {
        self.truth = Some(truth);
    }

    fn fail(&mut self, trouble: Trouble) {
        self.state = State::Problem(trouble);
        self.turn_page();
    }

    /// Another screen is shown: what was typed on the last one is gone.
    fn turn_page(&mut self) {
        self.page += 1;
        self.ctx.request_repaint();
    }

    /// The texts can be shown: the participant is known from the link, or asked for.
    fn begin(&mut self, ready: Ready) {
        if let Some(problem) = self.cannot_work() {
            return self.fail(Trouble::of(problem, "", true));
        }
        self.show_pictures(&ready);
        match std::mem::replace(&mut self.purpose, Purpose::TakePart) {
            Purpose::TakePart => {}
            Purpose::Watch(results) => return self.watch(ready, *results),
            Purpose::Change(truth) => {
                self.open_to_change(&ready, truth.as_deref());
                self.purpose = Purpose::Change(truth);
                return;
            }
        }
        let named = |name: &String| platform::page_parameter(name).filter(|id| !id.trim().is_empty());
        let id = match self.link {
            Some(_) => ready.files.study.parameters.participant.iter().find_map(named),
            None => Some("preview".to_owned()),
        };
        self.state = State::AskId(Box::new(ready));
        match id {
            Some(id) => self.look_back(&id),
            None => self.turn_page(),
        }
    }

    fn show_pictures(&mut self, ready: &Ready) {
        for asset in &ready.files.study.texts.pictures {
            let decoded = ready.files.file(asset).and_then(|file| crate::photo::decode(&file.bytes).ok());
            if let Some(decoded) = decoded {
                // More than a graphics card may take, and than the column shows.
                let pixels = crate::photo::thumbnail(&decoded.pixels, MOST_PICTURE_SIDE);
                self.pictures.insert(&self.ctx, &asset.name, &pixels);
            }
        }
    }

    /// Looks for what is kept of an earlier visit.
    fn look_back(&mut self, id: &str) {
        let state = std::mem::replace(&mut self.state, State::Loading(None));
        let State::AskId(ready) = state else {
            self.state = state;
            return;
        };
        let parameters = ready.files.study.parameters.recruiter.iter();
        let given = parameters
            .filter_map(|(name, parameter)| Some((name.clone(), platform::page_parameter(parameter)?)));
        let participant = Participant { id: id.to_owned(), recruiter: given.collect() };
        let kept = self.link.as_ref().map(|_| keeping::kept_id(&ready.files.study.id, id));
        self.state = State::LookingBack { ready, participant, kept: None };
        match kept {
            Some(kept) => self.load_kept(&kept),
            None => self.run(None),
        }
    }

    /// Begins, or goes on where an earlier visit ended.
    fn run(&mut self, kept: Option<Participation>) {
        let state = std::mem::replace(&mut self.state, State::Loading(None));
        let State::LookingBack { ready, participant, .. } = state else {
            // A file that cannot be had was noticed meanwhile: that stays on screen.
            self.state = state;
            return;
        };
        let now_ms = platform::now_ms();
        let is_same = |kept: &Participation| kept.results.study.sha256 == ready.files.sha256;
        let reopened = kept.filter(is_same).map(|kept| kept.reopen(ready.files.study.resume, now_ms));
        let participation = match reopened {
            Some(Reopened::Blocked) => {
                let text = "This study was begun here before, and it cannot be gone on with.";
                return self.fail(Trouble::of(text, "", false));
            }
            Some(Reopened::GoesOn(participation) | Reopened::Done(participation)) => *participation,
            Some(Reopened::Restarts) | None => match self.fresh(&ready, participant, now_ms) {
                Ok(participation) => participation,
                Err(problem) => {
                    let text = "You cannot take part with this link.";
                    return self.fail(Trouble::of(text, problem, false));
                }
            },
        };
        let id = participation.results.participant.id.clone();
        let keeping = match &self.link {
            Some(_) => Keeping::new(self.storage.clone(), &ready.files.study.id, &id),
            None => Keeping::nowhere(),
        };
        let sender = Sender::new(&ready.files.study, self.link.is_some() && !participation.is_saved);
        let mut running = Running {
            ready: *ready,
            participation,
            stage: None,
            pairs: Vec::new(),
            keeping,
            sender,
            problem: None,
            waits: false,
            shows_new_feedback: false,
            redirect_at_ms: None,
        };
        running.enter(now_ms);
        self.state = State::Running(Box::new(running));
        self.turn_page();
    }

    fn fresh(&self, ready: &Ready, participant: Participant, now_ms: f64) -> Result<Participation, String> {
        let parameters = &ready.files.study.parameters;
        let asked = AskedFor {
            condition: platform::page_parameter(&parameters.condition),
            sample_set: platform::page_parameter(&parameters.sample_set),
        };
        let asked = if self.link.is_some() { asked } else { AskedFor::default() };
        let plan = Plan::new(&ready.files.study, &participant.id, &asked);
        let plan = plan.map_err(|error| error.to_string())?;
        let environment = self.environment();
        Ok(Participation::begin(ready.files.record(), plan, participant, environment, now_ms))
    }

    /// A plain sentence where this browser or window is no place for a study.
    fn cannot_work(&self) -> Option<&'static str> {
        // A narrower window has no room for the bar over a photo.
        const LEAST: [u32; 2] = [640, 400];
        let window = platform::browser_facts().window;
        if cfg!(target_arch = "wasm32") && self.backend.is_empty() {
            return Some("This browser cannot draw 3D pictures: WebGL 2 is off. Please try another browser.");
        }
        let is_known = window != [0, 0];
        let is_small = window.iter().zip(LEAST).any(|(side, least)| *side < least);
        (is_known && is_small).then_some(
            "This window is too small. Please enlarge it, or open the link on a computer with a mouse or a touchpad.",
        )
    }

    fn environment(&self) -> Environment {
        let facts = platform::browser_facts();
        Environment {
            browser: facts.browser,
            language: facts.language,
            backend: self.backend.clone(),
            screen: facts.screen,
            window: facts.window,
            pixel_ratio: facts.pixel_ratio,
            utc_offset_minutes: platform::utc_offset_minutes(),
        }
    }
}

/// A gesture's kind, by the label that begins it.
fn kind_of_gesture(label: &str, by_handle: bool) -> EventKind {
    match label {
        _ if by_handle => EventKind::Handle,
        "Move" => EventKind::Move,
        "Rotate" => EventKind::Rotate,
        "Change depth" => EventKind::Depth,
        "Add pin" | "Drag pin" => EventKind::Pin,
        _ => EventKind::Other,
    }
}
