//! 2D–3D pairs as JSON: what "Save pins" writes, and what `pinpose pins` solves.
//!
//! A camera in any of the shapes that [`super::read_camera`] knows, and `pins`: `[{"point": [x, y, z], "pixel": [u, v]}, …]`
//! with an optional `weight` and `enabled` each. Millimetres of the object's frame, pixels with (0, 0) at the centre of the
//! top-left one.

use glam::{DVec2, DVec3};
use serde_json::{Value, json};

use super::FormatError;
use crate::math::{Intrinsics, Pose};
use crate::scene::Pin;

/// Is this JSON about pins?
pub fn looks_like_pins(value: &Value) -> bool {
    value.get("pins").is_some_and(Value::is_array)
}

/// The pins of one object in one photo, with that photo's camera, and its pose to start from.
pub fn write_pins(camera: &Intrinsics, camera_from_object: &Pose, pins: &[Pin]) -> String {
    let pins: Vec<Value> = pins
        .iter()
        .map(|pin| {
            let mut entry = json!({ "point": pin.point_mm.to_array(), "pixel": pin.pixel.to_array() });
            if pin.weight != 1.0 {
                entry["weight"] = json!(pin.weight);
            }
            if !pin.enabled {
                entry["enabled"] = json!(false);
            }
            entry
        })
        .collect();
    let mut file = json!({
        "conventions": "point: mm of the object's frame; pixel: (0, 0) is the centre of the top-left one; start: camera_from_object, OpenCV axes",
        "K": camera.k_rows(),
        "width": camera.width,
        "height": camera.height,
        "pins": pins,
        "start": camera_from_object.to_rows(),
    });
    if !camera.distortion.is_none() {
        file["distortion"] = json!(camera.distortion.to_array());
    }
    format!("{file:#}\n")
}

/// The pairs of a file.
///
/// # Errors
/// Where in the file something else than a pair is.
pub fn read_pins(value: &Value) -> Result<Vec<Pin>, FormatError> {
    let list = value.get("pins").and_then(Value::as_array).ok_or_else(|| {
        FormatError::at("\"pins\"", "a list of {\"point\": [x, y, z], \"pixel\": [u, v]} expected")
    })?;
    list.iter().enumerate().map(|(index, pin)| read_pin(&format!("\"pins\"[{index}]"), pin)).collect()
}

fn read_pin(place: &str, pin: &Value) -> Result<Pin, FormatError> {
    let numbers = |key: &str, count: usize| {
        let found: Option<Vec<f64>> =
            pin.get(key).and_then(Value::as_array).and_then(|list| list.iter().map(Value::as_f64).collect());
        found
            .filter(|found| found.len() == count)
            .ok_or_else(|| FormatError::at(format!("{place}.\"{key}\""), format!("{count} numbers expected")))
    };
    let (point, pixel) = (numbers("point", 3)?, numbers("pixel", 2)?);
    let enabled = match pin.get("enabled") {
        None => true,
        Some(Value::Bool(enabled)) => *enabled,
        Some(_) => return Err(FormatError::at(format!("{place}.\"enabled\""), "true or false expected")),
    };
    Ok(Pin {
        point_mm: DVec3::new(point[0], point[1], point[2]),
        pixel: DVec2::new(pixel[0], pixel[1]),
        weight: positive_number(pin, "weight", place)?.unwrap_or(1.0),
        enabled,
    })
}

/// A number above 0 that may be left out; `place` is where it stands.
pub fn positive_number(value: &Value, key: &str, place: &str) -> Result<Option<f64>, FormatError> {
    let read = |found: &Value| {
        let number = found.as_f64().filter(|number| *number > 0.0 && number.is_finite());
        number.ok_or_else(|| {
            FormatError::at(
                format!("{place}, \"{key}\""),
                format!("a positive number expected, found {found}"),
            )
        })
    };
    value.get(key).map(read).transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pins_that_were_written_are_read_again() {
        let camera = Intrinsics::pinhole(570.0, 580.0, 310.0, 250.0, 640, 480);
        let off = Pin {
            enabled: false,
            weight: 2.5,
            ..Pin::new(DVec3::new(0.1, -2.0, 3.3), DVec2::new(7.5, 8.25))
        };
        let pins = [Pin::new(DVec3::X, DVec2::Y), off];
        let text = write_pins(&camera, &Pose::from_translation(DVec3::Z * 700.0), &pins);
        let value: Value = serde_json::from_str(&text).unwrap();
        assert!(looks_like_pins(&value));
        assert_eq!(read_pins(&value).unwrap(), pins);
    }

    #[test]
    fn what_is_no_pin_is_named() {
        let value = json!({ "pins": [{ "point": [1, 2, 3], "pixel": [4, 5] }, { "point": [1, 2], "pixel": [4, 5] }] });
        assert_eq!(read_pins(&value).unwrap_err().to_string(), "\"pins\"[1].\"point\": 3 numbers expected");
    }
}
