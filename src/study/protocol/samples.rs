//! What is annotated: photographs, objects, and which object in which photograph from which start.

use glam::DMat4;
use serde::{Deserialize, Serialize};

use crate::math::{CameraError, Distortion, Intrinsics};
use crate::study::PoseRecord;

/// A file beside `study.json`, known by its content.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Asset {
    /// What the researcher called it.
    pub name: String,
    /// Where it is, relative to `study.json`: `assets/<sha256>.<extension>`.
    pub path: String,
    /// 64 hexadecimal digits.
    pub sha256: String,
    pub bytes: u64,
}

/// K and lens of a photograph, in the `image` frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraRecord {
    /// [[fx, s, cx], [0, fy, cy], [0, 0, 1]] in pixels; (0, 0) is the centre of the top-left pixel.
    #[serde(rename = "K")]
    pub k: [[f64; 3]; 3],
    /// Brown–Conrady, `k1 k2 p1 p2 k3`; absent for none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distortion: Option<[f64; 5]>,
    pub width: u32,
    pub height: u32,
}

impl From<Intrinsics> for CameraRecord {
    fn from(camera: Intrinsics) -> Self {
        Self {
            k: [[camera.fx, camera.skew, camera.cx], [0.0, camera.fy, camera.cy], [0.0, 0.0, 1.0]],
            distortion: (!camera.distortion.is_none()).then(|| camera.distortion.to_array()),
            width: camera.width,
            height: camera.height,
        }
    }
}

impl CameraRecord {
    pub fn to_intrinsics(&self) -> Result<Intrinsics, CameraError> {
        let [[fx, skew, cx], [zero, fy, cy], last] = self.k;
        if zero != 0.0 || last != [0.0, 0.0, 1.0] {
            return Err(CameraError::NotACameraMatrix);
        }
        let distortion = self.distortion.map_or(Distortion::NONE, Distortion::from_array);
        let (width, height) = (self.width, self.height);
        Intrinsics { fx, fy, cx, cy, skew, distortion, width, height }.checked()
    }
}

/// A photograph; its file holds pixels and nothing else.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyPhoto {
    pub id: String,
    pub asset: Asset,
    pub camera: CameraRecord,
}

/// A mesh, and how it becomes the object whose pose is asked for.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyObject {
    pub id: String,
    pub name: String,
    pub mesh: Asset,
    /// Textures and material libraries, by the names that the mesh asks for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub companions: Vec<Asset>,
    /// From the numbers in the file to the `object` frame in millimetres, row by row.
    pub mesh_from_file: [[f64; 4]; 4],
    /// `#rrggbb`, sRGB.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub color: Option<String>,
}

impl StudyObject {
    pub fn mesh_from_file(&self) -> DMat4 {
        DMat4::from_cols_array_2d(&self.mesh_from_file).transpose()
    }
}

/// One object in one photograph.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sample {
    pub id: String,
    /// A [`StudyPhoto`]'s id.
    pub photo: String,
    /// A [`StudyObject`]'s id.
    pub object: String,
    /// The sample set that it belongs to; absent in a study that has only one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub set: Option<String>,
    /// Where [`StartPose::Given`] begins.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<PoseRecord>,
}

/// A sample to practise on: it comes with its truth, so that the participant can be told how near a pose is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PracticeSample {
    pub sample: Sample,
    pub truth: PoseRecord,
    /// ADD up to this part of the object's diameter counts as well done.
    #[serde(default = "tenth")]
    pub good_add_of_diameter: f64,
    /// Again until it is well done, but no more often than this.
    #[serde(default = "one")]
    pub most_attempts: u32,
}

fn tenth() -> f64 {
    0.1
}

fn one() -> u32 {
    1
}

/// Where an object is when a trial begins.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum StartPose {
    /// The same `camera_from_object` for every sample; the paper's is R = I, t = (0, 0, 1000) mm.
    Fixed { pose: PoseRecord },
    /// As an object that was just added: R = I, in the middle, a third of the photo's height.
    Centered,
    /// Any rotation, the middle of the object's box at any pixel of the photo's middle half, at a depth between these. Drawn
    /// from the participant's seed, anew for every trial.
    Random { least_depth_mm: f64, most_depth_mm: f64 },
    /// Each sample has its own.
    Given,
}

impl Default for StartPose {
    fn default() -> Self {
        let rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        Self::Fixed { pose: PoseRecord { rotation, translation_mm: [0.0, 0.0, 1000.0] } }
    }
}
