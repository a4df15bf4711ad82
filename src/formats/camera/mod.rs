//! A camera in a file of its own: JSON, OpenCV's YAML, NumPy, plain text.

mod json;
mod matrix;
mod opencv;

use super::FormatError;
use crate::math::{Distortion, Intrinsics};

pub(super) use json::looks_like_camera;
pub use json::read_camera;
pub(super) use matrix::{read_matrix_array, read_matrix_text};
pub(super) use opencv::read_opencv_yaml;

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
    /// The camera, if its numbers are those of one.
    pub fn checked(
        file_name: &str,
        k: [[f64; 3]; 3],
        distortion: Distortion,
        size: Option<(u32, u32)>,
    ) -> Result<Self, FormatError> {
        let (width, height) = size.unwrap_or((1, 1));
        let pinhole = Intrinsics::from_k_rows(&k, width, height);
        let checked = pinhole.and_then(|pinhole| Intrinsics { distortion, ..pinhole }.checked());
        checked.map_err(|error| FormatError::camera("the camera", error))?;
        Ok(Self { file_name: file_name.to_owned(), k, distortion, size })
    }

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

/// Nine numbers in three rows.
pub(super) fn rows_of(flat: &[f64; 9]) -> [[f64; 3]; 3] {
    let [a, b, c, d, e, f, g, h, i] = *flat;
    [[a, b, c], [d, e, f], [g, h, i]]
}

/// OpenCV's list of coefficients `k1 k2 p1 p2 [k3 [k4 k5 k6 …]]`. What a Brown–Conrady lens has none of has to be zero.
pub(super) fn distortion_from_list(place: &str, coefficients: &[f64]) -> Result<Distortion, FormatError> {
    let (known, rest) = coefficients.split_at(coefficients.len().min(5));
    if rest.iter().any(|coefficient| *coefficient != 0.0) {
        return Err(FormatError::at(
            place,
            format!(
                "{} coefficients; a lens model with more than k1 k2 p1 p2 k3 (rational, thin prism, tilted) is not read: \
                 undistort the photos, or calibrate with five coefficients",
                coefficients.len()
            ),
        ));
    }
    let mut five = [0.0; 5];
    match known.len() {
        0 | 4 | 5 => five.iter_mut().zip(known).for_each(|(coefficient, value)| *coefficient = *value),
        count => {
            return Err(FormatError::at(
                place,
                format!("{count} coefficients; four (k1 k2 p1 p2) or five (and k3) expected"),
            ));
        }
    }
    Ok(Distortion::from_array(five))
}
