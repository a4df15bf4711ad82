//! Vision6D's workspace: `{"image_path": {name: path}, "mask_path": {name: path}, "mesh_path": {name: [path, 4×4]}}`. Paths
//! are those of the machine that wrote it, often with `\`. The camera is not in it.

use serde::Deserialize;
use serde_json::{Map, Value};

use crate::formats::gather::{Found, Gather};
use crate::formats::{FileKey, FormatError, Incoming};

/// What a workspace names.
#[derive(Debug, Clone, PartialEq)]
pub struct Vision6dWorkspace {
    pub images: Vec<String>,
    pub masks: Vec<String>,
    pub meshes: Vec<String>,
    pub poses: Incoming,
}

pub fn looks_like_workspace(value: &Value) -> bool {
    ["mesh_path", "image_path"].iter().any(|key| value.get(key).is_some_and(Value::is_object))
}

/// Reads a workspace.
pub fn read_workspace(file_name: &str, value: &Value) -> Result<Vision6dWorkspace, FormatError> {
    let images = paths(value, "image_path")?;
    let mut gather = Gather::new(file_name);
    let photo = gather.photo(match images.first() {
        Some(path) => FileKey::Path(path.clone()),
        None => FileKey::Unnamed { stem: String::new(), position: 0, of: 1 },
    });
    let mut meshes = Vec::new();
    for (name, entry) in entries(value, "mesh_path")? {
        let place = || format!("\"mesh_path\", \"{name}\"");
        let (path, rows) =
            mesh_entry(entry).ok_or_else(|| FormatError::at(place(), "[path, 4×4] expected"))?;
        meshes.push(path.clone());
        let Some(rows) = rows else { continue };
        if rows[3] != [0.0, 0.0, 0.0, 1.0] {
            gather.leave_out(|| format!("{}: the last row of the 4×4 is not 0 0 0 1", place()));
            continue;
        }
        let [x, y, z, _] = rows;
        let rotation = [x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]];
        let found = Found {
            photo,
            object: FileKey::Path(path),
            rotation: &rotation,
            translation_mm: [x[3], y[3], z[3]],
            score: None,
        };
        gather.pose(found, place);
    }
    if images.len() > 1 {
        gather.remark(format!(
            "a workspace does not say in which of its {} photos its poses are: they were given to the first",
            images.len()
        ));
    }
    Ok(Vision6dWorkspace { masks: paths(value, "mask_path")?, images, meshes, poses: gather.finish()? })
}

/// A mesh's path, with a pose or alone.
fn mesh_entry(entry: &Value) -> Option<(String, Option<[[f64; 4]; 4]>)> {
    match entry {
        Value::String(path) => Some((path.clone(), None)),
        Value::Array(parts) => {
            let path = parts.first()?.as_str()?.to_owned();
            match parts.get(1) {
                None | Some(Value::Null) => Some((path, None)),
                Some(matrix) => Some((path, Some(<[[f64; 4]; 4]>::deserialize(matrix).ok()?))),
            }
        }
        _ => None,
    }
}

fn entries<'a>(value: &'a Value, key: &str) -> Result<Vec<(&'a String, &'a Value)>, FormatError> {
    match value.get(key) {
        None | Some(Value::Null) => Ok(Vec::new()),
        Some(value) => {
            let entries: Option<&Map<String, Value>> = value.as_object();
            let entries = entries.ok_or_else(|| {
                FormatError::at(format!("\"{key}\""), "an object of names and paths expected")
            })?;
            Ok(entries.iter().collect())
        }
    }
}

fn paths(value: &Value, key: &str) -> Result<Vec<String>, FormatError> {
    let path = |(name, entry): (&String, &Value)| {
        // Some versions write a path with more beside it.
        let path = entry.as_str().or_else(|| entry.get(0)?.as_str());
        let place = || format!("\"{key}\", \"{name}\"");
        path.map(str::to_owned).ok_or_else(|| FormatError::at(place(), "a path expected"))
    };
    entries(value, key)?.into_iter().map(path).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn poses_belong_to_the_photo_and_paths_are_as_written() {
        let value = json!({
            "image_path": {"a": "C:\\data\\a.png"},
            "mask_path": {},
            "mesh_path": {
                "mug": ["C:\\data\\mug.ply", [[1, 0, 0, 5], [0, 1, 0, 6], [0, 0, 1, 700], [0, 0, 0, 1]]],
                "tin": ["tin.ply", null],
            },
        });
        assert!(looks_like_workspace(&value));
        let workspace = read_workspace("workspace.json", &value).unwrap();
        assert_eq!(workspace.meshes, ["C:\\data\\mug.ply", "tin.ply"]);
        assert_eq!(workspace.poses.pose_count(), 1);
        assert_eq!(workspace.poses.photos[0].key, FileKey::Path("C:\\data\\a.png".to_owned()));
        assert_eq!(workspace.poses.photos[0].poses[0].camera_from_object.translation_mm.z, 700.0);
    }

    #[test]
    fn broken_workspaces_say_where() {
        let message = |value: &Value| read_workspace("w.json", value).unwrap_err().to_string();
        assert!(message(&json!({"mesh_path": {"mug": 5}})).contains("\"mug\": [path, 4×4] expected"));
        assert!(message(&json!({"mesh_path": {"mug": ["a.ply", [[1, 2]]]}})).contains("mug"));
        assert!(message(&json!({"image_path": {"a": {}}})).contains("a path expected"));
        let mirrored = json!({"mesh_path": {"mug": ["a.ply", [[-1, 0, 0, 5], [0, 1, 0, 6], [0, 0, 1, 7], [0, 0, 0, 1]]]}});
        assert!(message(&mirrored).contains("mirrored"));
    }
}
