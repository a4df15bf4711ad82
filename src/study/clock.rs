//! How long a trial took: from its first complete frame to its end, less pauses, hidden and closed time, each told apart.

use serde::{Deserialize, Serialize};

/// Without input for longer, a participant counts as idle: that is still time on the task, for looking is a part of it.
const IDLE_AFTER_MS: f64 = 5000.0;

/// The page looks at its clock every second; one that did not for so long was not running: the computer slept.
const ASLEEP_AFTER_MS: f64 = 15_000.0;

/// The clock of one trial, by the wall clock (milliseconds since 1970), so that it outlives the page.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrialClock {
    pub shown_at_ms: f64,
    /// Everything before is accounted for.
    last_ms: f64,
    last_input_ms: f64,
    is_paused: bool,
    is_hidden: bool,
    pub active_ms: f64,
    pub idle_ms: f64,
    pub paused_ms: f64,
    pub hidden_ms: f64,
    /// The page was closed, or its computer slept.
    pub closed_ms: f64,
}

impl TrialClock {
    /// Starts: the first complete frame is on screen.
    pub fn shown(now_ms: f64) -> Self {
        Self {
            shown_at_ms: now_ms,
            last_ms: now_ms,
            last_input_ms: now_ms,
            is_paused: false,
            is_hidden: false,
            active_ms: 0.0,
            idle_ms: 0.0,
            paused_ms: 0.0,
            hidden_ms: 0.0,
            closed_ms: 0.0,
        }
    }

    /// The time on the task so far.
    pub fn time_ms(&self) -> f64 {
        self.active_ms + self.idle_ms
    }

    pub fn is_paused(&self) -> bool {
        self.is_paused
    }

    pub fn is_hidden(&self) -> bool {
        self.is_hidden
    }

    /// Milliseconds of the wall clock since the trial was shown.
    pub fn since_shown_ms(&self, now_ms: f64) -> u64 {
        (now_ms - self.shown_at_ms).max(0.0) as u64
    }

    /// Accounts for the time up to now. A clock that was set back counts nothing.
    pub fn tick(&mut self, now_ms: f64) {
        let passed_ms = (now_ms - self.last_ms).max(0.0);
        if self.is_paused {
            self.paused_ms += passed_ms;
        } else if self.is_hidden {
            self.hidden_ms += passed_ms;
        } else if passed_ms > ASLEEP_AFTER_MS {
            self.closed_ms += passed_ms;
        } else {
            let active_until_ms = self.last_input_ms + IDLE_AFTER_MS;
            let active_ms = (active_until_ms - self.last_ms).clamp(0.0, passed_ms);
            self.active_ms += active_ms;
            self.idle_ms += passed_ms - active_ms;
        }
        self.last_ms = now_ms;
    }

    /// The participant did something with mouse or keys.
    pub fn input(&mut self, now_ms: f64) {
        self.tick(now_ms);
        self.last_input_ms = now_ms;
    }

    pub fn pause(&mut self, now_ms: f64) {
        self.tick(now_ms);
        self.is_paused = true;
    }

    pub fn go_on(&mut self, now_ms: f64) {
        self.tick(now_ms);
        self.is_paused = false;
        self.last_input_ms = now_ms;
    }

    /// Another tab or window is looked at.
    pub fn hide(&mut self, now_ms: f64) {
        self.tick(now_ms);
        self.is_hidden = true;
    }

    pub fn show(&mut self, now_ms: f64) {
        self.tick(now_ms);
        self.is_hidden = false;
        self.last_input_ms = now_ms;
    }

    /// The page has come back; whatever it was doing when it went, it did not go on with. A pause goes on.
    pub fn reopen(&mut self, now_ms: f64) {
        self.closed_ms += (now_ms - self.last_ms).max(0.0);
        self.last_ms = now_ms;
        self.last_input_ms = now_ms;
        self.is_hidden = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A page that looks at its clock every second.
    fn run(clock: &mut TrialClock, from_s: u32, to_s: u32) {
        (from_s..=to_s).for_each(|second| clock.tick(f64::from(second) * 1000.0));
    }

    fn parts(clock: &TrialClock) -> [f64; 5] {
        [clock.active_ms, clock.idle_ms, clock.paused_ms, clock.hidden_ms, clock.closed_ms]
            .map(|ms| ms / 1000.0)
    }

    #[test]
    fn every_second_is_one_of_five_kinds() {
        let mut clock = TrialClock::shown(0.0);
        run(&mut clock, 0, 8);
        assert_eq!(parts(&clock), [5.0, 3.0, 0.0, 0.0, 0.0]);
        clock.input(10_000.0);
        clock.pause(12_000.0);
        run(&mut clock, 12, 40);
        clock.hide(40_000.0);
        run(&mut clock, 40, 45);
        clock.go_on(45_000.0);
        run(&mut clock, 45, 50);
        clock.show(50_000.0);
        run(&mut clock, 50, 53);
        clock.reopen(100_000.0);
        clock.input(101_000.0);
        assert_eq!(parts(&clock), [5.0 + 2.0 + 3.0 + 1.0, 3.0 + 2.0, 33.0, 5.0, 47.0]);
        assert_eq!(parts(&clock).iter().sum::<f64>(), 101.0);
        assert_eq!(clock.time_ms(), 16_000.0);
        assert_eq!(clock.since_shown_ms(101_000.0), 101_000);
    }

    #[test]
    fn a_computer_that_sleeps_is_no_work_and_a_clock_set_back_counts_nothing() {
        let mut clock = TrialClock::shown(1000.0);
        clock.tick(2000.0);
        clock.tick(3_602_000.0);
        assert_eq!((clock.time_ms(), clock.closed_ms), (1000.0, 3_600_000.0));
        clock.tick(500.0);
        clock.tick(1500.0);
        assert!(clock.time_ms() <= 2000.0);
    }

    #[test]
    fn a_pause_outlives_a_reload() {
        let mut clock = TrialClock::shown(0.0);
        clock.pause(1000.0);
        clock.reopen(5000.0);
        clock.go_on(9000.0);
        assert_eq!(parts(&clock), [1.0, 0.0, 4.0, 0.0, 4.0]);
    }
}
