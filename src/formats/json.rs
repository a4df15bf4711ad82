//! What a JSON file is, from its content.

use serde_json::Value;

use super::{
    FormatError, Incoming, NamedFile, Parsed, bop, camera, megapose, own_poses, pins, pose_array,
    read_document, sixdpat, vision6d,
};

/// Poses of a thousand photos with twenty objects each take a third of it. A value takes up to sixteen times its text in
/// memory.
const MAX_BYTES: usize = 32 << 20;

/// What the values of a text may take in memory: far more than those of any data set do.
const MAX_VALUE_BYTES: usize = 160 << 20;

/// Refuses a text of very many small values, each of which takes more than its text: `[[],[],…` and the like. `marks` are what
/// an item of a list or a line begins or ends with.
pub(super) fn check_values(bytes: &[u8], marks: &[u8]) -> Result<(), FormatError> {
    // A list's room is doubled when it is full, with the old one still there; a mapping has room for eleven from the start.
    const BYTES_PER_ITEM: usize = 96;
    const BYTES_PER_MAPPING: usize = 700;
    let most = bytes.iter().fold(0_usize, |sum, byte| match byte {
        b'{' => sum.saturating_add(BYTES_PER_MAPPING),
        mark if marks.contains(mark) => sum.saturating_add(BYTES_PER_ITEM),
        _ => sum,
    });
    if most > MAX_VALUE_BYTES {
        return Err(FormatError::at("the file", "more values than any cameras and poses have"));
    }
    Ok(())
}

/// What a file of ours says it is, without a tree of its values.
fn own_format(bytes: &[u8]) -> Option<String> {
    #[derive(serde::Deserialize)]
    struct Head {
        format: String,
    }
    serde_json::from_slice(bytes).ok().map(|Head { format }| format)
}

/// Reads a camera, poses or a document of ours.
pub(super) fn parse_json(file: &NamedFile) -> Result<Parsed, FormatError> {
    let (name, bytes) = (file.name.as_str(), &*file.bytes);
    if bytes.len() > MAX_BYTES {
        return Err(FormatError::TooMuchText { megabytes: MAX_BYTES >> 20 });
    }
    match own_format(bytes).as_deref() {
        Some(own_poses::FORMAT) => return own_poses::read_poses_json(name, bytes).map(Parsed::Poses),
        Some(_) => {
            let document = read_document(bytes)?;
            return Ok(Parsed::Poses(Incoming::from_document(name, &document)?));
        }
        None => check_values(bytes, b",[")?,
    }
    let value: Value = serde_json::from_slice(bytes).map_err(FormatError::json)?;
    if value.is_array() {
        return parse_list(name, bytes, &value);
    }
    if pins::looks_like_pins(&value) {
        return pins::read_pins(&value).map(Parsed::Pins);
    }
    if camera::looks_like_camera(&value) {
        return camera::read_camera(name, &value).map(Parsed::Camera);
    }
    if vision6d::looks_like_workspace(&value) {
        return vision6d::read_workspace(name, &value).map(|workspace| Parsed::Poses(workspace.poses));
    }
    if sixdpat::looks_like_poses(&value) {
        return sixdpat::read_poses(name, bytes).map(Parsed::Poses);
    }
    match bop_key(&value) {
        Some("cam_R_m2c") => bop::scene_gt_incoming(name, bytes).map(Parsed::Poses),
        Some("cam_K") => bop::scene_camera_incoming(name, bytes).map(Parsed::Poses),
        Some("bbox_obj") => Err(only_with_folder("scene_gt_info.json (boxes and visibilities)")),
        Some("diameter") => Err(only_with_folder("models_info.json (sizes and symmetries)")),
        _ if sixdpat::looks_like_cameras(&value) => sixdpat::read_cameras(name, &value).map(Parsed::Poses),
        _ => camera::read_camera(name, &value).map(Parsed::Camera),
    }
}

fn parse_list(name: &str, bytes: &[u8], value: &Value) -> Result<Parsed, FormatError> {
    if value.get(0).is_some_and(|first| first.get("label").is_some()) {
        return megapose::object_data_incoming(name, bytes).map(Parsed::Poses);
    }
    match pose_array::array_of_json(value) {
        Some(array) => super::parse_array(name, &array),
        None => Err(FormatError::at(
            "the list",
            "a 3×3 camera matrix, 4×4 poses or MegaPose's objects with \"label\" expected",
        )),
    }
}

/// The key by which one of BOP's files is told, which have an entry for each image or object.
fn bop_key(value: &Value) -> Option<&'static str> {
    let entries = value.as_object()?.values();
    let first = entries
        .map(|entry| entry.as_array().map_or(Some(entry), |list| list.first()))
        .find_map(|entry| entry)?;
    ["cam_R_m2c", "cam_K", "bbox_obj", "diameter"].into_iter().find(|key| first.get(key).is_some())
}

fn only_with_folder(what: &str) -> FormatError {
    FormatError::at("the file", format!("BOP's {what} is read with the folder it belongs to: drop that"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Parsed, String> {
        let file = NamedFile { name: "a.json".to_owned(), bytes: text.as_bytes().into() };
        parse_json(&file).map_err(|error| error.to_string())
    }

    #[test]
    fn content_says_what_it_is() {
        assert!(matches!(parse(r#"{"fx": 1, "fy": 1, "cx": 0, "cy": 0}"#), Ok(Parsed::Camera(_))));
        assert!(matches!(parse("[[1, 0, 0], [0, 1, 0], [0, 0, 1]]"), Ok(Parsed::Camera(_))));
        let poses = [
            r#"{"1": [], "2": [{"cam_R_m2c": [1,0,0,0,1,0,0,0,1], "cam_t_m2c": [0,0,1], "obj_id": 1}]}"#,
            r#"{"1": {"cam_K": [1,0,0,0,1,0,0,0,1]}}"#,
            r#"{"a.jpg": {"K": [1,0,0,0,1,0,0,0,1]}}"#,
            r#"{"a.jpg": [{"obj": "a.ply", "R": [1,0,0,0,1,0,0,0,1], "t": [0,0,1]}]}"#,
            r#"[{"label": "mug", "TWO": [[0,0,0,1],[0,0,1]]}]"#,
            "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 5], [0, 0, 0, 1]]",
            r#"{"image_path": {"a": "a.png"}, "mesh_path": {}}"#,
        ];
        for text in poses {
            assert!(matches!(parse(text), Ok(Parsed::Poses(_))), "{text}: {:?}", parse(text));
        }
    }

    #[test]
    fn what_is_none_of_these_is_refused_in_words() {
        assert!(parse(r#"{"1": {"diameter": 5}}"#).unwrap_err().contains("models_info.json"));
        assert!(parse(r#"{"1": [{"bbox_obj": [1]}]}"#).unwrap_err().contains("scene_gt_info.json"));
        assert!(parse("[]").unwrap_err().contains("3×3"));
        assert!(parse("{}").unwrap_err().contains("fx"));
        assert!(parse("5").is_err());
        assert!(parse(&"[".repeat(100_000)).unwrap_err().contains("line 1"));
    }
}
