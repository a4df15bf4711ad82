//! What there is for a report and what is missing, in words, before it is made.

use std::collections::BTreeSet;

use super::files::ReportFiles;
use super::gather::chosen;
use crate::study::{Results, Truth};

/// All that a researcher has to see before a report is made.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Overview {
    pub results: Part,
    pub truth: Part,
    /// The study's meshes and photos.
    pub study: Part,
    pub people: Vec<Person>,
    /// What was left out or is not as it should be, one sentence each.
    pub remarks: Vec<String>,
}

/// One kind of files that a report needs.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Part {
    pub text: String,
    pub is_there: bool,
}

impl Part {
    fn there(text: String) -> Self {
        Self { text, is_there: true }
    }

    fn missing(text: impl Into<String>) -> Self {
        Self { text: text.into(), is_there: false }
    }
}

/// One participation that would be in the report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Person {
    pub id: String,
    pub study: String,
    pub trials: usize,
    pub is_finished: bool,
    pub is_simulated: bool,
    pub file: String,
}

impl Overview {
    pub fn of(files: &ReportFiles) -> Self {
        let mut remarks = files.unreadable.clone();
        let chosen = chosen(&files.results, &mut remarks);
        for (file, results) in &chosen {
            remarks.extend(mismatch(files, file, results));
        }
        let people: Vec<Person> = chosen.iter().map(|(file, results)| person(file, results)).collect();
        remarks.extend(repeated(&people));
        Self {
            results: results_part(&people),
            truth: truth_part(files),
            study: study_part(files),
            people,
            remarks,
        }
    }

    /// A report can be made of it, of whatever is there.
    pub fn is_enough(&self) -> bool {
        self.results.is_there && self.truth.is_there && self.study.is_there
    }
}

fn person(file: &str, results: &Results) -> Person {
    Person {
        id: results.participant.id.clone(),
        study: results.study.title.clone(),
        trials: results.trials.len(),
        is_finished: results.finished_at.is_some(),
        is_simulated: results.is_simulated,
        file: file.to_owned(),
    }
}

/// Results of a study that nothing else here is of, or of another version of it.
fn mismatch(files: &ReportFiles, file: &str, results: &Results) -> Option<String> {
    if files.truths.is_empty() {
        return None;
    }
    let study = &results.study;
    let of_study: Vec<&Truth> = files.truths.iter().filter(|truth| truth.study == study.id).collect();
    if of_study.is_empty() {
        return Some(format!(
            "{file}: these are results of the study \"{}\", whose true poses are not here; they are left out",
            study.title
        ));
    }
    let is_same = of_study.iter().any(|truth| truth.study_sha256 == study.sha256);
    (!is_same).then(|| format!("{file}: made with another version of the study than the true poses"))
}

/// Two participations under one id.
fn repeated(people: &[Person]) -> Vec<String> {
    let mut said = BTreeSet::new();
    let mut remarks = Vec::new();
    for one in people {
        let same: Vec<&str> = people
            .iter()
            .filter(|other| other.id == one.id && other.study == one.study)
            .map(|other| other.file.as_str())
            .collect();
        if same.len() > 1 && said.insert((&one.study, &one.id)) {
            let (count, files) = (same.len(), same.join(", "));
            remarks.push(format!(
                "{count} participations have the id {} ({files}); each counts as a person of its own",
                one.id
            ));
        }
    }
    remarks
}

fn results_part(people: &[Person]) -> Part {
    if people.is_empty() {
        return Part::missing("No result file yet");
    }
    let trials: usize = people.iter().map(|person| person.trials).sum();
    let mut text = format!("{}, {}", counted(people.len(), "participant"), counted(trials, "trial"));
    for (count, words) in [
        (people.iter().filter(|person| !person.is_finished).count(), "not finished"),
        (people.iter().filter(|person| person.is_simulated).count(), "simulated"),
    ] {
        if count > 0 {
            text += &format!(", {count} {words}");
        }
    }
    Part::there(text)
}

fn truth_part(files: &ReportFiles) -> Part {
    let samples = files.truths.iter().flat_map(|truth| &truth.samples);
    let count = samples.clone().count();
    if count == 0 {
        return Part::missing("Missing: the file whose name ends in _truth_PRIVATE.json, or truth.json");
    }
    let unknown = samples.filter(|sample| sample.pose.is_none()).count();
    let mut text = counted(count, "sample");
    if unknown > 0 {
        text += &format!(", {unknown} without a true pose");
    }
    Part::there(text)
}

fn study_part(files: &ReportFiles) -> Part {
    let samples = || files.truths.iter().flat_map(|truth| &truth.samples);
    let meshes: BTreeSet<(&str, &str)> =
        samples().map(|sample| (sample.mesh_sha256.as_str(), sample.object.as_str())).collect();
    let photos: BTreeSet<&str> = samples().map(|sample| sample.photo_sha256.as_str()).collect();
    let missing: Vec<&str> =
        meshes.iter().filter(|(sha256, _)| !files.has_asset(sha256)).map(|(_, name)| *name).collect();
    let unseen = photos.iter().filter(|sha256| !files.has_asset(sha256)).count();
    if meshes.is_empty() {
        return match files.studies.first() {
            Some(study) => Part::there(study.title.clone()),
            None => Part::missing("Missing: the study's zip, with its meshes and photos"),
        };
    }
    if missing.len() == meshes.len() {
        return Part::missing("Missing: the study's zip, with its meshes and photos");
    }
    let mut text = format!("{}, {}", counted(meshes.len(), "object"), counted(photos.len(), "photo"));
    if !missing.is_empty() {
        text += &format!("; left out are {}, whose meshes are not here", missing.join(", "));
    }
    if unseen > 0 {
        text += &format!("; {} not here, so not shown", counted(unseen, "photo"));
    }
    Part::there(text)
}

fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::NamedFile;
    use crate::study::{Environment, Participant, StudyRecord};

    fn results(study: &str, sha256: &str, id: &str, started: &str) -> String {
        let record =
            StudyRecord { id: study.to_owned(), title: format!("Study {study}"), sha256: sha256.to_owned() };
        let participant = Participant { id: id.to_owned(), recruiter: std::collections::BTreeMap::new() };
        Results::new(record, participant, Environment::default(), 1, started.to_owned()).to_json()
    }

    fn with(files: &[(&str, String)]) -> Overview {
        let mut found = ReportFiles::default();
        for (name, text) in files {
            found.add_or_note(&NamedFile {
                name: (*name).to_owned(),
                bytes: text.clone().into_bytes().into(),
            });
        }
        Overview::of(&found)
    }

    #[test]
    fn nothing_is_there_and_all_of_it_is_named() {
        let nothing = with(&[]);
        assert!(!nothing.is_enough() && nothing.remarks.is_empty());
        for part in [&nothing.results, &nothing.truth, &nothing.study] {
            assert!(!part.is_there && !part.text.is_empty(), "{part:?}");
        }
    }

    #[test]
    fn what_does_not_belong_is_said_in_words() {
        let truth = Truth::new("a", "v1", Vec::new()).to_json();
        let first = results("a", "v1", "P1", "2026-01-01T00:00:00Z");
        let cut = first.get(..first.len() / 2).unwrap_or_default().to_owned();
        let found = with(&[
            ("truth.json", truth),
            ("first.json", first.clone()),
            ("copy.json", first.clone()),
            ("again.json", results("a", "v1", "P1", "2026-01-02T00:00:00Z")),
            ("older.json", results("a", "v0", "P2", "2026-01-01T00:00:00Z")),
            ("other.json", results("b", "v1", "P3", "2026-01-01T00:00:00Z")),
            ("cut.json", cut),
        ]);
        // The copy is the first file once more.
        assert_eq!(found.people.len(), 4, "{:?}", found.people);
        let said = |words: &str| {
            assert!(
                found.remarks.iter().any(|remark| remark.contains(words)),
                "{words}: {:?}",
                found.remarks
            );
        };
        said("cut.json: line");
        said("cut short; it is left out");
        said("older.json: made with another version");
        said("other.json: these are results of the study \"Study b\"");
        said("2 participations have the id P1 (first.json, again.json)");
        assert_eq!(found.remarks.len(), 4, "{:?}", found.remarks);
    }
}
