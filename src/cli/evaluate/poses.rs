//! Poses by themselves: what is held against the truth needs no photos and meshes of its own.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::cli::Failure;
use crate::cli::open::{expand, file_name, parse};
use crate::formats::{FileKind, Incoming, NamedFile, Parsed, classify};

/// What was named as poses: the poses, and files that are none of that but may be needed with them.
pub struct PoseFiles {
    pub poses: Vec<Incoming>,
    pub other_files: Vec<PathBuf>,
}

/// Reads poses without their photos and meshes: of a workspace its document alone.
pub fn read_poses(paths: &[PathBuf]) -> Result<PoseFiles, Failure> {
    let mut found = PoseFiles { poses: Vec::new(), other_files: Vec::new() };
    let mut problems = Vec::new();
    for path in paths {
        let files =
            expand(path).map_err(|error| Failure::Input(vec![format!("{}: {error}", path.display())]))?;
        for path in files {
            match read_poses_of(&path) {
                Ok(Some(poses)) => found.poses.push(poses),
                Ok(None) => found.other_files.push(path),
                Err(problem) => problems.push(problem),
            }
        }
    }
    if problems.is_empty() { Ok(found) } else { Err(Failure::Input(problems)) }
}

/// `None` for a file that holds none.
fn read_poses_of(path: &Path) -> Result<Option<Incoming>, String> {
    let bytes = fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let file = NamedFile { name: file_name(path), bytes: Arc::from(bytes) };
    if matches!(classify(&file.name, &file.bytes), FileKind::Photo | FileKind::Mesh | FileKind::Unknown) {
        return Ok(None);
    }
    match parse(&file, &[])?.0 {
        Parsed::Poses(poses) => Ok(Some(poses)),
        Parsed::Workspace(workspace) => Incoming::from_document(&file.name, &workspace.document)
            .map(Some)
            .map_err(|error| format!("{}: {error}", file.name)),
        Parsed::Photo(_) | Parsed::Mesh(_) | Parsed::Camera(_) => Ok(None),
    }
}
