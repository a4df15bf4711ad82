//! A trial under way: its clock, what was done so far, and where the object is now.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

use crate::math::Pose;
use crate::scene::Pin;
use crate::study::clock::TrialClock;
use crate::study::time::rfc3339;
use crate::study::{
    Event, EventKind, FileRecord, Outcome, Pause, PauseKind, PoseRecord, Sample, Study, TrialResult,
};

/// Which trial it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TrialPlace<'a> {
    pub index: usize,
    pub repeat: u32,
    pub condition: &'a str,
}

/// A pin of the pose that is being found, for a reload.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PinRecord {
    point_mm: [f64; 3],
    pixel: [f64; 2],
    enabled: bool,
}

impl From<&Pin> for PinRecord {
    fn from(pin: &Pin) -> Self {
        Self { point_mm: pin.point_mm.to_array(), pixel: pin.pixel.to_array(), enabled: pin.enabled }
    }
}

impl PinRecord {
    pub fn to_pin(self) -> Pin {
        let pin = Pin::new(DVec3::from_array(self.point_mm), DVec2::from_array(self.pixel));
        Pin { enabled: self.enabled, ..pin }
    }
}

/// One sample in front of the participant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunningTrial {
    start_pose: PoseRecord,
    pose: PoseRecord,
    pub pins: Vec<PinRecord>,
    /// `None` until the first complete frame.
    clock: Option<TrialClock>,
    events: Vec<Event>,
    paused_at_ms: Option<f64>,
    hidden_at_ms: Option<f64>,
}

impl RunningTrial {
    pub fn new(start_pose: Pose) -> Self {
        Self {
            start_pose: start_pose.into(),
            pose: start_pose.into(),
            pins: Vec::new(),
            clock: None,
            events: Vec::new(),
            paused_at_ms: None,
            hidden_at_ms: None,
        }
    }

    /// Where the object is now.
    pub fn pose(&self) -> Option<Pose> {
        self.pose.to_pose().ok()
    }

    pub fn is_shown(&self) -> bool {
        self.clock.is_some()
    }

    pub fn is_paused(&self) -> bool {
        self.clock.is_some_and(|clock| clock.is_paused())
    }

    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// Was anything done to the pose?
    pub fn has_gesture(&self) -> bool {
        self.events.iter().any(|event| event.kind.is_gesture())
    }

    /// The time on the task so far.
    pub fn time_ms(&self) -> f64 {
        self.clock.map_or(0.0, |clock| clock.time_ms())
    }

    /// The first complete frame is on screen: the clock starts. Later ones change nothing.
    pub fn show(&mut self, now_ms: f64) {
        if self.clock.is_none() {
            self.clock = Some(TrialClock::shown(now_ms));
            self.push(EventKind::Shown, None, now_ms);
        }
    }

    pub fn tick(&mut self, now_ms: f64) {
        if let Some(clock) = &mut self.clock {
            clock.tick(now_ms);
        }
    }

    pub fn input(&mut self, now_ms: f64) {
        if let Some(clock) = &mut self.clock {
            clock.input(now_ms);
        }
    }

    /// Something was done; with the pose that it left behind, if it changed it.
    pub fn record(&mut self, kind: EventKind, pose: Option<Pose>, now_ms: f64) {
        if let Some(pose) = pose {
            self.pose = pose.into();
        }
        self.push(kind, pose, now_ms);
    }

    fn push(&mut self, kind: EventKind, pose: Option<Pose>, now_ms: f64) {
        let Some(clock) = &self.clock else { return };
        // A replay goes forward only, also where the computer's clock was set back.
        let last_ms = self.events.last().map_or(0, |event| event.at_ms);
        self.events.push(Event::new(clock.since_shown_ms(now_ms).max(last_ms), kind, pose));
    }

    pub fn pause(&mut self, now_ms: f64) {
        if let Some(clock) = self.clock.as_mut().filter(|clock| !clock.is_paused()) {
            clock.pause(now_ms);
            self.paused_at_ms = Some(now_ms);
            self.push(EventKind::Paused, None, now_ms);
        }
    }

    /// Ends a pause and says how long it was.
    pub fn go_on(&mut self, index: usize, now_ms: f64) -> Option<Pause> {
        let began_ms = self.paused_at_ms.take()?;
        self.clock.as_mut()?.go_on(now_ms);
        self.push(EventKind::Resumed, None, now_ms);
        Some(pause(PauseKind::Pause, index, began_ms, now_ms))
    }

    /// The tab is looked at, or not: a pause of its own kind.
    pub fn set_hidden(&mut self, is_hidden: bool, index: usize, now_ms: f64) -> Option<Pause> {
        let clock = self.clock.as_mut()?;
        if clock.is_hidden() == is_hidden {
            return None;
        }
        if is_hidden {
            clock.hide(now_ms);
            self.hidden_at_ms = Some(now_ms);
            self.push(EventKind::Hidden, None, now_ms);
            return None;
        }
        clock.show(now_ms);
        self.push(EventKind::Visible, None, now_ms);
        self.hidden_at_ms.take().map(|began_ms| pause(PauseKind::Hidden, index, began_ms, now_ms))
    }

    /// The page has come back.
    pub(super) fn reopen(&mut self, now_ms: f64) -> Option<Pause> {
        let clock = self.clock.as_mut()?;
        let closed_before_ms = clock.closed_ms;
        clock.reopen(now_ms);
        let closed_ms = clock.closed_ms - closed_before_ms;
        self.hidden_at_ms = None;
        self.push(EventKind::Reopened, self.pose.to_pose().ok(), now_ms);
        Some(Pause {
            kind: PauseKind::Closed,
            trial: None,
            began_at: rfc3339(now_ms - closed_ms),
            seconds: closed_ms / 1000.0,
        })
    }

    /// The trial as a result. What is asked of the study is copied, so that a result can be read by itself.
    pub fn result(
        &self,
        study: &Study,
        sample: &Sample,
        place: TrialPlace<'_>,
        outcome: Outcome,
        now_ms: f64,
    ) -> Option<TrialResult> {
        let mut ended = self.clone();
        ended.tick(now_ms);
        let kind = match outcome {
            Outcome::Confirmed => EventKind::Confirmed,
            Outcome::TimedOut => EventKind::TimedOut,
        };
        ended.push(kind, None, now_ms);
        let clock = ended.clock?;
        let (photo, object) = (study.photo(&sample.photo)?, study.object(&sample.object)?);
        let seconds = |ms: f64| ms / 1000.0;
        Some(TrialResult {
            index: u32::try_from(place.index).unwrap_or(u32::MAX),
            sample: sample.id.clone(),
            set: sample.set.clone(),
            repeat: place.repeat,
            condition: place.condition.to_owned(),
            tools: study.condition(place.condition).map(|one| one.tools.clone()).unwrap_or_default(),
            photo: FileRecord {
                id: photo.id.clone(),
                name: photo.asset.name.clone(),
                sha256: photo.asset.sha256.clone(),
            },
            object: FileRecord {
                id: object.id.clone(),
                name: object.name.clone(),
                sha256: object.mesh.sha256.clone(),
            },
            start_pose: ended.start_pose,
            final_pose: ended.pose,
            outcome,
            shown_at: rfc3339(clock.shown_at_ms),
            confirmed_at: rfc3339(now_ms),
            time_s: seconds(clock.time_ms()),
            active_s: seconds(clock.active_ms),
            idle_s: seconds(clock.idle_ms),
            paused_s: seconds(clock.paused_ms),
            hidden_s: seconds(clock.hidden_ms),
            closed_s: seconds(clock.closed_ms),
            gestures: counted(&ended.events),
            events: ended.events,
        })
    }
}

fn pause(kind: PauseKind, index: usize, began_ms: f64, now_ms: f64) -> Pause {
    Pause {
        kind,
        trial: u32::try_from(index).ok(),
        began_at: rfc3339(began_ms),
        seconds: (now_ms - began_ms).max(0.0) / 1000.0,
    }
}

fn counted(events: &[Event]) -> BTreeMap<String, u32> {
    let mut counts = BTreeMap::new();
    for event in events.iter().filter(|event| event.kind.is_gesture()) {
        *counts.entry(event.kind.name()).or_default() += 1;
    }
    counts
}
