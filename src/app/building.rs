//! A study that is being built: packed a sample a frame, then checked, previewed or downloaded.

use super::PinPose;
use crate::platform;
use crate::session::Notice;
use crate::study::check::{Finding, check};
use crate::study::pack::{Draft, Pack, Packing};
use crate::ui::{BuilderView, StudyBuild};

/// What is being packed, and what was found the last time.
#[derive(Default)]
pub struct Building {
    under_way: Option<(StudyBuild, Packing)>,
    findings: Vec<Finding>,
    download_bytes: Option<u64>,
    /// Files of a study that was chosen to be looked at.
    pub picked: super::study::Picked,
}

impl Building {
    pub fn view(&self) -> BuilderView<'_> {
        BuilderView {
            findings: &self.findings,
            download_bytes: self.download_bytes,
            packing: self.under_way.as_ref().map(|(_, packing)| packing.progress()),
        }
    }
}

impl PinPose {
    pub(super) fn start_building(&mut self, build: StudyBuild) {
        let packing = build.draft().start_packing(self.session.scene());
        self.building.under_way = Some((build, packing));
        self.ctx.request_repaint();
    }

    /// Once a frame: one sample more.
    pub(super) fn tick_building(&mut self) {
        self.take_picked();
        let Some((_, packing)) = &mut self.building.under_way else { return };
        self.ctx.request_repaint();
        let packed = match packing.step() {
            Ok(None) => return,
            Ok(Some(pack)) => Ok(pack),
            Err(error) => Err(error),
        };
        let Some((build, _)) = self.building.under_way.take() else { return };
        self.building.findings = check(build.draft(), self.session.scene(), packed.as_ref());
        self.building.download_bytes = packed.as_ref().ok().map(Pack::download_bytes);
        let is_usable = self.building.findings.iter().all(|finding| !finding.is_error);
        let Ok(pack) = packed else { return };
        let done = match build {
            StudyBuild::Check(_) => Ok(()),
            _ if !is_usable => Err("The study is not complete yet: see what the check says".to_owned()),
            StudyBuild::Preview(_) => self.preview_pack(&pack),
            StudyBuild::Export(draft) => download(&draft, &pack),
        };
        if let Err(problem) = done {
            self.notify(Notice::error(problem));
        }
    }

    fn preview_pack(&mut self, pack: &Pack) -> Result<(), String> {
        let zip = pack.zip().map_err(|error| error.to_string())?;
        self.preview_study(zip.into());
        Ok(())
    }

    /// The example, as its participants see it.
    pub(super) fn fetch_example_study(&mut self) {
        self.preview_address(platform::EXAMPLE_STUDY_PATH);
    }
}

/// Two files: one to put on a server, and one to keep.
fn download(draft: &Draft, pack: &Pack) -> Result<(), String> {
    let id = &draft.study.id;
    let zip = pack.zip().map_err(|error| error.to_string())?;
    platform::download(&format!("{id}.zip"), &zip)?;
    platform::download(&format!("{id}_truth_PRIVATE.json"), pack.truth.to_json().as_bytes())
}
