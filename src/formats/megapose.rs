//! MegaPose's `object_data.json`: `[{label, TWO: [[qx, qy, qz, qw], [x, y, z]], …}]`, metres; the world is the camera unless
//! its `camera_data.json` says otherwise with `TWC`.

use glam::{DMat3, DQuat, DVec3};
use serde::Deserialize;
use serde_json::Value;

use super::gather::{Found, Gather};
use super::{FileKey, FormatError, Incoming, file_stem};
use crate::math::Pose;

/// A rotation (x y z w) and a translation in metres.
type QuaternionAndMetres = ([f64; 4], [f64; 3]);

#[derive(Debug, Deserialize)]
pub(super) struct ObjectData {
    pub label: String,
    /// `world_from_object`; missing in inputs that know a box alone.
    #[serde(rename = "TWO")]
    world_from_object: Option<QuaternionAndMetres>,
    score: Option<f64>,
}

impl ObjectData {
    pub fn has_pose(&self) -> bool {
        self.world_from_object.is_some()
    }
}

/// Reads the list of objects.
pub(super) fn read_objects(bytes: &[u8]) -> Result<Vec<ObjectData>, FormatError> {
    serde_json::from_slice(bytes).map_err(FormatError::json)
}

/// `camera_from_world` of a `camera_data.json`; the identity where it says none.
pub(super) fn read_camera_from_world(camera: &Value) -> Result<Pose, FormatError> {
    let Some(value) = camera.get("TWC").filter(|value| !value.is_null()) else { return Ok(Pose::IDENTITY) };
    let (quaternion, metres) = QuaternionAndMetres::deserialize(value).map_err(|error| {
        FormatError::at("\"TWC\"", format!("[[qx, qy, qz, qw], [x, y, z]] expected: {error}"))
    })?;
    let world_from_camera =
        pose_of(&quaternion, &metres).map_err(|error| FormatError::at("\"TWC\"", error))?;
    Ok(world_from_camera.inverse())
}

fn pose_of(quaternion: &[f64; 4], metres: &[f64; 3]) -> Result<Pose, &'static str> {
    let rotation = rotation_of(quaternion).ok_or("the quaternion has no length")?;
    let translation_mm = DVec3::from_array(*metres) * 1000.0;
    let (pose, _) = Pose::from_parts(rotation, translation_mm).map_err(|_| "finite numbers expected")?;
    Ok(pose)
}

/// The rotation of a quaternion x y z w of any length but none.
fn rotation_of(&[x, y, z, w]: &[f64; 4]) -> Option<DMat3> {
    let quaternion = DQuat::from_xyzw(x, y, z, w);
    let length = quaternion.length();
    (length > 1e-9 && length.is_finite()).then(|| DMat3::from_quat(quaternion.normalize()))
}

/// Adds the poses of a list to a photo.
pub(super) fn gather_objects(
    gather: &mut Gather,
    photo: usize,
    objects: &[ObjectData],
    camera_from_world: &Pose,
    key_of: impl Fn(&str) -> FileKey,
) {
    for (index, object) in objects.iter().enumerate() {
        let Some((quaternion, metres)) = &object.world_from_object else { continue };
        let place = || format!("object {index} (\"{}\")", object.label);
        let camera_from_object = match pose_of(quaternion, metres) {
            Ok(world_from_object) => *camera_from_world * world_from_object,
            Err(reason) => {
                gather.leave_out(|| format!("{}: {reason}", place()));
                continue;
            }
        };
        let rotation = camera_from_object.rotation.transpose().to_cols_array();
        let translation_mm = camera_from_object.translation_mm.to_array();
        let found = Found {
            photo,
            object: key_of(&object.label),
            rotation: &rotation,
            translation_mm,
            score: object.score,
        };
        gather.pose(found, place);
    }
}

/// A list that came alone: it names its meshes, but no photo.
pub(super) fn object_data_incoming(file_name: &str, bytes: &[u8]) -> Result<Incoming, FormatError> {
    let objects = read_objects(bytes)?;
    if !objects.iter().any(ObjectData::has_pose) {
        return Err(FormatError::at("\"TWO\"", "missing: these objects have boxes, but no poses"));
    }
    let mut gather = Gather::new(file_name);
    let stem = file_stem(file_name).to_owned();
    let photo = gather.photo(FileKey::Unnamed { stem, position: 0, of: 1 });
    gather_objects(&mut gather, photo, &objects, &Pose::IDENTITY, |label| FileKey::Label(label.to_owned()));
    gather.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE: &str = r#"[{"label": "mug", "TWO": [[0, 0, 0.7071067811865476, 0.7071067811865476], [0.1, 0.2, 0.5]], "score": 0.9}]"#;

    #[test]
    fn quaternions_end_with_w_and_metres_become_millimetres() {
        let incoming = object_data_incoming("object_data.json", ONE.as_bytes()).unwrap();
        assert_eq!(incoming.objects[0].key, FileKey::Label("mug".to_owned()));
        let pose = &incoming.photos[0].poses[0];
        assert_eq!(pose.score, Some(0.9));
        assert_eq!(pose.camera_from_object.translation_mm, DVec3::new(100.0, 200.0, 500.0));
        let x_axis = pose.camera_from_object.rotation * DVec3::X;
        assert!(x_axis.distance(DVec3::Y) < 1e-15);
    }

    #[test]
    fn a_camera_in_the_world_is_taken_into_account() {
        let camera = serde_json::json!({"TWC": [[0, 0, 0, 1], [0, 0, -1]]});
        let camera_from_world = read_camera_from_world(&camera).unwrap();
        assert_eq!(camera_from_world.translation_mm.z, 1000.0);
        assert_eq!(read_camera_from_world(&serde_json::json!({})).unwrap(), Pose::IDENTITY);
        assert!(read_camera_from_world(&serde_json::json!({"TWC": [1, 2]})).is_err());
    }

    #[test]
    fn what_holds_no_pose_is_refused_in_words() {
        let message = |text: &str| object_data_incoming("o.json", text.as_bytes()).unwrap_err().to_string();
        assert!(message(r#"[{"label": "mug", "bbox_modal": [1, 2, 3, 4]}]"#).contains("boxes, but no poses"));
        assert!(message(r#"[{"label": "mug", "TWO": [[0, 0, 0, 0], [0, 0, 1]]}]"#).contains("no length"));
        assert!(message(r#"[{"label": "mug", "TWO": [[0, 0, 1], [0, 0, 1]]}]"#).contains("column"));
        assert!(message(r#"[{"TWO": null}]"#).contains("label"));
    }
}
