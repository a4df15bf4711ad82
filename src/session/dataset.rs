//! A data set into an empty scene, as one step.

use std::collections::HashMap;
use std::sync::Arc;

use super::log::Log;
use super::{Effect, Notice, Session};
use crate::formats::dataset::{Dataset, DatasetPhoto};
use crate::formats::{Incoming, PosesAs};
use crate::scene::{AnnotationState, DepthMap, MeshAsset, ObjectId, PhotoAsset, PhotoId, Scene};

/// A data set with its files. What it names and what is not here could not be read, and was said.
#[derive(Debug, Clone)]
pub struct DatasetImport {
    pub dataset: Dataset,
    /// Photos, masks and depth maps by path, by their headers.
    pub images: HashMap<String, Arc<PhotoAsset>>,
    pub meshes: HashMap<String, Arc<MeshAsset>>,
    /// `None`: its poses are left out.
    pub poses_as: Option<PosesAs>,
}

/// What did not fit, counted.
#[derive(Debug, Default)]
struct Misfits {
    same_photos: usize,
    masks: usize,
    depth_maps: usize,
}

impl Session {
    /// Puts a data set in place of what is open.
    pub(super) fn open_dataset(&mut self, import: DatasetImport, now_ms: f64) -> Vec<Effect> {
        self.finish_gesture();
        let before = self.snapshot();
        let DatasetImport { dataset, images, meshes, poses_as } = import;
        self.scene = Scene::named(&dataset.name);
        (self.photo, self.selected) = (None, None);
        self.also_selected.clear();
        self.questions.clear();
        self.unit_questions.clear();
        self.waiting.clear();
        self.log = Log::default();

        let mut misfits = Misfits::default();
        let photos = self.add_dataset_photos(&dataset, &images, &mut misfits);
        for mesh in &dataset.meshes {
            let Some(asset) = meshes.get(&mesh.path) else { continue };
            let id = self.scene.add_object(asset.clone());
            if let Some(object) = self.scene.object_mut(id) {
                object.name.clone_from(&mesh.name);
            }
        }
        let mut new: Vec<ObjectId> = self.scene.objects.iter().map(|object| object.id).collect();
        let setting = [dataset.setting()];
        new.retain(|id| !self.is_told_frame(*id, &setting) && !self.is_told_frame(*id, &dataset.poses));
        let mut effects = self.give_units(&new);
        effects.extend(self.take_all_poses(&dataset, poses_as, now_ms));
        self.add_dataset_masks(&dataset, &photos, &images, &mut misfits);
        self.photo = self.scene.photos.first().map(|photo| photo.id);
        self.place_start_poses(now_ms);
        self.show_annotated_photo();
        self.keep_selection_valid();
        self.history.push("Open data set", before);
        self.touched();
        effects.extend(misfits.notices(&dataset.name));
        effects.push(Effect::Notify(Notice::info(self.summary())));
        effects
    }

    /// The scene's photos by the data set's: `None` where one could not be read, or has the content of another.
    fn add_dataset_photos(
        &mut self,
        dataset: &Dataset,
        images: &HashMap<String, Arc<PhotoAsset>>,
        misfits: &mut Misfits,
    ) -> Vec<Option<PhotoId>> {
        let has_names_of_its_own = has_names_of_its_own(&dataset.photos);
        let mut add = |photo: &DatasetPhoto| {
            let asset = images.get(&photo.path)?;
            let count = self.scene.photos.len();
            let id = self.scene.add_photo(asset.clone());
            if self.scene.photos.len() == count {
                misfits.same_photos += 1;
                return None;
            }
            let added = self.scene.photo_mut(id)?;
            if has_names_of_its_own {
                base_name(&photo.path).clone_into(&mut added.name);
            }
            let Some(depth) = &photo.depth else { return Some(id) };
            if let Some(map) = images.get(&depth.path) {
                if is_same_size(map, asset) {
                    let (asset, mm_per_unit) = (map.clone(), depth.mm_per_unit);
                    added.depth = Some(DepthMap { asset, mm_per_unit, occludes: true });
                } else {
                    misfits.depth_maps += 1;
                }
            }
            Some(id)
        };
        dataset.photos.iter().map(&mut add).collect()
    }

    /// Cameras, mesh frames and symmetries first, for poses are given to meshes that are as they should be.
    fn take_all_poses(&mut self, dataset: &Dataset, poses_as: Option<PosesAs>, now_ms: f64) -> Vec<Effect> {
        let setting = (dataset.setting(), PosesAs::Annotations);
        let poses = poses_as.map(|poses_as| dataset.poses.iter().map(move |poses| (poses.clone(), poses_as)));
        let mut effects = Vec::new();
        for (incoming, poses_as) in std::iter::once(setting).chain(poses.into_iter().flatten()) {
            effects.extend(self.take_silently(&incoming, poses_as, now_ms));
        }
        effects
    }

    /// What a data set brings was told before it was opened; only what went wrong is said.
    fn take_silently(&mut self, incoming: &Incoming, poses_as: PosesAs, now_ms: f64) -> Vec<Effect> {
        let outcome = incoming.apply(&mut self.scene, poses_as, now_ms);
        let name = &incoming.file_name;
        let problems = outcome.problems.iter();
        let effects =
            problems.map(|text| Effect::Notify(Notice::warning(format!("{name}: {text}")))).collect();
        self.ask_about_cameras(&outcome);
        self.wait_for(outcome, poses_as);
        effects
    }

    fn add_dataset_masks(
        &mut self,
        dataset: &Dataset,
        photos: &[Option<PhotoId>],
        images: &HashMap<String, Arc<PhotoAsset>>,
        misfits: &mut Misfits,
    ) {
        let objects_of = |path: &str| -> Vec<ObjectId> {
            let objects = self.scene.objects.iter().filter(|object| object.mesh.file_name == path);
            objects.map(|object| object.id).collect()
        };
        let objects: Vec<Vec<ObjectId>> = dataset.meshes.iter().map(|mesh| objects_of(&mesh.path)).collect();
        for (photo, id) in dataset.photos.iter().zip(photos) {
            let Some(id) = *id else { continue };
            let Some(asset) = self.scene.photo(id).map(|photo| photo.asset.clone()) else { continue };
            for mask in &photo.masks {
                let Some(image) = images.get(&mask.path) else { continue };
                if !is_same_size(image, &asset) {
                    misfits.masks += 1;
                    continue;
                }
                let shown = mask.mesh.and_then(|mesh| objects.get(mesh)?.get(mask.instance)).copied();
                let id = self.scene.add_mask(id, shown, image.clone());
                if let Some(added) = self.scene.masks.iter_mut().rev().find(|added| added.id == id) {
                    base_name(&mask.path).clone_into(&mut added.name);
                }
            }
        }
    }

    /// Where no pose came as a start, the first photo has all objects to begin with: those that a reference has in it, if
    /// there is one.
    fn place_start_poses(&mut self, now_ms: f64) {
        let Some(photo) = self.photo.filter(|_| self.scene.annotations.is_empty()) else { return };
        let is_referred = |object: ObjectId| {
            self.scene.references.iter().any(|reference| reference.poses.contains_key(&(photo, object)))
        };
        let all: Vec<ObjectId> = self.scene.objects.iter().map(|object| object.id).collect();
        let referred: Vec<ObjectId> = all.iter().copied().filter(|object| is_referred(*object)).collect();
        for object in if referred.is_empty() { all } else { referred } {
            self.scene.place(photo, object, now_ms);
        }
    }

    /// "lmo16: 16 photos, 8 objects, 122 poses".
    fn summary(&self) -> String {
        let Scene { name, photos, objects, annotations, references, masks, .. } = &self.scene;
        let posed = annotations.values().filter(|pose| pose.state >= AnnotationState::Posed).count();
        let referred: usize = references.iter().map(|reference| reference.poses.len()).sum();
        let counts = [
            (photos.len(), "photo", "photos"),
            (objects.len(), "object", "objects"),
            (posed, "pose", "poses"),
            (referred, "pose for reference", "poses for reference"),
            (masks.len(), "mask", "masks"),
        ];
        let said = counts.into_iter().filter(|(count, ..)| *count > 0);
        let said: Vec<String> = said.map(|(count, one, many)| counted(count, one, many)).collect();
        format!("{name}: {}", said.join(", "))
    }
}

impl Misfits {
    fn notices(&self, name: &str) -> Vec<Effect> {
        const SAME: &str = "of the same content as another, left out";
        const SIZE: &str = "of another size than the photo, left out";
        let all = [
            (self.same_photos, "photo", "photos", SAME),
            (self.masks, "mask", "masks", SIZE),
            (self.depth_maps, "depth map", "depth maps", SIZE),
        ];
        let some = all.into_iter().filter(|(count, ..)| *count > 0);
        let text =
            some.map(|(count, one, many, what)| format!("{name}: {} {what}", counted(count, one, many)));
        text.map(|text| Effect::Notify(Notice::warning(text))).collect()
    }
}

fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

fn is_same_size(a: &PhotoAsset, b: &PhotoAsset) -> bool {
    (a.width, a.height) == (b.width, b.height)
}

/// Photos of one folder are told apart without it.
fn has_names_of_its_own(photos: &[DatasetPhoto]) -> bool {
    let mut names = std::collections::HashSet::new();
    photos.iter().all(|photo| names.insert(base_name(&photo.path)))
}

fn base_name(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}
