//! The study of the flows: the paper's on its ten photographs, or some of them, as a researcher makes it.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, ensure};
use pinpose::formats::zip_of_files;
use pinpose::study::{Asset, Study, Truth};

use crate::data::Linemod;

/// A study in a folder of its own, which goes with it.
pub struct Made {
    pub folder: PathBuf,
    pub study: Study,
    pub truth: Truth,
}

impl Made {
    /// `change` is what the researcher changes of the paper's protocol.
    pub fn new(name: &str, samples: usize, change: impl FnOnce(&mut Study)) -> anyhow::Result<Made> {
        let linemod = Linemod::open()?;
        let folder = std::env::temp_dir().join(format!("pinpose-{}-made-{name}", std::process::id()));
        std::fs::remove_dir_all(&folder).ok();
        let built = Command::new(env!("CARGO_BIN_EXE_pinpose"))
            .arg("build-study")
            .arg(linemod.folder())
            .args(["--id", "flow", "--title", "Ten objects", "--out"])
            .arg(&folder)
            .output()?;
        ensure!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
        let mut study = Study::from_json(&std::fs::read(folder.join("study/study.json"))?)?;
        let mut truth = Truth::from_json(&std::fs::read(folder.join("truth.json"))?)?;
        study.samples.truncate(samples);
        let used = |id: &str| study.samples.iter().any(|sample| sample.photo == id || sample.object == id);
        let (photos, objects) = (study.photos.clone(), study.objects.clone());
        let photos = photos.into_iter().filter(|photo| used(&photo.id)).collect();
        let objects = objects.into_iter().filter(|object| used(&object.id)).collect();
        (study.photos, study.objects) = (photos, objects);
        study.contact = "study@example.org".to_owned();
        change(&mut study);
        truth.samples.retain(|sample| study.sample(&sample.id).is_some());
        let mut made = Made { folder, study, truth };
        made.write()?;
        Ok(made)
    }

    /// What participants are sent.
    pub fn study_folder(&self) -> PathBuf {
        self.folder.join("study")
    }

    /// Both files as they are now: the truth is that of this version.
    pub fn write(&mut self) -> anyhow::Result<()> {
        let json = self.study.to_json();
        self.truth.study_sha256 = pinpose::scene::Sha256::of(json.as_bytes()).to_string();
        std::fs::write(self.folder.join("truth.json"), self.truth.to_json())?;
        Ok(std::fs::write(self.study_folder().join("study.json"), json)?)
    }

    /// A file of it.
    pub fn asset(&self, asset: &Asset) -> PathBuf {
        self.study_folder().join(&asset.path)
    }

    /// The files that are handed out, each with its path.
    pub fn files(&self) -> anyhow::Result<Vec<(String, std::sync::Arc<[u8]>)>> {
        let mut files = vec![("study.json".to_owned(), self.study.to_json().into_bytes().into())];
        for asset in self.study.assets() {
            files.push((asset.path.clone(), std::fs::read(self.asset(asset))?.into()));
        }
        Ok(files)
    }

    pub fn zip(&self) -> anyhow::Result<Vec<u8>> {
        Ok(zip_of_files(&self.files()?)?)
    }
}

impl Drop for Made {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.folder).ok();
    }
}

/// Nothing of the truth is in these bytes: no number of it as text, and no three in a row as a machine has them.
pub fn ensure_no_truth(what: &str, bytes: &[u8], truth: &Truth) -> anyhow::Result<()> {
    for sample in &truth.samples {
        let pose = sample.pose.context("A sample without a pose")?;
        let rows = pose.rotation.iter().chain(std::iter::once(&pose.translation_mm));
        for row in rows.filter(|row| row.iter().all(|number| number.fract() != 0.0)) {
            let doubles: Vec<u8> = row.iter().flat_map(|number| number.to_le_bytes()).collect();
            let floats: Vec<u8> = row.iter().flat_map(|number| (*number as f32).to_le_bytes()).collect();
            for pattern in [doubles, floats] {
                ensure!(!contains(bytes, &pattern), "{what} has numbers of {}'s truth", sample.id);
            }
            for number in row {
                // Seven digits of a number are nobody's by chance.
                let text: String = format!("{:.12}", number.abs()).chars().take(9).collect();
                ensure!(!contains(bytes, text.as_bytes()), "{what} has {text} of {}'s truth", sample.id);
            }
        }
    }
    Ok(())
}

fn contains(bytes: &[u8], pattern: &[u8]) -> bool {
    let Some(first) = pattern.first() else { return false };
    let mut from = 0;
    while let Some(at) = bytes[from..].iter().position(|byte| byte == first) {
        if bytes[from + at..].starts_with(pattern) {
            return true;
        }
        from += at + 1;
    }
    false
}

/// Every file beneath a folder.
pub fn files_beneath(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        match path.is_dir() {
            true => found.extend(files_beneath(&path)?),
            false => found.push(path),
        }
    }
    Ok(found)
}
