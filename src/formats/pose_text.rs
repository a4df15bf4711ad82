//! A pose as text that people copy and paste: plain rows, NumPy, JSON.

use glam::{DMat3, DVec3};
use serde_json::Value;

use super::FormatError;
use crate::math::{Pose, rotation_defect};

/// How a pose is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PoseText {
    /// Four lines of four numbers.
    Matrix,
    NumPy,
    Json,
}

const EXPECTED: &str = "16 numbers (4×4, row by row), 12 (R and t), 9 (R alone) or 3 (t alone, mm) expected, or JSON with \
     camera_from_object, R and t, or cam_R_m2c and cam_t_m2c";

/// The 4×4 row by row, with as many digits as bring it back bit for bit.
pub fn write_pose_text(pose: &Pose, style: PoseText) -> String {
    let rows = pose.to_rows();
    let row = |row: [f64; 4], separator: &str| row.map(|value| value.to_string()).join(separator);
    let bracketed = || rows.map(|values| format!("[{}]", row(values, ", ")));
    match style {
        PoseText::Matrix => rows.map(|values| row(values, " ")).join("\n"),
        PoseText::NumPy => format!("np.array([{}])", bracketed().join(",\n          ")),
        PoseText::Json => format!("[{}]", bracketed().join(",\n ")),
    }
}

/// Reads a pose in any of these forms. What the text leaves out (a rotation or a translation alone) is taken from
/// `present`. The second value is how far R was from a rotation, ‖RᵀR − I‖; it was projected onto SO(3).
pub fn read_pose_text(text: &str, present: &Pose) -> Result<(Pose, f64), FormatError> {
    let numbers = match serde_json::from_slice::<Value>(text.trim().as_bytes()) {
        Ok(Value::Object(object)) => numbers_of_object(&object)?,
        _ => numbers_in(text)?,
    };
    let (rotation, translation_mm) = split(&numbers, present)?;
    Pose::from_parts(rotation, translation_mm).map_err(|error| FormatError::pose("pose", error))
}

fn split(numbers: &[f64], present: &Pose) -> Result<(DMat3, DVec3), FormatError> {
    match *numbers {
        [x, y, z] => Ok((present.rotation, DVec3::new(x, y, z))),
        [_, _, _, _, _, _, _, _, _] => Ok((rotation_of_rows(numbers, 3), present.translation_mm)),
        [.., x, y, z] if numbers.len() == 12 => {
            // R and t side by side, or R followed by t: whichever is nearer to a rotation.
            let (side_by_side, in_a_row) = (rotation_of_rows(numbers, 4), rotation_of_rows(numbers, 3));
            if rotation_defect(&in_a_row) < rotation_defect(&side_by_side) {
                return Ok((in_a_row, DVec3::new(x, y, z)));
            }
            Ok((side_by_side, DVec3::new(numbers[3], numbers[7], numbers[11])))
        }
        [.., a, b, c, d] if numbers.len() == 16 => {
            if [a, b, c, d] == [0.0, 0.0, 0.0, 1.0] {
                return Ok((rotation_of_rows(numbers, 4), DVec3::new(numbers[3], numbers[7], numbers[11])));
            }
            let transposed = [numbers[3], numbers[7], numbers[11], d] == [0.0, 0.0, 0.0, 1.0];
            let reason = if transposed {
                "the matrix is written column by column: transpose it, the last row has to be 0 0 0 1"
            } else {
                "the last row of the 4×4 matrix is not 0 0 0 1"
            };
            Err(FormatError::at("pose", reason))
        }
        _ => Err(FormatError::at("pose", format!("{} numbers found; {EXPECTED}", numbers.len()))),
    }
}

/// The left 3×3 of rows of `stride` numbers.
fn rotation_of_rows(numbers: &[f64], stride: usize) -> DMat3 {
    let at = |row: usize, column: usize| numbers.get(row * stride + column).copied().unwrap_or(f64::NAN);
    DMat3::from_cols_array_2d(&[0, 1, 2].map(|column| [0, 1, 2].map(|row| at(row, column))))
}

fn numbers_of_object(object: &serde_json::Map<String, Value>) -> Result<Vec<f64>, FormatError> {
    let field = |names: &[&str]| names.iter().find_map(|name| object.get(*name));
    if let Some(matrix) = field(&["camera_from_object", "pose", "matrix"]) {
        return flattened(matrix);
    }
    let rotation = field(&["R", "cam_R_m2c", "rotation"]);
    let translation = field(&["t", "cam_t_m2c", "translation"]);
    let (Some(rotation), Some(translation)) = (rotation, translation) else {
        return Err(FormatError::at("pose", format!("no pose found; {EXPECTED}")));
    };
    let (mut numbers, translation) = (flattened(rotation)?, flattened(translation)?);
    if (numbers.len(), translation.len()) != (9, 3) {
        let found = format!("R has {} numbers and t {}, 9 and 3 expected", numbers.len(), translation.len());
        return Err(FormatError::at("pose", found));
    }
    // Side by side, so that nothing is left to a guess.
    for (row, value) in translation.into_iter().enumerate() {
        numbers.insert(row * 4 + 3, value);
    }
    numbers.extend([0.0, 0.0, 0.0, 1.0]);
    Ok(numbers)
}

fn flattened(value: &Value) -> Result<Vec<f64>, FormatError> {
    match value {
        Value::Number(number) => Ok(vec![number.as_f64().unwrap_or(f64::NAN)]),
        Value::Array(values) => {
            let parts: Result<Vec<Vec<f64>>, FormatError> = values.iter().map(flattened).collect();
            Ok(parts?.concat())
        }
        _ => Err(FormatError::at("pose", "numbers expected")),
    }
}

/// The numbers of a text, whatever brackets, commas and names (`np.array`, `dtype=float64`) are between them.
fn numbers_in(text: &str) -> Result<Vec<f64>, FormatError> {
    const BETWEEN: &str = ",;:[](){}=|\"'";
    let words = text.split(|c: char| c.is_whitespace() || BETWEEN.contains(c));
    let mut numbers = Vec::new();
    for word in words.filter(|word| !word.is_empty()) {
        let is_name = word.starts_with(|c: char| c.is_alphabetic() || c == '_');
        let is_infinite = matches!(word.to_ascii_lowercase().as_str(), "nan" | "inf" | "infinity");
        if is_name && !is_infinite {
            continue;
        }
        // NumPy writes "1." and tuples of one number "1,".
        let number = word.parse::<f64>();
        numbers.push(number.map_err(|_| {
            let shown: String = word.chars().take(20).collect();
            FormatError::at("pose", format!("a number expected, found \"{shown}\""))
        })?);
        if numbers.len() > 16 {
            return Err(FormatError::at("pose", format!("more than 16 numbers found; {EXPECTED}")));
        }
    }
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose() -> Pose {
        Pose::exp(DVec3::new(0.3, -1.0, 0.7), DVec3::new(12.25, -7.0, 812.5))
    }

    #[test]
    fn every_style_is_read_back_bit_for_bit() {
        for style in [PoseText::Matrix, PoseText::NumPy, PoseText::Json] {
            let text = write_pose_text(&pose(), style);
            let (read, defect) = read_pose_text(&text, &Pose::IDENTITY).unwrap();
            assert_eq!(read, pose(), "{text}");
            assert!(defect < 1e-12);
        }
    }

    #[test]
    fn what_others_write_is_understood() {
        let present = Pose::from_translation(DVec3::new(1.0, 2.0, 3.0));
        let translated = Pose::from_translation(DVec3::new(10.0, 20.0, 700.0));
        let same = [
            "array([[1., 0., 0., 10.],\n       [0., 1., 0., 20.],\n       [0., 0., 1., 700.],\n       [0., 0., 0., 1.]], dtype=float32)",
            "1 0 0 10\n0 1 0 20\n0 0 1 700",
            "R = [[1,0,0],[0,1,0],[0,0,1]]\nt = [10, 20, 7e2]",
            r#"{"R": [[1,0,0],[0,1,0],[0,0,1]], "t": [10, 20, 700]}"#,
            r#"{"cam_R_m2c": [1,0,0,0,1,0,0,0,1], "cam_t_m2c": [10, 20, 700], "obj_id": 5}"#,
            "10, 20, 700",
        ];
        for text in same {
            assert_eq!(read_pose_text(text, &present).unwrap().0, translated, "{text}");
        }
        let turned = "0 -1 0  1 0 0  0 0 1";
        assert_eq!(read_pose_text(turned, &present).unwrap().0.translation_mm, present.translation_mm);
    }

    #[test]
    fn what_is_no_pose_is_refused_in_words() {
        let refused = |text: &str| read_pose_text(text, &Pose::IDENTITY).unwrap_err().to_string();
        assert!(refused("1 2 3 4").contains("4 numbers found"));
        assert!(refused("1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1").contains("column by column"));
        assert!(refused("0 0 0 0 0 0 0 0 0 0 0 1").contains("singular"));
        assert!(refused("nan 0 0 0 1 0 0 0 1 0 0 1").contains("not finite"));
        assert!(refused("1 0 0 12px").contains("12px"));
        assert!(refused(&"1 ".repeat(100)).contains("more than 16"));
        assert!(refused("{}").contains("no pose"));
        assert!(refused("").contains("0 numbers"));
    }

    #[test]
    fn a_matrix_that_is_nearly_a_rotation_is_corrected_and_that_is_known() {
        let (pose, defect) = read_pose_text("1.01 0 0 1\n0 1 0 2\n0 0 1 3", &Pose::IDENTITY).unwrap();
        assert!((defect - 0.0201).abs() < 1e-12);
        assert!(pose.rotation.abs_diff_eq(DMat3::IDENTITY, 1e-15));
    }
}
