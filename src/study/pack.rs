//! From an open scene to the files of a study: `study.json` and its assets for participants, and the truth for the researcher alone.

mod files;
mod reopened;

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DMat4;

use super::{
    Asset, PoseRecord, PracticeSample, Sample, Study, StudyError, StudyObject, StudyPhoto, SymmetriesRecord,
    Truth, TruthSample,
};
use crate::math::Pose;
use crate::mesh::PointTree;
use crate::photo::without_metadata;
use crate::scene::{AnnotationState, Object, ObjectId, Photo, PhotoId, Scene, Sha256};

pub use files::{STUDY_NAME, StudyFiles};
pub use reopened::reopened;

/// What a photo with an object becomes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Role {
    #[default]
    None,
    Sample,
    Practice,
}

/// Where the truth is in the open scene.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum TruthFrom {
    /// What was annotated: posed or confirmed.
    #[default]
    Annotations,
    /// A reference by its name; what was annotated is then the start of [`super::StartPose::Given`].
    Reference(String),
}

/// One choice of the researcher's.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Chosen {
    pub photo: PhotoId,
    pub object: ObjectId,
    pub role: Role,
    pub set: Option<String>,
}

/// A study that is being built: its settings, what of the open scene is in it, and the pictures of its texts.
#[derive(Debug, Clone, PartialEq)]
pub struct Draft {
    /// All but photos, objects and samples, which [`Draft::pack`] fills in.
    pub study: Study,
    pub chosen: Vec<Chosen>,
    pub truth_from: TruthFrom,
    /// By name, as the texts speak of them.
    pub pictures: Vec<(String, Arc<[u8]>)>,
}

/// A study's files.
#[derive(Debug, Clone, PartialEq)]
pub struct Pack {
    pub study: Study,
    /// `study.json` and its assets, by their paths.
    pub files: Vec<(String, Arc<[u8]>)>,
    pub truth: Truth,
}

impl Pack {
    /// What a participant's browser fetches.
    pub fn download_bytes(&self) -> u64 {
        self.files.iter().map(|(_, bytes)| bytes.len() as u64).sum()
    }

    pub fn zip(&self) -> Result<Vec<u8>, StudyError> {
        crate::formats::zip_of_files(&self.files).map_err(|error| StudyError::Pack(error.to_string()))
    }
}

impl Draft {
    /// Every object of every photo, none of them chosen yet.
    pub fn of_scene(scene: &Scene, study: Study) -> Self {
        let chosen = scene.annotations.keys().map(|(photo, object)| Chosen {
            photo: *photo,
            object: *object,
            role: Role::None,
            set: None,
        });
        Self { study, chosen: chosen.collect(), truth_from: TruthFrom::default(), pictures: Vec::new() }
    }

    /// The pose that counts as true; `None` where nobody stands for one.
    pub fn truth_of(&self, scene: &Scene, chosen: &Chosen) -> Option<Pose> {
        let key = (chosen.photo, chosen.object);
        match &self.truth_from {
            TruthFrom::Annotations => {
                let annotation = scene.annotations.get(&key)?;
                let stands = matches!(annotation.state, AnnotationState::Posed | AnnotationState::Confirmed);
                stands.then_some(annotation.camera_from_object)
            }
            TruthFrom::Reference(name) => {
                let reference = scene.references.iter().find(|reference| reference.name == *name)?;
                reference.poses.get(&key).copied()
            }
        }
    }

    /// The study's files. Errors name what is missing, in words for the researcher; see [`super::check`] for all of it at once.
    pub fn pack(&self, scene: &Scene) -> Result<Pack, StudyError> {
        let mut packing = self.start_packing(scene);
        loop {
            if let Some(pack) = packing.step()? {
                return Ok(pack);
            }
        }
    }

    /// The same a sample at a time, for pictures take a moment each.
    pub fn start_packing(&self, scene: &Scene) -> Packing {
        Packing { packer: Packer::new(scene.clone(), self.clone()), next: 0 }
    }
}

/// A study on its way into its files.
#[derive(Debug)]
pub struct Packing {
    packer: Packer,
    /// The sample, or after them the picture, that is next.
    next: usize,
}

impl Packing {
    /// How much is done, of how much.
    pub fn progress(&self) -> (usize, usize) {
        let draft = &self.packer.draft;
        (self.next, draft.chosen.len() + draft.pictures.len())
    }

    /// Packs what is next; the files once there is no more.
    pub fn step(&mut self) -> Result<Option<Pack>, StudyError> {
        let place = self.next;
        self.next += 1;
        if let Some(chosen) = self.packer.draft.chosen.get(place).cloned() {
            if chosen.role != Role::None {
                self.packer.add(&chosen)?;
            }
            return Ok(None);
        }
        let picture = self.packer.draft.pictures.get(place - self.packer.draft.chosen.len()).cloned();
        match picture {
            Some((name, bytes)) => self.packer.add_picture(&name, &bytes).map(|()| None),
            None => Ok(Some(self.packer.finish())),
        }
    }
}

#[derive(Debug)]
struct Packer {
    scene: Scene,
    draft: Draft,
    study: Study,
    files: BTreeMap<String, Arc<[u8]>>,
    truth: Vec<TruthSample>,
    /// The largest distance in each object, in millimetres.
    diameters: BTreeMap<ObjectId, f64>,
}

impl Packer {
    fn new(scene: Scene, draft: Draft) -> Self {
        let mut study = draft.study.clone();
        (study.photos, study.objects, study.samples, study.practice) = Default::default();
        study.texts.pictures = Vec::new();
        Self { scene, draft, study, files: BTreeMap::new(), truth: Vec::new(), diameters: BTreeMap::new() }
    }

    fn add(&mut self, chosen: &Chosen) -> Result<(), StudyError> {
        let (Some(photo), Some(object)) =
            (self.scene.photo(chosen.photo).cloned(), self.scene.object(chosen.object).cloned())
        else {
            return Err(StudyError::Pack("a chosen photo or object is no longer in the scene".to_owned()));
        };
        let pose = self.draft.truth_of(&self.scene, chosen);
        let start = match self.draft.truth_from {
            TruthFrom::Annotations => None,
            TruthFrom::Reference(_) => self
                .scene
                .annotations
                .get(&(chosen.photo, chosen.object))
                .map(|annotation| PoseRecord::from(annotation.camera_from_object)),
        };
        let sample = Sample {
            id: String::new(),
            photo: self.photo(&photo)?,
            object: self.object(&object),
            set: chosen.set.clone(),
            start: start.filter(|_| self.draft.study.start_pose == super::StartPose::Given),
        };
        if chosen.role == Role::Practice {
            return self.add_practice(sample, pose, &photo, &object);
        }
        // Ids say nothing of what is in a photo.
        let sample = Sample { id: format!("S{}", self.study.samples.len()), ..sample };
        let truth = self.truth_sample(&sample, pose, &object)?;
        self.truth.push(truth);
        self.study.samples.push(sample);
        Ok(())
    }

    fn add_practice(
        &mut self,
        sample: Sample,
        pose: Option<Pose>,
        photo: &Photo,
        object: &Object,
    ) -> Result<(), StudyError> {
        let Some(pose) = pose else {
            let reason =
                "a practice sample needs a true pose: confirm one, or choose a reference that has it";
            return Err(StudyError::at(photo.name.clone(), reason));
        };
        let id = format!("P{}", self.study.practice.len());
        self.study.practice.push(PracticeSample {
            sample: Sample { id, set: None, ..sample },
            truth: pose.into(),
            symmetries: SymmetriesRecord::of(&object.symmetries),
            good_add_of_diameter: 0.1,
            most_attempts: 3,
        });
        Ok(())
    }

    /// The photo's id in the study; its file is stripped of all but pixels.
    fn photo(&mut self, photo: &Photo) -> Result<String, StudyError> {
        let id = format!("photo{}", photo.id.0);
        if self.study.photo(&id).is_none() {
            let stripped = without_metadata(&photo.asset.bytes).ok_or_else(|| {
                let reason = "its picture cannot be read, so nothing could be taken out of it";
                StudyError::at(photo.name.clone(), reason)
            })?;
            let asset = self.asset(&photo.asset.file_name, stripped.extension, stripped.bytes.into());
            self.study.photos.push(StudyPhoto { id: id.clone(), asset, camera: photo.camera.into() });
        }
        Ok(id)
    }

    fn object(&mut self, object: &Object) -> String {
        let id = format!("object{}", object.id.0);
        if self.study.object(&id).is_none() {
            let mesh = &object.mesh;
            let asset = self.asset(&mesh.file_name, extension(&mesh.file_name), mesh.bytes.clone());
            let mut companions = Vec::new();
            for companion in &mesh.companions {
                let name = &companion.file_name;
                companions.push(self.asset(name, extension(name), companion.bytes.clone()));
            }
            self.study.objects.push(StudyObject {
                companions,
                id: id.clone(),
                name: object.name.clone(),
                mesh: asset,
                mesh_from_file: rows(&object.mesh_from_file),
                color: Some(object.color.to_hex()),
            });
        }
        id
    }

    fn add_picture(&mut self, name: &str, bytes: &[u8]) -> Result<(), StudyError> {
        let stripped = without_metadata(bytes)
            .ok_or_else(|| StudyError::at(name, "this picture cannot be read; PNG or JPEG expected"))?;
        let asset = self.asset(name, stripped.extension, stripped.bytes.into());
        self.study.texts.pictures.push(asset);
        Ok(())
    }

    /// Puts a file among the assets, under its content's name.
    fn asset(&mut self, name: &str, extension: &str, bytes: Arc<[u8]>) -> Asset {
        let sha256 = Sha256::of(&bytes).to_string();
        let path = format!("assets/{sha256}.{extension}");
        let asset =
            Asset { name: base_name(name).to_owned(), path: path.clone(), sha256, bytes: bytes.len() as u64 };
        self.files.insert(path, bytes);
        asset
    }

    fn truth_sample(
        &mut self,
        sample: &Sample,
        pose: Option<Pose>,
        object: &Object,
    ) -> Result<TruthSample, StudyError> {
        let (Some(photo), Some(mesh)) = (self.study.photo(&sample.photo), self.study.object(&sample.object))
        else {
            return Err(StudyError::Pack("a sample without photo or object".to_owned()));
        };
        let diameter_mm = *self.diameters.entry(object.id).or_insert_with(|| {
            let tree = PointTree::build(object.mesh.mesh.positions_mm());
            tree.map_or(0.0, |tree| tree.diameter())
        });
        Ok(TruthSample {
            id: sample.id.clone(),
            set: sample.set.clone(),
            pose: pose.map(PoseRecord::from),
            photo: photo.asset.name.clone(),
            photo_sha256: photo.asset.sha256.clone(),
            camera: photo.camera,
            object: mesh.name.clone(),
            mesh_sha256: mesh.mesh.sha256.clone(),
            mesh_from_file: mesh.mesh_from_file,
            symmetries: SymmetriesRecord::of(&object.symmetries),
            diameter_mm,
        })
    }

    fn finish(&mut self) -> Pack {
        let json = self.study.to_json();
        let version = Sha256::of(json.as_bytes()).to_string();
        let truth = Truth::new(&self.study.id, &version, std::mem::take(&mut self.truth));
        let study_file = (STUDY_NAME.to_owned(), Arc::from(json.into_bytes()));
        let files = std::iter::once(study_file).chain(std::mem::take(&mut self.files)).collect();
        Pack { study: self.study.clone(), files, truth }
    }
}

fn rows(matrix: &DMat4) -> [[f64; 4]; 4] {
    matrix.transpose().to_cols_array_2d()
}

fn base_name(name: &str) -> &str {
    name.rsplit(['/', '\\']).next().unwrap_or(name)
}

/// As it stands in the name, in small letters; a name of a file on a server is nobody's place for anything else.
fn extension(name: &str) -> &str {
    let extension = base_name(name).rsplit_once('.').map_or("", |(_, extension)| extension);
    let is_plain = !extension.is_empty() && extension.chars().all(|c| c.is_ascii_alphanumeric());
    if is_plain { extension } else { "bin" }
}

#[cfg(test)]
mod tests;
