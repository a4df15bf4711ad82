//! A study that was exported comes back into the builder: its photos and objects as a new scene, its settings as the draft.

use super::words::Trouble;
use super::{Participating, Purpose, State};
use crate::app::PinPose;
use crate::platform;
use crate::scene::Scene;
use crate::session::{Notice, Session};
use crate::study::Truth;
use crate::study::pack::{Draft, reopened};

impl PinPose {
    /// Asks for a study's zip, and its true poses with it.
    pub(in crate::app) fn pick_study(&mut self) {
        let (picked, ctx) = (self.building.picked_study.clone(), self.ctx.clone());
        platform::pick_files(&["zip", "json"], move |files| {
            *picked.borrow_mut() = Some(files);
            ctx.request_repaint();
        });
    }

    /// Once a frame.
    pub(in crate::app) fn tick_changing(&mut self) {
        let picked = self.building.picked_study.borrow_mut().take();
        if let Some(files) = picked {
            self.take_picked_study(files);
        }
        self.place_reopened();
    }

    fn take_picked_study(&mut self, files: Vec<Result<platform::FileBytes, String>>) {
        let (mut zip, mut truth) = (None, None);
        for file in files {
            match file {
                Ok(file) if file.bytes.starts_with(b"PK") => zip = Some(file.bytes),
                Ok(file) => match Truth::from_json(&file.bytes) {
                    Ok(read) => truth = Some(read),
                    Err(error) => self.notify(Notice::error(format!("{}: {error}", file.name))),
                },
                Err(problem) => self.notify(Notice::error(problem)),
            }
        }
        let Some(zip) = zip else {
            let text = "Choose the study's zip, and with it the file with its true poses";
            return self.notify(Notice::warning(text));
        };
        self.preview_study(zip.into());
        if let Some(study) = &mut self.study {
            study.purpose = Purpose::Change(truth.map(Box::new));
        }
    }

    /// The files are read, or cannot be.
    pub(super) fn tick_study_to_change(&mut self) {
        let Some(study) = &mut self.study else { return };
        if !matches!(study.purpose, Purpose::Change(_)) {
            return;
        }
        let opened = match &study.state {
            State::ToChange(opened) => Ok(opened.clone()),
            State::Problem(trouble) => Err(format!("{} {}", trouble.text, trouble.details)),
            _ => return,
        };
        self.leave_preview();
        match opened {
            Ok(opened) => {
                // What is open stays among the scenes.
                self.building.reopened = Some(opened);
                self.new_scene();
            }
            Err(problem) => self.notify(Notice::error(problem)),
        }
    }

    /// As soon as the scene that was open is saved, and an empty one is in its place.
    fn place_reopened(&mut self) {
        if self.scenes.is_switching() {
            return;
        }
        let Some(opened) = self.building.reopened.take() else { return };
        // It cannot be saved, which was said.
        if !self.session.scene().is_empty() {
            return;
        }
        let (scene, draft) = *opened;
        let without_truth = draft.chosen.iter().any(|chosen| draft.truth_of(&scene, chosen).is_none());
        self.session = Session::with_scene(scene);
        self.hands = crate::interact::Hands::default();
        self.autosave.mark_unsaved();
        self.ui_state.study_builder.show_draft(draft);
        if without_truth {
            let text =
                "Some true poses are not known: choose the study's zip together with the file that has them";
            self.notify(Notice::warning(text));
        }
    }
}

impl Participating {
    /// All files are read: this is what the researcher goes on with.
    pub(super) fn open_to_change(&mut self, ready: &super::Ready, truth: Option<&Truth>) {
        match reopened(&ready.files, &ready.photos, &ready.meshes, truth) {
            Ok(opened) => self.state = State::ToChange(Box::new(opened)),
            Err(error) => self.fail(Trouble::of("The study cannot be changed.", error.to_string(), false)),
        }
    }
}

/// A study as a scene and a draft.
pub type Opened = (Scene, Draft);
