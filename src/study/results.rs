//! `results.json`, version 1: what one participant did and answered. It holds no truth of a study sample.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::error::read_versioned;
use super::{Event, PoseRecord, StudyError, Tool};

/// The JSON Schema of a results file.
pub const RESULTS_SCHEMA: &str = include_str!("results.schema.json");

const FORMAT: &str = "pinpose-study-results";
const VERSION: u64 = 1;

/// One participation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Results {
    format: String,
    version: u64,
    pub generator: String,
    pub study: StudyRecord,
    pub participant: Participant,
    /// No person, but a model of one: reports keep these apart.
    #[serde(default)]
    pub is_simulated: bool,
    /// Of the order of trials and of start poses; below 2⁵³, so that every JSON reader keeps it.
    pub seed: u64,
    /// The ids of the conditions that the participant worked under, in their order.
    pub conditions: Vec<String>,
    /// The names of the sample sets that the participant worked on, in the order of the conditions where these have sets of
    /// their own; empty in a study without sets.
    #[serde(default)]
    pub sample_sets: Vec<String>,
    pub environment: Environment,
    /// RFC 3339, UTC.
    pub started_at: String,
    /// `null` as long as the participation is not finished.
    #[serde(default)]
    pub finished_at: Option<String>,
    #[serde(default)]
    pub consented_at: Option<String>,
    /// Expertise and the like.
    #[serde(default)]
    pub items_before: Vec<Answer>,
    #[serde(default)]
    pub practice: Vec<PracticeResult>,
    pub trials: Vec<TrialResult>,
    #[serde(default)]
    pub questionnaires: Vec<QuestionnaireResult>,
    /// Of all trials and between them.
    #[serde(default)]
    pub pauses: Vec<Pause>,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyRecord {
    pub id: String,
    pub title: String,
    /// The study's version: the SHA-256 of its `study.json`.
    pub sha256: String,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Participant {
    pub id: String,
    /// What recruiters' pages put into the link.
    #[serde(default)]
    pub recruiter: BTreeMap<String, String>,
}

/// Where it was done.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Environment {
    /// The browser's own words.
    pub browser: String,
    pub language: String,
    /// `webgpu` or `webgl`.
    pub backend: String,
    /// CSS pixels.
    pub screen: [u32; 2],
    pub window: [u32; 2],
    /// Physical pixels per CSS pixel.
    pub pixel_ratio: f64,
    pub utc_offset_minutes: i32,
}

/// A file that was shown, known by its content.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileRecord {
    /// The id in the study.
    pub id: String,
    pub name: String,
    /// Of the photo's or the mesh's file.
    pub sha256: String,
}

/// One presentation of one sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrialResult {
    /// The place in this participant's order, from 0.
    pub index: u32,
    pub sample: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set: Option<String>,
    /// How often the sample had come before under this condition.
    pub repeat: u32,
    /// The condition's id, and what it allowed.
    pub condition: String,
    pub tools: Vec<Tool>,
    pub photo: FileRecord,
    pub object: FileRecord,
    pub start_pose: PoseRecord,
    pub final_pose: PoseRecord,
    pub outcome: Outcome,
    /// RFC 3339, UTC, with milliseconds: the first complete frame, and the end.
    pub shown_at: String,
    pub confirmed_at: String,
    /// The time on the task: `active_s` + `idle_s`. It and the next four add up to the time between `shown_at` and
    /// `confirmed_at`, where the computer's clock was not set meanwhile.
    pub time_s: f64,
    /// With input within the last five seconds.
    pub active_s: f64,
    /// Without.
    pub idle_s: f64,
    pub paused_s: f64,
    /// In a tab that was not looked at.
    pub hidden_s: f64,
    /// Between a page's end and its coming back.
    #[serde(default)]
    pub closed_s: f64,
    /// How often each kind of gesture was made, by the kinds of the events.
    pub gestures: BTreeMap<String, u32>,
    pub events: Vec<Event>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The participant said it is done.
    Confirmed,
    /// The time was over.
    TimedOut,
}

/// One attempt at a practice sample.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PracticeResult {
    /// How often it had been tried before.
    pub attempt: u32,
    /// As a trial; `index` is the place among the practice samples.
    pub trial: TrialResult,
    /// What the participant was told.
    pub feedback: Feedback,
}

/// The errors of a practice pose.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Feedback {
    pub rotation_deg: f64,
    pub translation_mm: f64,
    pub add_mm: f64,
    pub is_good: bool,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Answer {
    pub item: String,
    /// `null`: left out.
    pub value: Option<AnswerValue>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum AnswerValue {
    Number(f64),
    Text(String),
    Several(Vec<String>),
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QuestionnaireResult {
    /// The id in the study.
    pub id: String,
    /// `nasa_tlx`, `sus` or `own`.
    pub kind: String,
    /// The condition that it was asked about; absent where it was about all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub condition: Option<String>,
    /// NASA-TLX: `mental`, `physical`, `temporal`, `performance`, `effort`, `frustration`, 0–20, performance from perfect (0) to
    /// failure (20). SUS: `sus1` to `sus10`, 1–5, as answered.
    pub answers: Vec<Answer>,
    /// NASA-TLX's weights come from these, in the order in which they were asked.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pairs: Vec<PairChoice>,
    /// NASA-TLX: `raw`, and `weighted` where pairs were asked, 0–20. SUS: `sus`, 0–100, and `missing` where items were left out.
    #[serde(default)]
    pub scores: BTreeMap<String, f64>,
    pub answered_at: String,
}

/// Which of two scales contributed more to the workload.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairChoice {
    pub left: String,
    pub right: String,
    pub chosen: String,
}

/// A time without work.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pause {
    pub kind: PauseKind,
    /// The trial that was under way; absent between trials.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trial: Option<u32>,
    pub began_at: String,
    pub seconds: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PauseKind {
    /// The participant asked for it.
    Pause,
    /// Another tab or window was looked at.
    Hidden,
    /// The page was closed.
    Closed,
    /// The rest that the study offers.
    Break,
}

impl Results {
    /// A participation that begins now.
    pub fn new(
        study: StudyRecord,
        participant: Participant,
        environment: Environment,
        seed: u64,
        started_at: String,
    ) -> Self {
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            generator: concat!("PinPose ", env!("CARGO_PKG_VERSION")).to_owned(),
            study,
            participant,
            is_simulated: false,
            seed,
            conditions: Vec::new(),
            sample_sets: Vec::new(),
            environment,
            started_at,
            finished_at: None,
            consented_at: None,
            items_before: Vec::new(),
            practice: Vec::new(),
            trials: Vec::new(),
            questionnaires: Vec::new(),
            pauses: Vec::new(),
        }
    }

    pub fn from_json(bytes: &[u8]) -> Result<Self, StudyError> {
        read_versioned(bytes, FORMAT, VERSION)
    }

    pub fn to_json(&self) -> String {
        // Nothing in it has no form in JSON: numbers come from clocks and checked poses.
        serde_json::to_string(self).unwrap_or_default()
    }
}
