//! A study on its way in: `study.json` or a zip, its files one after the other, and what the worker makes of them.
//!
//! As soon as the texts can be shown, the participant reads; photos and meshes come meanwhile.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::words::Trouble;
use super::{Participating, Purpose, Ready, State, newest_kept};
use crate::app::jobs::{Done, JobKind};
use crate::app::loading::Loading as Jobs;
use crate::math::sort_short;
use crate::platform::{self, EXAMPLE_STUDY_PATH, FetchError, Saved};
use crate::study::pack::{STUDY_NAME, StudyFiles};
use crate::study::{Asset, Participation, Sample, framed_mesh};

/// What has come since the last frame.
pub enum Arrived {
    Zip(Result<Vec<u8>, FetchError>),
    Json(Result<Vec<u8>, FetchError>),
    File(Asset, Result<Vec<u8>, FetchError>),
    Kept(Option<Saved>),
    /// Another tab of this browser has the participation.
    IsElsewhere,
}

/// A study's zip may have so many bytes: the most that a browser gives a page without trouble.
const MOST_ZIP_BYTES: u64 = 1 << 30;
/// And `study.json`, which is text.
const MOST_JSON_BYTES: u64 = 32 << 20;

/// A file that did not come, while there is something to do without it, is asked for again after this time.
const REFETCH_MS: f64 = 4000.0;

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
        self.state = State::Loading(None);
        self.refetch_at_ms = None;
        let Some(link) = &self.link else { return };
        let (url, is_zip) = address(&link.study);
        let (arrived, ctx) = (self.arrived.clone(), self.ctx.clone());
        platform::spawn(async move {
            let most = if is_zip { MOST_ZIP_BYTES } else { MOST_JSON_BYTES };
            let bytes = platform::fetch(&url, most).await;
            let came = if is_zip { Arrived::Zip(bytes) } else { Arrived::Json(bytes) };
            arrived.borrow_mut().push_back(came);
            ctx.request_repaint();
        });
    }

    pub(super) fn load_kept(&self, id: &platform::SceneId) {
        let (arrived, ctx) = (self.arrived.clone(), self.ctx.clone());
        let (storage, id) = (self.storage.clone(), id.clone());
        platform::spawn(async move {
            // Two tabs would each write over what the other one has kept. Where a browser cannot tell, there is one.
            let came = match storage.claim(&id).await.unwrap_or(true) {
                true => Arrived::Kept(newest_kept(&*storage, &id).await),
                false => Arrived::IsElsewhere,
            };
            arrived.borrow_mut().push_back(came);
            ctx.request_repaint();
        });
    }

    pub(super) fn take_zip(&mut self, zip: Arc<[u8]>) {
        match StudyFiles::from_zip(zip) {
            Ok(files) => self.take_study(files),
            Err(error) => self.fail(Trouble::reading("the study's zip", &error)),
        }
    }

    /// `study.json` is here: what it says is shown, and its files are fetched.
    fn take_study(&mut self, files: StudyFiles) {
        self.title.clone_from(&files.study.title);
        self.contact.clone_from(&files.study.contact);
        let missing = files.missing();
        self.state = State::Loading(Some(Box::new(Ready::of(files))));
        self.fetch_files(missing);
    }

    pub(super) fn tick_arriving(&mut self, jobs: &mut Jobs, now_ms: f64) {
        loop {
            let arrived = self.arrived.borrow_mut().pop_front();
            match arrived {
                Some(arrived) => self.take_arrived(arrived, now_ms),
                None => break,
            }
        }
        self.refetch(now_ms);
        let Some(ready) = self.ready_mut() else { return };
        if let Err(problem) = ready.advance(jobs) {
            return self.fail(Trouble::of("This study was not put together correctly.", problem, false));
        }
        let is_complete = ready.is_complete();
        let can_begin = is_complete || ready.has_pictures();
        // What is watched or changed is shown whole; a participant reads meanwhile.
        let can_begin = can_begin && (is_complete || matches!(self.purpose, Purpose::TakePart));
        match &mut self.state {
            State::Loading(ready) if can_begin => {
                if let Some(ready) = ready.take() {
                    self.begin(*ready);
                }
            }
            // The clock of a trial that is gone on with runs: it is gone on with when it can be shown.
            State::LookingBack { kept, .. } if is_complete => {
                if let Some(kept) = kept.take() {
                    self.run(Some(*kept));
                }
            }
            State::Running(running) if running.can_go_on() => {
                running.enter(now_ms);
                self.turn_page();
            }
            _ => {}
        }
    }

    fn take_arrived(&mut self, arrived: Arrived, now_ms: f64) {
        let address = self.link.as_ref().map(|link| address(&link.study).0).unwrap_or_default();
        match arrived {
            Arrived::Zip(Ok(bytes)) => self.take_zip(bytes.into()),
            Arrived::Json(Ok(bytes)) => match StudyFiles::from_json(&bytes) {
                Ok(files) => self.take_study(files),
                Err(error) => self.fail(Trouble::reading(&address, &error)),
            },
            Arrived::File(asset, Ok(bytes)) => {
                let Some(ready) = self.ready_mut() else { return };
                if let Err(error) = ready.files.add(&asset, bytes.into()) {
                    self.fail(Trouble::reading(&asset.path, &error));
                }
            }
            Arrived::File(asset, Err(error)) => self.take_missing(&asset, &error, now_ms),
            Arrived::Zip(Err(error)) | Arrived::Json(Err(error)) => {
                self.fail(Trouble::fetching(&address, &error));
            }
            Arrived::IsElsewhere => {
                let text = "You have this study open in another tab or window of this browser. Please go on there. \
                    Or close it there, and then try again here: nothing of what you have done is lost.";
                self.fail(Trouble::of(text, "", true));
            }
            Arrived::Kept(saved) => {
                let kept = saved.and_then(|saved| Participation::from_json(&saved.json));
                match (kept, &mut self.state) {
                    (Some(found), State::LookingBack { kept, .. }) => *kept = Some(Box::new(found)),
                    _ => self.run(None),
                }
            }
        }
    }

    /// A file did not come. Who has something to do meanwhile is not told of a network that is gone for a moment.
    fn take_missing(&mut self, asset: &Asset, error: &FetchError, now_ms: f64) {
        let is_waited_for = match &self.state {
            State::Running(running) => running.waits,
            _ => true,
        };
        let may_pass = matches!(error, FetchError::Unreachable(_) | FetchError::Status(500..));
        match may_pass && !is_waited_for {
            true => self.refetch_at_ms = Some(now_ms + REFETCH_MS),
            false => self.fail(Trouble::fetching(&asset.path, error)),
        }
    }

    fn refetch(&mut self, now_ms: f64) {
        let Some(at_ms) = self.refetch_at_ms else { return };
        if now_ms < at_ms {
            let wait = std::time::Duration::from_secs_f64((at_ms - now_ms) / 1000.0);
            return self.ctx.request_repaint_after(wait);
        }
        self.refetch_at_ms = None;
        if let Some(ready) = self.ready() {
            self.fetch_files(ready.files.missing());
        }
    }

    /// One after the other: a slow line is not made faster by more at once, and the first problem ends it.
    fn fetch_files(&self, mut missing: Vec<Asset>) {
        let (Some(link), Some(study)) = (&self.link, self.ready().map(|ready| &ready.files.study)) else {
            return;
        };
        // Texts are read first, and practice comes before the rest.
        let practice: BTreeSet<&str> = study
            .practice
            .iter()
            .flat_map(|one| [one.sample.photo.as_str(), one.sample.object.as_str()])
            .collect();
        let of_practice: BTreeSet<&str> = study
            .photos
            .iter()
            .filter(|photo| practice.contains(photo.id.as_str()))
            .map(|photo| photo.asset.path.as_str())
            .chain(
                study
                    .objects
                    .iter()
                    .filter(|object| practice.contains(object.id.as_str()))
                    .flat_map(|object| std::iter::once(&object.mesh).chain(&object.companions))
                    .map(|asset| asset.path.as_str()),
            )
            .collect();
        let pictures = &study.texts.pictures;
        let rank = |path: &str| match pictures.iter().any(|picture| picture.path == path) {
            true => 0,
            false => 1 + u8::from(!of_practice.contains(path)),
        };
        sort_short(&mut missing, |a, b| rank(&a.path).cmp(&rank(&b.path)));
        let (url, _) = address(&link.study);
        let folder = url.rsplit_once('/').map_or(String::new(), |(folder, _)| format!("{folder}/"));
        let (arrived, ctx) = (self.arrived.clone(), self.ctx.clone());
        platform::spawn(async move {
            for asset in missing {
                // What has more bytes than the study says is not the file that it speaks of.
                let bytes = platform::fetch(&format!("{folder}{}", asset.path), asset.bytes).await;
                let is_problem = bytes.is_err();
                arrived.borrow_mut().push_back(Arrived::File(asset, bytes));
                ctx.request_repaint();
                if is_problem {
                    return;
                }
            }
        });
    }

    /// The study with what has come of it.
    pub(super) fn ready(&self) -> Option<&Ready> {
        match &self.state {
            State::Loading(ready) => ready.as_deref(),
            State::AskId(ready) | State::LookingBack { ready, .. } => Some(ready),
            State::Running(running) => Some(&running.ready),
            State::Problem(_) | State::Watching(_) | State::ToChange(_) => None,
        }
    }

    fn ready_mut(&mut self) -> Option<&mut Ready> {
        match &mut self.state {
            State::Loading(ready) => ready.as_deref_mut(),
            State::AskId(ready) | State::LookingBack { ready, .. } => Some(ready),
            State::Running(running) => Some(&mut running.ready),
            State::Problem(_) | State::Watching(_) | State::ToChange(_) => None,
        }
    }
}

impl Ready {
    fn of(files: StudyFiles) -> Self {
        Self { files, photos: BTreeMap::new(), meshes: BTreeMap::new(), submitted: BTreeSet::new() }
    }

    /// Files that are done, of all that there are. Each is fetched and then read.
    pub fn progress(&self) -> (usize, usize) {
        let study = &self.files.study;
        let fetched = study.assets().len();
        let to_read = study.photos.len() + study.objects.len();
        let done = fetched - self.files.missing().len() + self.photos.len() + self.meshes.len();
        (done, fetched + to_read)
    }

    pub fn is_complete(&self) -> bool {
        let study = &self.files.study;
        self.photos.len() == study.photos.len()
            && self.meshes.len() == study.objects.len()
            && self.has_pictures()
    }

    /// All that the texts show is here.
    fn has_pictures(&self) -> bool {
        self.files.study.texts.pictures.iter().all(|picture| self.files.has(picture))
    }

    /// A sample can be shown.
    pub fn has(&self, sample: &Sample) -> bool {
        self.photos.contains_key(&sample.photo) && self.meshes.contains_key(&sample.object)
    }

    /// Gives the worker what has come, and takes what it has read.
    fn advance(&mut self, jobs: &mut Jobs) -> Result<(), String> {
        self.submit(jobs);
        for (id, done) in jobs.take_for_study() {
            let named = |problem: String| format!("{id}: {problem}");
            match done.map_err(named)? {
                Done::Mesh(mesh, _) => {
                    let framed =
                        framed_mesh(&self.files.study, &id, &mesh).map_err(|error| error.to_string())?;
                    self.meshes.insert(id, framed);
                }
                Done::Headers(photos) => {
                    if let Some(photo) = photos.into_iter().next() {
                        let photo = photo.map_err(named)?;
                        self.photos.insert(id, photo);
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Every mesh goes by its object's id, and every photo by its own.
    fn submit(&mut self, jobs: &mut Jobs) {
        for photo in &self.files.study.photos {
            if let Some(file) = self.files.file(&photo.asset)
                && self.submitted.insert(format!("photo {}", photo.id))
            {
                jobs.read_for_study(JobKind::Headers, &photo.id, file, &[]);
            }
        }
        for object in &self.files.study.objects {
            let companions: Vec<_> =
                object.companions.iter().filter_map(|asset| self.files.file(asset)).collect();
            if companions.len() == object.companions.len()
                && let Some(file) = self.files.file(&object.mesh)
                && self.submitted.insert(format!("object {}", object.id))
            {
                jobs.read_for_study(JobKind::Mesh, &object.id, file, &companions);
            }
        }
    }
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
