//! What the page's script and an embedding page are told: `changed`, `saved`, `notice`.

use super::PinPose;
use crate::platform;
use crate::ui::Saving;

/// What was told last.
#[derive(Debug, Default)]
pub struct Events {
    revision: u64,
    saved: bool,
}

impl PinPose {
    /// Once a frame: a drag is one `changed` a frame, not one a step.
    pub(super) fn send_events(&mut self) {
        let revision = self.session.revision();
        if self.events.revision != revision {
            self.events.revision = revision;
            platform::send_event("changed", "");
        }
        let saved = self.autosave.state(&self.session) == Saving::Saved;
        if saved && !self.events.saved {
            platform::send_event("saved", "");
        }
        self.events.saved = saved;
    }
}
