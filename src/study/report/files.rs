//! The files that a report is made of, told apart by their content, in whatever order they come.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::{DAffine3, DMat4};
use serde::Deserialize;

use super::gather::GatherError;
use crate::formats::NamedFile;
use crate::mesh::Mesh;
use crate::scene::{MeshFrame, Sha256};
use crate::study::pack::StudyFiles;
use crate::study::{Results, Study, StudyError, Truth, TruthSample};

/// Files of a study that were recognised by their content; what is none of them may be a mesh or a photo.
#[derive(Debug, Default)]
pub struct ReportFiles {
    pub results: Vec<(String, Results)>,
    pub truths: Vec<Truth>,
    pub studies: Vec<Study>,
    /// What was left out because it cannot be read: the file, and why.
    pub unreadable: Vec<String>,
    /// By their SHA-256.
    assets: BTreeMap<String, NamedFile>,
    /// Of every file that came: a second one of the same content is nothing new.
    seen: BTreeSet<String>,
    /// Meshes that were read, by file and frame.
    meshes: BTreeMap<String, Result<Arc<Mesh>, String>>,
}

impl ReportFiles {
    /// Sorts files by what they say they are. A result or truth file that cannot be read is an error.
    pub fn read(files: &[NamedFile]) -> Result<Self, GatherError> {
        let mut found = Self::default();
        files.iter().try_for_each(|file| found.add(file))?;
        Ok(found)
    }

    /// Takes one file more. What is JSON and no part of a study is passed over; what was cut short is an error, for it may
    /// have been one.
    pub fn add(&mut self, file: &NamedFile) -> Result<(), GatherError> {
        let sha256 = Sha256::of(&file.bytes).to_string();
        if !self.seen.insert(sha256.clone()) {
            return Ok(());
        }
        let failed = |error| GatherError::File { file: file.name.clone(), error };
        match format_of(&file.bytes).map_err(failed)?.as_deref() {
            Some("pinpose-study-results") => {
                let results = Results::from_json(&file.bytes).map_err(failed)?;
                self.results.push((file.name.clone(), results));
            }
            Some("pinpose-study-truth") => self.truths.push(Truth::from_json(&file.bytes).map_err(failed)?),
            Some("pinpose-study") => self.studies.push(Study::from_json(&file.bytes).map_err(failed)?),
            Some(_) => {}
            None => {
                self.assets.insert(sha256, file.clone());
            }
        }
        Ok(())
    }

    /// Takes one file more, or notes why it is left out.
    pub fn add_or_note(&mut self, file: &NamedFile) {
        if let Err(error) = self.add(file) {
            self.unreadable.push(format!("{error}; it is left out"));
        }
    }

    /// A study that was just packed, with what nobody but its researcher has.
    pub fn of_study(study: &StudyFiles, truth: Truth) -> Self {
        let mut found = Self { truths: vec![truth], studies: vec![study.study.clone()], ..Self::default() };
        for (sha256, file) in study.named_files() {
            found.assets.insert(sha256, file);
        }
        found
    }

    pub fn is_empty(&self) -> bool {
        self.seen.is_empty() && self.truths.is_empty() && self.unreadable.is_empty()
    }

    pub(super) fn photo(&self, sha256: &str) -> Option<Arc<[u8]>> {
        self.assets.get(sha256).map(|file| file.bytes.clone())
    }

    pub(super) fn has_asset(&self, sha256: &str) -> bool {
        self.assets.contains_key(sha256)
    }

    /// Reads one mesh that a truth speaks of and that was not read yet; `false` once there is none. A page reads one a frame.
    pub fn read_next_mesh(&mut self) -> bool {
        let samples = self.truths.iter().flat_map(|truth| &truth.samples);
        let mut unread = samples.filter(|sample| !self.meshes.contains_key(&mesh_key(sample)));
        let Some(sample) = unread.next() else { return false };
        let (key, mesh) = (mesh_key(sample), self.read_mesh(sample).map(Arc::new));
        self.meshes.insert(key, mesh);
        true
    }

    /// The mesh of a sample, in the `object` frame.
    pub(super) fn mesh_of(&self, sample: &TruthSample) -> Result<Arc<Mesh>, String> {
        let read = self.meshes.get(&mesh_key(sample));
        read.cloned().unwrap_or_else(|| Err("its mesh was not read".to_owned()))
    }

    fn read_mesh(&self, sample: &TruthSample) -> Result<Mesh, String> {
        let file = self
            .assets
            .get(&sample.mesh_sha256)
            .ok_or_else(|| format!("the mesh {} is not among the files", sample.object))?;
        let object = self
            .studies
            .iter()
            .flat_map(|study| &study.objects)
            .find(|object| object.mesh.sha256 == sample.mesh_sha256);
        // A mesh asks for its buffers by the names that they had before they were packed.
        let companions: Vec<NamedFile> = object
            .iter()
            .flat_map(|object| &object.companions)
            .filter_map(|asset| {
                let bytes = self.assets.get(&asset.sha256)?.bytes.clone();
                Some(NamedFile { name: asset.name.clone(), bytes })
            })
            .collect();
        mesh_of_study(file, &companions, &sample.mesh_from_file)
            .map_err(|error| format!("{}: {error}", sample.object))
    }
}

/// The same file may be in two frames.
fn mesh_key(sample: &TruthSample) -> String {
    format!("{} {:?}", sample.mesh_sha256, sample.mesh_from_file)
}

/// A study's mesh in the `object` frame. `companions` are the files that it asks for, by their names.
pub fn mesh_of_study(
    file: &NamedFile,
    companions: &[NamedFile],
    mesh_from_file: &[[f64; 4]; 4],
) -> Result<Mesh, String> {
    let find = |asked: &str| {
        // A study keeps its files' names without their folders.
        let asked = asked.rsplit(['/', '\\']).next().unwrap_or(asked);
        let found = companions.iter().find(|companion| companion.name.eq_ignore_ascii_case(asked));
        found.map(|companion| companion.bytes.clone())
    };
    let mesh = crate::mesh::load(&file.name, &file.bytes, &find).map_err(|error| error.to_string())?.mesh;
    let mesh_from_file = DMat4::from_cols_array_2d(mesh_from_file).transpose();
    if mesh_from_file == DMat4::IDENTITY {
        return Ok(mesh);
    }
    // Another matrix than these would give numbers that are none.
    MeshFrame::checked(mesh_from_file).map_err(|error| error.to_string())?;
    mesh.transformed(&DAffine3::from_mat4(mesh_from_file)).map_err(|error| error.to_string())
}

/// What a JSON file says it is; empty where it says nothing, `None` for other files.
fn format_of(bytes: &[u8]) -> Result<Option<String>, StudyError> {
    #[derive(Deserialize)]
    struct Head {
        #[serde(default)]
        format: String,
    }
    if bytes.iter().find(|byte| !byte.is_ascii_whitespace()) != Some(&b'{') {
        return Ok(None);
    }
    match serde_json::from_slice::<Head>(bytes) {
        Ok(head) => Ok(Some(head.format)),
        Err(error) if error.is_eof() => Err(StudyError::json(&error)),
        // Of another program.
        Err(_) => Ok(Some(String::new())),
    }
}
