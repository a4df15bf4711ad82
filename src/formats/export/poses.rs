//! Poses as `poses.json` and as CSV, in the convention that was chosen.

use serde::Serialize;

use super::convention::ConventionWords;
use super::plan::{PhotoPlan, Placed, Plan};
use super::{ExportPart, paths};
use crate::math::Intrinsics;
use crate::scene::{AnnotationState, Photo, PoseSource};

/// The JSON Schema of `poses.json`.
pub const POSES_SCHEMA: &str = include_str!("poses.schema.json");

const VERSION: u32 = 1;

#[derive(Serialize)]
struct PosesFile<'a> {
    format: &'static str,
    version: u32,
    generator: &'static str,
    conventions: ConventionWords,
    photos: Vec<PhotoEntry<'a>>,
}

#[derive(Serialize)]
struct PhotoEntry<'a> {
    file: &'a str,
    sha256: String,
    width: u32,
    height: u32,
    #[serde(rename = "K")]
    k: [[f64; 3]; 3],
    /// k1 k2 p1 p2 k3.
    distortion: Option<[f64; 5]>,
    k_npy: Option<String>,
    poses: Vec<PoseEntry<'a>>,
}

#[derive(Serialize)]
struct PoseEntry<'a> {
    object: &'a str,
    mesh_file: &'a str,
    mesh_sha256: String,
    /// The mesh that the pose refers to, in this export.
    mesh: Option<String>,
    matrix: [[f64; 4]; 4],
    npy: Option<String>,
    state: &'static str,
    source: &'static str,
    changed_at_ms: f64,
}

pub(super) fn poses_json(plan: &Plan) -> String {
    let photos = plan.photos.iter().filter_map(|planned| Some((planned, plan.photo(planned)?)));
    let file = PosesFile {
        format: "pinpose-poses",
        version: VERSION,
        generator: concat!("PinPose ", env!("CARGO_PKG_VERSION")),
        conventions: plan.options.convention.words(),
        photos: photos.map(|(planned, photo)| photo_entry(plan, planned, photo)).collect(),
    };
    // Nothing in it is of a kind that JSON has no form for.
    serde_json::to_string_pretty(&file).unwrap_or_default()
}

fn photo_entry<'a>(plan: &'a Plan, planned: &PhotoPlan, photo: &'a Photo) -> PhotoEntry<'a> {
    let has = |part: ExportPart| plan.options.parts.contains(&part);
    let pose_entry = |placed: &Placed<'a>| PoseEntry {
        object: &placed.object.name,
        mesh_file: &placed.object.mesh.file_name,
        mesh_sha256: placed.object.mesh.sha256.to_string(),
        mesh: has(ExportPart::Meshes).then(|| paths::mesh(plan, placed.index)),
        matrix: plan.options.convention.rows(placed.pose()),
        npy: has(ExportPart::Npy).then(|| paths::pose_npy(plan, planned, placed.index)),
        state: state_name(placed.annotation.state),
        source: source_name(placed.annotation.source),
        changed_at_ms: placed.annotation.changed_at_ms,
    };
    PhotoEntry {
        file: &photo.asset.file_name,
        sha256: photo.asset.sha256.to_string(),
        width: photo.camera.width,
        height: photo.camera.height,
        k: photo.camera.k_rows(),
        distortion: distortion(&photo.camera),
        k_npy: has(ExportPart::Npy).then(|| paths::camera_npy(planned)),
        poses: plan.placed(photo).iter().map(pose_entry).collect(),
    }
}

fn distortion(camera: &Intrinsics) -> Option<[f64; 5]> {
    (!camera.distortion.is_none()).then(|| camera.distortion.to_array())
}

const CSV_COLUMNS: &str = "photo,object,mesh_file,direction,camera_axes,length_unit,\
    r11,r12,r13,r21,r22,r23,r31,r32,r33,tx,ty,tz,\
    fx,fy,cx,cy,skew,k1,k2,p1,p2,k3,width,height,state,source,changed_at_ms";

/// One row per pose; the convention is in three columns of each row, so that it stays with the rows wherever they go.
pub(super) fn poses_csv(plan: &Plan) -> String {
    let mut text = format!("{CSV_COLUMNS}\n");
    for photo in plan.photos.iter().filter_map(|planned| plan.photo(planned)) {
        for placed in plan.placed(photo) {
            text += &csv_row(plan, photo, &placed);
            text.push('\n');
        }
    }
    text
}

fn csv_row(plan: &Plan, photo: &Photo, placed: &Placed<'_>) -> String {
    let convention = plan.options.convention;
    let camera = &photo.camera;
    let [x, y, z, _] = convention.rows(placed.pose());
    let pose = [x, y, z].into_iter().flat_map(|[a, b, c, _]| [a, b, c]).chain([x[3], y[3], z[3]]);
    let lens = [camera.fx, camera.fy, camera.cx, camera.cy, camera.skew];
    let numbers = pose.chain(lens).chain(camera.distortion.to_array());
    let names = [&photo.asset.file_name, &placed.object.name, &placed.object.mesh.file_name];
    let mut fields: Vec<String> = names.into_iter().map(|name| csv_field(name)).collect();
    fields.extend(
        [convention.direction.name(), convention.axes.name(), convention.unit.name()].map(str::to_owned),
    );
    // Rust prints as few digits as bring the number back bit for bit.
    fields.extend(numbers.map(|number| number.to_string()));
    fields.extend([camera.width, camera.height].map(|side| side.to_string()));
    fields.push(state_name(placed.annotation.state).to_owned());
    fields.push(source_name(placed.annotation.source).to_owned());
    fields.push(placed.annotation.changed_at_ms.to_string());
    fields.join(",")
}

/// A text as a field of CSV (RFC 4180).
fn csv_field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

fn state_name(state: AnnotationState) -> &'static str {
    match state {
        AnnotationState::Untouched => "untouched",
        AnnotationState::Carried => "carried",
        AnnotationState::Posed => "posed",
        AnnotationState::Confirmed => "confirmed",
    }
}

fn source_name(source: PoseSource) -> &'static str {
    match source {
        PoseSource::Manual => "manual",
        PoseSource::Pins => "pins",
        PoseSource::Snap => "snap",
        PoseSource::Tracked => "tracked",
        PoseSource::Imported => "imported",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_with_commas_are_quoted() {
        assert_eq!(csv_field("plain"), "plain");
        assert_eq!(csv_field("a, \"b\""), "\"a, \"\"b\"\"\"");
    }
}
