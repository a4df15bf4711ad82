//! A study that is being built: packed a sample a frame, then checked, previewed or downloaded.

use std::cell::RefCell;
use std::rc::Rc;

use super::PinPose;
use crate::platform::{self, ExportFolder};
use crate::session::Notice;
use crate::study::check::{Finding, check};
use crate::study::pack::{Draft, Pack, Packing};
use crate::ui::{BuilderView, StudyBuild};

/// What is being packed, and what was found the last time.
#[derive(Default)]
pub struct Building {
    under_way: Option<(StudyBuild, Packing, Option<ExportFolder>)>,
    findings: Vec<Finding>,
    download_bytes: Option<u64>,
    /// Files of a study that was chosen to be looked at.
    pub picked: super::study::Picked,
    /// And of one that is to be changed.
    pub picked_study: super::study::Picked,
    /// That study, until there is room for it.
    pub reopened: Option<Box<super::study::Opened>>,
    /// Pictures for the texts.
    pictures: super::study::Picked,
    /// A folder for the study, once the researcher has picked it: its files are then written there.
    folder: Rc<RefCell<Option<PickedFolder>>>,
    /// What came of writing them.
    written: Rc<RefCell<Option<Result<String, String>>>>,
}

type PickedFolder = (Box<Draft>, Result<Option<ExportFolder>, String>);

impl Building {
    pub fn view(&self) -> BuilderView<'_> {
        BuilderView {
            findings: &self.findings,
            download_bytes: self.download_bytes,
            packing: self.under_way.as_ref().map(|(_, packing, _)| packing.progress()),
        }
    }
}

impl PinPose {
    pub(super) fn start_building(&mut self, build: StudyBuild) {
        if let StudyBuild::IntoFolder(draft) = build {
            // Browsers let a folder be picked only soon after a click: before the packing, which takes its time.
            let (folder, ctx) = (self.building.folder.clone(), self.ctx.clone());
            platform::spawn(async move {
                let picked = ExportFolder::pick().await;
                *folder.borrow_mut() = Some((draft, picked));
                ctx.request_repaint();
            });
            return;
        }
        self.pack(build, None);
    }

    fn pack(&mut self, build: StudyBuild, folder: Option<ExportFolder>) {
        let packing = build.draft().start_packing(self.session.scene());
        self.building.under_way = Some((build, packing, folder));
        self.ctx.request_repaint();
    }

    /// Asks for pictures that the texts are to show.
    pub(super) fn pick_study_pictures(&mut self) {
        let (pictures, ctx) = (self.building.pictures.clone(), self.ctx.clone());
        platform::pick_files(&["png", "jpg", "jpeg", "webp"], move |files| {
            *pictures.borrow_mut() = Some(files);
            ctx.request_repaint();
        });
    }

    fn take_pictures(&mut self) {
        let picked = self.building.pictures.borrow_mut().take();
        for file in picked.into_iter().flatten() {
            let added = file.and_then(|file| {
                // Only what can be stripped of what cameras write into it can be handed out.
                match crate::photo::without_metadata(&file.bytes) {
                    Some(_) => Ok(file),
                    None => Err(format!("{}: this picture cannot be read; PNG or JPEG expected", file.name)),
                }
            });
            match added {
                Ok(file) => self.ui_state.study_builder.add_picture(&file.name, file.bytes.into()),
                Err(problem) => self.notify(Notice::error(problem)),
            }
        }
    }

    /// The folder has been picked, or all is in it.
    fn tick_folder(&mut self) {
        let picked = self.building.folder.borrow_mut().take();
        match picked {
            Some((draft, Ok(Some(folder)))) => self.pack(StudyBuild::IntoFolder(draft), Some(folder)),
            Some((_, Err(problem))) => {
                self.notify(Notice::error(format!("The folder cannot be used: {problem}")));
            }
            Some((_, Ok(None))) | None => {}
        }
        let written = self.building.written.borrow_mut().take();
        match written {
            Some(Ok(said)) => self.notify(Notice::info(said)),
            Some(Err(problem)) => self.notify(Notice::error(format!("The export has failed: {problem}"))),
            None => {}
        }
    }

    /// What participants load goes into the folder; the truth is a download, so that it is never uploaded with it.
    fn write_into_folder(&self, draft: &Draft, pack: Pack, folder: ExportFolder) -> Result<(), String> {
        let id = draft.study.id.clone();
        platform::download(&truth_name(&id), pack.truth.to_json().as_bytes())?;
        let (written, ctx) = (self.building.written.clone(), self.ctx.clone());
        platform::spawn(async move {
            let mut done =
                Ok(format!("The study is in the folder {id}; its true poses are in your downloads"));
            for (path, bytes) in pack.files {
                if let Err(problem) = folder.clone().write(format!("{id}/{path}"), bytes).await {
                    done = Err(problem);
                    break;
                }
            }
            *written.borrow_mut() = Some(done);
            ctx.request_repaint();
        });
        Ok(())
    }

    /// Once a frame: one sample more.
    pub(super) fn tick_building(&mut self) {
        self.take_picked();
        self.take_pictures();
        self.tick_changing();
        self.tick_folder();
        let Some((_, packing, _)) = &mut self.building.under_way else { return };
        self.ctx.request_repaint();
        let packed = match packing.step() {
            Ok(None) => return,
            Ok(Some(pack)) => Ok(pack),
            Err(error) => Err(error),
        };
        let Some((build, _, folder)) = self.building.under_way.take() else { return };
        self.building.findings = check(build.draft(), self.session.scene(), packed.as_ref());
        self.building.download_bytes = packed.as_ref().ok().map(Pack::download_bytes);
        let is_usable = self.building.findings.iter().all(|finding| !finding.is_error);
        let Ok(pack) = packed else { return };
        let done = match build {
            StudyBuild::Check(_) => Ok(()),
            _ if !is_usable => Err("The study is not complete yet: see what the check says".to_owned()),
            StudyBuild::Preview(_) => self.preview_pack(&pack),
            StudyBuild::Export(draft) => download(&draft, &pack),
            StudyBuild::IntoFolder(draft) => match folder {
                Some(folder) => self.write_into_folder(&draft, pack, folder),
                None => Ok(()),
            },
        };
        if let Err(problem) = done {
            self.notify(Notice::error(problem));
        }
    }

    fn preview_pack(&mut self, pack: &Pack) -> Result<(), String> {
        let zip = pack.zip().map_err(|error| error.to_string())?;
        self.preview_study(zip.into());
        if let Some(study) = &mut self.study {
            study.know_truth(pack.truth.clone());
        }
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
    platform::download(&truth_name(id), pack.truth.to_json().as_bytes())
}

/// Nobody is to put it on a server by mistake.
fn truth_name(study: &str) -> String {
    format!("{study}_truth_PRIVATE.json")
}
