//! `pinpose pins FILE`: 2D–3D pairs and a camera to a pose, as JSON.
//!
//! In: a camera in any of the shapes that [`read_camera`] knows, `pins`: `[{"point": [x, y, z], "pixel": [u, v]}, …]` with an
//! optional `weight` and `enabled` each, and if wanted `start` (a row-major 4×4), `click_sigma_px`, `object_diameter_mm` and
//! `estimate_focal`. Millimetres of the object's frame, pixels with (0, 0) at the centre of the top-left one.

use serde_json::{Value, json};

use super::{Failure, Outcome, open};
use crate::formats::{FormatError, NamedFile, positive_number, read_camera, read_pins};
use crate::math::{Intrinsics, Pose};
use crate::solve::pins::{PinOptions, PinSolution, solve_focal, solve_pins};

pub fn run(mut parser: lexopt::Parser) -> Outcome {
    let mut paths = Vec::new();
    while let Some(argument) = parser.next()? {
        match argument {
            // The answer is JSON with or without it.
            lexopt::Arg::Long("json") => {}
            lexopt::Arg::Value(path) => paths.push(path.into()),
            other => return Err(other.unexpected().into()),
        }
    }
    if paths.len() != 1 {
        return Err(Failure::Usage("pins needs one file".to_owned()));
    }
    for file in open::read_files(&paths)? {
        let answer =
            answer(&file).map_err(|error| Failure::Input(vec![format!("{}: {error}", file.name)]))?;
        println!("{answer:#}");
    }
    Ok(())
}

fn answer(file: &NamedFile) -> Result<Value, FormatError> {
    let value: Value = serde_json::from_slice(&file.bytes).map_err(FormatError::json)?;
    let camera_file = read_camera(&file.name, &value)?;
    // The size matters for guesses at the focal length alone; where it is not said, the principal point is in the middle.
    let middle = |center: f64| (2.0 * center + 1.0).clamp(1.0, 65535.0) as u32;
    let camera = camera_file.intrinsics(middle(camera_file.k[0][2]), middle(camera_file.k[1][2]));
    let pins = read_pins(&value)?;
    let start = value.get("start").map(read_start).transpose()?;
    let options = read_options(&value)?;
    let refused = |error: &dyn std::error::Error| FormatError::at("\"pins\"", error.to_string());
    let focal = match value.get("estimate_focal") {
        Some(Value::Bool(true)) => {
            Some(solve_focal(&camera, &pins, &options).map_err(|error| refused(&error))?)
        }
        None | Some(Value::Bool(false)) => None,
        Some(other) => {
            return Err(FormatError::at(
                "\"estimate_focal\"",
                format!("true or false expected, found {other}"),
            ));
        }
    };
    let camera = focal.map_or(camera, |focal| focal.camera);
    let solution = solve_pins(&camera, &pins, start.as_ref(), &options).map_err(|error| refused(&error))?;
    let mut answer = describe(&camera, &solution);
    if let Some(focal) = focal {
        answer["focal_relative_sigma"] = json!(focal.relative_sigma);
    }
    Ok(answer)
}

fn describe(camera: &Intrinsics, solution: &PinSolution) -> Value {
    let pose = |pose: &Pose| json!(pose.to_rows());
    json!({
        "frame": "camera_from_object, OpenCV camera axes, millimetres, row-major",
        "K": camera.k_rows(),
        "pose": pose(&solution.camera_from_object),
        "rms_px": solution.rms_px,
        "residuals_px": solution.residuals_px.iter().map(|r| r.map(|r| r.to_array())).collect::<Vec<_>>(),
        "misclicks": solution.misclicks,
        "alternatives": solution.alternatives.iter()
            .map(|other| json!({"pose": pose(&other.camera_from_object), "rms_px": other.rms_px}))
            .collect::<Vec<_>>(),
        "advice": solution.advice.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "covariance": solution.covariance.map(|covariance| covariance.0),
        "covariance_of": "the left twist (wx wy wz in radians, vx vy vz in mm), true pose = exp(twist) * pose",
    })
}

fn read_options(value: &Value) -> Result<PinOptions, FormatError> {
    let default = PinOptions::default();
    Ok(PinOptions {
        click_sigma_px: positive_number(value, "click_sigma_px", "the file")?
            .unwrap_or(default.click_sigma_px),
        object_diameter_mm: positive_number(value, "object_diameter_mm", "the file")?,
    })
}

fn read_start(value: &Value) -> Result<Pose, FormatError> {
    let wrong = || FormatError::at("\"start\"", "four rows of four numbers expected");
    let rows: Option<Vec<f64>> = value
        .as_array()
        .filter(|rows| rows.len() == 4)
        .and_then(|rows| rows.iter().map(Value::as_array).collect::<Option<Vec<_>>>())
        .filter(|rows| rows.iter().all(|row| row.len() == 4))
        .and_then(|rows| rows.into_iter().flatten().map(Value::as_f64).collect());
    let numbers: [f64; 16] = rows.ok_or_else(wrong)?.try_into().map_err(|_| wrong())?;
    let rows = [0, 4, 8, 12].map(|i| [numbers[i], numbers[i + 1], numbers[i + 2], numbers[i + 3]]);
    let (pose, _) = Pose::from_rows(&rows).map_err(|error| FormatError::pose("\"start\"", error))?;
    Ok(pose)
}
