//! The Python that results are held against.

use std::process::Command;

/// A Python with NumPy: the one that `PINPOSE_PYTHON` names, or else the one on the path, or the system's own, which is where
/// a distribution's package puts NumPy though a version manager's Python may come first on the path.
pub fn with_numpy() -> Option<String> {
    let candidates = match std::env::var("PINPOSE_PYTHON") {
        Ok(named) => vec![named],
        Err(_) => ["python3", "/usr/bin/python3"].map(str::to_owned).to_vec(),
    };
    candidates.into_iter().find(|python| {
        let found = Command::new(python).args(["-c", "import numpy"]).output();
        found.is_ok_and(|output| output.status.success())
    })
}
