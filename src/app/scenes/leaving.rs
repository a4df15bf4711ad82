//! What waits until the open scene is saved.

use super::{Next, PinPose};
use crate::platform;
use crate::session::Notice;
use crate::ui::{Offer, Saving};

impl PinPose {
    pub(super) fn after_saving(&mut self, next: Next) {
        let is_left = match &next {
            Next::Open(_) | Next::New => true,
            Next::Delete(id) => *id == self.autosave.id(),
            Next::SaveAs(_) | Next::Duplicate(_) => false,
        };
        if is_left {
            // What is done of a batch belongs to the scene that is left.
            self.cancel_snap();
        }
        self.scenes.next = Some(next);
        self.go_on();
    }

    /// Does what waits for the open scene to be saved, if it is.
    pub(super) fn go_on(&mut self) {
        if self.scenes.next.is_none() || self.scenes.opening.is_some() || self.autosave.is_saving() {
            return;
        }
        // Deleting another scene may be what makes room for this one.
        let is_deleting = matches!(self.scenes.next, Some(Next::Delete(_)));
        if !is_deleting && !self.autosave.is_saved() {
            if matches!(self.autosave.state(&self.session), Saving::Failed(_)) {
                self.scenes.next = None;
                let text = "This scene cannot be saved, so it stays open. Download the workspace to keep it";
                self.notify_with_offer(Notice::error(text), Offer::Workspace);
                return;
            }
            self.autosave.save_now(&self.session, platform::now_ms());
            if self.autosave.is_saving() || !self.autosave.is_saved() {
                return;
            }
        }
        match self.scenes.next.take() {
            Some(Next::Open(id)) => self.begin_opening(id),
            Some(Next::New) => self.begin_new(),
            Some(Next::SaveAs(name)) => self.begin_copy(name),
            Some(Next::Duplicate(id)) => self.duplicate_stored(&id),
            Some(Next::Delete(id)) => self.delete_stored(&id),
            None => {}
        }
    }
}
