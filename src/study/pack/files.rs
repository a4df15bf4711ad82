//! A study that was received: `study.json` and the files that it names, each checked by its content.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::formats::{Archive, NamedFile};
use crate::scene::Sha256;
use crate::study::{Asset, Study, StudyError, StudyRecord, check};

/// Where the protocol is, in a folder or a zip.
pub const STUDY_NAME: &str = "study.json";

/// A study with the files that have come so far.
#[derive(Debug, Clone)]
pub struct StudyFiles {
    pub study: Study,
    /// Of `study.json`: the study's version.
    pub sha256: String,
    files: BTreeMap<String, Arc<[u8]>>,
}

impl StudyFiles {
    pub fn from_json(bytes: &[u8]) -> Result<Self, StudyError> {
        let study = Study::from_json(bytes)?;
        check::usable(&study)?;
        Ok(Self { study, sha256: Sha256::of(bytes).to_string(), files: BTreeMap::new() })
    }

    /// All of a study in one file.
    pub fn from_zip(bytes: Arc<[u8]>) -> Result<Self, StudyError> {
        let packed = |error: crate::formats::FormatError| StudyError::Pack(error.to_string());
        let mut archive = Archive::open(bytes).map_err(packed)?;
        let listing = archive.listing("study").map_err(packed)?;
        // A folder that was zipped from outside is in the archive as a folder.
        let paths: Vec<String> = listing.paths().map(str::to_owned).collect();
        let is_study = |path: &&String| *path == STUDY_NAME || path.ends_with(&format!("/{STUDY_NAME}"));
        let place = paths.iter().find(is_study).ok_or_else(|| {
            StudyError::Pack(format!("there is no {STUDY_NAME} in the zip: it is no study"))
        })?;
        let folder = place.strip_suffix(STUDY_NAME).unwrap_or_default().to_owned();
        let mut files = Self::from_json(&archive.read(place).map_err(packed)?)?;
        let assets: Vec<Asset> = files.study.assets().into_iter().cloned().collect();
        for asset in assets {
            let content = archive.read(&format!("{folder}{}", asset.path)).map_err(packed)?;
            files.add(&asset, content)?;
        }
        Ok(files)
    }

    /// A file that has come; refused if it is not what the study speaks of.
    pub fn add(&mut self, asset: &Asset, bytes: Arc<[u8]>) -> Result<(), StudyError> {
        if Sha256::of(&bytes).to_string() != asset.sha256 {
            return Err(StudyError::Changed(asset.path.clone()));
        }
        self.files.insert(asset.path.clone(), bytes);
        Ok(())
    }

    pub fn has(&self, asset: &Asset) -> bool {
        self.files.contains_key(&asset.path)
    }

    /// What has not come yet.
    pub fn missing(&self) -> Vec<Asset> {
        let assets = self.study.assets().into_iter();
        assets.filter(|asset| !self.files.contains_key(&asset.path)).cloned().collect()
    }

    /// A file under the name that the researcher gave it.
    pub fn file(&self, asset: &Asset) -> Option<NamedFile> {
        Some(NamedFile { name: asset.name.clone(), bytes: self.files.get(&asset.path)?.clone() })
    }

    /// All that have come, with their SHA-256 and the researcher's names.
    pub fn named_files(&self) -> Vec<(String, NamedFile)> {
        let assets = self.study.assets().into_iter();
        assets.filter_map(|asset| Some((asset.sha256.clone(), self.file(asset)?))).collect()
    }

    pub fn record(&self) -> StudyRecord {
        StudyRecord {
            id: self.study.id.clone(),
            title: self.study.title.clone(),
            sha256: self.sha256.clone(),
        }
    }
}
