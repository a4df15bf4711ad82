//! What is asked of the worker besides files that come in: pixels to show, thumbnails, meshes for the solvers.

use std::sync::Arc;

use super::Loading;
use crate::app::jobs::{Done, JobKind, Urgency, symmetries};
use crate::formats::NamedFile;
use crate::mesh::Mesh;
use crate::photo::{DepthPixels, Pixels};
use crate::scene::{CompanionFile, MeshAsset, PhotoAsset, Sha256};
use crate::solve::symmetry::FoundSymmetries;

/// A study's file by its path in it, and what was made of it.
pub type StudyFile = (String, Result<Done, String>);

impl Loading {
    /// Reads a mesh of a study, or the header of a photo.
    pub fn read_for_study(&mut self, kind: JobKind, path: &str, file: NamedFile, companions: &[NamedFile]) {
        let job = self.jobs.submit(kind, file, companions, Urgency::InTurn);
        self.study_jobs.insert(job, path.to_owned());
    }

    pub fn take_for_study(&mut self) -> Vec<StudyFile> {
        std::mem::take(&mut self.finished_for_study)
    }

    /// Decodes a photo of the scene that is to be shown.
    pub fn decode(&mut self, photo: &PhotoAsset) {
        self.jobs.submit(JobKind::Photo, file_of(photo), &[], Urgency::Next);
    }

    /// Decodes a photo that may be shown soon.
    pub fn decode_ahead(&mut self, photo: &PhotoAsset) {
        self.jobs.submit(JobKind::Photo, file_of(photo), &[], Urgency::InTurn);
    }

    pub fn make_thumbnail(&mut self, photo: &PhotoAsset) {
        let job = self.jobs.submit(JobKind::Thumbnail, file_of(photo), &[], Urgency::InTurn);
        self.thumbnails.insert(job, photo.sha256);
    }

    /// Decodes a depth map of the scene that is to be shown.
    pub fn decode_depth(&mut self, depth: &PhotoAsset) {
        let job = self.jobs.submit(JobKind::DepthMap, file_of(depth), &[], Urgency::Next);
        self.depth_jobs.insert(job, depth.sha256);
    }

    /// Makes of a mesh what the solvers look at: it comes as it is in the file, before any change of its frame.
    pub fn prepare_for_solvers(&mut self, mesh: &MeshAsset) {
        let file = NamedFile { name: mesh.file_name.clone(), bytes: mesh.bytes.clone() };
        let companion =
            |file: &CompanionFile| NamedFile { name: file.file_name.clone(), bytes: file.bytes.clone() };
        let companions: Vec<NamedFile> = mesh.companions.iter().map(companion).collect();
        let job = self.jobs.submit(JobKind::SolverMesh, file, &companions, Urgency::Next);
        self.solver_mesh_jobs.insert(job, mesh.sha256);
    }

    /// Looks for a mesh's symmetries.
    pub fn find_symmetries(&mut self, mesh: &Arc<MeshAsset>) {
        let job = self.jobs.submit(JobKind::Symmetries, symmetries::request(mesh), &[], Urgency::Next);
        self.symmetry_jobs.insert(job, mesh.clone());
    }

    /// Is a mesh on screen of which something still follows?
    pub fn is_finishing_mesh(&self) -> bool {
        self.jobs.is_finishing_mesh()
    }

    pub fn is_worker_idle(&self) -> bool {
        self.jobs.is_idle()
    }

    pub fn take_thumbnails(&mut self) -> Vec<(Sha256, Option<Pixels>)> {
        std::mem::take(&mut self.finished_thumbnails)
    }

    pub fn take_depth_maps(&mut self) -> Vec<(Sha256, Option<Arc<DepthPixels>>)> {
        std::mem::take(&mut self.finished_depths)
    }

    pub fn take_solver_meshes(&mut self) -> Vec<(Sha256, Option<Arc<Mesh>>)> {
        std::mem::take(&mut self.finished_solver_meshes)
    }

    pub fn take_symmetries(&mut self) -> Vec<(Arc<MeshAsset>, Option<FoundSymmetries>)> {
        std::mem::take(&mut self.finished_symmetries)
    }

    /// Takes what came of one of these jobs; gives it back if it was another one's.
    pub(super) fn take_side_job(
        &mut self,
        job: u64,
        done: Result<Done, String>,
    ) -> Option<Result<Done, String>> {
        if let Some(sha256) = self.thumbnails.remove(&job) {
            let made = if let Ok(Done::Thumbnail(pixels)) = done { Some(pixels) } else { None };
            self.finished_thumbnails.push((sha256, made));
        } else if let Some(sha256) = self.depth_jobs.remove(&job) {
            let read = if let Ok(Done::DepthMap(_, depth)) = done { Some(depth) } else { None };
            self.finished_depths.push((sha256, read));
        } else if let Some(sha256) = self.solver_mesh_jobs.remove(&job) {
            let made = if let Ok(Done::SolverMesh(mesh)) = done { Some(mesh) } else { None };
            self.finished_solver_meshes.push((sha256, made));
        } else if let Some(mesh) = self.symmetry_jobs.remove(&job) {
            let found = if let Ok(Done::Symmetries(found)) = done { Some(found) } else { None };
            self.finished_symmetries.push((mesh, found));
        } else if let Some(path) = self.study_jobs.remove(&job) {
            self.finished_for_study.push((path, done));
        } else {
            return Some(done);
        }
        None
    }
}

fn file_of(photo: &PhotoAsset) -> NamedFile {
    NamedFile { name: photo.file_name.clone(), bytes: photo.bytes.clone() }
}
