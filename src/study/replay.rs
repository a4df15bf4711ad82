//! A trial watched again from its events.

use super::{EventKind, TrialResult};
use crate::math::{Pose, PoseError, sort_short};

/// Where the object was at every moment of a trial.
#[derive(Debug, Clone, PartialEq)]
pub struct Replay {
    start: Pose,
    /// By time: what was done, and where the object was after it.
    steps: Vec<(u64, EventKind, Option<Pose>)>,
}

impl Replay {
    /// An error for a file whose poses are none.
    pub fn of(trial: &TrialResult) -> Result<Self, PoseError> {
        let step = |event: &super::Event| Ok((event.at_ms, event.kind, event.pose().transpose()?));
        let mut steps = trial.events.iter().map(step).collect::<Result<Vec<_>, PoseError>>()?;
        // Written in order; a file that was edited may not be.
        sort_short(&mut steps, |a, b| a.0.cmp(&b.0));
        Ok(Self { start: trial.start_pose.to_pose()?, steps })
    }

    /// From the first frame to the last event.
    pub fn duration_ms(&self) -> u64 {
        self.steps.last().map_or(0, |(at_ms, ..)| *at_ms)
    }

    /// Where the object was after so many milliseconds: exactly as each gesture left it.
    pub fn pose_at(&self, ms: f64) -> Pose {
        let before = self.steps.iter().take_while(|(at_ms, ..)| *at_ms as f64 <= ms);
        before.filter_map(|(.., pose)| *pose).last().unwrap_or(self.start)
    }

    /// What was done last.
    pub fn kind_at(&self, ms: f64) -> Option<EventKind> {
        let before = self.steps.iter().take_while(|(at_ms, ..)| *at_ms as f64 <= ms);
        before.last().map(|(_, kind, _)| *kind)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use glam::DVec3;

    use super::*;
    use crate::study::{Event, FileRecord, Outcome};

    fn pose(x: f64) -> Pose {
        Pose::from_translation(DVec3::new(x, 0.0, 700.0))
    }

    fn trial(events: Vec<Event>) -> TrialResult {
        let file = FileRecord { id: String::new(), name: String::new(), sha256: String::new() };
        TrialResult {
            index: 0,
            sample: "S0".to_owned(),
            set: None,
            repeat: 0,
            condition: "all".to_owned(),
            tools: Vec::new(),
            photo: file.clone(),
            object: file,
            start_pose: pose(0.0).into(),
            final_pose: pose(2.0).into(),
            outcome: Outcome::Confirmed,
            shown_at: String::new(),
            confirmed_at: String::new(),
            time_s: 0.0,
            active_s: 0.0,
            idle_s: 0.0,
            paused_s: 0.0,
            hidden_s: 0.0,
            closed_s: 0.0,
            gestures: BTreeMap::new(),
            events,
        }
    }

    #[test]
    fn poses_are_those_that_gestures_left_behind() {
        let events = vec![
            Event::new(0, EventKind::Shown, None),
            Event::new(1000, EventKind::Move, Some(pose(1.0))),
            Event::new(2500, EventKind::Rotate, Some(pose(2.0))),
            Event::new(4000, EventKind::Confirmed, None),
        ];
        let replay = Replay::of(&trial(events)).unwrap();
        assert_eq!(replay.duration_ms(), 4000);
        let at = [0.0, 999.0, 1000.0, 2499.0, 2500.0, 9000.0].map(|ms| replay.pose_at(ms));
        assert_eq!(at, [pose(0.0), pose(0.0), pose(1.0), pose(1.0), pose(2.0), pose(2.0)]);
        assert_eq!(replay.kind_at(3000.0), Some(EventKind::Rotate));
        assert_eq!(Replay::of(&trial(Vec::new())).unwrap().duration_ms(), 0);
    }
}
