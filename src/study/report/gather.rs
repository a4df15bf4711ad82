//! From files to what a report is made of: results, truth, meshes and photos, found by their content.

use std::collections::BTreeMap;
use std::sync::Arc;

use thiserror::Error;

use super::files::ReportFiles;
use super::input::{ReportCondition, ReportInput, ReportSample, SampleView};
use super::people::{participant_of, sorted_and_labelled};
use crate::mesh::Mesh;
use crate::study::{Results, StudyError, Truth, TruthSample};

/// Why there can be no report.
#[derive(Debug, Error)]
pub enum GatherError {
    #[error("{file}: {error}")]
    File { file: String, error: StudyError },
    #[error("there is no result file among the files")]
    NoResults,
    #[error(
        "there is no truth file among the files: truth.json is written beside a study's folder when it is packed"
    )]
    NoTruth,
    #[error("no trial can be scored: {0}")]
    NothingToScore(String),
}

/// All that was gathered so far.
struct Gathered {
    input: ReportInput,
    /// By study and sample.
    samples: BTreeMap<(String, String), usize>,
    /// By study and set.
    sets: BTreeMap<(String, Option<String>), usize>,
}

/// Puts results, truth, meshes and photos together. What cannot be scored is left out with a remark.
pub fn gather(files: &ReportFiles) -> Result<ReportInput, GatherError> {
    if files.results.is_empty() {
        return Err(GatherError::NoResults);
    }
    if files.truths.is_empty() {
        return Err(GatherError::NoTruth);
    }
    let title_of = |study: &str| {
        let found = files.results.iter().find(|(_, results)| results.study.id == study);
        found.map_or_else(|| study.to_owned(), |(_, results)| results.study.title.clone())
    };
    let titles: Vec<String> = files.truths.iter().map(|truth| title_of(&truth.study)).collect();
    let input = ReportInput {
        title: titles.join(" and "),
        remarks: files.unreadable.clone(),
        ..ReportInput::default()
    };
    let mut gathered = Gathered { input, samples: BTreeMap::new(), sets: BTreeMap::new() };
    for truth in &files.truths {
        gathered.take_samples(files, truth, &title_of(&truth.study));
    }
    if gathered.input.samples.is_empty() {
        return Err(GatherError::NothingToScore(gathered.input.remarks.join("; ")));
    }
    let chosen = chosen(&files.results, &mut gathered.input.remarks);
    gathered.input.remarks.extend(ids_that_come_twice(&chosen));
    for (file, results) in chosen {
        gathered.take_results(files, file, results);
    }
    if gathered.input.participants.is_empty() {
        return Err(GatherError::NothingToScore(gathered.input.remarks.join("; ")));
    }
    sorted_and_labelled(&mut gathered.input);
    Ok(gathered.input)
}

/// Whose id comes more than once: somebody took part twice, or two people were given one id. Nobody but the researcher can tell.
fn ids_that_come_twice(results: &[(&str, &Results)]) -> Vec<String> {
    let mut files: BTreeMap<[&str; 2], Vec<&str>> = BTreeMap::new();
    for (file, results) in results {
        files.entry([&results.study.id, &results.participant.id]).or_default().push(file);
    }
    let remark = |([_, id], files): ([&str; 2], Vec<&str>)| {
        let among = files.join(", ");
        (files.len() > 1).then(|| {
            format!("{among}: {} participations have the id {id}; each counts as a person", files.len())
        })
    };
    files.into_iter().filter_map(remark).collect()
}

/// Of several files of one participation the one that got farthest.
pub(super) fn chosen<'a>(
    results: &'a [(String, Results)],
    remarks: &mut Vec<String>,
) -> Vec<(&'a str, &'a Results)> {
    let mut best: BTreeMap<[&str; 3], (&str, &Results)> = BTreeMap::new();
    for (file, found) in results {
        let key = [found.started_at.as_str(), &found.study.id, &found.participant.id];
        let progress = |results: &Results| (results.finished_at.is_some(), results.trials.len());
        let held = best.entry(key).or_insert((file, found));
        if held.1 != found {
            let (kept, left) = if progress(found) > progress(held.1) {
                (file.as_str(), held.0)
            } else {
                (held.0, file.as_str())
            };
            remarks.push(format!("{left}: left out, {kept} is of the same participation"));
            if kept == file {
                *held = (file, found);
            }
        }
    }
    best.into_values().collect()
}

impl Gathered {
    fn take_samples(&mut self, files: &ReportFiles, truth: &Truth, title: &str) {
        let several = files.truths.len() > 1;
        for sample in &truth.samples {
            let mesh = files.mesh_of(sample);
            let set = self.set(&truth.study, sample.set.as_deref(), several.then_some(title));
            match sample_of(files, sample, mesh, set) {
                Ok(mut found) => {
                    let place = self.input.samples.iter().filter(|other| other.set == set).count();
                    found.label = format!("S{place}");
                    self.samples.insert((truth.study.clone(), sample.id.clone()), self.input.samples.len());
                    self.input.samples.push(found);
                }
                Err(reason) => self.input.remarks.push(format!("sample {}: left out, {reason}", sample.id)),
            }
        }
    }

    fn set(&mut self, study: &str, set: Option<&str>, title: Option<&str>) -> usize {
        let key = (study.to_owned(), set.map(str::to_owned));
        let name = match (title, set) {
            (Some(title), Some(set)) => format!("{title}, {set}"),
            (one, other) => other.or(one).unwrap_or_default().to_owned(),
        };
        let sets = &mut self.input.sets;
        *self.sets.entry(key).or_insert_with(|| {
            sets.push(name);
            sets.len() - 1
        })
    }

    fn take_results(&mut self, files: &ReportFiles, file: &str, results: &Results) {
        let study = &results.study;
        let Some(truth) = files.truths.iter().find(|truth| truth.study == study.id) else {
            self.input.remarks.push(format!("{file}: left out, no truth of the study {} is here", study.id));
            return;
        };
        if truth.study_sha256 != study.sha256 {
            self.input.remarks.push(format!("{file}: made with another version of the study than the truth"));
        }
        if results.finished_at.is_none() {
            let count = results.trials.len();
            self.input.remarks.push(format!("{file}: not finished, its {count} trials are in the report"));
        }
        let items = files.studies.iter().find(|known| known.id == study.id);
        let conditions = &mut self.input.conditions;
        let mut condition = |id: &str| {
            conditions.iter().position(|known| known.id == id).unwrap_or_else(|| {
                let title = items.and_then(|study| study.condition(id)).map_or(id, |found| &found.title);
                conditions.push(ReportCondition { id: id.to_owned(), title: title.to_owned() });
                conditions.len() - 1
            })
        };
        let sample = |id: &str| self.samples.get(&(study.id.clone(), id.to_owned())).copied();
        let (participant, left_out) = participant_of(results, items, sample, &mut condition);
        if left_out > 0 {
            self.input.remarks.push(format!("{file}: {left_out} trials are left out, they cannot be scored"));
        }
        if !participant.trials.is_empty() {
            self.input.participants.push(participant);
        }
    }
}

/// A sample with its mesh; its label is still to be given.
fn sample_of(
    files: &ReportFiles,
    sample: &TruthSample,
    mesh: Result<Arc<Mesh>, String>,
    set: usize,
) -> Result<ReportSample, String> {
    let mesh = mesh?;
    let truth = sample.pose.ok_or("its true pose is not known")?;
    let truth = truth.to_pose().map_err(|error| format!("its true pose: {error}"))?;
    let symmetries = sample.symmetries.to_symmetries().ok_or("its symmetries are no transforms")?;
    let camera = sample.camera.to_intrinsics().ok();
    let photo = files.photo(&sample.photo_sha256);
    let view = camera.zip(photo).map(|(camera, photo)| SampleView { camera, photo });
    let name = format!("{} in {}", sample.object, sample.photo);
    Ok(ReportSample { label: String::new(), set, name, mesh, symmetries, truth, view })
}
