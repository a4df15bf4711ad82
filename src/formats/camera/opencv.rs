//! OpenCV's YAML with a camera matrix and distortion, and the YAML of ROS and others that has the same parts.

use serde_json::Value;

use super::{CameraFile, distortion_from_list, rows_of};
use crate::formats::FormatError;
use crate::formats::yaml::read_yaml;
use crate::math::Distortion;

/// Compared without case.
const MATRIX_NAMES: [&str; 6] =
    ["camera_matrix", "cameramatrix", "intrinsic_matrix", "intrinsics", "k", "m1"];
const DISTORTION_NAMES: [&str; 8] = [
    "distortion_coefficients",
    "distortioncoefficients",
    "distcoeffs",
    "dist_coeffs",
    "dist_coeff",
    "distortion",
    "d",
    "d1",
];

/// Reads a camera from YAML.
pub fn read_opencv_yaml(file_name: &str, text: &str) -> Result<CameraFile, FormatError> {
    let value = read_yaml(text)?;
    let (name, matrix) = find(&value, &MATRIX_NAMES)
        .ok_or_else(|| FormatError::at("the YAML", "a matrix \"camera_matrix\" expected"))?;
    let k = match pinhole_numbers(matrix) {
        Some(k) => k,
        None => {
            let flat = matrix_data(name, matrix)?;
            rows_of(flat.as_slice().try_into().map_err(|_| {
                FormatError::at(name, format!("nine numbers, row by row, expected, found {}", flat.len()))
            })?)
        }
    };
    let distortion = match find(&value, &DISTORTION_NAMES) {
        Some((name, list)) => {
            refuse_other_lenses(&value)?;
            distortion_from_list(name, &matrix_data(name, list)?)?
        }
        None => Distortion::NONE,
    };
    CameraFile::checked(file_name, k, distortion, size(&value).or_else(|| size(matrix)))
}

/// The first of these names that is there, whatever its case.
fn find<'a>(value: &'a Value, names: &[&str]) -> Option<(&'a str, &'a Value)> {
    let entries = value.as_object()?;
    names.iter().find_map(|name| {
        let entry = entries.iter().find(|(key, _)| key.eq_ignore_ascii_case(name))?;
        Some((entry.0.as_str(), entry.1))
    })
}

/// Named numbers in place of a matrix, as some trackers write them.
fn pinhole_numbers(value: &Value) -> Option<[[f64; 3]; 3]> {
    let number = |names: [&str; 2]| find(value, &names).and_then(|(_, number)| number.as_f64());
    let (fx, fy) = (number(["fx", "f_u"])?, number(["fy", "f_v"])?);
    let (cx, cy) = (number(["cx", "pp_x"])?, number(["cy", "pp_y"])?);
    Some([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
}

/// The numbers of an `!!opencv-matrix`, whose `rows` and `cols` have to fit, or of a plain list.
fn matrix_data(name: &str, value: &Value) -> Result<Vec<f64>, FormatError> {
    let data = value.get("data").unwrap_or(value);
    let rows = data.as_array().ok_or_else(|| FormatError::at(name, "a list of numbers expected"))?;
    let flat =
        rows.iter().flat_map(|row| row.as_array().map_or_else(|| vec![row], |row| row.iter().collect()));
    let numbers: Option<Vec<f64>> = flat.map(Value::as_f64).collect();
    let numbers = numbers.ok_or_else(|| FormatError::at(name, "finite numbers expected"))?;
    let count = |key: &str| value.get(key).and_then(Value::as_u64);
    if let (Some(rows), Some(columns)) = (count("rows"), count("cols"))
        && rows.checked_mul(columns) != Some(numbers.len() as u64)
    {
        return Err(FormatError::at(
            name,
            format!("{rows}×{columns} announced, but {} numbers are there", numbers.len()),
        ));
    }
    Ok(numbers)
}

/// Fisheye coefficients look like `k1 k2 p1 p2` and are none.
fn refuse_other_lenses(value: &Value) -> Result<(), FormatError> {
    let Some((name, model)) = find(value, &["distortion_model", "camera_model"]) else { return Ok(()) };
    let model = model.as_str().unwrap_or_default();
    let is_other = ["fisheye", "equidistant", "kannala_brandt", "omni", "mei", "fov"]
        .contains(&model.to_lowercase().as_str());
    if is_other {
        return Err(FormatError::at(
            name,
            format!(
                "the lens model \"{model}\" is not read: undistort the photos, or calibrate with k1 k2 p1 p2 k3"
            ),
        ));
    }
    Ok(())
}

fn size(value: &Value) -> Option<(u32, u32)> {
    let whole = |number: &Value| number.as_u64().and_then(|number| u32::try_from(number).ok());
    if let Some((_, pair)) = find(value, &["image_size", "imagesize"]) {
        return pair.get(0).and_then(whole).zip(pair.get(1).and_then(whole));
    }
    let (_, width) = find(value, &["image_width", "imagewidth", "width"])?;
    let (_, height) = find(value, &["image_height", "imageheight", "height"])?;
    whole(width).zip(whole(height))
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPENCV: &str = "%YAML:1.0\n---\ncalibration_time: \"Mon 12:00:00\"\nimage_width: 640\nimage_height: 480\n\
        camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 5.724114e+02, 0., 3.252611e+02, 0.,\n\
        \x20      5.7357043e+02, 2.4204899e+02, 0., 0., 1. ]\n\
        distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n   data: [ -0.1, 0.02, 1.0e-03, -2.0e-03, 0. ]\n\
        avg_reprojection_error: 2.1e-01\n";

    #[test]
    fn what_opencv_writes_is_read() {
        let camera = read_opencv_yaml("calibration.yml", OPENCV).unwrap();
        assert_eq!(camera.k, [[572.4114, 0.0, 325.2611], [0.0, 573.57043, 242.04899], [0.0, 0.0, 1.0]]);
        assert_eq!(camera.distortion.to_array(), [-0.1, 0.02, 0.001, -0.002, 0.0]);
        assert_eq!(camera.size, Some((640, 480)));
    }

    #[test]
    fn ros_and_named_numbers_are_read() {
        let ros = "image_width: 640\nimage_height: 480\ncamera_name: head\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: [500, 0, 320, 0, 501, 240, 0, 0, 1]\n\
            distortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0.1, 0, 0, 0, 0]\n";
        assert_eq!(read_opencv_yaml("ros.yaml", ros).unwrap().distortion.k1, 0.1);
        let tracker = "%YAML:1.2\nload_directory: \"./\"\nintrinsics:\n  f_u: 698.128\n  f_v: 698.617\n  pp_x: 478.459\n  pp_y: 274.426\n  width: 960\n  height: 540\n";
        let camera = read_opencv_yaml("camera.yaml", tracker).unwrap();
        assert_eq!((camera.k[0][0], camera.size), (698.128, Some((960, 540))));
    }

    #[test]
    fn other_lenses_and_broken_matrices_are_refused_in_words() {
        let message = |text: &str| read_opencv_yaml("c.yml", text).unwrap_err().to_string();
        let rational =
            OPENCV.replace("rows: 5", "rows: 8").replace("-2.0e-03, 0. ]", "-2.0e-03, 0., 0.1, 0., 0. ]");
        assert!(message(&rational).contains("8 coefficients"), "{}", message(&rational));
        let zeros = rational.replace("0., 0.1, 0., 0. ]", "0., 0., 0., 0. ]");
        assert!(read_opencv_yaml("c.yml", &zeros).is_ok());
        let fisheye = format!("{OPENCV}camera_model: fisheye\n");
        assert!(message(&fisheye).contains("fisheye"));
        assert!(message(&OPENCV.replace("rows: 3", "rows: 4")).contains("4×3 announced"));
        assert!(message(&OPENCV.replace("5.724114e+02", ".Nan")).contains("finite numbers"));
        assert!(message("a: 1\n").contains("camera_matrix"));
        for length in 0..OPENCV.len() {
            // What matters is that it returns.
            let _ = read_opencv_yaml("c.yml", &OPENCV[..length]);
        }
    }
}
