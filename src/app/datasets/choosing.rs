//! A data set that was recognised and waits for the user's choices; the small files that say what is in it are read meanwhile.

use std::collections::BTreeSet;

use super::opening::Opening;
use super::reading::{Reading, Source};
use crate::formats::PosesAs;
use crate::formats::dataset::{Contents, Dataset, Recognised};
use crate::platform::PageReply;
use crate::ui::{DatasetRequest, DatasetView};

/// More depth maps or masks are read only if they are asked for: they would take longer than the photos.
const MOST_UNASKED: usize = 2000;

pub struct Choosing {
    pub recognised: Recognised,
    source: Source,
    chosen: BTreeSet<usize>,
    /// What was read of the small files; those that could not be are not in it.
    contents: Contents,
    tried: BTreeSet<String>,
    problems: Vec<String>,
    reading: Option<Reading>,
    /// What the chosen parts hold.
    dataset: Option<Result<Dataset, String>>,
    poses_as: Option<PosesAs>,
    /// `None`: as many as there are may be.
    depth_maps: Option<bool>,
    masks: Option<bool>,
    opens_by_itself: bool,
    /// Waits until it is open.
    pub reply: Option<PageReply>,
}

impl Choosing {
    /// With the first part chosen. If it was said what poses are to be, nobody is asked.
    pub fn new(
        recognised: Recognised,
        source: Source,
        poses_as: Option<PosesAs>,
        reply: Option<PageReply>,
        ctx: &egui::Context,
    ) -> Self {
        let mut choosing = Self {
            recognised,
            source,
            chosen: BTreeSet::from([0]),
            contents: Contents::new(),
            tried: BTreeSet::new(),
            problems: Vec::new(),
            reading: None,
            dataset: None,
            poses_as: Some(poses_as.unwrap_or(PosesAs::Annotations)),
            depth_maps: None,
            masks: None,
            opens_by_itself: poses_as.is_some(),
            reply,
        };
        choosing.read_needed(ctx);
        choosing
    }

    pub fn opens_by_itself(&self) -> bool {
        self.opens_by_itself
    }

    pub fn is_reading(&self) -> bool {
        self.reading.is_some()
    }

    /// Once a frame; true in the one in which it became known what the chosen parts hold.
    pub fn advance(&mut self, ctx: &egui::Context) -> bool {
        let Some(reading) = &self.reading else { return false };
        for (path, read) in reading.take() {
            match read {
                Ok(bytes) => drop(self.contents.insert(path, bytes)),
                Err(problem) => self.problems.push(format!("{path}: {problem}")),
            }
        }
        if !reading.is_done() {
            return false;
        }
        self.reading = None;
        let chosen: Vec<usize> = self.chosen.iter().copied().collect();
        let read = self.recognised.interpret(&chosen, &self.contents).map_err(|error| error.to_string());
        self.dataset = Some(read.map(|mut dataset| {
            dataset.missing.extend(self.problems.iter().cloned());
            dataset
        }));
        ctx.request_repaint();
        true
    }

    pub fn change(&mut self, request: DatasetRequest, ctx: &egui::Context) {
        match request {
            DatasetRequest::Choose(chosen) => {
                self.chosen = chosen;
                self.read_needed(ctx);
            }
            DatasetRequest::PosesAs(poses_as) => self.poses_as = poses_as,
            DatasetRequest::DepthMaps(wanted) => self.depth_maps = Some(wanted),
            DatasetRequest::Masks(wanted) => self.masks = Some(wanted),
            DatasetRequest::Open | DatasetRequest::Cancel => {}
        }
    }

    /// Reads what is needed to say what the chosen parts hold, and was not read before.
    fn read_needed(&mut self, ctx: &egui::Context) {
        self.dataset = None;
        self.reading = None;
        if self.chosen.is_empty() {
            return;
        }
        // What was begun and dropped is begun anew.
        self.tried.retain(|path| self.contents.contains_key(path));
        let chosen: Vec<usize> = self.chosen.iter().copied().collect();
        let needed = self.recognised.needed(&chosen);
        let new: Vec<String> = needed.into_iter().filter(|path| self.tried.insert(path.clone())).collect();
        self.problems.clear();
        self.reading = Some(Reading::new(self.source.clone(), new, ctx));
    }

    /// The data set without what is not wanted, on its way in.
    pub fn begin_opening(&mut self, ctx: &egui::Context) -> Result<Opening, String> {
        let (with_depth_maps, with_masks) = (self.with_depth_maps(), self.with_masks());
        let mut dataset = match &self.dataset {
            Some(Ok(dataset)) => dataset.clone(),
            Some(Err(problem)) => return Err(problem.clone()),
            None => return Err("it is still being read".to_owned()),
        };
        for photo in &mut dataset.photos {
            photo.depth = photo.depth.take().filter(|_| with_depth_maps);
            if !with_masks {
                photo.masks.clear();
            }
        }
        Ok(Opening::new(dataset, self.poses_as, self.source.clone(), ctx))
    }

    pub fn view(&self, progress: Option<(usize, usize)>) -> DatasetView<'_> {
        DatasetView {
            recognised: &self.recognised,
            chosen: &self.chosen,
            dataset: self.dataset.as_ref().map(|read| read.as_ref().map_err(String::as_str)),
            poses_as: self.poses_as,
            with_depth_maps: self.with_depth_maps(),
            with_masks: self.with_masks(),
            progress,
        }
    }

    fn with_depth_maps(&self) -> bool {
        let count = |dataset: &Dataset| dataset.photos.iter().filter(|photo| photo.depth.is_some()).count();
        self.depth_maps.unwrap_or_else(|| self.known().map_or(0, count) <= MOST_UNASKED)
    }

    fn with_masks(&self) -> bool {
        let count = |dataset: &Dataset| dataset.photos.iter().map(|photo| photo.masks.len()).sum::<usize>();
        self.masks.unwrap_or_else(|| self.known().map_or(0, count) <= MOST_UNASKED)
    }

    fn known(&self) -> Option<&Dataset> {
        self.dataset.as_ref().and_then(|read| read.as_ref().ok())
    }
}
