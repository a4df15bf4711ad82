//! What participants have done on this computer, out of the store again.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use super::PinPose;
use super::study::{is_kept_id, newest_kept};
use crate::platform::{self, FileBytes, SceneId, SceneSummary};
use crate::session::Notice;
use crate::study::{Participation, Results, results_name};
use crate::ui::{KeptRequest, KeptView};

/// The participations that are stored.
#[derive(Default)]
pub struct Kept {
    list: Option<Vec<SceneSummary>>,
    arrived: Rc<RefCell<VecDeque<Arrived>>>,
}

enum Arrived {
    Listed(Result<Vec<SceneSummary>, String>),
    /// The results of one, and what they are for.
    Results(KeptRequest, Option<Box<Results>>),
    Removed(Result<(), String>),
}

impl Kept {
    pub fn view(&self) -> KeptView<'_> {
        KeptView { list: self.list.as_deref(), now_ms: platform::now_ms() }
    }
}

impl PinPose {
    pub(super) fn show_kept(&mut self) {
        self.ui_state.kept_dialog.show();
        self.list_kept();
    }

    fn when_kept(&self, future: impl Future<Output = Arrived> + 'static) {
        let (arrived, ctx) = (self.kept.arrived.clone(), self.ctx.clone());
        platform::spawn(async move {
            let came = future.await;
            arrived.borrow_mut().push_back(came);
            ctx.request_repaint();
        });
    }

    fn list_kept(&self) {
        let listing = self.scenes.storage().list();
        self.when_kept(async move { Arrived::Listed(listing.await) });
    }

    pub(super) fn take_kept_request(&mut self, request: KeptRequest) {
        let storage = self.scenes.storage();
        match request {
            KeptRequest::Remove(id) => {
                storage.remove_journal(&id);
                let removing = storage.delete(&id);
                self.when_kept(async move { Arrived::Removed(removing.await) });
            }
            KeptRequest::Download(ref id) | KeptRequest::Report(ref id) => {
                let id: SceneId = id.clone();
                self.when_kept(async move {
                    let kept = newest_kept(&*storage, &id).await;
                    let participation = kept.and_then(|kept| Participation::from_json(&kept.json));
                    Arrived::Results(request, participation.map(|one| Box::new(one.results)))
                });
            }
        }
    }

    /// Once a frame.
    pub(super) fn tick_kept(&mut self) {
        let arrived = std::mem::take(&mut *self.kept.arrived.borrow_mut());
        for came in arrived {
            if let Err(problem) = self.take_kept(came) {
                self.notify(Notice::error(problem));
            }
        }
    }

    fn take_kept(&mut self, came: Arrived) -> Result<(), String> {
        match came {
            Arrived::Listed(list) => {
                let mut list = list?;
                list.retain(|summary| is_kept_id(&summary.id));
                self.kept.list = Some(list);
            }
            Arrived::Removed(removed) => {
                removed?;
                self.list_kept();
            }
            Arrived::Results(_, None) => return Err("These results cannot be read".to_owned()),
            Arrived::Results(request, Some(results)) => {
                let name = results_name(&results.study.id, &results.participant.id, platform::now_ms());
                let file = FileBytes { name: format!("{name}.json"), bytes: results.to_json().into_bytes() };
                match request {
                    KeptRequest::Report(_) => self.add_to_report(file),
                    _ => platform::download(&file.name, &file.bytes)?,
                }
            }
        }
        Ok(())
    }
}
