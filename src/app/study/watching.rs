//! Watching what a participant did: a study's zip with a results file, trial by trial, at up to sixteen times the speed.

use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

use super::words::Trouble;
use super::{Participating, Purpose, Ready, State};
use crate::app::PinPose;
use crate::platform::{self, FileBytes};
use crate::session::{Command, Notice, Session};
use crate::study::{Replay, Results, Stage, TrialResult};
use crate::ui::study::{ReplayView, StudyRequest};

/// Files that were picked, until they are looked at.
pub type Picked = Rc<RefCell<Option<Vec<Result<FileBytes, String>>>>>;

/// The example study is far smaller.
const MOST_EXAMPLE_BYTES: u64 = 64 << 20;

/// A participant's trials, and the one that is watched.
pub struct Watching {
    ready: Ready,
    results: Results,
    names: Vec<String>,
    trial: usize,
    replay: Option<Replay>,
    at_ms: f64,
    speed: f64,
    is_playing: bool,
    last_ms: f64,
    /// The session of the trial that was just chosen.
    session: Option<Box<Session>>,
}

impl Watching {
    pub fn new(ready: Ready, results: Results, now_ms: f64) -> Result<Self, String> {
        if results.study.id != ready.files.study.id {
            return Err(format!(
                "these are results of the study \"{}\", not of \"{}\"",
                results.study.id, ready.files.study.id
            ));
        }
        let name = |trial: &TrialResult| {
            format!("{}: {}, {} ({:.0} s)", trial.index + 1, trial.sample, trial.object.name, trial.time_s)
        };
        let names = results.trials.iter().map(name).collect();
        let mut watching = Self {
            ready,
            results,
            names,
            trial: 0,
            replay: None,
            at_ms: 0.0,
            speed: 4.0,
            is_playing: true,
            last_ms: now_ms,
            session: None,
        };
        watching.choose(0, now_ms)?;
        Ok(watching)
    }

    fn choose(&mut self, trial: usize, now_ms: f64) -> Result<(), String> {
        let result = self.results.trials.get(trial).ok_or("there are no trials in these results")?;
        let study = &self.ready.files.study;
        let sample = study.sample(&result.sample).ok_or("the study has no such sample")?;
        let photo = self.ready.photos.get(&sample.photo).ok_or("a photo is missing")?.clone();
        let mesh = self.ready.meshes.get(&sample.object).ok_or("a mesh is missing")?.clone();
        let replay = Replay::of(result).map_err(|error| error.to_string())?;
        let start = replay.pose_at(-1.0);
        let stage =
            Stage::new(study, sample, photo, mesh, start, now_ms).map_err(|error| error.to_string())?;
        self.session = Some(Box::new(Session::with_scene(stage.scene)));
        self.replay = Some(replay);
        (self.trial, self.at_ms, self.last_ms, self.is_playing) = (trial, 0.0, now_ms, true);
        Ok(())
    }

    fn duration_ms(&self) -> f64 {
        self.replay.as_ref().map_or(0.0, |replay| replay.duration_ms() as f64)
    }

    pub fn view(&self) -> ReplayView<'_> {
        let kind = self.replay.as_ref().and_then(|replay| replay.kind_at(self.at_ms));
        ReplayView {
            participant: &self.results.participant.id,
            trials: &self.names,
            trial: self.trial,
            at_ms: self.at_ms,
            duration_ms: self.duration_ms(),
            speed: self.speed,
            is_playing: self.is_playing,
            last_event: kind,
        }
    }

    pub fn take_request(&mut self, request: &StudyRequest, now_ms: f64) -> Result<(), String> {
        match request {
            StudyRequest::WatchTrial(trial) => self.choose(*trial, now_ms)?,
            StudyRequest::Play(is_playing) => {
                // At its end it begins anew.
                if *is_playing && self.at_ms >= self.duration_ms() {
                    self.at_ms = 0.0;
                }
                (self.is_playing, self.last_ms) = (*is_playing, now_ms);
            }
            StudyRequest::PlayAt(at_ms) => self.at_ms = at_ms.clamp(0.0, self.duration_ms()),
            StudyRequest::Speed(speed) => self.speed = speed.clamp(1.0, 16.0),
            _ => {}
        }
        Ok(())
    }
}

impl PinPose {
    /// Asks for a study and a participant's results.
    pub(in crate::app) fn pick_results(&mut self) {
        let (picked, ctx) = (self.building.picked.clone(), self.ctx.clone());
        platform::pick_files(&["zip", "json"], move |files| {
            *picked.borrow_mut() = Some(files);
            ctx.request_repaint();
        });
    }

    /// Shows the study at an address as its participants see it.
    pub(in crate::app) fn preview_address(&mut self, url: &'static str) {
        let (picked, ctx) = (self.building.picked.clone(), self.ctx.clone());
        platform::spawn(async move {
            let fetched = platform::fetch(url, MOST_EXAMPLE_BYTES).await;
            let fetched = fetched.map_err(|error| format!("{url} {error}"));
            let file = fetched.map(|bytes| FileBytes { name: "study.zip".to_owned(), bytes });
            *picked.borrow_mut() = Some(vec![file]);
            ctx.request_repaint();
        });
    }

    /// A zip alone is looked at as participants do; with results beside it, these are watched.
    pub(in crate::app) fn take_picked(&mut self) {
        let Some(files) = self.building.picked.borrow_mut().take() else { return };
        let (mut zip, mut results) = (None, None);
        for file in files {
            match file {
                Ok(file) if file.name.to_lowercase().ends_with(".zip") => {
                    zip = Some(Arc::<[u8]>::from(file.bytes));
                }
                Ok(file) => match Results::from_json(&file.bytes) {
                    Ok(read) => results = Some(read),
                    Err(error) => self.notify(Notice::error(format!("{}: {error}", file.name))),
                },
                Err(problem) => self.notify(Notice::error(problem)),
            }
        }
        let Some(zip) = zip else {
            return self.notify(Notice::warning("Choose the study's zip, together with a results file"));
        };
        self.preview_study(zip);
        if let Some(study) = &mut self.study {
            study.purpose = results.map_or(Purpose::TakePart, |results| Purpose::Watch(Box::new(results)));
        }
    }

    /// Moves the object to where it was at the moment that is watched.
    pub(in crate::app) fn tick_watching(&mut self, now_ms: f64) {
        let Some(study) = &mut self.study else { return };
        let State::Watching(watching) = &mut study.state else { return };
        if let Some(session) = watching.session.take() {
            self.session = *session;
            self.hands = crate::interact::Hands::default();
        }
        let passed_ms = (now_ms - watching.last_ms).max(0.0);
        watching.last_ms = now_ms;
        if watching.is_playing {
            let duration_ms = watching.duration_ms();
            watching.at_ms = (watching.at_ms + passed_ms * watching.speed).min(duration_ms);
            watching.is_playing = watching.at_ms < duration_ms;
            self.ctx.request_repaint_after(std::time::Duration::from_millis(30));
        }
        let Some(pose) = watching.replay.as_ref().map(|replay| replay.pose_at(watching.at_ms)) else {
            return;
        };
        let Some((photo, object, annotation)) = self.session.selected_annotation() else { return };
        if annotation.camera_from_object != pose {
            // One gesture that never ends: there is nothing to undo in what somebody else did.
            if !self.session.gesture_under_way() {
                self.session.apply(Command::BeginGesture("Watch"), now_ms).ok();
            }
            let moved = Command::Drag { photo, object, camera_from_object: pose };
            if let Err(error) = self.session.apply(moved, now_ms) {
                log::warn!("a pose of a trial cannot be shown: {error}");
            }
        }
    }
}

impl Participating {
    /// Watches the results that came with the study.
    pub(super) fn watch(&mut self, ready: Ready, results: Results) {
        match Watching::new(ready, results, platform::now_ms()) {
            Ok(watching) => self.state = State::Watching(Box::new(watching)),
            Err(problem) => {
                let text = format!("This cannot be watched: {problem}.");
                self.fail(Trouble::of(&text, "", false));
            }
        }
        self.turn_page();
    }
}
