//! Files on their way in: read, recognised, parsed on another thread, and given to the session together.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use super::PinPose;
use super::jobs::{Done, JobKind, Jobs};
use crate::formats::{Document, FileKind, NamedFile, Parsed, PosesAs, classify, parse_text_or_archive};
use crate::photo::Pixels;
use crate::platform::{self, FileBytes, Loaded, PageAnswer, PageReply, Saved};
use crate::scene::{MeshAsset, PhotoAsset, Sha256};
use crate::session::{Batch, Command, Notice, Opening};

/// Everything that is being loaded.
pub struct Loading {
    ctx: egui::Context,
    jobs: Jobs,
    loads: Vec<Load>,
    /// Jobs to loads; a job of no load decodes the photo that is shown.
    load_of_job: HashMap<u64, u64>,
    next_load: u64,
    /// Files that a picker or a drop is reading.
    arrived: Rc<RefCell<Vec<Arrival>>>,
    reading: Rc<RefCell<u32>>,
}

/// Files that came together.
pub struct Arrival {
    pub files: Vec<Result<FileBytes, String>>,
    pub poses_as: Option<PosesAs>,
    pub reply: Option<PageReply>,
}

/// One drop on its way.
struct Load {
    id: u64,
    jobs_left: usize,
    batch: Batch,
    opening: Option<(Document, Origin)>,
    problems: Vec<String>,
    warnings: Vec<String>,
    files: u32,
    reply: Option<PageReply>,
    /// An empty scene was asked for, to open a workspace in.
    has_asked_for_room: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Origin {
    Workspace,
    Storage,
}

impl Loading {
    pub fn new(ctx: &egui::Context) -> Self {
        Self {
            ctx: ctx.clone(),
            jobs: Jobs::new(ctx),
            loads: Vec::new(),
            load_of_job: HashMap::new(),
            next_load: 0,
            arrived: Rc::default(),
            reading: Rc::default(),
        }
    }

    /// What the user waits for, if anything.
    pub fn busy_text(&self) -> Option<String> {
        let waiting: usize = self.loads.iter().map(|load| load.jobs_left).sum();
        match waiting {
            0 if *self.reading.borrow() == 0 => None,
            0 => Some("Reading files…".to_owned()),
            1 => Some("Reading 1 file…".to_owned()),
            _ => Some(format!("Reading {waiting} files…")),
        }
    }

    pub fn pick_files(&self) {
        let deliver = self.deliverer();
        platform::pick_files(move |files| deliver(Arrival { files, poses_as: None, reply: None }));
    }

    pub fn fetch_example(&self) {
        *self.reading.borrow_mut() += 1;
        let (deliver, reading) = (self.deliverer(), self.reading.clone());
        platform::fetch_example(move |file| {
            *reading.borrow_mut() -= 1;
            deliver(Arrival { files: vec![file], poses_as: None, reply: None });
        });
    }

    pub fn arrive(&self, arrival: Arrival) {
        self.deliverer()(arrival);
    }

    fn deliverer(&self) -> impl Fn(Arrival) + 'static {
        let (arrived, ctx) = (self.arrived.clone(), self.ctx.clone());
        move |arrival| {
            arrived.borrow_mut().push(arrival);
            ctx.request_repaint();
        }
    }

    /// Decodes a photo of the scene that is to be shown.
    pub fn decode(&mut self, photo: &PhotoAsset) {
        self.jobs
            .submit(JobKind::Photo, NamedFile { name: photo.file_name.clone(), bytes: photo.bytes.clone() });
    }

    fn start(&mut self, arrival: Arrival) {
        let batch = Batch { poses_as: arrival.poses_as, ..Batch::default() };
        let mut load = self.new_load(batch, arrival.reply);
        for file in arrival.files {
            match file {
                Ok(file) => {
                    self.take_file(&mut load, NamedFile { name: file.name, bytes: Arc::from(file.bytes) });
                }
                Err(problem) => load.problems.push(problem),
            }
        }
        self.loads.push(load);
    }

    /// Brings back a saved scene under its name, which may have been changed since.
    pub fn start_saved(&mut self, saved: Saved, name: &str) -> Result<(), String> {
        let mut document =
            crate::formats::read_document(saved.json.as_bytes()).map_err(|error| error.to_string())?;
        name.clone_into(&mut document.name);
        let mut load = self.new_load(Batch::default(), None);
        load.opening = Some((document, Origin::Storage));
        for asset in saved.assets {
            self.take_file(&mut load, NamedFile { name: asset.file_name, bytes: asset.bytes });
        }
        self.loads.push(load);
        Ok(())
    }

    fn new_load(&mut self, batch: Batch, reply: Option<PageReply>) -> Load {
        self.next_load += 1;
        Load {
            id: self.next_load,
            jobs_left: 0,
            batch,
            opening: None,
            problems: Vec::new(),
            warnings: Vec::new(),
            files: 0,
            reply,
            has_asked_for_room: false,
        }
    }

    fn take_file(&mut self, load: &mut Load, file: NamedFile) {
        if file.bytes.is_empty() {
            load.problems.push(format!("{}: the file is empty", file.name));
            return;
        }
        let kind = classify(&file.name, &file.bytes);
        let job = match kind {
            FileKind::Photo => Some(JobKind::Photo),
            FileKind::Mesh => Some(JobKind::Mesh),
            _ => None,
        };
        if let Some(job) = job {
            let id = self.jobs.submit(job, file);
            self.load_of_job.insert(id, load.id);
            load.jobs_left += 1;
            return;
        }
        match parse_text_or_archive(&file, kind) {
            Ok(parsed) => self.take_parsed(load, parsed),
            Err(error) => load.problems.push(format!("{}: {error}", file.name)),
        }
    }

    fn take_parsed(&mut self, load: &mut Load, parsed: Parsed) {
        load.files += 1;
        match parsed {
            Parsed::Photo(photo) => load.batch.photos.push(photo),
            Parsed::Mesh(mesh) => load.batch.meshes.push(mesh),
            Parsed::Camera(camera) => load.batch.cameras.push(camera),
            Parsed::Poses(poses) => load.batch.poses.push(poses),
            Parsed::Workspace(workspace) => {
                load.opening = Some((workspace.document, Origin::Workspace));
                for file in workspace.files {
                    self.take_file(load, file);
                }
            }
        }
    }

    /// Photos that were decoded, and loads that are complete. While a scene `is_switching`, other files wait for it.
    fn poll(&mut self, is_switching: bool) -> (Vec<(Sha256, Arc<Pixels>)>, Vec<Load>) {
        for arrival in self.arrived.take() {
            self.start(arrival);
        }
        let mut decoded = Vec::new();
        for (job, file, done) in self.jobs.poll() {
            if let Ok(Done::Photo(asset, pixels)) = &done {
                decoded.push((asset.sha256, pixels.clone()));
            }
            let load = self.load_of_job.remove(&job);
            if let Some(load) = self.loads.iter_mut().find(|candidate| Some(candidate.id) == load) {
                load.jobs_left -= 1;
                load.take_done(&file, done);
            }
        }
        let is_next = |load: &Load| load.jobs_left == 0 && (!is_switching || load.is_of(Origin::Storage));
        let (complete, waiting) = std::mem::take(&mut self.loads).into_iter().partition(is_next);
        self.loads = waiting;
        (decoded, complete)
    }
}

impl Load {
    fn is_of(&self, origin: Origin) -> bool {
        self.opening.as_ref().is_some_and(|(_, candidate)| *candidate == origin)
    }

    fn take_done(&mut self, file: &NamedFile, done: Result<Done, String>) {
        match done {
            Ok(Done::Photo(asset, _)) => self.batch.photos.push(asset),
            Ok(Done::Mesh(asset, warnings)) => {
                self.warnings.extend(warnings.into_iter().map(|warning| format!("{}: {warning}", file.name)));
                self.batch.meshes.push(asset);
            }
            Err(problem) => {
                self.problems.push(format!("{}: {problem}", file.name));
                return;
            }
        }
        self.files += 1;
    }

    /// Replies come in any order; files of one drop are taken by name.
    fn sort(&mut self) {
        self.batch.photos.sort_by(|a: &Arc<PhotoAsset>, b| a.file_name.cmp(&b.file_name));
        self.batch.meshes.sort_by(|a: &Arc<MeshAsset>, b| a.file_name.cmp(&b.file_name));
    }
}

impl PinPose {
    /// Files dropped on the window.
    pub(super) fn take_dropped(&mut self, ctx: &egui::Context) {
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        if dropped.is_empty() {
            return;
        }
        let (deliver, reading) = (self.loading.deliverer(), self.loading.reading.clone());
        *reading.borrow_mut() += 1;
        platform::spawn(async move {
            let mut files = Vec::new();
            for file in dropped {
                let name = file.path().file_name().unwrap_or_default().to_string_lossy().into_owned();
                #[cfg(target_arch = "wasm32")]
                let bytes = file.bytes_async().await;
                #[cfg(not(target_arch = "wasm32"))]
                let bytes = file.bytes();
                files.push(match bytes {
                    Ok(bytes) => Ok(FileBytes { name, bytes }),
                    Err(error) => Err(format!("{name}: {error}")),
                });
            }
            *reading.borrow_mut() -= 1;
            deliver(Arrival { files, poses_as: None, reply: None });
        });
    }

    /// Gives complete loads to the session.
    pub(super) fn take_loaded(&mut self) {
        let (decoded, complete) = self.loading.poll(self.scenes.is_switching());
        for (sha256, pixels) in decoded {
            self.photos.insert(sha256, pixels);
        }
        for mut load in complete {
            if load.is_of(Origin::Workspace) && !self.make_room(&mut load) {
                self.loading.loads.push(load);
                continue;
            }
            load.sort();
            let restored = load.is_of(Origin::Storage);
            let command = match load.opening.take() {
                Some((document, _)) => Command::Open(Box::new(Opening {
                    document,
                    photos: load.batch.photos,
                    meshes: load.batch.meshes,
                    restored,
                })),
                None => Command::Import(Box::new(load.batch)),
            };
            self.apply(command);
            if restored {
                // What could not be read stays in storage: a change goes into a scene of its own.
                self.scene_opened(load.problems.is_empty());
            }
            load.warnings.into_iter().for_each(|warning| self.notify(Notice::warning(warning)));
            load.problems.iter().for_each(|problem| self.notify(Notice::error(problem.clone())));
            if let Some(reply) = load.reply {
                // Who asked may be gone.
                let loaded = Loaded { files: load.files, problems: load.problems };
                reply.send(Ok(PageAnswer::Loaded(loaded))).ok();
            }
        }
    }

    /// A workspace opens in a scene of its own: the open one is kept. False while that one is being saved.
    fn make_room(&mut self, load: &mut Load) -> bool {
        if self.session.scene().is_empty() {
            return true;
        }
        if self.scenes.is_switching() {
            return false;
        }
        if !load.has_asked_for_room {
            load.has_asked_for_room = true;
            self.new_scene();
            return self.session.scene().is_empty();
        }
        // The open scene cannot be saved, which was said. It can still be brought back by undo.
        true
    }

    /// Makes sure that the shown photo's pixels are there or on their way.
    pub(super) fn want_pixels(&mut self) {
        let Some(photo) = self.session.photo() else { return };
        let sha256 = photo.asset.sha256;
        if self.photos.get(sha256).is_none() && self.photos.wanted != Some(sha256) {
            self.photos.wanted = Some(sha256);
            self.loading.decode(&photo.asset);
        }
    }
}
