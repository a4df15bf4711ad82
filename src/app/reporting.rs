//! A study's report: files are read, trials compared and files written a moment in each frame, so that the page stays awake.

mod packing;

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;
use std::sync::Arc;

use super::PinPose;
use super::loading::Arrival;
use crate::formats::export::safe_file_name;
use crate::formats::{Archive, NamedFile};
use crate::platform::{self, FileBytes};
use crate::session::Notice;
use crate::study::report::{Overview, Report, ReportFiles, ReportJob, ReportOptions, ReportProgress, gather};
use crate::ui::{ReportRequest, ReportStage, ReportView};
use packing::Packing;

/// So long a frame may work; the rest of it is for drawing.
const SLICE_MS: f64 = 20.0;

/// Who made it, for the page's foot.
const GENERATOR: &str = concat!("PinPose ", env!("CARGO_PKG_VERSION"));

/// Files that came together.
type Files = Vec<Result<FileBytes, String>>;

/// The report that is being made, from its files on.
#[derive(Default)]
pub struct Reporting {
    arrived: Rc<RefCell<Vec<(Files, From)>>>,
    waiting: VecDeque<Waiting>,
    files: ReportFiles,
    overview: Overview,
    stage: Stage,
}

/// Where files come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum From {
    /// For the report, whatever they are.
    Dialog,
    /// Dropped on the program: they may be for the scene.
    Drop,
}

enum Waiting {
    File(NamedFile),
    /// One of a zip, by its path there.
    Packed(Rc<RefCell<Archive>>, String),
}

#[derive(Default)]
enum Stage {
    #[default]
    Collecting,
    /// It cannot be made, and why.
    Refused(String),
    /// Meshes are read before anything is compared.
    Meshes(ReportOptions),
    Making(Box<ReportJob>, f64),
    Done(Box<Report>),
    Packing(Box<Report>, Box<Packing>),
}

impl Reporting {
    pub fn view(&self) -> ReportView<'_> {
        let stage = match &self.stage {
            _ if !self.waiting.is_empty() => ReportStage::Reading,
            Stage::Collecting => ReportStage::Collecting { problem: None },
            Stage::Refused(problem) => ReportStage::Collecting { problem: Some(problem) },
            Stage::Meshes(_) => ReportStage::Making(0.0),
            Stage::Making(_, part) => ReportStage::Making(*part),
            Stage::Done(report) => ReportStage::Done(report),
            Stage::Packing(_, packing) => {
                let (done, all) = packing.progress();
                ReportStage::Packing(done, all)
            }
        };
        ReportView { overview: &self.overview, stage }
    }

    /// Is something under way that ends by itself?
    pub fn is_busy(&self) -> bool {
        let is_at_work = matches!(self.stage, Stage::Meshes(_) | Stage::Making(..) | Stage::Packing(..));
        is_at_work || !self.waiting.is_empty() || !self.arrived.borrow().is_empty()
    }

    fn take(&mut self, files: Files) {
        // With more files it is another report.
        self.stage = Stage::Collecting;
        for file in files {
            match file {
                Ok(file) => {
                    let file = NamedFile { name: file.name, bytes: file.bytes.into() };
                    self.waiting.push_back(Waiting::File(file));
                }
                Err(problem) => self.files.unreadable.push(problem),
            }
        }
        self.overview = Overview::of(&self.files);
    }

    fn read_next(&mut self, next: Waiting) {
        match next {
            Waiting::File(file) if file.bytes.starts_with(b"PK\x03\x04") => self.open_zip(&file),
            Waiting::File(file) => self.files.add_or_note(&file),
            Waiting::Packed(archive, path) => {
                let read = archive.borrow_mut().read(&path);
                match read {
                    Ok(bytes) => self.files.add_or_note(&NamedFile { name: path, bytes }),
                    Err(error) => self.files.unreadable.push(error.to_string()),
                }
            }
        }
    }

    fn open_zip(&mut self, file: &NamedFile) {
        let opened = Archive::open(file.bytes.clone()).and_then(|mut archive| {
            let paths: Vec<String> = archive.listing(&file.name)?.paths().map(str::to_owned).collect();
            Ok((Rc::new(RefCell::new(archive)), paths))
        });
        match opened {
            Ok((archive, paths)) => {
                for path in paths.into_iter().rev() {
                    self.waiting.push_front(Waiting::Packed(archive.clone(), path));
                }
            }
            Err(error) => self.files.unreadable.push(format!("{}: {error}; it is left out", file.name)),
        }
    }

    /// Works for a moment; what comes of a download that has ended is a sentence.
    fn tick(&mut self, ctx: &egui::Context) -> Option<Result<String, String>> {
        let start_ms = platform::now_ms();
        let mut has_time = || platform::now_ms() - start_ms < SLICE_MS;
        if !self.waiting.is_empty() {
            ctx.request_repaint();
            while let Some(next) = self.waiting.pop_front() {
                self.read_next(next);
                if !has_time() {
                    break;
                }
            }
            self.overview = Overview::of(&self.files);
            return None;
        }
        let mut said = None;
        self.stage = match std::mem::take(&mut self.stage) {
            Stage::Meshes(options) => {
                ctx.request_repaint();
                match self.files.read_next_mesh() {
                    true => Stage::Meshes(options),
                    false => match gather(&self.files) {
                        Ok(input) => Stage::Making(Box::new(ReportJob::new(input, options, true)), 0.0),
                        Err(error) => Stage::Refused(error.to_string()),
                    },
                }
            }
            Stage::Making(mut job, _) => {
                ctx.request_repaint();
                match job.step(&mut has_time) {
                    ReportProgress::Working(part) => Stage::Making(job, part),
                    ReportProgress::Done(report) => Stage::Done(report),
                }
            }
            Stage::Packing(report, mut packing) => match packing.step(ctx, &mut has_time) {
                Ok(false) => Stage::Packing(report, packing),
                Ok(true) => {
                    let name = format!("{}.zip", name_of(&report));
                    said = Some(packing.finish(&name).map(|()| format!("The report is in {name}")));
                    Stage::Done(report)
                }
                Err(problem) => {
                    said = Some(Err(problem));
                    Stage::Done(report)
                }
            },
            other => other,
        };
        said
    }

    fn take_request(&mut self, request: ReportRequest) -> Result<(), String> {
        self.stage = match (std::mem::take(&mut self.stage), request) {
            (_, ReportRequest::StartOver) => {
                *self = Self { arrived: self.arrived.clone(), ..Self::default() };
                self.overview = Overview::of(&self.files);
                return Ok(());
            }
            (_, ReportRequest::Make(options)) => Stage::Meshes(options),
            (Stage::Packing(report, _), ReportRequest::Cancel) => Stage::Done(report),
            (_, ReportRequest::Cancel) => {
                self.waiting.clear();
                Stage::Collecting
            }
            (Stage::Done(_), ReportRequest::Back) => Stage::Collecting,
            (Stage::Done(report), ReportRequest::DownloadAll) => {
                let packing = Packing::new(&report, GENERATOR);
                Stage::Packing(report, Box::new(packing))
            }
            (Stage::Done(report), request) => {
                let page = report.page(GENERATOR);
                let name = format!("{}.html", name_of(&report));
                self.stage = Stage::Done(report);
                return match request {
                    ReportRequest::Open => platform::show_page(&page),
                    ReportRequest::DownloadPage => platform::download(&name, page.as_bytes()),
                    _ => Ok(()),
                };
            }
            (stage, _) => stage,
        };
        Ok(())
    }
}

fn name_of(report: &Report) -> String {
    format!("{}_report", safe_file_name(&report.analysis.title))
}

impl PinPose {
    pub(super) fn show_report(&mut self) {
        self.reporting.overview = Overview::of(&self.reporting.files);
        self.ui_state.report_dialog.show();
    }

    /// Makes at once the report of files that are at hand.
    pub(super) fn report_of(&mut self, files: ReportFiles) {
        let arrived = self.reporting.arrived.clone();
        let stage = Stage::Meshes(ReportOptions::default());
        self.reporting = Reporting { arrived, files, stage, ..Reporting::default() };
        self.show_report();
        self.ctx.request_repaint();
    }

    /// Adds a file to those that a report is made of, and shows them.
    pub(super) fn add_to_report(&mut self, file: FileBytes) {
        self.ui_state.kept_dialog.close();
        self.reporting.take(vec![Ok(file)]);
        self.show_report();
        self.ctx.request_repaint();
    }

    pub(super) fn take_report_request(&mut self, request: ReportRequest) {
        self.ctx.request_repaint();
        if request == ReportRequest::AddFiles {
            let (arrived, ctx) = (self.reporting.arrived.clone(), self.ctx.clone());
            platform::pick_files(&["json", "zip"], move |files| {
                arrived.borrow_mut().push((files, From::Dialog));
                ctx.request_repaint();
            });
        } else if let Err(problem) = self.reporting.take_request(request) {
            self.notify(Notice::error(problem));
        }
    }

    /// Once a frame.
    pub(super) fn tick_reporting(&mut self) {
        let arrived = std::mem::take(&mut *self.reporting.arrived.borrow_mut());
        for (files, from) in arrived {
            let is_for_report = from == From::Dialog
                || self.ui_state.report_dialog.is_open()
                || files.iter().flatten().any(|file| is_of_report(&file.bytes));
            if is_for_report {
                self.reporting.take(files);
                self.show_report();
                self.ctx.request_repaint();
            } else {
                self.loading.arrive(Arrival::of_files(files));
            }
        }
        match self.reporting.tick(&self.ctx) {
            Some(Ok(said)) => self.notify(Notice::info(said)),
            Some(Err(problem)) => self.notify(Notice::error(problem)),
            None => {}
        }
    }

    /// Files are the report's while it is open; result files open it. Others are left to who comes after.
    pub(super) fn take_dropped_results(&mut self, ctx: &egui::Context) {
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        let is_open = self.ui_state.report_dialog.is_open();
        let may_be_results = dropped.iter().any(|file| {
            file.path().extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
        });
        #[cfg(not(target_arch = "wasm32"))]
        let may_be_results = may_be_results && !dropped.iter().any(|file| file.path().is_dir());
        if dropped.is_empty() || !(is_open || may_be_results) {
            return;
        }
        ctx.input_mut(|input| input.raw.dropped_files.clear());
        let (arrived, ctx) = (self.reporting.arrived.clone(), self.ctx.clone());
        platform::spawn(async move {
            let mut files = Vec::new();
            for file in dropped {
                let name = file.path().file_name().unwrap_or_default().to_string_lossy().into_owned();
                #[cfg(target_arch = "wasm32")]
                let bytes = file.bytes_async().await;
                #[cfg(not(target_arch = "wasm32"))]
                let bytes = file.bytes();
                let named = bytes.map(|bytes| FileBytes { name: name.clone(), bytes });
                files.push(named.map_err(|error| format!("{name}: {error}")));
            }
            arrived.borrow_mut().push((files, From::Drop));
            ctx.request_repaint();
        });
    }
}

/// Results or a truth: what nobody drops for a scene. What they are stands at their beginning.
fn is_of_report(bytes: &[u8]) -> bool {
    const HEAD: usize = 256;
    let head = String::from_utf8_lossy(bytes.get(..HEAD.min(bytes.len())).unwrap_or_default());
    head.contains("\"pinpose-study-results\"") || head.contains("\"pinpose-study-truth\"")
}

/// Texts as the bytes of a file.
fn named(path: String, text: String) -> NamedFile {
    NamedFile { name: path, bytes: Arc::from(text.into_bytes()) }
}
