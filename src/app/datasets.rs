//! Data sets on their way in: a folder or a zip is listed, recognised by its names, shown to the user, read and opened.

mod choosing;
mod opening;
mod reading;

use std::cell::{Cell, RefCell};
use std::rc::Rc;
use std::sync::Arc;

use super::PinPose;
use super::loading::{Arrival, FoundArchive};
use crate::formats::PosesAs;
use crate::formats::dataset::{Listing, recognise};
use crate::platform::{self, FileBytes, FileTree, FolderEvent, GoOn, Loaded, PageAnswer, PageReply};
use crate::session::{Command, Notice};
use crate::ui::{Busy, DatasetRequest, DatasetView};
use choosing::Choosing;
use opening::Opening;
use reading::{Reading, Source};

/// A folder that is no data set is a drop of its files, unless there are more than somebody means by that.
const MOST_LOOSE_FILES: usize = 200;

/// One data set at a time.
pub struct Datasets {
    ctx: egui::Context,
    arrived: Rc<RefCell<Vec<FolderEvent>>>,
    /// A folder is being listed: so many files were found so far.
    listing: Option<usize>,
    /// The user does not want what is being listed.
    is_cancelled: Rc<Cell<bool>>,
    stage: Stage,
}

enum Stage {
    Idle,
    /// The files of a folder that is no data set.
    Loose(Loose),
    Choosing(Box<Choosing>),
    Opening(Box<BeingOpened>),
}

struct Loose {
    name: String,
    reading: Reading,
    arrival: Arrival,
}

struct BeingOpened {
    choosing: Choosing,
    opening: Opening,
    is_read: bool,
    has_asked_for_room: bool,
}

impl Datasets {
    pub fn new(ctx: &egui::Context) -> Self {
        let datasets = Self {
            ctx: ctx.clone(),
            arrived: Rc::default(),
            listing: None,
            is_cancelled: Rc::default(),
            stage: Stage::Idle,
        };
        platform::watch_dropped_folders(datasets.listener());
        datasets
    }

    pub fn pick_folder(&self) {
        platform::pick_folder(self.listener());
    }

    fn listener(&self) -> impl Fn(FolderEvent) -> GoOn + 'static {
        let (arrived, is_cancelled, ctx) =
            (self.arrived.clone(), self.is_cancelled.clone(), self.ctx.clone());
        move |event| {
            if is_cancelled.take() {
                return GoOn::No;
            }
            arrived.borrow_mut().push(event);
            ctx.request_repaint();
            GoOn::Yes
        }
    }

    pub fn is_dialog_open(&self) -> bool {
        matches!(self.stage, Stage::Choosing(_) | Stage::Opening(_))
    }

    /// Is something under way that ends by itself?
    pub fn is_busy(&self) -> bool {
        let is_at_work = match &self.stage {
            Stage::Idle => false,
            Stage::Choosing(choosing) => choosing.is_reading(),
            Stage::Loose(_) | Stage::Opening(_) => true,
        };
        is_at_work || self.listing.is_some() || !self.arrived.borrow().is_empty()
    }

    /// Does the dialog wait for the user?
    pub fn asks(&self) -> bool {
        matches!(&self.stage, Stage::Choosing(choosing) if !choosing.is_reading())
    }

    /// What the user waits for while there is no dialog.
    pub fn busy(&self) -> Option<Busy> {
        let text = match (&self.stage, self.listing) {
            (_, Some(found)) => format!("Listing files: {found} so far…"),
            (Stage::Loose(loose), None) => format!("Reading the files of {}…", loose.name),
            _ => return None,
        };
        Some(Busy { text, can_cancel: true })
    }

    /// Leaves out what has no dialog; true if there was something.
    pub fn cancel(&mut self) -> bool {
        let is_listing = self.listing.take().is_some();
        self.is_cancelled.set(is_listing);
        let is_loose = matches!(self.stage, Stage::Loose(_));
        if is_loose {
            self.stage = Stage::Idle;
        }
        is_listing || is_loose
    }

    /// For the dialog.
    pub fn view(&self) -> Option<DatasetView<'_>> {
        match &self.stage {
            Stage::Choosing(choosing) if !choosing.opens_by_itself() => Some(choosing.view(None)),
            Stage::Opening(being) => {
                let progress = being.opening.progress();
                Some(being.choosing.view(Some((progress.done, progress.all))))
            }
            _ => None,
        }
    }
}

impl PinPose {
    /// Once a frame: whatever is under way goes on.
    pub(super) fn tick_datasets(&mut self) {
        for event in self.datasets.arrived.take() {
            match event {
                FolderEvent::Listing(found) => self.datasets.listing = Some(found),
                FolderEvent::Listed(tree) => {
                    self.datasets.listing = None;
                    self.take_folder(tree);
                }
                FolderEvent::Failed(problem) => {
                    self.datasets.listing = None;
                    self.notify(Notice::error(problem));
                }
            }
        }
        for archive in self.loading.take_archives() {
            self.take_archive(archive);
        }
        match &mut self.datasets.stage {
            Stage::Idle => {}
            Stage::Loose(loose) => {
                loose.take_files();
                if loose.reading.is_done() {
                    self.drop_loose_files();
                }
            }
            Stage::Choosing(choosing) => {
                if choosing.advance(&self.datasets.ctx) && choosing.opens_by_itself() {
                    self.open_dataset();
                }
            }
            Stage::Opening(being) => {
                being.is_read |= being.opening.advance();
                self.finish_dataset();
            }
        }
    }

    pub(super) fn take_folder(&mut self, tree: Rc<dyn FileTree>) {
        let listing = Listing::new(tree.name(), tree.files());
        match listing {
            Ok(listing) => self.take_listing(listing, Source::Folder(tree), None, None),
            Err(error) => self.notify(Notice::error(error.to_string())),
        }
    }

    fn take_archive(&mut self, found: FoundArchive) {
        let FoundArchive { name, mut archive, poses_as, reply } = found;
        match archive.listing(&name) {
            Ok(listing) => {
                let source = Source::Zip(Rc::new(RefCell::new(archive)));
                self.take_listing(listing, source, poses_as, reply);
            }
            Err(error) => self.refuse(format!("{name}: {error}"), reply),
        }
    }

    fn take_listing(
        &mut self,
        listing: Listing,
        source: Source,
        poses_as: Option<PosesAs>,
        reply: Option<PageReply>,
    ) {
        let listing = Arc::new(listing);
        if matches!(self.datasets.stage, Stage::Opening(_) | Stage::Loose(_)) {
            let text =
                format!("{}: another data set is being opened. Drop it again after that", listing.name());
            self.refuse(text, reply);
            return;
        }
        if let Some(recognised) = recognise(&listing) {
            let choosing = Choosing::new(recognised, source, poses_as, reply, &self.datasets.ctx);
            self.datasets.stage = Stage::Choosing(Box::new(choosing));
            return;
        }
        let paths: Vec<String> =
            listing.paths().filter(|path| is_loose_file(path)).map(str::to_owned).collect();
        if paths.is_empty() || paths.len() > MOST_LOOSE_FILES {
            let expected = "photos and meshes, or a BOP, Linemod or MegaPose data set, expected in it";
            let text = format!("{}: nothing in it can be opened; {expected}", listing.name());
            self.refuse(text, reply);
            return;
        }
        let mut arrival = Arrival::of_files(Vec::new());
        (arrival.poses_as, arrival.reply) = (poses_as, reply);
        let reading = Reading::new(source, paths, &self.datasets.ctx);
        self.datasets.stage = Stage::Loose(Loose { name: listing.name().to_owned(), reading, arrival });
    }

    /// Says why nothing comes of it.
    fn refuse(&mut self, problem: String, reply: Option<PageReply>) {
        self.notify(Notice::error(problem.clone()));
        if let Some(reply) = reply {
            // Who asked may be gone.
            reply.send(Ok(PageAnswer::Loaded(Loaded { files: 0, problems: vec![problem] }))).ok();
        }
    }

    fn drop_loose_files(&mut self) {
        if let Stage::Loose(loose) = std::mem::replace(&mut self.datasets.stage, Stage::Idle) {
            self.loading.arrive(loose.arrival);
        }
    }

    pub(super) fn take_dataset_request(&mut self, request: DatasetRequest) {
        match request {
            DatasetRequest::Open => self.open_dataset(),
            DatasetRequest::Cancel => self.cancel_dataset(),
            other => {
                if let Stage::Choosing(choosing) = &mut self.datasets.stage {
                    choosing.change(other, &self.datasets.ctx);
                }
            }
        }
    }

    /// Reads what was chosen.
    fn open_dataset(&mut self) {
        match std::mem::replace(&mut self.datasets.stage, Stage::Idle) {
            Stage::Choosing(mut choosing) => match choosing.begin_opening(&self.datasets.ctx) {
                Ok(opening) => {
                    let being = BeingOpened {
                        choosing: *choosing,
                        opening,
                        is_read: false,
                        has_asked_for_room: false,
                    };
                    self.datasets.stage = Stage::Opening(Box::new(being));
                    self.datasets.ctx.request_repaint();
                }
                // Whoever opens by itself has no dialog that says it.
                Err(problem) if choosing.opens_by_itself() => self.refuse(problem, choosing.reply.take()),
                Err(_) => self.datasets.stage = Stage::Choosing(choosing),
            },
            other => self.datasets.stage = other,
        }
    }

    fn cancel_dataset(&mut self) {
        let (name, reply) = match std::mem::replace(&mut self.datasets.stage, Stage::Idle) {
            Stage::Choosing(choosing) => (None, choosing.reply),
            Stage::Opening(being) => (Some(being.choosing.recognised.name), being.choosing.reply),
            other => {
                self.datasets.stage = other;
                return;
            }
        };
        if let Some(name) = name {
            self.notify(Notice::info(format!("Cancelled: {name} was not opened")));
        }
        if let Some(reply) = reply {
            // Who asked may be gone.
            reply.send(Err("the user cancelled the loading".to_owned())).ok();
        }
    }

    /// Gives what was read to the session, in a scene of its own: the open one is kept.
    fn finish_dataset(&mut self) {
        let Stage::Opening(mut being) = std::mem::replace(&mut self.datasets.stage, Stage::Idle) else {
            return;
        };
        if !being.is_read || !self.make_room(&mut being.has_asked_for_room) {
            self.datasets.stage = Stage::Opening(being);
            self.datasets.ctx.request_repaint();
            return;
        }
        let import = being.opening.finish();
        let files = (import.images.len() + import.meshes.len()) as u32;
        self.apply(Command::OpenDataset(Box::new(import)));
        let Opening { problems, warnings, .. } = being.opening;
        warnings.into_iter().for_each(|warning| self.notify(Notice::warning(warning)));
        for problem in summed_up(&problems) {
            self.notify(Notice::error(problem));
        }
        if let Some(reply) = being.choosing.reply {
            // Who asked may be gone.
            reply.send(Ok(PageAnswer::Loaded(Loaded { files, problems }))).ok();
        }
    }
}

impl Loose {
    fn take_files(&mut self) {
        for (path, read) in self.reading.take() {
            // As a drop names files.
            let name = path.rsplit('/').next().unwrap_or(&path).to_owned();
            self.arrival.files.push(match read {
                Ok(bytes) => Ok(FileBytes { name, bytes: bytes.to_vec() }),
                Err(problem) => Err(format!("{name}: {problem}")),
            });
        }
    }
}

/// Could it be opened by itself, or belong to what can?
fn is_loose_file(path: &str) -> bool {
    const EXTENSIONS: [&str; 22] = [
        "png", "jpg", "jpeg", "webp", "bmp", "tif", "tiff", "ply", "obj", "stl", "glb", "gltf", "off", "mtl",
        "bin", "json", "txt", "csv", "yml", "yaml", "npy", "zip",
    ];
    let extension = path.rsplit_once('.').map_or("", |(_, extension)| extension).to_ascii_lowercase();
    EXTENSIONS.contains(&extension.as_str())
}

/// A few problems by themselves, more by their number: they would hide the photo.
fn summed_up(problems: &[String]) -> Vec<String> {
    const MOST_SAID: usize = 4;
    let mut said: Vec<String> = problems.iter().take(MOST_SAID).cloned().collect();
    let others = problems.len().saturating_sub(MOST_SAID);
    if others > 0 {
        said.push(format!("and {others} more files that could not be read"));
    }
    said
}
