//! Files on their way in: read, recognised, parsed on another thread, and given to the session together.

mod foreign;
mod into_session;
mod side_jobs;

use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use super::jobs::{Done, JobKind, Jobs, Urgency};
use super::thumbnails::ThumbnailJobs;
use crate::formats::{
    Archive, Document, FileKind, FileWithCompanions, NamedFile, Parsed, PosesAs, classify,
    parse_text_or_archive, with_companions,
};
use crate::math::sort_short;
use crate::mesh::Mesh;
use crate::photo::{DepthPixels, Pixels, is_depth_like};
use crate::platform::{self, FileBytes, PageReply, Saved, SavedAsset};
use crate::scene::{MeshAsset, PhotoAsset, Sha256};
use crate::session::{Batch, Pick};
use crate::solve::symmetry::FoundSymmetries;
use crate::ui::Busy;

/// What takes less is over before it could be read.
const QUIET_MS: f64 = 300.0;

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
    /// Grows with every cancel: what was begun before is thrown away when it comes.
    cancels: Rc<Cell<u64>>,
    /// When the present work began.
    busy_since_ms: Option<f64>,
    pub thumbnails: ThumbnailJobs,
    /// `None`: it could not be made.
    finished_thumbnails: Vec<(Sha256, Option<Pixels>)>,
    /// Depth maps of the scene that are decoded to be shown.
    depth_jobs: HashMap<u64, Sha256>,
    finished_depths: Vec<(Sha256, Option<Arc<DepthPixels>>)>,
    solver_mesh_jobs: HashMap<u64, Sha256>,
    /// Files of a study by their paths in it.
    study_jobs: HashMap<u64, String>,
    finished_for_study: Vec<side_jobs::StudyFile>,
    finished_solver_meshes: Vec<(Sha256, Option<Arc<Mesh>>)>,
    symmetry_jobs: HashMap<u64, Arc<MeshAsset>>,
    finished_symmetries: Vec<(Arc<MeshAsset>, Option<FoundSymmetries>)>,
    /// Zips that are no workspaces.
    archives: Vec<FoundArchive>,
}

/// What images are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ImagesAs {
    /// Photos, unless something speaks for masks or a depth map.
    Photos,
    /// Masks of the photo that is shown.
    Masks,
    /// The depth map of the photo that is shown.
    DepthMap,
}

/// Files that came together.
pub struct Arrival {
    pub files: Vec<Result<FileBytes, String>>,
    pub poses_as: Option<PosesAs>,
    pub images_as: ImagesAs,
    pub reply: Option<PageReply>,
    /// Foreign pictures have been made PNGs as far as the browser reads them, which was said of these; `None`: not tried.
    pub converted: Option<Vec<String>>,
}

impl Arrival {
    pub fn of_files(files: Vec<Result<FileBytes, String>>) -> Self {
        Self { files, poses_as: None, images_as: ImagesAs::Photos, reply: None, converted: None }
    }
}

/// A zip that may be a data set.
pub struct FoundArchive {
    pub name: String,
    pub archive: Archive,
    pub poses_as: Option<PosesAs>,
    /// Of whoever loaded it and said what poses are to be.
    pub reply: Option<PageReply>,
}

/// One drop on its way.
struct Load {
    id: u64,
    jobs_left: usize,
    job_count: usize,
    batch: Batch,
    images_as: ImagesAs,
    /// Images that are masks if a photo of their size is shown.
    likely_masks: Vec<Arc<PhotoAsset>>,
    /// The same of depth maps.
    likely_depths: Vec<Arc<PhotoAsset>>,
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
            cancels: Rc::default(),
            busy_since_ms: None,
            thumbnails: ThumbnailJobs::default(),
            finished_thumbnails: Vec::new(),
            depth_jobs: HashMap::new(),
            finished_depths: Vec::new(),
            solver_mesh_jobs: HashMap::new(),
            study_jobs: HashMap::new(),
            finished_for_study: Vec::new(),
            finished_solver_meshes: Vec::new(),
            symmetry_jobs: HashMap::new(),
            finished_symmetries: Vec::new(),
            archives: Vec::new(),
        }
    }

    /// Is anything on its way in?
    pub fn is_busy(&self) -> bool {
        *self.reading.borrow() > 0 || self.loads.iter().any(|load| load.jobs_left > 0)
    }

    /// What the user waits for, once it takes long enough to be worth saying.
    pub fn busy(&mut self, now_ms: f64) -> Option<Busy> {
        if !self.is_busy() {
            self.busy_since_ms = None;
            return None;
        }
        let since_ms = *self.busy_since_ms.get_or_insert(now_ms);
        let left_ms = QUIET_MS - (now_ms - since_ms);
        if left_ms > 0.0 {
            self.ctx.request_repaint_after(std::time::Duration::from_secs_f64(left_ms / 1000.0));
            return None;
        }
        let all: usize = self.loads.iter().map(|load| load.job_count).sum();
        let left: usize = self.loads.iter().map(|load| load.jobs_left).sum();
        let text = match (left, all) {
            (0, _) => "Reading files…".to_owned(),
            (_, 1) => "Reading 1 file…".to_owned(),
            _ => format!("Reading {} of {all} files…", all - left + 1),
        };
        // Half a saved scene is none.
        let can_cancel = !self.loads.iter().any(|load| load.is_of(Origin::Storage));
        Some(Busy { text, can_cancel })
    }

    /// Leaves out what is not read yet.
    pub fn cancel(&mut self) {
        self.cancels.set(self.cancels.get() + 1);
        *self.reading.borrow_mut() = 0;
        self.arrived.borrow_mut().clear();
        let loads = std::mem::take(&mut self.loads);
        let (kept, dropped): (Vec<_>, Vec<_>) =
            loads.into_iter().partition(|load| load.is_of(Origin::Storage));
        self.loads = kept;
        for load in dropped {
            let jobs: Vec<u64> =
                self.load_of_job.iter().filter(|(_, of)| **of == load.id).map(|(job, _)| *job).collect();
            self.jobs.cancel(|job| jobs.contains(&job));
            jobs.iter().for_each(|job| {
                self.load_of_job.remove(job);
            });
            if let Some(reply) = load.reply {
                // Who asked may be gone.
                reply.send(Err("the user cancelled the loading".to_owned())).ok();
            }
        }
    }

    pub fn pick_files(&self, pick: Pick) {
        let deliver = self.deliverer();
        let images_as = match pick {
            Pick::Masks => ImagesAs::Masks,
            Pick::DepthMap => ImagesAs::DepthMap,
            _ => ImagesAs::Photos,
        };
        platform::pick_files(accepted(pick), move |files| {
            deliver(Arrival { images_as, ..Arrival::of_files(files) });
        });
    }

    pub fn fetch_example(&self) {
        let arrive = self.begin_reading();
        platform::fetch_example(move |file| arrive(Arrival::of_files(vec![file])));
    }

    /// Counts as busy until what is returned is called; a cancel meanwhile makes that do nothing.
    fn begin_reading(&self) -> impl FnOnce(Arrival) + 'static {
        *self.reading.borrow_mut() += 1;
        let (deliver, reading, cancels) = (self.deliverer(), self.reading.clone(), self.cancels.clone());
        let begun = cancels.get();
        move |arrival| {
            if cancels.get() == begun {
                *reading.borrow_mut() -= 1;
                deliver(arrival);
            }
        }
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

    pub fn take_archives(&mut self) -> Vec<FoundArchive> {
        std::mem::take(&mut self.archives)
    }

    fn start(&mut self, arrival: Arrival) {
        let batch = Batch { poses_as: arrival.poses_as, ..Batch::default() };
        let mut load = self.new_load(batch, arrival.reply);
        load.images_as = arrival.images_as;
        load.warnings = arrival.converted.unwrap_or_default();
        let mut files = Vec::new();
        let is_alone = arrival.files.len() == 1;
        for file in arrival.files {
            match file {
                Ok(file) => {
                    let file = NamedFile { name: file.name, bytes: Arc::from(file.bytes) };
                    let Some(archive) = dataset_archive(&file) else {
                        files.push(file);
                        continue;
                    };
                    let poses_as = arrival.poses_as;
                    let reply = load.reply.take_if(|_| is_alone && poses_as.is_some());
                    load.files += 1;
                    self.archives.push(FoundArchive { name: file.name, archive, poses_as, reply });
                }
                Err(problem) => load.problems.push(problem),
            }
        }
        self.take_files(&mut load, files);
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
            let its_own = saved.companions.iter().filter(|companion| companion.of == asset.key);
            let named =
                |file: &SavedAsset| NamedFile { name: file.file_name.clone(), bytes: file.bytes.clone() };
            let companions: Vec<NamedFile> = its_own.map(|companion| named(&companion.file)).collect();
            self.take_file(&mut load, named(&asset), &companions);
        }
        self.loads.push(load);
        Ok(())
    }

    fn new_load(&mut self, batch: Batch, reply: Option<PageReply>) -> Load {
        self.next_load += 1;
        Load {
            id: self.next_load,
            jobs_left: 0,
            job_count: 0,
            batch,
            images_as: ImagesAs::Photos,
            likely_masks: Vec::new(),
            likely_depths: Vec::new(),
            opening: None,
            problems: Vec::new(),
            warnings: Vec::new(),
            files: 0,
            reply,
            has_asked_for_room: false,
        }
    }

    /// Files that came together: textures are taken along with their meshes.
    fn take_files(&mut self, load: &mut Load, files: Vec<NamedFile>) {
        for FileWithCompanions { file, companions } in with_companions(files) {
            self.take_file(load, file, &companions);
        }
    }

    fn take_file(&mut self, load: &mut Load, file: NamedFile, companions: &[NamedFile]) {
        if file.bytes.is_empty() {
            load.problems.push(format!("{}: the file is empty", file.name));
            return;
        }
        let kind = classify(&file.name, &file.bytes);
        let job = match kind {
            FileKind::Photo if load.takes_as_depth(&file) => Some(JobKind::DepthMap),
            FileKind::Photo => Some(JobKind::Photo),
            FileKind::Mesh => Some(JobKind::Mesh),
            _ => None,
        };
        if let Some(job) = job {
            let id = self.jobs.submit(job, file, companions, Urgency::InTurn);
            self.load_of_job.insert(id, load.id);
            load.jobs_left += 1;
            load.job_count += 1;
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
            Parsed::Pins(pins) => load.batch.pins = Some(pins),
            Parsed::Workspace(workspace) => {
                load.opening = Some((workspace.document, Origin::Workspace));
                for FileWithCompanions { file, companions } in workspace.files {
                    self.take_file(load, file, &companions);
                }
            }
        }
    }

    /// Photos that were decoded, and loads that are complete. While a scene `is_switching`, other files wait for it.
    fn poll(&mut self, is_switching: bool) -> (Vec<(Sha256, Arc<Pixels>)>, Vec<Load>) {
        for arrival in self.arrived.take() {
            self.receive(arrival);
        }
        let mut decoded = Vec::new();
        for (job, file, done) in self.jobs.poll() {
            let Some(done) = self.take_side_job(job, done) else { continue };
            match &done {
                Ok(Done::Photo(asset, pixels)) => decoded.push((asset.sha256, pixels.clone())),
                Ok(Done::DepthMap(asset, depth)) => {
                    self.finished_depths.push((asset.sha256, Some(depth.clone())));
                }
                _ => {}
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

/// The names of files that a picker shows at first; nothing for all.
fn accepted(pick: Pick) -> &'static [&'static str] {
    match pick {
        Pick::Anything => &[],
        // The last four where the browser reads them.
        Pick::Photos | Pick::Masks if cfg!(target_arch = "wasm32") => {
            &["png", "jpg", "jpeg", "webp", "bmp", "tif", "tiff", "avif", "gif", "heic", "heif"]
        }
        Pick::Photos | Pick::Masks => &["png", "jpg", "jpeg", "webp", "bmp", "tif", "tiff"],
        Pick::DepthMap => &["png", "tif", "tiff"],
        Pick::Meshes => &["ply", "obj", "stl", "glb", "gltf", "off"],
        Pick::Cameras => &["json", "txt", "npy", "yml", "yaml"],
        Pick::Poses => &["json", "txt", "csv", "npy"],
        Pick::Workspace => &["zip"],
    }
}

/// The file as an archive, if it is a zip that this program did not save.
fn dataset_archive(file: &NamedFile) -> Option<Archive> {
    let is_zip = classify(&file.name, &file.bytes) == FileKind::Workspace;
    // What is damaged is said by whoever reads it as a workspace.
    let archive = if is_zip { Archive::open(file.bytes.clone()).ok()? } else { return None };
    (!archive.is_workspace()).then_some(archive)
}

fn is_grey(pixels: &Pixels) -> bool {
    pixels.rgba.chunks_exact(4).all(|pixel| pixel[0] == pixel[1] && pixel[1] == pixel[2])
}

impl Load {
    fn is_of(&self, origin: Origin) -> bool {
        self.opening.as_ref().is_some_and(|(_, candidate)| *candidate == origin)
    }

    fn takes_as_depth(&self, file: &NamedFile) -> bool {
        match self.images_as {
            ImagesAs::Photos => is_depth_like(&file.bytes),
            ImagesAs::Masks => false,
            ImagesAs::DepthMap => true,
        }
    }

    fn take_done(&mut self, file: &NamedFile, done: Result<Done, String>) {
        match done {
            Ok(Done::Photo(asset, pixels)) => {
                let is_named_mask = asset.file_name.to_lowercase().contains("mask");
                if self.images_as == ImagesAs::Masks
                    || (is_named_mask && self.opening.is_none() && is_grey(&pixels))
                {
                    self.likely_masks.push(asset);
                } else {
                    self.batch.photos.push(asset);
                }
            }
            // A saved scene says itself what is whose depth map.
            Ok(Done::DepthMap(asset, _)) if self.opening.is_some() => self.batch.photos.push(asset),
            Ok(Done::DepthMap(asset, _)) => self.likely_depths.push(asset),
            // These are of no load.
            Ok(
                Done::Thumbnail(_)
                | Done::Headers(_)
                | Done::SolverMesh(_)
                | Done::Symmetries(_)
                | Done::MeshRest(_),
            ) => return,
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
        sort_short(&mut self.batch.photos, |a: &Arc<PhotoAsset>, b| a.file_name.cmp(&b.file_name));
        sort_short(&mut self.batch.meshes, |a: &Arc<MeshAsset>, b| a.file_name.cmp(&b.file_name));
    }
}
