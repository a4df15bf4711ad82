//! `scene_gt.json` and `scene_camera.json`, and the same in YAML as Linemod has it.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::formats::camera::rows_of;
use crate::formats::gather::{Found, Gather};
use crate::formats::yaml::read_yaml;
use crate::formats::{CameraFile, FileKey, FormatError, Incoming, text};
use crate::math::Distortion;

/// What a file says of each image, by its number.
pub type Frames<T> = BTreeMap<u32, T>;

/// One pose of `scene_gt`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct FramePose {
    pub obj_id: u32,
    #[serde(rename = "cam_R_m2c")]
    rotation: [f64; 9],
    #[serde(rename = "cam_t_m2c")]
    translation_mm: [f64; 3],
}

/// One image of `scene_camera`.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
pub struct FrameCamera {
    /// Missing where the camera is no pinhole.
    #[serde(rename = "cam_K")]
    k: Option<[f64; 9]>,
    pub depth_scale: Option<f64>,
}

impl FramePose {
    pub fn found(&self, photo: usize, object: FileKey) -> Found<'_> {
        Found { photo, object, rotation: &self.rotation, translation_mm: self.translation_mm, score: None }
    }
}

impl FrameCamera {
    /// `None` where there is no camera matrix.
    pub fn camera(&self, file_name: &str) -> Option<Result<CameraFile, FormatError>> {
        let k = self.k?;
        Some(CameraFile::checked(file_name, rows_of(&k), Distortion::NONE, None))
    }
}

/// Reads `scene_gt.json` or `gt.yml`.
pub fn read_poses(path: &str, bytes: &[u8]) -> Result<Frames<Vec<FramePose>>, FormatError> {
    read_frames(path, bytes)
}

/// Reads `scene_camera.json` or `info.yml`.
pub fn read_cameras(path: &str, bytes: &[u8]) -> Result<Frames<FrameCamera>, FormatError> {
    read_frames(path, bytes)
}

fn read_frames<T: DeserializeOwned>(path: &str, bytes: &[u8]) -> Result<Frames<T>, FormatError> {
    let by_name: BTreeMap<String, T> = if path.ends_with(".yml") || path.ends_with(".yaml") {
        let value = read_yaml(text(bytes)?)?;
        serde_json::from_value(value).map_err(|error| FormatError::at("the YAML", error))?
    } else {
        serde_json::from_slice(bytes).map_err(FormatError::json)?
    };
    let numbered = by_name.into_iter().map(|(name, content)| {
        let number = name.parse().map_err(|_| {
            let shown: String = name.chars().take(40).collect();
            FormatError::at(format!("\"{shown}\""), "the number of an image expected")
        })?;
        Ok((number, content))
    });
    numbered.collect()
}

/// A `scene_gt.json` that came alone: it is for the photos that are open, or to come.
pub fn scene_gt_incoming(file_name: &str, bytes: &[u8]) -> Result<Incoming, FormatError> {
    let mut gather = Gather::new(file_name);
    for (image, poses) in read_poses(file_name, bytes)? {
        let photo = gather.photo(FileKey::BopImage { scene: None, image });
        for (index, pose) in poses.iter().enumerate() {
            let found = pose.found(photo, FileKey::BopObject(pose.obj_id));
            gather.pose(found, || format!("image {image}, pose {index}"));
        }
    }
    gather.finish()
}

/// A `scene_camera.json` that came alone.
pub fn scene_camera_incoming(file_name: &str, bytes: &[u8]) -> Result<Incoming, FormatError> {
    let mut gather = Gather::new(file_name);
    for (image, frame) in read_cameras(file_name, bytes)? {
        match frame.camera(file_name) {
            Some(Ok(camera)) => {
                let photo = gather.photo(FileKey::BopImage { scene: None, image });
                gather.camera(photo, camera);
            }
            Some(Err(error)) => gather.leave_out(|| format!("image {image}: {error}")),
            None => gather.leave_out(|| format!("image {image}: \"cam_K\" missing")),
        }
    }
    gather.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    const GT: &str = r#"{"5": [{"cam_R_m2c": [0,-1,0, 1,0,0, 0,0,1], "cam_t_m2c": [1, 2, 700.5], "obj_id": 9, "visib": 1}],
        "12": []}"#;

    #[test]
    fn poses_of_numbered_images_are_read() {
        let incoming = scene_gt_incoming("scene_gt.json", GT.as_bytes()).unwrap();
        assert_eq!(incoming.photos[0].key, FileKey::BopImage { scene: None, image: 5 });
        assert_eq!(incoming.objects[0].key, FileKey::BopObject(9));
        let pose = incoming.photos[0].poses[0].camera_from_object;
        assert_eq!(pose.to_rows()[0], [0.0, -1.0, 0.0, 1.0]);
        assert_eq!(pose.to_rows()[2], [0.0, 0.0, 1.0, 700.5]);
    }

    #[test]
    fn yaml_says_the_same() {
        let yaml = "5:\n- cam_R_m2c: [0, -1, 0, 1, 0, 0, 0, 0, 1]\n  cam_t_m2c: [1, 2, 700.5]\n  obj_bb: [1, 2, 3, 4]\n  obj_id: 9\n12: []\n";
        assert_eq!(
            read_poses("gt.yml", yaml.as_bytes()).unwrap(),
            read_poses("a.json", GT.as_bytes()).unwrap()
        );
        let info = "0:\n  cam_K: [572.4114, 0.0, 325.2611, 0.0, 573.57043, 242.04899, 0.0, 0.0, 1.0]\n  depth_scale: 1.0\n";
        let frame = &read_cameras("info.yml", info.as_bytes()).unwrap()[&0];
        assert_eq!(frame.depth_scale, Some(1.0));
        assert_eq!(frame.camera("info.yml").unwrap().unwrap().k[1], [0.0, 573.57043, 242.04899]);
    }

    #[test]
    fn broken_files_say_where() {
        let message =
            |text: &str| scene_gt_incoming("scene_gt.json", text.as_bytes()).unwrap_err().to_string();
        assert!(message(&GT.replace("0,-1,0,", "0,-1,")).contains("line 1, column"));
        assert!(message(&GT.replace("\"12\"", "\"twelve\"")).contains("twelve"));
        assert!(message(&GT.replace("700.5", "\"far\"")).contains("line 1"));
        assert!(message(&GT[..60]).contains("line 1"));
        let cameras = br#"{"1": {"depth_scale": 1}, "2": {"cam_K": [0,0,0,0,1,0,0,0,1]}, "3": {"cam_K": [1,0,0,0,1,0,0,0,1]}}"#;
        let camera = scene_camera_incoming("scene_camera.json", cameras);
        let remarks = camera.unwrap().remarks.join("\n");
        assert!(remarks.contains("\"cam_K\" missing") && remarks.contains("fx is 0"), "{remarks}");
    }
}
