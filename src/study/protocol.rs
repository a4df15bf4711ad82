//! `study.json`, version 1: all that a participant's page is told. It holds no truth of a study sample.

mod questions;
mod samples;
mod settings;

use serde::{Deserialize, Serialize};

use super::StudyError;
use super::error::read_versioned;

pub use questions::{Item, ItemKind, Questionnaire, QuestionnaireKind, QuestionnaireTime};
pub use samples::{Asset, CameraRecord, PracticeSample, Sample, StartPose, StudyObject, StudyPhoto};
pub use settings::{
    Assignment, Completion, Condition, IdParameters, Limits, ResumePolicy, SampleSets, Saving, Schedule,
    Texts, Tool, TrialOrder,
};

/// The JSON Schema of `study.json`.
pub const STUDY_SCHEMA: &str = include_str!("study.schema.json");

const FORMAT: &str = "pinpose-study";
const VERSION: u64 = 1;

/// A study as it is handed out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    format: String,
    version: u64,
    /// Letters, digits, `-` and `_`: it is a part of file names.
    pub id: String,
    pub title: String,
    /// Whom participants can write to; shown where something went wrong.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub contact: String,
    #[serde(default)]
    pub texts: Texts,
    pub photos: Vec<StudyPhoto>,
    pub objects: Vec<StudyObject>,
    pub samples: Vec<Sample>,
    /// With truth, for feedback; never one of [`Self::samples`].
    #[serde(default)]
    pub practice: Vec<PracticeSample>,
    /// Which tools may be used; at least one.
    pub conditions: Vec<Condition>,
    /// Who works under which conditions.
    #[serde(default)]
    pub assignment: Assignment,
    /// Who works on which samples.
    #[serde(default)]
    pub sample_sets: SampleSets,
    #[serde(default)]
    pub start_pose: StartPose,
    #[serde(default)]
    pub schedule: Schedule,
    /// Asked before the first trial: expertise and the like.
    #[serde(default)]
    pub items_before: Vec<Item>,
    #[serde(default)]
    pub questionnaires: Vec<Questionnaire>,
    #[serde(default)]
    pub limits: Limits,
    #[serde(default)]
    pub resume: ResumePolicy,
    #[serde(default)]
    pub saving: Saving,
    #[serde(default)]
    pub completion: Completion,
    #[serde(default)]
    pub parameters: IdParameters,
}

impl Study {
    /// A study of no samples yet, with the paper's protocol: each sample three times, every tool.
    pub fn new(id: &str, title: &str) -> Self {
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            id: id.to_owned(),
            title: title.to_owned(),
            contact: String::new(),
            texts: Texts::default(),
            photos: Vec::new(),
            objects: Vec::new(),
            samples: Vec::new(),
            practice: Vec::new(),
            conditions: vec![Condition::with_every_tool()],
            assignment: Assignment::default(),
            sample_sets: SampleSets::default(),
            start_pose: StartPose::default(),
            schedule: Schedule::default(),
            items_before: Vec::new(),
            questionnaires: Vec::new(),
            limits: Limits::default(),
            resume: ResumePolicy::default(),
            saving: Saving::default(),
            completion: Completion::default(),
            parameters: IdParameters::default(),
        }
    }

    pub fn from_json(bytes: &[u8]) -> Result<Self, StudyError> {
        read_versioned(bytes, FORMAT, VERSION)
    }

    pub fn to_json(&self) -> String {
        // Nothing in it has no form in JSON: numbers are checked where they enter.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    pub fn photo(&self, id: &str) -> Option<&StudyPhoto> {
        self.photos.iter().find(|photo| photo.id == id)
    }

    pub fn object(&self, id: &str) -> Option<&StudyObject> {
        self.objects.iter().find(|object| object.id == id)
    }

    pub fn sample(&self, id: &str) -> Option<&Sample> {
        self.samples.iter().find(|sample| sample.id == id)
    }

    pub fn practice_sample(&self, id: &str) -> Option<&PracticeSample> {
        self.practice.iter().find(|practice| practice.sample.id == id)
    }

    pub fn condition(&self, id: &str) -> Option<&Condition> {
        self.conditions.iter().find(|condition| condition.id == id)
    }

    /// The names of the sample sets, in the order in which they first come; empty where there are none.
    pub fn set_names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for set in self.samples.iter().filter_map(|sample| sample.set.as_deref()) {
            if !names.contains(&set) {
                names.push(set);
            }
        }
        names
    }

    /// Every file that a participant's page needs, each once.
    pub fn assets(&self) -> Vec<&Asset> {
        let photos = self.photos.iter().map(|photo| &photo.asset);
        let meshes =
            self.objects.iter().flat_map(|object| std::iter::once(&object.mesh).chain(&object.companions));
        let mut assets: Vec<&Asset> = Vec::new();
        for asset in photos.chain(meshes).chain(&self.texts.pictures) {
            if assets.iter().all(|earlier| earlier.path != asset.path) {
                assets.push(asset);
            }
        }
        assets
    }
}
