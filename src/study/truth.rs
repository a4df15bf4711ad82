//! `truth.json`, version 1: what the researcher keeps and no participant is sent. A report reads it with the meshes of the
//! study's folder.

use serde::{Deserialize, Serialize};

use super::error::read_versioned;
use super::{CameraRecord, PoseRecord, StudyError, SymmetriesRecord};

/// The JSON Schema of `truth.json`.
pub const TRUTH_SCHEMA: &str = include_str!("truth.schema.json");

const FORMAT: &str = "pinpose-study-truth";
const VERSION: u64 = 1;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Truth {
    format: String,
    version: u64,
    /// The study's id.
    pub study: String,
    /// The SHA-256 of its `study.json`.
    pub study_sha256: String,
    pub samples: Vec<TruthSample>,
}

/// The answer to one sample, with all that scoring needs but the mesh itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TruthSample {
    pub id: String,
    /// The sample set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set: Option<String>,
    /// `camera_from_object`; absent for a sample whose pose the researcher does not know.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pose: Option<PoseRecord>,
    /// Of the pictures as the study shows them.
    pub photo: String,
    pub photo_sha256: String,
    pub camera: CameraRecord,
    pub object: String,
    pub mesh_sha256: String,
    /// From the numbers in the mesh's file to the `object` frame in millimetres, row by row.
    pub mesh_from_file: [[f64; 4]; 4],
    #[serde(default)]
    pub symmetries: SymmetriesRecord,
    /// The largest distance between two vertices.
    pub diameter_mm: f64,
}

impl Truth {
    pub fn new(study: &str, study_sha256: &str, samples: Vec<TruthSample>) -> Self {
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            study: study.to_owned(),
            study_sha256: study_sha256.to_owned(),
            samples,
        }
    }

    pub fn from_json(bytes: &[u8]) -> Result<Self, StudyError> {
        read_versioned(bytes, FORMAT, VERSION)
    }

    pub fn to_json(&self) -> String {
        // Nothing in it has no form in JSON: poses and cameras are checked where they enter.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    pub fn sample(&self, id: &str) -> Option<&TruthSample> {
        self.samples.iter().find(|sample| sample.id == id)
    }
}
