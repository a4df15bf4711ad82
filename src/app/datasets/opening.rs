//! A data set that is being opened: its files read, images known by their headers, meshes parsed, all by another thread.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

use super::reading::{Read, Reading, Source};
use crate::app::jobs::{Done, JobKind, Jobs, Urgency};
use crate::formats::dataset::{Dataset, DatasetMesh};
use crate::formats::{FileWithCompanions, NamedFile, PosesAs, with_companions};
use crate::math::sort_short;
use crate::scene::{MeshAsset, PhotoAsset};
use crate::session::DatasetImport;

/// Images that go to the other thread together. One by one they would wait for a frame each; too many at once would be in
/// memory twice.
const MOST_TOGETHER: usize = 32;
const MOST_BYTES_TOGETHER: usize = 16 << 20;

pub struct Opening {
    dataset: Dataset,
    poses_as: Option<PosesAs>,
    reading: Reading,
    /// Of its own: with a cancel it ends, and what it does with it.
    jobs: Jobs,
    jobs_left: usize,
    /// Files of meshes, until all of them are there.
    mesh_files: BTreeMap<String, Arc<[u8]>>,
    /// Paths of meshes and what may belong to them, not read yet.
    awaited: BTreeSet<String>,
    is_image: BTreeSet<String>,
    together: Vec<NamedFile>,
    /// Images that are with the other thread, by job.
    batches: HashMap<u64, Vec<NamedFile>>,
    images: HashMap<String, Arc<PhotoAsset>>,
    meshes: HashMap<String, Arc<MeshAsset>>,
    files_done: usize,
    file_count: usize,
    pub problems: Vec<String>,
    pub warnings: Vec<String>,
}

/// How far it is, in files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    pub done: usize,
    pub all: usize,
}

impl Opening {
    pub fn new(dataset: Dataset, poses_as: Option<PosesAs>, source: Source, ctx: &egui::Context) -> Self {
        let of_meshes: BTreeSet<String> = dataset.meshes.iter().flat_map(files_of).cloned().collect();
        let is_image: BTreeSet<String> = images_of(&dataset).cloned().collect();
        // Meshes first: they take longest.
        let images = images_of(&dataset).filter(|path| !of_meshes.contains(*path));
        let mut seen = BTreeSet::new();
        let paths: Vec<String> =
            of_meshes.iter().chain(images).filter(|path| seen.insert((*path).clone())).cloned().collect();
        Self {
            file_count: paths.len(),
            reading: Reading::new(source, paths, ctx),
            dataset,
            poses_as,
            jobs: Jobs::new(ctx),
            jobs_left: 0,
            mesh_files: BTreeMap::new(),
            awaited: of_meshes,
            is_image,
            together: Vec::new(),
            batches: HashMap::new(),
            images: HashMap::new(),
            meshes: HashMap::new(),
            files_done: 0,
            problems: Vec::new(),
            warnings: Vec::new(),
        }
    }

    pub fn progress(&self) -> Progress {
        Progress { done: self.files_done.min(self.file_count), all: self.file_count }
    }

    /// Once a frame; true when everything is there.
    pub fn advance(&mut self) -> bool {
        for read in self.reading.take() {
            self.take_read(read);
        }
        if self.reading.is_done() {
            self.send_images();
        }
        for (job, file, done) in self.jobs.poll() {
            self.jobs_left -= 1;
            let batch = self.batches.remove(&job).unwrap_or_default();
            if done.is_err() && batch.len() > 1 {
                // One of them made it crash: the others are not lost with it.
                batch.into_iter().for_each(|file| self.send_together(vec![file]));
            } else {
                self.take_done(&file, done);
            }
        }
        self.reading.is_done() && self.jobs_left == 0 && self.together.is_empty()
    }

    /// What was read, for the session.
    pub fn finish(&mut self) -> DatasetImport {
        sort_short(&mut self.problems, Ord::cmp);
        DatasetImport {
            dataset: self.dataset.clone(),
            images: std::mem::take(&mut self.images),
            meshes: std::mem::take(&mut self.meshes),
            poses_as: self.poses_as,
        }
    }

    fn take_read(&mut self, (path, read): Read) {
        let bytes = match read {
            Ok(bytes) => bytes,
            Err(problem) => {
                self.files_done += 1;
                // What comes out of a zip says by itself which file it is about.
                let is_named = problem.contains(&path);
                self.problems.push(if is_named { problem } else { format!("{path}: {problem}") });
                self.no_longer_awaited(&path);
                return;
            }
        };
        if self.is_image.contains(&path) {
            let bytes_together: usize = self.together.iter().map(|file| file.bytes.len()).sum();
            if self.together.len() >= MOST_TOGETHER || bytes_together + bytes.len() > MOST_BYTES_TOGETHER {
                self.send_images();
            }
            self.together.push(NamedFile { name: path.clone(), bytes: bytes.clone() });
        } else {
            self.files_done += 1;
        }
        if self.awaited.contains(&path) {
            self.mesh_files.insert(path.clone(), bytes);
            self.no_longer_awaited(&path);
        }
    }

    /// Meshes whose last file this was go to be parsed.
    fn no_longer_awaited(&mut self, path: &str) {
        if !self.awaited.remove(path) {
            return;
        }
        let is_complete = |mesh: &&DatasetMesh| files_of(mesh).all(|path| !self.awaited.contains(path));
        let has_it = |mesh: &&DatasetMesh| files_of(mesh).any(|file| file == path);
        let ready: Vec<DatasetMesh> =
            self.dataset.meshes.iter().filter(has_it).filter(is_complete).cloned().collect();
        for mesh in ready {
            self.send_mesh(&mesh);
        }
    }

    fn send_mesh(&mut self, mesh: &DatasetMesh) {
        let read =
            |path: &String| Some(NamedFile { name: path.clone(), bytes: self.mesh_files.get(path)?.clone() });
        let files: Vec<NamedFile> = files_of(mesh).filter_map(read).collect();
        // Which of the companions it asks for, its content says.
        let own = with_companions(files).into_iter().find(|candidate| candidate.file.name == mesh.path);
        if let Some(FileWithCompanions { file, companions }) = own {
            self.jobs.submit(JobKind::Mesh, file, &companions, Urgency::InTurn);
            self.jobs_left += 1;
        }
    }

    fn send_images(&mut self) {
        let files = std::mem::take(&mut self.together);
        self.send_together(files);
    }

    fn send_together(&mut self, files: Vec<NamedFile>) {
        let Some((first, others)) = files.split_first() else { return };
        let job = self.jobs.submit(JobKind::Headers, first.clone(), others, Urgency::InTurn);
        self.batches.insert(job, files);
        self.jobs_left += 1;
    }

    fn take_done(&mut self, file: &NamedFile, done: Result<Done, String>) {
        match done {
            Ok(Done::Headers(headers)) => {
                self.files_done += headers.len();
                for header in headers {
                    match header {
                        Ok(asset) => drop(self.images.insert(asset.file_name.clone(), asset)),
                        Err(problem) => self.problems.push(problem),
                    }
                }
            }
            Ok(Done::Mesh(asset, warnings)) => {
                self.warnings.extend(warnings.into_iter().map(|text| format!("{}: {text}", file.name)));
                self.meshes.insert(file.name.clone(), asset);
            }
            // Nothing else is asked for.
            Ok(_) => {}
            Err(problem) => self.problems.push(format!("{}: {problem}", file.name)),
        }
    }
}

/// A mesh's own path and those that may belong to it.
fn files_of(mesh: &DatasetMesh) -> impl Iterator<Item = &String> {
    std::iter::once(&mesh.path).chain(&mesh.companions)
}

fn images_of(dataset: &Dataset) -> impl Iterator<Item = &String> {
    dataset.photos.iter().flat_map(|photo| {
        let depth = photo.depth.iter().map(|depth| &depth.path);
        let masks = photo.masks.iter().map(|mask| &mask.path);
        std::iter::once(&photo.path).chain(depth).chain(masks)
    })
}
