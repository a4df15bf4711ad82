//! OpenCV as the anchor: the same problems, solved by its Python package in a process of its own.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// Sends the problems to `anchor.py` and returns its answer; says in words why there is none.
pub fn solve(problems: &Value) -> Result<Value, String> {
    let python = python_with_opencv()?;
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let (input, output) = (folder.join("solver_problems.json"), folder.join("solver_answers.json"));
    std::fs::write(&input, problems.to_string()).map_err(|error| error.to_string())?;
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/solvers/anchor.py");
    run(Command::new(python).arg(script).arg(&input).arg(&output))?;
    let text = std::fs::read_to_string(&output).map_err(|error| error.to_string())?;
    serde_json::from_str(&text).map_err(|error| error.to_string())
}

/// A virtual environment beside the build, made on first use.
fn python_with_opencv() -> Result<PathBuf, String> {
    let environment = Path::new(env!("CARGO_TARGET_TMPDIR")).join("opencv");
    let python = environment.join("bin/python");
    let has_opencv = || run(Command::new(&python).args(["-c", "import cv2"])).is_ok();
    if has_opencv() {
        return Ok(python);
    }
    run(Command::new("python3").args(["-m", "venv"]).arg(&environment))
        .map_err(|error| format!("there is no Python here ({error})"))?;
    run(Command::new(&python).args(["-m", "pip", "install", "--quiet", "opencv-python-headless"]))
        .map_err(|error| format!("OpenCV cannot be installed ({error})"))?;
    Ok(python)
}

fn run(command: &mut Command) -> Result<(), String> {
    let output = command.output().map_err(|error| error.to_string())?;
    if output.status.success() {
        return Ok(());
    }
    let text = String::from_utf8_lossy(&output.stderr);
    Err(text.lines().last().unwrap_or("it failed without a word").to_owned())
}
