//! A study on its way in: `study.json` or a zip, its files one after the other, and what the worker makes of them.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::{Participating, Ready, State};
use crate::app::jobs::{Done, JobKind};
use crate::app::loading::Loading as Jobs;
use crate::platform::{self, EXAMPLE_STUDY_PATH, Saved};
use crate::scene::{MeshAsset, PhotoAsset};
use crate::study::pack::{STUDY_NAME, StudyFiles};
use crate::study::{Asset, Participation, framed_mesh};

/// What has come since the last frame.
pub enum Arrived {
    Zip(Result<Vec<u8>, String>),
    Json(Result<Vec<u8>, String>),
    File(Asset, Result<Vec<u8>, String>),
    Kept(Option<Saved>),
}

/// How far a study has come.
#[derive(Default)]
pub struct Loading {
    files: Option<StudyFiles>,
    photos: BTreeMap<String, Arc<PhotoAsset>>,
    meshes: BTreeMap<String, Arc<MeshAsset>>,
    /// Files are with the worker.
    is_reading: bool,
    /// Photos and meshes that the worker has not read yet.
    unread: usize,
}

impl Loading {
    fn of(files: StudyFiles) -> Self {
        Self { files: Some(files), ..Self::default() }
    }

    /// Files that are done, of all that there are. Each is fetched and then read.
    pub fn progress(&self) -> (usize, usize) {
        let Some(files) = &self.files else { return (0, 0) };
        let fetched = files.study.assets().len();
        let read = files.study.photos.len() + files.study.objects.len();
        let missing = files.missing().len();
        let unread = if self.is_reading { self.unread } else { read };
        (fetched + read - missing - unread, fetched + read)
    }
}

/// Where a study is: a zip, or a folder with `study.json`.
fn address(study: &str) -> (String, bool) {
    if study == "example" {
        return (EXAMPLE_STUDY_PATH.to_owned(), true);
    }
    // What follows a question mark is the server's business.
    let path = study.split(['?', '#']).next().unwrap_or(study);
    if path.to_lowercase().ends_with(".zip") {
        return (study.to_owned(), true);
    }
    if path.to_lowercase().ends_with(".json") {
        return (study.to_owned(), false);
    }
    (format!("{}/{STUDY_NAME}", study.trim_end_matches('/')), false)
}

impl Participating {
    /// Fetches the study that the link names.
    pub(super) fn fetch_study(&mut self) {
        self.state = State::Loading(Box::default());
        let Some(link) = &self.link else { return };
        let (url, is_zip) = address(&link.study);
        let (arrived, ctx) = (self.arrived.clone(), self.ctx.clone());
        platform::spawn(async move {
            let bytes = platform::fetch(&url).await;
            let came = if is_zip { Arrived::Zip(bytes) } else { Arrived::Json(bytes) };
            arrived.borrow_mut().push_back(came);
            ctx.request_repaint();
        });
    }

    pub(super) fn load_kept(&self, id: &platform::SceneId) {
        let (arrived, ctx) = (self.arrived.clone(), self.ctx.clone());
        let (storage, id) = (self.storage.clone(), id.clone());
        platform::spawn(async move {
            // What cannot be read is none: the participant begins.
            let mut kept = storage.load(&id).await.unwrap_or_default();
            // What was put aside when the page went is newer than what was stored before.
            if let Some(journal) = storage.read_journal(&id) {
                let stored_ms = kept.as_ref().map_or(0.0, |kept| kept.heading.changed_at_ms);
                if journal.changed_at_ms > stored_ms {
                    kept = Some(Saved { json: journal.json, ..kept.unwrap_or_default() });
                }
            }
            arrived.borrow_mut().push_back(Arrived::Kept(kept));
            ctx.request_repaint();
        });
    }

    pub(super) fn take_zip(&mut self, zip: Arc<[u8]>) {
        match StudyFiles::from_zip(zip) {
            Ok(files) => self.state = State::Loading(Box::new(Loading::of(files))),
            Err(error) => self.fail(format!("The study cannot be read: {error}"), false),
        }
    }

    pub(super) fn tick_arriving(&mut self, jobs: &mut Jobs) {
        loop {
            let arrived = self.arrived.borrow_mut().pop_front();
            match arrived {
                Some(arrived) => self.take_arrived(arrived),
                None => break,
            }
        }
        let State::Loading(loading) = &mut self.state else { return };
        let result = loading.advance(jobs);
        match result {
            Ok(false) => {}
            Ok(true) => {
                let Loading { files, photos, meshes, .. } = std::mem::take(&mut **loading);
                if let Some(files) = files {
                    self.begin(Ready { files, photos, meshes });
                }
            }
            Err(problem) => self.fail(problem, false),
        }
    }

    fn take_arrived(&mut self, arrived: Arrived) {
        match arrived {
            Arrived::Zip(Ok(bytes)) => self.take_zip(bytes.into()),
            Arrived::Json(Ok(bytes)) => match StudyFiles::from_json(&bytes) {
                Ok(files) => {
                    let missing = files.missing();
                    self.state = State::Loading(Box::new(Loading::of(files)));
                    self.fetch_files(missing);
                }
                Err(error) => self.fail(format!("The study cannot be read: {error}"), false),
            },
            Arrived::File(asset, Ok(bytes)) => {
                let State::Loading(loading) = &mut self.state else { return };
                let added = loading.files.as_mut().map(|files| files.add(&asset, bytes.into()));
                if let Some(Err(error)) = added {
                    self.fail(error.to_string(), true);
                }
            }
            Arrived::Zip(Err(problem)) | Arrived::Json(Err(problem)) | Arrived::File(_, Err(problem)) => {
                self.fail(format!("A file of the study did not come: {problem}"), true);
            }
            Arrived::Kept(saved) => {
                self.run(saved.and_then(|saved| Participation::from_json(&saved.json)));
            }
        }
    }

    /// One after the other: a slow line is not made faster by more at once, and the first problem ends it.
    fn fetch_files(&self, missing: Vec<Asset>) {
        let Some(link) = &self.link else { return };
        let (url, _) = address(&link.study);
        let folder = url.rsplit_once('/').map_or(String::new(), |(folder, _)| format!("{folder}/"));
        let (arrived, ctx) = (self.arrived.clone(), self.ctx.clone());
        platform::spawn(async move {
            for asset in missing {
                let bytes = platform::fetch(&format!("{folder}{}", asset.path)).await;
                let is_problem = bytes.is_err();
                arrived.borrow_mut().push_back(Arrived::File(asset, bytes));
                ctx.request_repaint();
                if is_problem {
                    return;
                }
            }
        });
    }
}

impl Loading {
    /// True once every file is there and read.
    fn advance(&mut self, jobs: &mut Jobs) -> Result<bool, String> {
        let Some(files) = &self.files else { return Ok(false) };
        if !files.missing().is_empty() {
            return Ok(false);
        }
        if !self.is_reading {
            self.is_reading = true;
            self.unread = submit(files, jobs);
        }
        for (path, done) in jobs.take_for_study() {
            self.unread = self.unread.saturating_sub(1);
            let named = |problem: String| format!("{path}: {problem}");
            match done.map_err(named)? {
                Done::Mesh(mesh, _) => {
                    self.meshes.insert(path, mesh);
                }
                Done::Headers(photos) => {
                    if let Some(photo) = photos.into_iter().next() {
                        let photo = photo.map_err(named)?;
                        self.photos.insert(path, photo);
                    }
                }
                _ => {}
            }
        }
        if self.unread > 0 {
            return Ok(false);
        }
        self.frame_meshes()?;
        Ok(true)
    }

    /// From the meshes of files to those of objects, each in its frame.
    fn frame_meshes(&mut self) -> Result<(), String> {
        let Some(files) = &self.files else { return Ok(()) };
        let mut framed = BTreeMap::new();
        for object in &files.study.objects {
            let loaded = self.meshes.get(&object.id).ok_or_else(|| format!("{}: no mesh", object.name))?;
            let mesh = framed_mesh(&files.study, &object.id, loaded).map_err(|error| error.to_string())?;
            framed.insert(object.id.clone(), mesh);
        }
        self.meshes = framed;
        Ok(())
    }
}

/// Gives the worker every mesh by its object's id, and every photo by its own.
fn submit(files: &StudyFiles, jobs: &mut Jobs) -> usize {
    let mut count = 0;
    for photo in &files.study.photos {
        if let Some(file) = files.file(&photo.asset) {
            jobs.read_for_study(JobKind::Headers, &photo.id, file, &[]);
            count += 1;
        }
    }
    for object in &files.study.objects {
        let companions: Vec<_> = object.companions.iter().filter_map(|asset| files.file(asset)).collect();
        if let Some(file) = files.file(&object.mesh) {
            jobs.read_for_study(JobKind::Mesh, &object.id, file, &companions);
            count += 1;
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::address;

    #[test]
    fn a_study_is_a_zip_a_json_or_a_folder() {
        assert_eq!(address("example"), (EXAMPLE.to_owned(), true));
        assert_eq!(address("https://a.org/s.ZIP?x=1"), ("https://a.org/s.ZIP?x=1".to_owned(), true));
        assert_eq!(address("s/study.json"), ("s/study.json".to_owned(), false));
        assert_eq!(address("s/"), ("s/study.json".to_owned(), false));
    }

    const EXAMPLE: &str = super::EXAMPLE_STUDY_PATH;
}
