//! Our own JSON document, version 1: the serde mirror of a scene. The live types never derive `Serialize`, so that they can
//! change without the files changing; `document.schema.json` describes it for others.

mod convert;
mod view;

use serde::{Deserialize, Serialize};

use super::FormatError;

pub use convert::Keep;
pub use view::ViewSettings;

/// The JSON Schema of what [`write_document`] writes.
pub const DOCUMENT_SCHEMA: &str = include_str!("document.schema.json");

const VERSION: u64 = 1;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Document {
    format: String,
    version: u64,
    generator: String,
    conventions: Conventions,
    pub name: String,
    photos: Vec<PhotoEntry>,
    objects: Vec<ObjectEntry>,
    references: Vec<ReferenceEntry>,
    pub view: ViewSettings,
}

/// What the numbers mean, in the file itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Conventions {
    pose: String,
    camera_axes: String,
    length_unit: String,
    matrix_order: String,
    pixel_origin: String,
    time: String,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PhotoEntry {
    id: u32,
    /// What the user calls it; absent where that is the file's name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    file: String,
    sha256: String,
    width: u32,
    height: u32,
    #[serde(rename = "K")]
    k: [[f64; 3]; 3],
    /// k1 k2 p1 p2 k3, or null.
    distortion: Option<[f64; 5]>,
    camera_origin: CameraOriginEntry,
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    visible: bool,
    #[serde(default = "one", skip_serializing_if = "is_one")]
    opacity: f32,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    locked: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    depth: Option<DepthEntry>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    masks: Vec<MaskEntry>,
    poses: Vec<PoseEntry>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct MaskEntry {
    name: String,
    file: String,
    sha256: String,
    object: Option<u32>,
    color: String,
    opacity: f32,
    visible: bool,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct DepthEntry {
    file: String,
    sha256: String,
    mm_per_unit: f64,
    occludes: bool,
}

fn yes() -> bool {
    true
}

fn is_yes(value: &bool) -> bool {
    *value
}

fn one() -> f32 {
    1.0
}

fn is_one(value: &f32) -> bool {
    *value == 1.0
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
enum CameraOriginEntry {
    AssumedFieldOfView,
    Exif {
        #[serde(default, skip_serializing_if = "ExifSensorEntry::is_default")]
        sensor: ExifSensorEntry,
    },
    Pins {
        relative_sigma: f64,
    },
    Slider {
        before_px: f64,
    },
    Typed,
    File {
        name: String,
    },
}

/// How the size of the sensor is known that EXIF's millimetres need.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum ExifSensorEntry {
    #[default]
    Equivalent,
    FocalPlane,
    SensorTable,
}

impl ExifSensorEntry {
    fn is_default(&self) -> bool {
        *self == Self::Equivalent
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PoseEntry {
    object: u32,
    /// Repeated from the object, so that a pose can be used without looking it up.
    name: String,
    mesh_file: String,
    mesh_sha256: String,
    #[serde(rename = "R")]
    rotation: [[f64; 3]; 3],
    #[serde(rename = "t")]
    translation_mm: [f64; 3],
    camera_from_object: [[f64; 4]; 4],
    state: StateEntry,
    source: SourceEntry,
    changed_at_ms: f64,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    camera_changed: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    score: Option<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pins: Vec<PinEntry>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PinEntry {
    point: [f64; 3],
    pixel: [f64; 2],
    #[serde(default = "unit_weight", skip_serializing_if = "is_unit_weight")]
    weight: f64,
    #[serde(default = "yes", skip_serializing_if = "is_yes")]
    enabled: bool,
}

fn unit_weight() -> f64 {
    1.0
}

fn is_unit_weight(value: &f64) -> bool {
    *value == 1.0
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum StateEntry {
    Untouched,
    Carried,
    Posed,
    Confirmed,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum SourceEntry {
    Manual,
    Pins,
    Snap,
    Tracked,
    Imported,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ObjectEntry {
    id: u32,
    name: String,
    mesh_file: String,
    mesh_sha256: String,
    mesh_from_file: [[f64; 4]; 4],
    /// `#rrggbb`, sRGB.
    color: String,
    opacity: f32,
    visible: bool,
    locked: bool,
    /// Objects of one group move together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    link: Option<u32>,
    #[serde(default, skip_serializing_if = "SymmetriesEntry::is_empty")]
    symmetries: SymmetriesEntry,
}

/// Transforms of the object onto itself, in its own frame.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SymmetriesEntry {
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    discrete: Vec<[[f64; 4]; 4]>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    continuous: Vec<ContinuousSymmetryEntry>,
}

impl SymmetriesEntry {
    fn is_empty(&self) -> bool {
        self.discrete.is_empty() && self.continuous.is_empty()
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ContinuousSymmetryEntry {
    axis: [f64; 3],
    offset_mm: [f64; 3],
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ReferenceEntry {
    name: String,
    visible: bool,
    poses: Vec<ReferencePoseEntry>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ReferencePoseEntry {
    photo: u32,
    object: u32,
    camera_from_object: [[f64; 4]; 4],
}

/// The document as text, numbers with as many digits as bring them back bit for bit.
pub fn write_document(document: &Document) -> String {
    // The mirror holds nothing that JSON has no form for but non-finite numbers, which become null and never arise: poses
    // and cameras are checked where they enter.
    serde_json::to_string_pretty(document).unwrap_or_default()
}

/// Reads a document of any version so far.
pub fn read_document(bytes: &[u8]) -> Result<Document, FormatError> {
    #[derive(Deserialize)]
    struct Head {
        format: String,
        version: u64,
    }
    let head: Head = serde_json::from_slice(bytes).map_err(FormatError::json)?;
    if head.format != "pinpose" {
        return Err(FormatError::at(
            "\"format\"",
            format!("\"pinpose\" expected, found \"{}\"", head.format),
        ));
    }
    if head.version != VERSION {
        return Err(FormatError::Version { found: head.version, supported: VERSION });
    }
    serde_json::from_slice(bytes).map_err(FormatError::json)
}
