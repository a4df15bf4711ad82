//! A trial on screen: its scene in the session, its clock from the first complete frame, its gestures as they are made.

use super::allowed::tool_of;
use super::{Running, State, kind_of_gesture};
use crate::app::PinPose;
use crate::interact::{Hands, Pane};
use crate::math::Pose;
use crate::scene::{PoseSource, Sha256};
use crate::session::{Command, CommandId, Panes, PinChange, Session};
use crate::study::{
    EventKind, Outcome, PinRecord, RunningTrial, Sample, Stage, Step, Tool, TrialPlace, camera_of, feedback,
    start_pose,
};

/// The sample that is in the session.
#[derive(Debug)]
pub struct OnStage {
    photo_sha256: Sha256,
    start: Pose,
    /// The session has this trial's scene.
    is_set: bool,
    /// The photo was drawn, with the object over it, in the last frame.
    pub was_drawn: bool,
    /// Of the gesture under way.
    pub gesture: Option<EventKind>,
    session: Option<Box<Session>>,
}

impl Running {
    /// The sample of the step that is shown, and its place; `None` between trials.
    pub(super) fn sample(&self) -> Option<(&Sample, TrialPlace<'_>)> {
        let study = &self.ready.files.study;
        match self.step() {
            Step::Practice(index) => {
                let practice = study.practice.get(index)?;
                let condition = self.participation.plan.conditions.first()?;
                Some((&practice.sample, TrialPlace { index, repeat: 0, condition }))
            }
            Step::Trial(index) => {
                let planned = self.participation.plan.trials.get(index)?;
                let place = TrialPlace { index, repeat: planned.repeat, condition: &planned.condition };
                Some((study.sample(&planned.sample)?, place))
            }
            _ => None,
        }
    }

    pub(super) fn tools(&self) -> &[Tool] {
        let condition =
            self.sample().and_then(|(_, place)| self.ready.files.study.condition(place.condition));
        condition.map_or(&[], |condition| condition.tools.as_slice())
    }

    pub(super) fn is_in_trial(&self) -> bool {
        self.stage.is_some() && self.participation.feedback().is_none()
    }

    /// Prepares what the step that has come needs.
    pub(super) fn enter(&mut self, now_ms: f64) {
        self.stage = None;
        self.pairs = self.pairs_of_step();
        self.waits = self.sample().is_some_and(|(sample, _)| !self.ready.has(sample));
        if self.participation.feedback().is_none()
            && !self.waits
            && let Err(problem) = self.set_stage(now_ms)
        {
            self.problem = Some(format!("The next photo cannot be shown: {problem}."));
        }
        self.keeping.changed(&self.participation, now_ms);
    }

    /// What was waited for is here.
    pub(super) fn can_go_on(&self) -> bool {
        self.waits && self.sample().is_some_and(|(sample, _)| self.ready.has(sample))
    }

    fn set_stage(&mut self, now_ms: f64) -> Result<(), String> {
        let step = self.step();
        let study = &self.ready.files.study;
        let Some((sample, place)) = self.sample() else { return Ok(()) };
        let photo = self.ready.photos.get(&sample.photo).ok_or("a photo is missing")?.clone();
        let mesh = self.ready.meshes.get(&sample.object).ok_or("a mesh is missing")?.clone();
        let text = |error: crate::study::StudyError| error.to_string();
        let camera = camera_of(study, sample).map_err(text)?;
        let given = sample.start.and_then(|start| start.to_pose().ok());
        let practice = if matches!(step, Step::Practice(_)) { "practice" } else { "trial" };
        let words = format!("start of {practice} {}", place.index);
        let start = start_pose(study, given, &camera, &mesh.mesh, self.participation.plan.seed, &words);
        let start = start.map_err(text)?;
        let (pose, pins) = match self.participation.trial() {
            // After a reload.
            Some(trial) => (trial.pose().unwrap_or(start), trial.pins.clone()),
            None => (start, Vec::new()),
        };
        let mut stage = Stage::new(study, sample, photo.clone(), mesh, pose, now_ms).map_err(text)?;
        if let Some(annotation) = stage.scene.annotations.get_mut(&(stage.photo, stage.object)) {
            annotation.pins = pins.into_iter().map(PinRecord::to_pin).collect();
        }
        if self.participation.trial().is_none() {
            self.participation.start_trial(RunningTrial::new(start));
        }
        self.stage = Some(OnStage {
            photo_sha256: photo.sha256,
            start,
            is_set: false,
            was_drawn: false,
            gesture: None,
            session: Some(Box::new(Session::with_scene(stage.scene))),
        });
        Ok(())
    }

    /// Hidden time by when it was, and the time since the last frame.
    pub(super) fn tick_clock(&mut self, hidden: &[(bool, f64)], now_ms: f64) {
        let index = self.sample().map_or(0, |(_, place)| place.index);
        let is_practice = matches!(self.step(), Step::Practice(_));
        let mut pauses = Vec::new();
        if let Some(trial) = self.participation.trial_mut() {
            pauses.extend(
                hidden.iter().filter_map(|(is_hidden, at_ms)| trial.set_hidden(*is_hidden, index, *at_ms)),
            );
            trial.tick(now_ms);
        }
        for mut pause in pauses {
            pause.trial = pause.trial.filter(|_| !is_practice);
            self.participation.add_pause(pause, now_ms);
        }
    }

    /// The trial ends: its result is kept, and the next step comes.
    pub(super) fn end_trial(&mut self, outcome: Outcome, now_ms: f64) {
        let Some((sample, place)) = self.sample() else { return };
        let Some(trial) = self.participation.trial().filter(|trial| trial.is_shown()) else { return };
        let Some(result) = trial.result(&self.ready.files.study, sample, place, outcome, now_ms) else {
            return;
        };
        if let Step::Practice(index) = self.step() {
            let said = self.ready.files.study.practice.get(index).and_then(|practice| {
                let mesh = self.ready.meshes.get(&practice.sample.object)?;
                feedback(practice, &result.final_pose.to_pose().ok()?, mesh)
            });
            if let Some(said) = said {
                self.participation.finish_practice(result, said);
                self.shows_new_feedback = true;
            }
        } else {
            self.participation.finish_trial(result, now_ms);
        }
        self.enter(now_ms);
    }

    /// Has the object been worked with?
    pub(super) fn can_confirm(&self) -> bool {
        self.participation.trial().is_some_and(RunningTrial::has_gesture)
    }
}

impl PinPose {
    /// Puts the trial's scene in the session, starts its clock, ends it when its time is over.
    pub(super) fn tick_trial(&mut self, now_ms: f64) {
        let Some(study) = &mut self.study else { return };
        let State::Running(running) = &mut study.state else {
            return;
        };
        let Some(stage) = &mut running.stage else {
            // Nothing of a sample stays behind its trial.
            if !self.session.scene().is_empty() {
                self.session = Session::default();
                self.hands = Hands::default();
            }
            return;
        };
        if !stage.is_set {
            stage.is_set = true;
            if let Some(session) = stage.session.take() {
                self.session = *session;
            }
            self.hands = Hands::default();
            self.snapping.cancel();
            let gizmo = running.tools().contains(&Tool::Handles);
            let panes = Panes { gizmo, ..self.session.panes() };
            if self.session.apply(Command::SetPanes(panes), now_ms).is_ok() {
                self.choose_first_tool(now_ms);
            }
            self.ctx.request_repaint();
            return;
        }
        let was_drawn = stage.was_drawn;
        let Some(trial) = running.participation.trial_mut() else { return };
        // What was drawn in the last frame is on screen now.
        if was_drawn && !trial.is_shown() {
            trial.show(now_ms);
            running.keeping.changed(&running.participation, now_ms);
        }
        self.end_when_time_is_over(now_ms);
        // The clock is looked at every second, drawn or not.
        self.ctx.request_repaint_after(std::time::Duration::from_secs(1));
    }

    /// The first tool of the bar that is allowed is in the hand.
    fn choose_first_tool(&mut self, now_ms: f64) {
        use crate::session::Tool as Hand;
        let tools = self.study_tools();
        let has = |tool| tools.contains(&tool);
        let hand = match (has(Tool::Move), has(Tool::Rotate), has(Tool::Pins)) {
            (false, true, _) => Hand::Rotate,
            (false, false, true) => Hand::Pin,
            (true, ..) | (false, false, false) => Hand::Move,
        };
        // Taking a tool never fails.
        self.session.apply(Command::SetTool(hand), now_ms).ok();
    }

    pub(super) fn study_tools(&self) -> Vec<Tool> {
        match self.study.as_ref().map(|study| &study.state) {
            Some(State::Running(running)) => running.tools().to_vec(),
            _ => Vec::new(),
        }
    }

    fn end_when_time_is_over(&mut self, now_ms: f64) {
        let Some(study) = &mut self.study else { return };
        let State::Running(running) = &mut study.state else { return };
        let limit = running.ready.files.study.limits.trial_seconds;
        let time_ms = running.participation.trial().map_or(0.0, RunningTrial::time_ms);
        let is_over = limit.is_some_and(|seconds| time_ms >= seconds * 1000.0);
        // Practice takes as long as it takes.
        if is_over && matches!(running.step(), Step::Trial(_)) {
            running.end_trial(Outcome::TimedOut, now_ms);
            study.turn_page();
            self.notify(crate::session::Notice::info(
                "The time for this photo was over; here is what comes next",
            ));
        }
    }

    /// The photo and the object were drawn in this frame.
    pub(super) fn note_drawn(&mut self) {
        let shown = self.session.photo().map(|photo| photo.asset.sha256);
        let are_pixels_there = shown.is_some_and(|sha256| self.photos.get(sha256).is_some());
        if let Some(study) = &mut self.study
            && let State::Running(running) = &mut study.state
            && let Some(stage) = &mut running.stage
            && !stage.was_drawn
            && stage.is_set
            && are_pixels_there
            && shown == Some(stage.photo_sha256)
        {
            stage.was_drawn = true;
            self.ctx.request_repaint();
        }
    }

    /// Mouse or keys were used.
    pub(super) fn note_input(&mut self, ctx: &egui::Context, now_ms: f64) {
        let is_input = |event: &egui::Event| !matches!(event, egui::Event::WindowFocused(_));
        let has_input = ctx.input(|input| input.events.iter().any(is_input));
        if has_input
            && let Some(study) = &mut self.study
            && let State::Running(running) = &mut study.state
            && let Some(trial) = running.participation.trial_mut()
        {
            trial.input(now_ms);
        }
    }

    /// A participant's command: carried out if the condition allows it, and written down.
    pub(in crate::app) fn apply_in_study(&mut self, command: Command, now_ms: f64) -> Result<(), String> {
        let by_handle = [Pane::Photo, Pane::Scene].iter().any(|pane| self.hands.handle_drag(*pane).is_some());
        let Some(study) = &mut self.study else { return Ok(()) };
        let State::Running(running) = &mut study.state else {
            return Err("this is not possible in a study".to_owned());
        };
        let Some(start) = running.stage.as_ref().filter(|stage| stage.was_drawn).map(|stage| stage.start)
        else {
            return Err("this is not possible between two photos of a study".to_owned());
        };
        if running.participation.trial().is_none_or(RunningTrial::is_paused) {
            return Err("this is not possible while the study is paused".to_owned());
        }
        if matches!(command, Command::Run(CommandId::ConfirmAndNext)) {
            if running.can_confirm() {
                running.end_trial(Outcome::Confirmed, now_ms);
                study.turn_page();
                return Ok(());
            }
            return Err("move the object first".to_owned());
        }
        match super::allowed::verdict(&command, running.tools(), &self.session, by_handle) {
            super::allowed::Verdict::Allowed => {}
            super::allowed::Verdict::Ignored => return Ok(()),
            super::allowed::Verdict::Refused(what) => {
                return Err(format!("{what} is not part of this study"));
            }
        }
        let command = match (command, self.session.selected_annotation()) {
            (Command::Run(CommandId::ResetPose), Some((photo, object, _))) => {
                Command::SetPose { photo, object, camera_from_object: start, source: PoseSource::Manual }
            }
            (command, _) => command,
        };
        self.carry_out_in_study(command, start, by_handle, now_ms)
    }

    fn carry_out_in_study(
        &mut self,
        command: Command,
        start: Pose,
        by_handle: bool,
        now_ms: f64,
    ) -> Result<(), String> {
        let mut kind = kind_of(&command, start);
        let before = self.session.selected_annotation().map(|(.., one)| one.clone());
        if let Command::BeginGesture(label) = &command {
            self.set_gesture(Some(kind_of_gesture(label, by_handle)));
        }
        if matches!(command, Command::CancelGesture | Command::Run(CommandId::Cancel)) {
            self.hands.cancel();
            if self.stop_snap_first() {
                return Ok(());
            }
        }
        let effects = self.session.apply(command, now_ms).map_err(|error| error.to_string())?;
        effects.into_iter().for_each(|effect| self.carry_out(effect));
        if self.session.gesture_under_way() {
            return Ok(());
        }
        kind = self.take_gesture().or(kind);
        let after = self.session.selected_annotation().map(|(.., one)| one.clone());
        let moved = before.as_ref().map(|one| one.camera_from_object)
            != after.as_ref().map(|one| one.camera_from_object);
        let pinned = before.map(|one| one.pins) != after.as_ref().map(|one| one.pins.clone());
        self.write_down(kind, moved || pinned, after, now_ms);
        Ok(())
    }

    fn set_gesture(&mut self, gesture: Option<EventKind>) {
        if let Some(study) = &mut self.study
            && let State::Running(running) = &mut study.state
            && let Some(stage) = &mut running.stage
        {
            stage.gesture = gesture;
        }
    }

    fn take_gesture(&mut self) -> Option<EventKind> {
        let State::Running(running) = &mut self.study.as_mut()?.state else { return None };
        running.stage.as_mut()?.gesture.take()
    }

    /// One event for a gesture, with the pose that it left behind; the end of a drag is told by the trial's last pose.
    fn write_down(
        &mut self,
        kind: Option<EventKind>,
        changed: bool,
        after: Option<crate::scene::Annotation>,
        now_ms: f64,
    ) {
        let Some(study) = &mut self.study else { return };
        let State::Running(running) = &mut study.state else { return };
        let Some(trial) = running.participation.trial_mut() else { return };
        let pose = after.as_ref().map(|one| one.camera_from_object);
        let differs = pose.is_some() && pose != trial.pose();
        let is_about_view = matches!(kind, Some(EventKind::Tool | EventKind::Look | EventKind::View));
        if differs || changed {
            trial.record(kind.filter(|_| !is_about_view).unwrap_or(EventKind::Other), pose, now_ms);
        } else if let Some(kind) = kind.filter(|_| is_about_view) {
            trial.record(kind, None, now_ms);
        } else {
            return;
        }
        if let Some(after) = after {
            trial.pins = after.pins.iter().map(Into::into).collect();
        }
        running.keeping.changed(&running.participation, now_ms);
    }
}

/// What a command does, as an event says it; drags are told by what began them.
fn kind_of(command: &Command, start: Pose) -> Option<EventKind> {
    Some(match command {
        Command::Run(CommandId::Undo) => EventKind::Undo,
        Command::Run(CommandId::Redo) => EventKind::Redo,
        Command::Run(CommandId::SolvePins) => EventKind::Pin,
        Command::Run(id) if id.nudge().is_some() => EventKind::Nudge,
        Command::Run(CommandId::MoveTool | CommandId::RotateTool | CommandId::PinTool)
        | Command::SetTool(_) => EventKind::Tool,
        Command::SetLook(_) => EventKind::Look,
        Command::Run(CommandId::ZoomToObject | CommandId::FitPhoto) | Command::SetPanes(_) => EventKind::View,
        Command::Run(id) if tool_of(*id) == Some(Tool::Looks) => EventKind::Look,
        Command::Run(id) if tool_of(*id) == Some(Tool::SceneView) => EventKind::View,
        Command::Nudge(..) => EventKind::Nudge,
        Command::Step { .. } => EventKind::Depth,
        Command::SetPose { camera_from_object, .. } if *camera_from_object == start => EventKind::Reset,
        Command::SetPose { .. } | Command::SetPoseFromText(_) => EventKind::Numbers,
        Command::TakeSnap { .. } => EventKind::Snap,
        Command::Run(CommandId::ClearPins) | Command::EditPins(PinChange::Remove(_)) => EventKind::PinRemoved,
        Command::AddPin { .. } | Command::CompletePin { .. } | Command::EditPins(_) => EventKind::Pin,
        Command::CancelGesture | Command::Run(CommandId::Cancel) => EventKind::Undo,
        _ => return None,
    })
}
