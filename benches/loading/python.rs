//! trimesh as the anchor, in a process of its own.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

pub struct Answer {
    pub version: String,
    pub seconds: f64,
    pub triangles: usize,
}

/// A virtual environment beside the build, made on first use.
pub fn with_trimesh() -> Result<PathBuf, String> {
    let environment = Path::new(env!("CARGO_TARGET_TMPDIR")).join("trimesh");
    let python = environment.join("bin/python");
    if run(Command::new(&python).args(["-c", "import trimesh"])).is_ok() {
        return Ok(python);
    }
    run(Command::new("python3").args(["-m", "venv"]).arg(&environment))
        .map_err(|error| format!("there is no Python here ({error})"))?;
    run(Command::new(&python).args(["-m", "pip", "install", "--quiet", "trimesh"]))
        .map_err(|error| format!("trimesh cannot be installed ({error})"))?;
    Ok(python)
}

pub fn load(python: &Path, path: &Path, repetitions: usize) -> Result<Answer, String> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/loading/anchor.py");
    let said = run(Command::new(python).arg(script).arg(path).arg(repetitions.to_string()))?;
    let answer: Value = serde_json::from_str(&said).map_err(|error| error.to_string())?;
    Ok(Answer {
        version: answer["version"].as_str().unwrap_or_default().to_owned(),
        seconds: answer["seconds"].as_f64().ok_or("no time")?,
        triangles: answer["triangles"].as_u64().ok_or("no triangles")? as usize,
    })
}

fn run(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|error| error.to_string())?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let text = String::from_utf8_lossy(&output.stderr);
    Err(text.lines().last().unwrap_or("it failed without a word").to_owned())
}
