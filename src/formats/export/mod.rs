//! A scene as files for others: poses in any convention, BOP datasets, masks and other pictures.
//!
//! Pure: a scene and options in, named files out, one after the other, so that an archive can be streamed with progress and
//! be given up half-way.

mod bop;
mod boxes;
mod convention;
mod meshes;
mod names;
mod npy;
mod options;
mod paths;
mod pictures;
mod plan;
mod poses;
mod readme;
mod steps;
mod stream;

use std::collections::BTreeSet;
use std::sync::Arc;

use thiserror::Error;

use super::{Document, NamedFile, ViewSettings};
use crate::raster::{MeasuredDepth, Silhouette, silhouettes};
use crate::scene::{PhotoId, Scene};
use pictures::{PhotoPictures, PictureKind};
use plan::{Plan, raster_items};
use steps::{Step, steps};

pub use convention::{CameraAxes, Convention, LengthUnit, PoseDirection};
pub use names::safe_file_name;
pub use npy::write_npy;
pub use options::{ExportOptions, ExportPart, PhotoChoice};
pub use pictures::PICTURES_SCHEMA;
pub use poses::POSES_SCHEMA;
pub use stream::ZipStream;

/// The Python script that comes with poses and projects meshes with NumPy.
pub const PROJECT_SCRIPT: &str = include_str!("project.py");

/// A file that could not be made; the others can.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct ExportError(String);

/// One file of an export.
#[derive(Debug, Clone)]
pub enum Exported {
    File(NamedFile),
    /// A picture that only a renderer can make.
    Overlay(OverlayRequest),
}

/// A photo of [`ExportJob::scene`] with its objects over it, as PNG at the photo's resolution.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OverlayRequest {
    pub photo: PhotoId,
    /// Of the file that it is to become.
    pub path: String,
}

/// An export under way: an iterator over its files, in an order in which they can be streamed. Names are paths with `/`.
#[derive(Debug)]
pub struct ExportJob {
    plan: Plan,
    document: Document,
    steps: std::vec::IntoIter<Step>,
    total: usize,
    /// Of the photo that was worked on last.
    silhouettes: Option<(usize, Arc<[Silhouette]>)>,
    pictures: Vec<PhotoPictures>,
    bop: bop::Records,
}

impl ExportJob {
    /// Plans the export; nothing is drawn or encoded yet. The scene is a snapshot: what changes afterwards plays no part.
    pub fn new(scene: &Scene, view: &ViewSettings, options: ExportOptions) -> Self {
        let plan = Plan::new(scene.clone(), options);
        let document = Document::from_scene(&plan.scene, view, plan.options.keep);
        let steps = steps(&plan);
        let bop = bop::Records::new(&plan);
        Self {
            total: steps.len(),
            steps: steps.into_iter(),
            silhouettes: None,
            pictures: Vec::new(),
            bop,
            document,
            plan,
        }
    }

    /// What is exported, as it was when the export began.
    pub fn scene(&self) -> &Scene {
        &self.plan.scene
    }

    /// How many files there are in all.
    pub fn total(&self) -> usize {
        self.total
    }

    /// How many of them have been made, or have failed.
    pub fn done(&self) -> usize {
        self.total - self.steps.len()
    }

    /// How many poses are exported.
    pub fn pose_count(&self) -> usize {
        let photos = self.plan.photos.iter().filter_map(|planned| self.plan.photo(planned));
        photos.map(|photo| self.plan.placed(photo).len()).sum()
    }

    /// What the chosen formats cannot hold, in sentences.
    pub fn warnings(&self) -> Vec<String> {
        let plan = &self.plan;
        let has = |part: ExportPart| plan.options.parts.contains(&part);
        let mut without_textures: BTreeSet<&str> = BTreeSet::new();
        if has(ExportPart::Meshes) {
            without_textures.extend(plan.textures_lost(plan.meshes.iter().zip(0..)));
        }
        let mut warnings = Vec::new();
        if has(ExportPart::Bop) {
            let models = plan.models.iter().map(|model| (&model.mesh, model.object));
            without_textures.extend(plan.textures_lost(models));
            warnings.extend(bop::warnings(plan));
        }
        let lost = without_textures
            .into_iter()
            .map(|name| format!("{name}: the mesh is written without its texture"));
        warnings.extend(lost);
        warnings
    }

    /// The masks of what is placed in a photo, in the order of [`Plan::placed`]; kept until another photo's are asked for.
    fn silhouettes(&mut self, photo_index: usize) -> Arc<[Silhouette]> {
        if let Some((index, known)) = &self.silhouettes
            && *index == photo_index
        {
            return known.clone();
        }
        let photo = self.plan.photos.get(photo_index).and_then(|planned| self.plan.photo(planned));
        let found: Arc<[Silhouette]> = photo.map_or_else(Arc::default, |photo| {
            let items = raster_items(&self.plan.placed(photo));
            let depth_mm = self.plan.depth_mm(photo);
            let delta_mm = self.plan.options.visibility_delta_mm;
            let depth = depth_mm.as_deref().map(|mm| MeasuredDepth { mm, delta_mm });
            silhouettes(&photo.camera, &items, depth).into()
        });
        self.silhouettes = Some((photo_index, found.clone()));
        found
    }
}

impl Iterator for ExportJob {
    type Item = Result<Exported, ExportError>;

    fn next(&mut self) -> Option<Self::Item> {
        let step = self.steps.next()?;
        let made = match step {
            Step::Picture(PictureKind::Overlay, photo, _) => self.overlay(photo).map(Exported::Overlay),
            _ => self
                .make(step)
                .map(|(name, bytes)| Exported::File(NamedFile { name, bytes: Arc::from(bytes) })),
        };
        Some(made.map_err(ExportError))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.steps.size_hint()
    }
}
