//! Poses by themselves: what is held against the truth needs no photos and meshes of its own.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::cli::Failure;
use crate::cli::open::{file_name, parse};
use crate::cli::source::Source;
use crate::formats::{FileKind, Incoming, NamedFile, Parsed, classify};

/// What was named as poses: the poses, and files and folders that hold none but may be needed with them.
pub struct PoseFiles {
    pub poses: Vec<Incoming>,
    pub other_files: Vec<PathBuf>,
}

/// Reads poses without their photos and meshes: of a workspace its document alone, of a data set its files of poses.
pub fn read_poses(paths: &[PathBuf]) -> Result<PoseFiles, Failure> {
    let mut found = PoseFiles { poses: Vec::new(), other_files: Vec::new() };
    let mut problems = Vec::new();
    for path in paths {
        match read_poses_of(path) {
            Ok(poses) if poses.is_empty() => found.other_files.push(path.clone()),
            Ok(poses) => found.poses.extend(poses),
            Err(problem) => problems.push(problem),
        }
    }
    if problems.is_empty() { Ok(found) } else { Err(Failure::Input(problems)) }
}

fn read_poses_of(path: &Path) -> Result<Vec<Incoming>, String> {
    if let Some(mut source) = Source::open(path)? {
        let all: Vec<usize> = (0..source.recognised.choices.len()).collect();
        return Ok(source.interpret(&all)?.poses);
    }
    if path.is_dir() {
        return Ok(Vec::new());
    }
    let bytes = fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let file = NamedFile { name: file_name(path), bytes: Arc::from(bytes) };
    if matches!(classify(&file.name, &file.bytes), FileKind::Photo | FileKind::Mesh | FileKind::Unknown) {
        return Ok(Vec::new());
    }
    match parse(&file, &[])?.0 {
        Parsed::Poses(poses) => Ok(vec![poses]),
        Parsed::Workspace(workspace) => Incoming::from_document(&file.name, &workspace.document)
            .map(|poses| vec![poses])
            .map_err(|error| format!("{}: {error}", file.name)),
        _ => Ok(Vec::new()),
    }
}
