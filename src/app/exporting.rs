//! An export under way: some files a frame, so that the page stays alive, into a zip or a folder.

use std::cell::RefCell;
use std::rc::Rc;

use super::PinPose;
use super::pictures::PictureFor;
use crate::formats::NamedFile;
use crate::formats::export::{ExportJob, Exported, OverlayRequest, ZipStream, safe_file_name};
use crate::platform::{self, ExportFolder, GrowingDownload};
use crate::render::ExportKind;
use crate::scene::Scene;
use crate::session::Notice;
use crate::ui::{Busy, ExportRequest};

/// Files are made so long within one frame, and at least one.
const SLICE_MS: f64 = 12.0;

/// Where the export that is under way stands.
#[derive(Default)]
pub struct Exporting {
    running: Option<Running>,
    /// The folder that the user is picking, or has picked.
    picked: Rc<RefCell<Option<Picked>>>,
}

struct Running {
    job: ExportJob,
    target: Target,
    /// Of the archive.
    name: String,
    problems: Vec<String>,
    /// An overlay is being drawn; what follows waits for it.
    awaits: Option<OverlayRequest>,
}

type Picked = (Box<ExportJob>, Result<Option<ExportFolder>, String>);

enum Target {
    Zip(Box<ZipStream>, GrowingDownload),
    /// One write at a time.
    Folder(ExportFolder, Rc<RefCell<Writing>>),
}

#[derive(Debug, Default)]
struct Writing {
    is_busy: bool,
    problem: Option<String>,
}

impl Exporting {
    pub fn busy(&self) -> Option<Busy> {
        let running = self.running.as_ref()?;
        let (done, total) = (running.job.done(), running.job.total());
        Some(Busy {
            text: format!("Exporting {} of {total} files…", (done + 1).min(total)),
            can_cancel: true,
        })
    }

    /// The scene as it is exported.
    pub fn scene(&self) -> Option<&Scene> {
        self.running.as_ref().map(|running| running.job.scene())
    }

    /// Gives up what is under way; true if there was something.
    pub fn cancel(&mut self) -> bool {
        self.running.take().is_some()
    }
}

impl PinPose {
    pub(super) fn start_export(&mut self, request: ExportRequest) {
        let scene = self.session.settled_scene();
        let job = ExportJob::new(scene, &self.session.view_settings(), request.options);
        for warning in job.warnings() {
            self.notify(Notice::warning(warning));
        }
        if !request.into_folder {
            self.run_export(job, Target::Zip(Box::default(), GrowingDownload::default()));
            return;
        }
        let (picked, ctx) = (self.exporting.picked.clone(), self.ctx.clone());
        platform::spawn(async move {
            let folder = ExportFolder::pick().await;
            *picked.borrow_mut() = Some((Box::new(job), folder));
            ctx.request_repaint();
        });
    }

    fn run_export(&mut self, job: ExportJob, target: Target) {
        let name = match self.session.scene().name.as_str() {
            "" => "pinpose-export".to_owned(),
            name => format!("{}-export", safe_file_name(name)),
        };
        self.exporting.running = Some(Running { job, target, name, problems: Vec::new(), awaits: None });
        self.ctx.request_repaint();
    }

    /// Once a frame: makes some more files.
    pub(super) fn tick_export(&mut self) {
        let picked = self.exporting.picked.borrow_mut().take();
        match picked {
            Some((job, Ok(Some(folder)))) => self.run_export(*job, Target::Folder(folder, Rc::default())),
            Some((_, Err(problem))) => {
                self.notify(Notice::error(format!("The folder cannot be used: {problem}")));
            }
            Some((_, Ok(None))) | None => {}
        }
        let Some(mut running) = self.exporting.running.take() else { return };
        match running.slice(&self.ctx) {
            Ok(Next::Later) => {
                self.exporting.running = Some(running);
                self.ctx.request_repaint();
            }
            Ok(Next::Draw(request)) => {
                running.awaits = Some(request.clone());
                self.exporting.running = Some(running);
                let target = PictureFor::Export(request.path);
                self.pictures.ask(request.photo, ExportKind::Overlay, None, target);
                self.ctx.request_repaint();
            }
            Ok(Next::Nothing) => self.finish_export(running),
            Err(problem) => self.notify(failed(&problem)),
        }
    }

    /// An overlay has been drawn. One that nobody waits for belongs to an export that was cancelled.
    pub(super) fn take_export_picture(&mut self, path: String, png: Result<Vec<u8>, String>) {
        let Some(running) = &mut self.exporting.running else { return };
        if running.awaits.take_if(|request| request.path == path).is_none() {
            return;
        }
        let put = match png {
            Ok(bytes) => running.put(NamedFile { name: path, bytes: bytes.into() }, &self.ctx),
            Err(problem) => {
                running.problems.push(format!("{path}: {problem}"));
                Ok(())
            }
        };
        if let Err(problem) = put {
            self.exporting.running = None;
            self.notify(failed(&problem));
        }
    }

    fn finish_export(&mut self, running: Running) {
        let Running { job, target, name, problems, .. } = running;
        let (files, poses) = (job.done().saturating_sub(problems.len()), job.pose_count());
        problems.into_iter().for_each(|problem| self.notify(Notice::error(format!("Left out: {problem}"))));
        let saved = match target {
            Target::Zip(stream, mut download) => {
                let name = format!("{name}.zip");
                let end = stream.finish().map_err(|error| error.to_string());
                end.and_then(|end| download.append(&end)).and_then(|()| download.finish(&name)).map(|()| name)
            }
            Target::Folder(..) => Ok("the folder".to_owned()),
        };
        match saved {
            Ok(name) => {
                let [files, poses] = [(files, "file"), (poses, "pose")]
                    .map(|(count, noun)| format!("{count} {noun}{}", if count == 1 { "" } else { "s" }));
                self.notify(Notice::info(format!("{files} with {poses} exported into {name}")));
            }
            Err(problem) => self.notify(Notice::error(problem)),
        }
    }
}

fn failed(problem: &str) -> Notice {
    Notice::error(format!("The export has failed: {problem}"))
}

/// What an export does after a moment of work.
enum Next {
    /// Goes on in another frame.
    Later,
    Draw(OverlayRequest),
    Nothing,
}

impl Running {
    /// Makes files for a moment.
    fn slice(&mut self, ctx: &egui::Context) -> Result<Next, String> {
        let start_ms = platform::now_ms();
        while self.awaits.is_none() {
            if let Target::Folder(_, writing) = &self.target {
                let mut writing = writing.borrow_mut();
                if let Some(problem) = writing.problem.take() {
                    return Err(problem);
                }
                if writing.is_busy {
                    return Ok(Next::Later);
                }
            }
            match self.job.next() {
                None => return Ok(Next::Nothing),
                Some(Err(error)) => self.problems.push(error.to_string()),
                Some(Ok(Exported::File(file))) => self.put(file, ctx)?,
                Some(Ok(Exported::Overlay(request))) => return Ok(Next::Draw(request)),
            }
            if platform::now_ms() - start_ms > SLICE_MS {
                break;
            }
        }
        Ok(Next::Later)
    }

    fn put(&mut self, file: NamedFile, ctx: &egui::Context) -> Result<(), String> {
        match &mut self.target {
            Target::Zip(stream, download) => {
                let bytes = stream.add(&file).map_err(|error| error.to_string())?;
                download.append(&bytes)
            }
            Target::Folder(folder, writing) => {
                writing.borrow_mut().is_busy = true;
                let (folder, writing, ctx) = (folder.clone(), writing.clone(), ctx.clone());
                platform::spawn(async move {
                    let written = folder.write(file.name, file.bytes).await;
                    *writing.borrow_mut() = Writing { is_busy: false, problem: written.err() };
                    ctx.request_repaint();
                });
                Ok(())
            }
        }
    }
}
