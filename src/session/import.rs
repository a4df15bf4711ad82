//! Files of one drop into the scene, and whole scenes in place of it.

use std::sync::Arc;

use glam::DMat4;

use super::log::Log;
use super::{
    Answer, Arrangement, CommandError, Effect, History, Notice, PinChange, Question, Session, Waiting,
};
use crate::formats::{CameraFile, Document, Incoming, Outcome, PosesAs};
use crate::scene::{CameraOrigin, DepthMap, Mask, MeshAsset, ObjectId, PhotoAsset, PhotoId, Pin, Scene};

/// The files of one drop, read.
#[derive(Debug, Clone, Default)]
pub struct Batch {
    pub photos: Vec<Arc<PhotoAsset>>,
    pub meshes: Vec<Arc<MeshAsset>>,
    pub cameras: Vec<CameraFile>,
    pub poses: Vec<Incoming>,
    /// For the selected object in the photo that is shown.
    pub pins: Option<Vec<Pin>>,
    /// `None`: the user is asked.
    pub poses_as: Option<PosesAs>,
}

/// A saved scene with its files.
#[derive(Debug, Clone)]
pub struct Opening {
    pub document: Document,
    pub photos: Vec<Arc<PhotoAsset>>,
    pub meshes: Vec<Arc<MeshAsset>>,
    /// A scene that is opened in place of another can be undone; one that is restored at the start cannot.
    pub restored: bool,
}

impl Session {
    /// Adds what was dropped, as one undo step.
    pub(super) fn import(&mut self, batch: Batch, now_ms: f64) -> Vec<Effect> {
        self.finish_gesture();
        let before = self.snapshot();
        let mut effects = Vec::new();
        let new_photos: Vec<PhotoId> =
            batch.photos.iter().map(|asset| self.add_dropped_photo(asset, &mut effects)).collect();
        if let Some(first) = new_photos.first() {
            self.photo = Some(*first);
        }
        effects.extend(self.add_meshes(&batch, now_ms));
        for camera in batch.cameras {
            self.take_camera(camera, &new_photos);
        }

        effects.extend(self.retry_waiting(now_ms));
        let mut asked = Vec::new();
        for incoming in batch.poses {
            match batch.poses_as {
                _ if incoming.pose_count() == 0 && incoming.references.is_empty() => {
                    effects.extend(self.take_poses(incoming, PosesAs::Annotations, now_ms));
                }
                Some(poses_as) => effects.extend(self.take_poses(incoming, poses_as, now_ms)),
                None => asked.push(incoming),
            }
        }
        if !asked.is_empty() {
            self.questions.push(Question::PosesAs(asked));
        }
        self.keep_selection_valid();
        self.record_imports(&before.scene);
        let pins = batch.pins;
        if self.scene != before.scene {
            self.history.push("Add files", before);
            self.touched();
        }
        effects.extend(pins.map(|pins| self.take_pins(pins, now_ms)));
        effects
    }

    /// The photo; one with the same content that is there already stays the only one, which is said.
    fn add_dropped_photo(&mut self, asset: &Arc<PhotoAsset>, effects: &mut Vec<Effect>) -> PhotoId {
        let id = self.scene.add_photo(asset.clone());
        let known = self.scene.photo(id).map_or("", |photo| &photo.asset.file_name);
        if known != asset.file_name {
            let name = &asset.file_name;
            let text = format!(
                "{name} is the same picture as {known}, which is open already: it is not added twice"
            );
            effects.push(Effect::Notify(Notice::warning(text)));
        }
        id
    }

    fn take_pins(&mut self, pins: Vec<Pin>, now_ms: f64) -> Effect {
        let count = pins.len();
        match self.edit_pins(PinChange::Replace(pins), now_ms) {
            Ok(_) => Effect::Notify(Notice::info(format!("{count} pins set on the selected object"))),
            Err(CommandError::NotAvailable(..)) => Effect::Notify(Notice::error(
                "Pins belong to an object in a photo: load both, select the object, then drop the pins again",
            )),
            Err(error) => Effect::Notify(Notice::error(error.to_string())),
        }
    }

    /// Adds each new mesh as an object. It is placed in the photo that is shown, unless the same drop brings poses: they say
    /// where it belongs.
    fn add_meshes(&mut self, batch: &Batch, now_ms: f64) -> Vec<Effect> {
        let mut new = Vec::new();
        for mesh in &batch.meshes {
            let known = self.scene.objects.iter().find(|object| object.mesh.sha256 == mesh.sha256);
            let known = known.map(|object| object.id);
            let id = match known {
                Some(id) => id,
                None => {
                    let id = self.scene.add_object(mesh.clone());
                    new.push(id);
                    id
                }
            };
            self.complete_mesh(id, mesh);
            self.selected = Some(id);
        }
        new.retain(|id| !self.is_told_frame(*id, &batch.poses));
        let effects = self.give_units(&new);
        let waits_for_poses =
            !batch.poses.is_empty() || self.waiting.iter().any(|w| w.incoming.pose_count() > 0);
        if waits_for_poses {
            return effects;
        }
        let Some(photo) = self.photo else { return effects };
        // Objects that came before any photo are placed with the first one.
        let unplaced: Vec<_> = self.scene.objects.iter().map(|object| object.id).collect();
        for id in unplaced {
            if !self.scene.annotations.keys().any(|(_, object)| *object == id) {
                self.scene.place(photo, id, now_ms);
            }
        }
        effects
    }

    /// A mesh that came without its textures gets them when it is loaded again together with them.
    fn complete_mesh(&mut self, id: ObjectId, again: &Arc<MeshAsset>) {
        let Some(object) = self.scene.objects.iter_mut().find(|object| object.id == id) else { return };
        if again.companions.len() <= object.mesh.companions.len() {
            return;
        }
        object.mesh = if object.mesh_from_file == DMat4::IDENTITY {
            again.clone()
        } else {
            match again.with_mesh_from_file(DMat4::IDENTITY, object.mesh_from_file) {
                Ok(mesh) => mesh,
                Err(_) => return,
            }
        };
    }

    /// A camera file is for the photos of its drop, else for the one that is shown, else for the ones to come.
    fn take_camera(&mut self, file: CameraFile, new_photos: &[PhotoId]) {
        let shown = self.photo;
        let targets = if new_photos.is_empty() { shown.as_slice() } else { new_photos };
        if targets.is_empty() {
            let mut incoming = Incoming::new(&file.file_name);
            incoming.cameras_to_come = Some(file);
            self.waiting.push(Waiting {
                incoming,
                poses_as: PosesAs::Annotations,
                missing: vec!["a photo".to_owned()],
            });
            return;
        }
        self.give_camera(file, targets);
    }

    fn give_camera(&mut self, file: CameraFile, photos: &[PhotoId]) {
        let mut differing = Vec::new();
        for &id in photos {
            let Some(photo) = self.scene.photo(id) else { continue };
            let (width, height) = (photo.asset.width, photo.asset.height);
            if file.differs_in_size(width, height) {
                differing.push(id);
            } else {
                let origin = CameraOrigin::File(file.file_name.clone());
                self.scene.set_camera(id, file.intrinsics(width, height), origin);
            }
        }
        if !differing.is_empty() {
            self.questions.push(Question::CameraSize { file, photos: differing });
        }
    }

    /// Gives poses to the scene; what finds no photo or mesh waits for them.
    fn take_poses(&mut self, incoming: Incoming, poses_as: PosesAs, now_ms: f64) -> Vec<Effect> {
        let outcome = incoming.apply(&mut self.scene, poses_as, now_ms);
        let mut effects: Vec<Effect> = remarks_of(&incoming, &outcome)
            .map(|remark| notify_warning(&incoming.file_name, remark))
            .collect();
        effects.push(Effect::Notify(describe(&incoming, poses_as, &outcome)));
        self.ask_about_cameras(&outcome);
        self.wait_for(outcome, poses_as);
        self.show_annotated_photo();
        effects
    }

    /// How many of some files' poses find their photos and meshes in the scene.
    pub fn count_fitting_poses(&self, files: &[Incoming]) -> usize {
        let fitting =
            |incoming: &Incoming| incoming.apply(&mut self.scene.clone(), PosesAs::Reference, 0.0).applied;
        files.iter().map(fitting).sum()
    }

    pub(super) fn wait_for(&mut self, outcome: Outcome, poses_as: PosesAs) {
        if let Some(incoming) = outcome.rest {
            self.waiting.retain(|waiting| waiting.incoming != incoming);
            self.waiting.push(Waiting { incoming, poses_as, missing: outcome.missing });
        }
    }

    pub(super) fn ask_about_cameras(&mut self, outcome: &Outcome) {
        for (photo, file) in &outcome.differing_cameras {
            let known = self.questions.iter_mut().find_map(|question| match question {
                Question::CameraSize { file: asked, photos } if asked == file => Some(photos),
                _ => None,
            });
            match known {
                Some(photos) if photos.contains(photo) => {}
                Some(photos) => photos.push(*photo),
                None => {
                    self.questions.push(Question::CameraSize { file: file.clone(), photos: vec![*photo] });
                }
            }
        }
    }

    /// After files have come: does anything that waited find its photo or mesh now?
    fn retry_waiting(&mut self, now_ms: f64) -> Vec<Effect> {
        let mut effects = Vec::new();
        for waiting in std::mem::take(&mut self.waiting) {
            if let Some(file) = waiting.incoming.cameras_to_come.clone() {
                match self.photo {
                    Some(_) => {
                        let guessed = self.scene.photos.iter().filter(|photo| photo.camera_origin.is_guess());
                        let photos: Vec<PhotoId> = guessed.map(|photo| photo.id).collect();
                        self.give_camera(file, &photos);
                    }
                    None => self.waiting.push(waiting),
                }
                continue;
            }
            let outcome = waiting.incoming.apply(&mut self.scene.clone(), waiting.poses_as, now_ms);
            if outcome.missing == waiting.missing {
                self.waiting.push(waiting);
            } else {
                effects.extend(self.take_poses(waiting.incoming, waiting.poses_as, now_ms));
            }
        }
        effects
    }

    /// If nothing is placed in the photo that is shown, another one that has something is a better start.
    pub(super) fn show_annotated_photo(&mut self) {
        let Some(photo) = self.photo else { return };
        if self.scene.objects_in(photo).next().is_none() {
            let annotated = |id: PhotoId| self.scene.objects_in(id).next().is_some();
            if let Some(better) = self.scene.photos.iter().find(|photo| annotated(photo.id)) {
                self.photo = Some(better.id);
            }
        }
        self.select_something_in_photo();
    }

    pub(super) fn answer(&mut self, answer: Answer, now_ms: f64) -> Result<Vec<Effect>, CommandError> {
        if self.questions.is_empty() {
            return Err(CommandError::Failed("no question is open".to_owned()));
        }
        let question = self.questions.remove(0);
        self.finish_gesture();
        let before = self.snapshot();
        let effects = match (&question, answer) {
            (_, Answer::Refuse) => Vec::new(),
            (Question::PosesAs(files), Answer::UsePosesAs(poses_as)) => {
                let files = files.iter().cloned();
                files.flat_map(|incoming| self.take_poses(incoming, poses_as, now_ms)).collect()
            }
            (Question::CameraSize { file, photos }, Answer::ScaleCamera) => {
                self.scale_camera(file, photos);
                Vec::new()
            }
            _ => {
                self.questions.insert(0, question);
                return Err(CommandError::Failed("that is no answer to the open question".to_owned()));
            }
        };
        self.record_imports(&before.scene);
        if self.scene != before.scene {
            self.history.push("Import poses", before);
        }
        self.touched();
        Ok(effects)
    }

    fn scale_camera(&mut self, file: &CameraFile, photos: &[PhotoId]) {
        for &id in photos {
            let Some(photo) = self.scene.photo(id) else { continue };
            let (width, height) = (photo.asset.width, photo.asset.height);
            let camera = file.intrinsics(width, height).scaled_to(width, height);
            self.scene.set_camera(id, camera, CameraOrigin::File(file.file_name.clone()));
        }
    }

    /// Puts a saved scene in place of this one.
    pub(super) fn open(&mut self, opening: Opening, now_ms: f64) -> Vec<Effect> {
        self.finish_gesture();
        let before = self.snapshot();
        let document = &opening.document;
        let title = if document.name.is_empty() { "This scene" } else { &document.name };
        let incoming = match Incoming::from_document(title, document) {
            Ok(incoming) => incoming,
            Err(error) => return vec![Effect::Notify(Notice::error(error.to_string()))],
        };
        let mut scene = Scene::named(&document.name);
        // In the document's order, whatever the order in which the files were read.
        for sha256 in document.photo_hashes() {
            if let Some(asset) = opening.photos.iter().find(|asset| Some(asset.sha256) == sha256) {
                scene.add_photo(asset.clone());
            }
        }
        for sha256 in document.mesh_hashes() {
            if let Some(mesh) = opening.meshes.iter().find(|mesh| Some(mesh.sha256) == sha256) {
                scene.add_object(mesh.clone());
            }
        }
        let outcome = incoming.apply(&mut scene, PosesAs::Annotations, now_ms);
        restore_masks(&mut scene, document, &opening.photos);
        restore_depth_maps(&mut scene, document, &opening.photos);
        self.scene = scene;
        self.questions.clear();
        self.unit_questions.clear();
        self.waiting.clear();
        self.log = Log::default();
        self.look = document.view.look();
        self.panes.arrangement = Arrangement::from_name(&document.view.panes).unwrap_or_default();
        let distance_mm = document.view.image_distance_mm;
        self.panes.image_distance_mm = distance_mm.filter(|mm| mm.is_finite() && *mm > 0.0);
        self.restore_view(document);
        if opening.restored {
            self.history = History::default();
        } else {
            self.history.push("Open scene", before);
        }
        self.touched();
        let mut effects: Vec<Effect> =
            remarks_of(&incoming, &outcome).map(|remark| notify_warning("scene", remark)).collect();
        if !outcome.missing.is_empty() {
            effects.push(Effect::Notify(describe(&incoming, PosesAs::Annotations, &outcome)));
            self.wait_for(outcome, PosesAs::Annotations);
        }
        effects
    }

    /// Ids are given anew when a scene is opened; what was shown is found by its position.
    fn restore_view(&mut self, document: &Document) {
        let (photo, object) = document.view_positions();
        self.photo = photo.and_then(|index| self.scene.photos.get(index)).map(|photo| photo.id);
        self.selected = object.and_then(|index| self.scene.objects.get(index)).map(|object| object.id);
        self.keep_selection_valid();
    }
}

/// Masks belong to photos and objects by their positions in the document, which are those in the scene: both are added in
/// its order.
fn restore_masks(scene: &mut Scene, document: &Document, images: &[Arc<PhotoAsset>]) {
    for mask in document.masks() {
        let asset = images.iter().find(|image| image.sha256 == mask.sha256);
        let photo = document.photo_hashes().nth(mask.photo).flatten();
        let photo = scene.photos.iter().find(|candidate| Some(candidate.asset.sha256) == photo);
        let (Some(asset), Some(photo)) = (asset, photo.map(|photo| photo.id)) else { continue };
        let object = mask.object.and_then(|index| scene.objects.get(index)).map(|object| object.id);
        let id = scene.add_mask(photo, object, asset.clone());
        if let Some(known) = scene.masks.iter_mut().find(|candidate| candidate.id == id) {
            *known = Mask {
                name: mask.name,
                color: mask.color,
                opacity: mask.opacity,
                visible: mask.visible,
                ..known.clone()
            };
        }
    }
}

fn restore_depth_maps(scene: &mut Scene, document: &Document, images: &[Arc<PhotoAsset>]) {
    let hashes: Vec<_> = document.photo_hashes().collect();
    for saved in document.depth_maps() {
        let asset = images.iter().find(|image| image.sha256 == saved.sha256);
        let photo = hashes.get(saved.photo).copied().flatten();
        let photo = scene.photos.iter_mut().find(|candidate| Some(candidate.asset.sha256) == photo);
        if let (Some(asset), Some(photo)) = (asset, photo) {
            let (mm_per_unit, occludes) = (saved.mm_per_unit, saved.occludes);
            photo.depth = Some(DepthMap { asset: asset.clone(), mm_per_unit, occludes });
        }
    }
}

fn remarks_of<'a>(incoming: &'a Incoming, outcome: &'a Outcome) -> impl Iterator<Item = &'a String> {
    incoming.remarks.iter().chain(&outcome.problems)
}

fn notify_warning(file_name: &str, text: &str) -> Effect {
    Effect::Notify(Notice::warning(format!("{file_name}: {text}")))
}

fn describe(incoming: &Incoming, poses_as: PosesAs, outcome: &Outcome) -> Notice {
    let (name, count, all) = (&incoming.file_name, outcome.applied, incoming.pose_count());
    let what = match poses_as {
        _ if all == 0 => return describe_without_poses(incoming, outcome),
        PosesAs::Annotations => "used as annotations",
        PosesAs::Reference => "kept as a reference",
    };
    let plural = if all == 1 { "" } else { "s" };
    if outcome.missing.is_empty() {
        return Notice::info(format!("{name}: {count} pose{plural} {what}"));
    }
    let files = missing_files(outcome);
    if count == 0 {
        Notice::warning(format!(
            "{name}: its poses wait for their photos and meshes. Drop these files too: {files}"
        ))
    } else {
        Notice::info(format!("{name}: {count} of {all} pose{plural} {what}, the others wait for {files}"))
    }
}

/// Of a file of cameras, or of objects that were never posed.
fn describe_without_poses(incoming: &Incoming, outcome: &Outcome) -> Notice {
    let name = &incoming.file_name;
    let cameras = incoming.photos.iter().filter(|photo| photo.camera.is_some()).count();
    let what = match (cameras, outcome.missing.is_empty()) {
        (0, _) => "no poses in it".to_owned(),
        // The user is asked what is to become of them.
        _ if !outcome.differing_cameras.is_empty() => "a camera for a photo of another size".to_owned(),
        (1, true) => "1 camera taken over".to_owned(),
        (_, true) => format!("{cameras} cameras taken over"),
        (1, false) => "1 camera in it".to_owned(),
        (_, false) => format!("{cameras} cameras in it"),
    };
    if outcome.missing.is_empty() {
        Notice::info(format!("{name}: {what}"))
    } else {
        Notice::info(format!("{name}: {what}. It waits for {}", missing_files(outcome)))
    }
}

/// The first few files that are still to come.
fn missing_files(outcome: &Outcome) -> String {
    let shown: Vec<&str> = outcome.missing.iter().take(4).map(String::as_str).collect();
    let mut files = shown.join(", ");
    if outcome.missing.len() > shown.len() {
        files += &format!(" and {} more", outcome.missing.len() - shown.len());
    }
    files
}
