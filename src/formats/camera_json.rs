//! A camera in JSON, in the shapes the field uses: `fx fy cx cy width height` (BOP's camera.json, Vision6D) or a matrix
//! `K`, `cam_K` or `camera_matrix` (3×3 or nine numbers) with `width` and `height` or MegaPose's `resolution` [h, w].

use serde_json::Value;

use super::FormatError;
use crate::math::{Distortion, Intrinsics};

/// Intrinsics from a file. The size is the photo's where the file names none.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraFile {
    pub file_name: String,
    /// Row by row.
    pub k: [[f64; 3]; 3],
    pub distortion: Distortion,
    /// Width and height in pixels.
    pub size: Option<(u32, u32)>,
}

impl CameraFile {
    /// The camera for a photo of this size, if the file does not name another.
    pub fn intrinsics(&self, photo_width: u32, photo_height: u32) -> Intrinsics {
        let (width, height) = self.size.unwrap_or((photo_width, photo_height));
        let pinhole =
            Intrinsics::pinhole(self.k[0][0], self.k[1][1], self.k[0][2], self.k[1][2], width, height);
        Intrinsics { skew: self.k[0][1], distortion: self.distortion, ..pinhole }
    }

    /// Does the file say a size that is not the photo's?
    pub fn differs_in_size(&self, photo_width: u32, photo_height: u32) -> bool {
        self.size.is_some_and(|size| size != (photo_width, photo_height))
    }
}

/// Reads a camera from a JSON object.
pub fn read_camera(file_name: &str, value: &Value) -> Result<CameraFile, FormatError> {
    let k = match ["K", "cam_K", "camera_matrix"].iter().find_map(|key| Some((*key, value.get(key)?))) {
        Some((key, matrix)) => matrix_rows(key, matrix)?,
        None => {
            let number = |key: &str| required_number(value, key);
            [[number("fx")?, 0.0, number("cx")?], [0.0, number("fy")?, number("cy")?], [0.0, 0.0, 1.0]]
        }
    };
    let camera =
        CameraFile { file_name: file_name.to_owned(), k, distortion: distortion(value)?, size: size(value)? };
    let (width, height) = camera.size.unwrap_or((1, 1));
    let checked = Intrinsics::from_k_rows(&k, width, height)
        .and_then(|pinhole| Intrinsics { distortion: camera.distortion, ..pinhole }.checked());
    checked.map_err(|error| FormatError::camera("the camera", error))?;
    Ok(camera)
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
    match flat.as_deref() {
        Some(&[a, b, c, d, e, f, g, h, i]) => Ok([[a, b, c], [d, e, f], [g, h, i]]),
        _ => Err(FormatError::at(format!("\"{key}\""), "nine numbers, row by row, expected")),
    }
}

fn size(value: &Value) -> Result<Option<(u32, u32)>, FormatError> {
    let whole = |number: &Value| number.as_u64().and_then(|number| u32::try_from(number).ok());
    if let (Some(width), Some(height)) = (value.get("width"), value.get("height")) {
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
    let mut coefficients = [0.0; 5];
    for (coefficient, key) in coefficients.iter_mut().zip(["k1", "k2", "p1", "p2", "k3"]) {
        if value.get(key).is_some() {
            *coefficient = required_number(value, key)?;
        }
    }
    Ok(Distortion::from_array(coefficients))
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
    }

    #[test]
    fn bad_cameras_say_where() {
        let message = |text: &str| read(text).unwrap_err().to_string();
        assert!(message(r#"{"fx": 0, "fy": 1, "cx": 0, "cy": 0}"#).contains("focal length fx is 0"));
        assert!(message(r#"{"fx": 1, "fy": 1, "cx": 0}"#).contains("\"cy\""));
        assert!(message(r#"{"K": [1, 2]}"#).contains("nine numbers"));
        assert!(message(r#"{"fx": "a", "fy": 1, "cx": 0, "cy": 0}"#).contains("\"fx\""));
    }
}
