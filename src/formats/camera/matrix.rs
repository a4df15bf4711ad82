//! A bare matrix: NumPy's, or numbers in a text.

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

/// A 3×3 or 4×4 with whatever brackets and commas between its numbers, as `np.savetxt` and people write it; lines after a `#`
/// are comments.
pub fn read_matrix_text(text: &str) -> Result<NpyArray, FormatError> {
    let mut values = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let words = line.split(|c: char| c.is_whitespace() || ",;[]()".contains(c));
        for word in words.filter(|word| !word.is_empty()) {
            let at = |reason: String| FormatError::at(format!("line {}", index + 1), reason);
            let number: f64 = word.parse().map_err(|_| {
                let shown: String = word.chars().take(20).collect();
                at(format!("a number of a matrix expected, found \"{shown}\""))
            })?;
            values.push(number);
            if values.len() > 16 {
                return Err(at("more numbers than a 4×4 matrix has".to_owned()));
            }
        }
    }
    let shape = match values.len() {
        9 => vec![3, 3],
        16 => vec![4, 4],
        count => {
            return Err(FormatError::at(
                "the text",
                format!(
                    "the nine numbers of a camera matrix or the sixteen of a pose expected, found {count}"
                ),
            ));
        }
    };
    Ok(NpyArray { shape, values })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nine_numbers_are_a_camera_and_sixteen_a_pose() {
        let text = "# K\n5.724114e+02 0 325.2611\n[0, 573.57043, 242.04899]\n0 0 1\n";
        let camera = read_matrix_array("K.txt", &read_matrix_text(text).unwrap()).unwrap();
        assert_eq!(camera.k, [[572.4114, 0.0, 325.2611], [0.0, 573.57043, 242.04899], [0.0, 0.0, 1.0]]);
        assert_eq!(read_matrix_text("1 0 0 5\n0 1 0 6\n0 0 1 7\n0 0 0 1").unwrap().shape, [4, 4]);
    }

    #[test]
    fn what_is_no_matrix_is_refused_in_words() {
        let message = |text: &str| read_matrix_text(text).unwrap_err().to_string();
        assert!(message("1 2 3").contains("found 3"));
        assert!(message("500 0 3\nwidth").contains("line 2"));
        assert!(message(&"1 ".repeat(1000)).contains("more numbers"));
        let camera = |text: &str| {
            read_matrix_array("K.txt", &read_matrix_text(text).unwrap()).unwrap_err().to_string()
        };
        assert!(camera("500 0 320 0 500 240 0 0 2").contains("K is not"));
        assert!(camera("nan 0 320 0 500 240 0 0 1").contains("fx is NaN"));
    }
}
