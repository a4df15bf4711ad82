//! A bare 3×3 matrix: NumPy's, or numbers in a text.

use super::{CameraFile, rows_of};
use crate::formats::FormatError;
use crate::formats::npy::NpyArray;
use crate::math::Distortion;

/// A NumPy array of shape 3×3.
pub fn read_matrix_array(file_name: &str, array: &NpyArray) -> Result<CameraFile, FormatError> {
    let flat: [f64; 9] = array.values.as_slice().try_into().map_err(|_| {
        FormatError::at("the array", format!("3×3 for a camera expected, found {}", array.shape_in_words()))
    })?;
    CameraFile::checked(file_name, rows_of(&flat), Distortion::NONE, None)
}

/// Nine numbers with whatever brackets and commas between them, as `np.savetxt` and people write them.
pub fn read_matrix_text(file_name: &str, text: &str) -> Result<CameraFile, FormatError> {
    let numbers = numbers_of(text)?;
    let flat: [f64; 9] = numbers.as_slice().try_into().map_err(|_| {
        FormatError::at(
            "the text",
            format!("the nine numbers of a 3×3 camera matrix expected, found {}", numbers.len()),
        )
    })?;
    CameraFile::checked(file_name, rows_of(&flat), Distortion::NONE, None)
}

/// The numbers of a text in which there is nothing else; lines after a `#` are comments.
fn numbers_of(text: &str) -> Result<Vec<f64>, FormatError> {
    let mut numbers = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let words = line.split(|c: char| c.is_whitespace() || ",;[]()".contains(c));
        for word in words.filter(|word| !word.is_empty()) {
            let number: f64 = word.parse().map_err(|_| {
                let shown: String = word.chars().take(20).collect();
                FormatError::at(
                    format!("line {}", index + 1),
                    format!("a number of a camera matrix expected, found \"{shown}\""),
                )
            })?;
            numbers.push(number);
            if numbers.len() > 9 {
                return Err(FormatError::at(
                    format!("line {}", index + 1),
                    "more than the nine numbers of a camera matrix",
                ));
            }
        }
    }
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nine_numbers_are_a_camera() {
        let camera =
            read_matrix_text("K.txt", "# K\n5.724114e+02 0 325.2611\n[0, 573.57043, 242.04899]\n0 0 1\n");
        assert_eq!(
            camera.unwrap().k,
            [[572.4114, 0.0, 325.2611], [0.0, 573.57043, 242.04899], [0.0, 0.0, 1.0]]
        );
    }

    #[test]
    fn what_is_no_camera_is_refused_in_words() {
        let message = |text: &str| read_matrix_text("K.txt", text).unwrap_err().to_string();
        assert!(message("1 2 3").contains("found 3"));
        assert!(message("500 0 3\nwidth").contains("line 2"));
        assert!(message(&"1 ".repeat(1000)).contains("more than the nine"));
        assert!(message("500 0 320 0 500 240 0 0 2").contains("K is not"));
        assert!(message("nan 0 320 0 500 240 0 0 1").contains("fx is NaN"));
    }
}
