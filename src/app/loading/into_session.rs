//! Files that were dropped, and complete loads on their way into the session.

use std::sync::Arc;

use super::{Arrival, ImagesAs, Load, Origin};
use crate::app::PinPose;
use crate::formats::Document;
use crate::platform::{self, FileBytes, Loaded, PageAnswer};
use crate::scene::{PhotoAsset, Sha256};
use crate::session::{Batch, Command, Notice, Opening};

impl PinPose {
    /// Files dropped on the window.
    pub(in crate::app) fn take_dropped(&mut self, ctx: &egui::Context) {
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        // A window gives folders as it gives files; a page hears of them before.
        #[cfg(not(target_arch = "wasm32"))]
        let dropped: Vec<_> =
            dropped.into_iter().filter(|file| !self.take_dropped_folder(file.path())).collect();
        if dropped.is_empty() {
            return;
        }
        let arrive = self.loading.begin_reading();
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
            arrive(Arrival::of_files(files));
        });
    }

    /// True if it was one.
    #[cfg(not(target_arch = "wasm32"))]
    fn take_dropped_folder(&mut self, path: &std::path::Path) -> bool {
        if !path.is_dir() {
            return false;
        }
        match platform::open_folder(path) {
            Ok(tree) => self.take_folder(tree),
            Err(problem) => self.notify(Notice::error(problem)),
        }
        true
    }

    /// Takes the pixels that are to be shown; whatever else is loaded stays out of a study.
    pub(in crate::app) fn take_decoded(&mut self) {
        let (decoded, complete) = self.loading.poll(false);
        for (sha256, pixels) in decoded {
            self.photos.insert(sha256, pixels);
        }
        for reply in complete.into_iter().filter_map(|load| load.reply) {
            // Who asked may be gone.
            reply.send(Err("files cannot be loaded in a study".to_owned())).ok();
        }
    }

    /// Gives complete loads to the session.
    pub(in crate::app) fn take_loaded(&mut self) {
        let (decoded, complete) = self.loading.poll(self.scenes.is_switching());
        for (sha256, pixels) in decoded {
            self.photos.insert(sha256, pixels);
        }
        for (sha256, pixels) in self.loading.take_thumbnails() {
            self.ui_state.thumbnails.insert(&self.ctx, sha256, pixels.as_ref());
        }
        for (sha256, depth) in self.loading.take_depth_maps() {
            self.depth_maps.insert(sha256, depth);
        }
        for mut load in complete {
            if load.is_of(Origin::Workspace) && !self.make_room(&mut load.has_asked_for_room) {
                self.loading.loads.push(load);
                continue;
            }
            load.sort();
            let masks = self.take_masks(&mut load);
            let depth = self.take_depth(&mut load);
            let restored = load.is_of(Origin::Storage);
            let lacks =
                load.opening.as_ref().map_or_else(Vec::new, |(document, _)| lacking(document, &load.batch));
            let command = match load.opening.take() {
                Some((document, _)) => Command::Open(Box::new(Opening {
                    document,
                    photos: load.batch.photos,
                    meshes: load.batch.meshes,
                    restored,
                })),
                None => Command::Import(Box::new(load.batch)),
            };
            if !matches!(&command, Command::Import(batch) if is_nothing(batch)) {
                self.apply(command);
            }
            if !masks.is_empty() {
                self.apply(Command::ImportMasks(masks));
            }
            if let Some(depth) = depth {
                self.apply(Command::ImportDepth(depth));
            }
            if restored {
                // What could not be read stays in storage: a change goes into a scene of its own.
                self.notify_lacking(&lacks, &load.problems);
                self.scene_opened(load.problems.is_empty() && lacks.is_empty());
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

    /// A workspace or a data set opens in a scene of its own: the open one is kept. False while that one is being saved.
    pub(in crate::app) fn make_room(&mut self, has_asked: &mut bool) -> bool {
        if self.scenes.is_switching() {
            return false;
        }
        if self.session.scene().is_empty() {
            return true;
        }
        if !*has_asked {
            *has_asked = true;
            self.new_scene();
            return self.session.scene().is_empty();
        }
        // The open scene cannot be saved, which was said. It can still be brought back by undo.
        true
    }

    /// The images of a load that are masks: all if they were picked as such, else those of the size of the photo that is
    /// going to be shown. The others are photos.
    fn take_masks(&self, load: &mut Load) -> Vec<Arc<PhotoAsset>> {
        let likely = std::mem::take(&mut load.likely_masks);
        if load.images_as == ImagesAs::Masks {
            return likely;
        }
        let size = self.size_to_be_shown(load);
        let (masks, photos) = likely.into_iter().partition(|image| size == Some((image.width, image.height)));
        load.batch.photos.extend::<Vec<_>>(photos);
        masks
    }

    /// The image of a load that is a depth map: the one that was picked as such, else the first of the size of the photo
    /// that is going to be shown. The others are photos.
    fn take_depth(&self, load: &mut Load) -> Option<Arc<PhotoAsset>> {
        let size = self.size_to_be_shown(load);
        let mut likely = std::mem::take(&mut load.likely_depths).into_iter();
        if load.images_as == ImagesAs::DepthMap {
            return likely.next();
        }
        let fits = |image: &Arc<PhotoAsset>| size == Some((image.width, image.height));
        let (mut fitting, photos): (Vec<_>, Vec<_>) = likely.partition(fits);
        load.batch.photos.extend(photos);
        if fitting.is_empty() {
            return None;
        }
        let depth = fitting.remove(0);
        load.batch.photos.extend(fitting);
        Some(depth)
    }

    /// Of the photo that is shown after a load.
    fn size_to_be_shown(&self, load: &Load) -> Option<(u32, u32)> {
        let first_new = load.batch.photos.first().map(|photo| (photo.width, photo.height));
        let shown = self.session.photo().map(|photo| (photo.asset.width, photo.asset.height));
        first_new.or(shown)
    }
}

/// The files that a document speaks of and that did not come with it.
fn lacking(document: &Document, batch: &Batch) -> Vec<String> {
    let is_there = |sha256| {
        batch.photos.iter().any(|photo| photo.sha256 == sha256)
            || batch.meshes.iter().any(|mesh| mesh.sha256 == sha256)
    };
    let lacks = |(_, sha256): &(&str, Option<Sha256>)| !sha256.is_some_and(is_there);
    document.files().filter(lacks).map(|(name, _)| name.to_owned()).collect()
}

/// A drop of masks alone brings nothing else.
fn is_nothing(batch: &Batch) -> bool {
    let Batch { photos, meshes, cameras, poses, pins, .. } = batch;
    photos.is_empty() && meshes.is_empty() && cameras.is_empty() && poses.is_empty() && pins.is_none()
}
