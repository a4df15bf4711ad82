//! Poses as bare 4×4 matrices, `.npy` or JSON: of one photo, or one for each photo in turn. Millimetres, camera_from_object.

use serde::Deserialize;
use serde_json::Value;

use super::gather::{Found, Gather};
use super::npy::NpyArray;
use super::{FileKey, FormatError, Incoming, file_stem};

/// Reads 4×4 or N×4×4.
pub(super) fn read_pose_array(file_name: &str, array: &NpyArray) -> Result<Incoming, FormatError> {
    let count = match *array.shape.as_slice() {
        [4, 4] => 1,
        [count, 4, 4] if count > 0 => count,
        _ => {
            return Err(FormatError::at(
                "the array",
                format!("3×3 (a camera), 4×4 or N×4×4 (poses) expected, found {}", array.shape_in_words()),
            ));
        }
    };
    let matrices: Vec<[f64; 16]> =
        array.values.chunks_exact(16).filter_map(|matrix| matrix.try_into().ok()).collect();
    let stem = file_stem(file_name).to_owned();
    let mut gather = Gather::new(file_name);
    for (position, matrix) in matrices.iter().enumerate() {
        let photo = gather.photo(FileKey::Unnamed { stem: stem.clone(), position, of: count });
        let place = || format!("matrix {position}");
        let [r00, r01, r02, x, r10, r11, r12, y, r20, r21, r22, z, last @ ..] = *matrix;
        if last != [0.0, 0.0, 0.0, 1.0] {
            gather.leave_out(|| format!("{}: the last row of the 4×4 is not 0 0 0 1", place()));
            continue;
        }
        let object = FileKey::Unnamed { stem: stem.clone(), position: 0, of: 1 };
        let rotation = [r00, r01, r02, r10, r11, r12, r20, r21, r22];
        let found = Found { photo, object, rotation: &rotation, translation_mm: [x, y, z], score: None };
        gather.pose(found, place);
    }
    gather.finish()
}

/// JSON's nested lists as an array, if that is what they are: 3×3, 4×4 or N×4×4.
pub(super) fn array_of_json(value: &Value) -> Option<NpyArray> {
    if let Ok(matrix) = <[[f64; 3]; 3]>::deserialize(value) {
        return Some(NpyArray { shape: vec![3, 3], values: matrix.concat() });
    }
    if let Ok(matrix) = <[[f64; 4]; 4]>::deserialize(value) {
        return Some(NpyArray { shape: vec![4, 4], values: matrix.concat() });
    }
    let matrices = Vec::<[[f64; 4]; 4]>::deserialize(value).ok().filter(|matrices| !matrices.is_empty())?;
    let values = matrices.iter().flatten().flatten().copied().collect();
    Some(NpyArray { shape: vec![matrices.len(), 4, 4], values })
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn array(value: &Value) -> NpyArray {
        array_of_json(value).unwrap()
    }

    #[test]
    fn one_matrix_or_one_for_each_photo() {
        let pose = json!([[0, -1, 0, 5], [1, 0, 0, 6], [0, 0, 1, 700], [0, 0, 0, 1]]);
        let one = read_pose_array("mug.npy", &array(&pose)).unwrap();
        let rows = one.photos[0].poses[0].camera_from_object.to_rows();
        assert_eq!(rows[0], [0.0, -1.0, 0.0, 5.0]);
        assert_eq!(rows[2], [0.0, 0.0, 1.0, 700.0]);
        let three = read_pose_array("mug.npy", &array(&json!([pose, pose, pose]))).unwrap();
        assert_eq!((three.photos.len(), three.objects.len()), (3, 1));
        assert_eq!(three.photos[2].key, FileKey::Unnamed { stem: "mug".to_owned(), position: 2, of: 3 });
    }

    #[test]
    fn other_shapes_are_refused_in_words() {
        let message = |array: &NpyArray| read_pose_array("a.npy", array).unwrap_err().to_string();
        let wide = NpyArray { shape: vec![2, 8], values: vec![0.0; 16] };
        assert!(message(&wide).contains("found 2×8"));
        let transposed = json!([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [5, 6, 700, 1]]);
        assert!(message(&array(&transposed)).contains("last row"));
    }
}
