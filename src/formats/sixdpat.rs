//! 6D-PAT: `poses.json` `{image: [{id, obj, R (9), t (3)}]}` and `info.json` `{image: {K (9), …}}`. Its unit is the mesh's own.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::Value;

use super::gather::{Found, Gather};
use super::{FileKey, FormatError, Incoming, camera};

#[derive(Debug, Deserialize)]
struct PoseEntry {
    obj: String,
    #[serde(rename = "R")]
    rotation: [f64; 9],
    #[serde(rename = "t")]
    translation: [f64; 3],
}

/// Is this `poses.json`: lists of poses by image?
pub(super) fn looks_like_poses(value: &Value) -> bool {
    let first =
        value.as_object().and_then(|images| images.values().find_map(|poses| poses.as_array()?.first()));
    first.is_some_and(|pose| pose.get("obj").is_some() && pose.get("R").is_some())
}

/// Is this `info.json`: cameras by image?
pub(super) fn looks_like_cameras(value: &Value) -> bool {
    let first = value.as_object().and_then(|images| images.values().next());
    first.is_some_and(|camera| camera.get("K").is_some())
}

pub(super) fn read_poses(file_name: &str, bytes: &[u8]) -> Result<Incoming, FormatError> {
    let images: BTreeMap<String, Vec<PoseEntry>> =
        serde_json::from_slice(bytes).map_err(FormatError::json)?;
    let mut gather = Gather::new(file_name);
    for (image, poses) in images {
        let photo = gather.photo(FileKey::Path(image.clone()));
        for (index, pose) in poses.into_iter().enumerate() {
            let found = Found {
                photo,
                object: FileKey::Path(pose.obj),
                rotation: &pose.rotation,
                translation_mm: pose.translation,
                score: None,
            };
            gather.pose(found, || format!("\"{image}\", pose {index}"));
        }
    }
    gather.finish()
}

pub(super) fn read_cameras(file_name: &str, value: &Value) -> Result<Incoming, FormatError> {
    let mut gather = Gather::new(file_name);
    for (image, entry) in value.as_object().into_iter().flatten() {
        match camera::read_camera(file_name, entry) {
            Ok(camera) => {
                let photo = gather.photo(FileKey::Path(image.clone()));
                gather.camera(photo, camera);
            }
            Err(error) => gather.leave_out(|| format!("\"{image}\": {error}")),
        }
    }
    gather.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::IncomingCamera;

    #[test]
    fn poses_and_cameras_name_their_images() {
        let poses =
            r#"{"a b.jpg": [{"id": "1", "obj": "duck.obj", "R": [1,0,0,0,1,0,0,0,1], "t": [1,2,10.5]}]}"#;
        assert!(looks_like_poses(&serde_json::from_str(poses).unwrap()));
        let incoming = read_poses("poses.json", poses.as_bytes()).unwrap();
        assert_eq!(incoming.photos[0].key, FileKey::Path("a b.jpg".to_owned()));
        assert_eq!(incoming.objects[0].key, FileKey::Path("duck.obj".to_owned()));
        assert_eq!(incoming.photos[0].poses[0].camera_from_object.translation_mm.z, 10.5);

        let info = serde_json::json!({"a.jpg": {"K": [3630.5, 0, 1324.25, 0, 3627.75, 659.5, 0, 0, 1], "nearPlane": 1.0}});
        assert!(looks_like_cameras(&info) && !looks_like_poses(&info));
        let cameras = read_cameras("info.json", &info).unwrap();
        let Some(IncomingCamera::File(camera)) = &cameras.photos[0].camera else { panic!("no camera") };
        assert_eq!(camera.k[1], [0.0, 3627.75, 659.5]);
    }

    #[test]
    fn broken_entries_say_where() {
        let short = r#"{"a.jpg": [{"obj": "duck.obj", "R": [1,0,0], "t": [1,2,3]}]}"#;
        assert!(read_poses("poses.json", short.as_bytes()).unwrap_err().to_string().contains("column"));
        let info = serde_json::json!({"a.jpg": {"K": [0]}});
        assert!(read_cameras("info.json", &info).unwrap_err().to_string().contains("a.jpg"));
    }
}
