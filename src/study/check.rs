//! What is missing before a study can be handed out, and what would make it unusable.

use std::collections::BTreeSet;

use super::markdown::{Block, blocks};
use super::pack::{Draft, Pack, Role};
use super::{Assignment, SampleSets, Saving, Schedule, StartPose, Study, StudyError};
use crate::math::sort_short;
use crate::scene::Scene;

/// One thing to look at.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Finding {
    /// Nobody can take part as it is; otherwise it is only worth knowing.
    pub is_error: bool,
    pub text: String,
}

impl Finding {
    fn error(text: impl Into<String>) -> Self {
        Self { is_error: true, text: text.into() }
    }

    fn hint(text: impl Into<String>) -> Self {
        Self { is_error: false, text: text.into() }
    }
}

/// A file of a study may be so large: the largest photos and meshes that the program takes are smaller.
const MOST_ASSET_BYTES: u64 = 512 << 20;

/// More than this takes a minute over a slow line.
const LARGE_BYTES: u64 = 50 << 20;

/// All findings about a study that is being built, errors first. `pack` is what it would be handed out as, if that is possible.
pub fn check(draft: &Draft, scene: &Scene, pack: Result<&Pack, &StudyError>) -> Vec<Finding> {
    let mut findings = Vec::new();
    match pack {
        Err(error) => findings.push(Finding::error(error.to_string())),
        Ok(pack) => {
            if let Err(error) = usable(&pack.study) {
                findings.push(Finding::error(error.to_string()));
            }
            if pack.download_bytes() > LARGE_BYTES {
                let megabytes = pack.download_bytes() >> 20;
                let text = format!("Participants load {megabytes} MB: smaller photos or meshes start sooner");
                findings.push(Finding::hint(text));
            }
        }
    }
    settings(&draft.study, &mut findings);
    pictures(draft, &mut findings);
    truths(draft, scene, &mut findings);
    sort_short(&mut findings, |a, b| b.is_error.cmp(&a.is_error));
    findings.dedup();
    findings
}

fn settings(study: &Study, findings: &mut Vec<Finding>) {
    if study.title.trim().is_empty() {
        findings.push(Finding::error("The study has no title"));
    }
    if study.texts.instructions.trim().is_empty() {
        findings
            .push(Finding::hint("There are no instructions: participants see only which keys they may use"));
    }
    if study.texts.consent.trim().is_empty() {
        findings.push(Finding::hint("No consent is asked for"));
    }
    if study.contact.trim().is_empty() {
        findings.push(Finding::hint("No contact is given for participants who need help"));
    }
    if study.saving == Saving::Download {
        findings.push(Finding::hint("Participants send you the file that they download at the end"));
    }
    if study.questionnaires.is_empty() {
        findings.push(Finding::hint("There is no questionnaire"));
    }
}

/// Pictures that a text names, and that are there.
fn pictures(draft: &Draft, findings: &mut Vec<Finding>) {
    let texts = &draft.study.texts;
    let of_conditions = draft.study.conditions.iter().map(|condition| &condition.instructions);
    let all = [&texts.consent, &texts.instructions, &texts.thanks].into_iter().chain(of_conditions);
    let shown: BTreeSet<String> = all
        .flat_map(|text| blocks(text))
        .filter_map(|block| match block {
            Block::Picture { name, .. } => Some(name),
            _ => None,
        })
        .collect();
    let added: BTreeSet<&String> = draft.pictures.iter().map(|(name, _)| name).collect();
    for name in shown.iter().filter(|name| !added.contains(name)) {
        findings.push(Finding::error(format!("A text shows {name}, which is not among the pictures")));
    }
    for name in added.into_iter().filter(|name| !shown.contains(*name)) {
        findings.push(Finding::hint(format!("The picture {name} is loaded, and no text shows it")));
    }
}

fn truths(draft: &Draft, scene: &Scene, findings: &mut Vec<Finding>) {
    let samples = draft.chosen.iter().filter(|chosen| chosen.role == Role::Sample);
    let without = samples.filter(|chosen| draft.truth_of(scene, chosen).is_none()).count();
    match without {
        0 => {}
        1 => findings
            .push(Finding::hint("One sample has no true pose: a report can say nothing of its errors")),
        many => {
            findings.push(Finding::hint(format!(
                "{many} samples have no true pose: a report can say nothing of their errors"
            )));
        }
    }
    if !draft.chosen.iter().any(|chosen| chosen.role == Role::Practice) {
        findings
            .push(Finding::hint("There is no practice sample: first trials will also show how people learn"));
    }
    let practised: BTreeSet<_> = chosen_photos(draft, Role::Practice);
    if chosen_photos(draft, Role::Sample).intersection(&practised).next().is_some() {
        findings.push(Finding::hint(
            "A photo is used for practice and for a trial: its practice object tells something of the scene",
        ));
    }
}

fn chosen_photos(draft: &Draft, role: Role) -> BTreeSet<crate::scene::PhotoId> {
    draft.chosen.iter().filter(|chosen| chosen.role == role).map(|chosen| chosen.photo).collect()
}

/// Can anybody take part? A `study.json` that was written by hand is read too.
pub fn usable(study: &Study) -> Result<(), StudyError> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if study.id.is_empty() || !study.id.chars().all(is_plain) {
        return Err(StudyError::at("id", "letters, digits, - and _ expected"));
    }
    if study.samples.is_empty() {
        return Err(StudyError::at("samples", "at least one expected"));
    }
    unique("photos", study.photos.iter().map(|photo| photo.id.as_str()))?;
    unique("objects", study.objects.iter().map(|object| object.id.as_str()))?;
    unique("conditions", study.conditions.iter().map(|condition| condition.id.as_str()))?;
    unique("questionnaires", study.questionnaires.iter().map(|one| one.id.as_str()))?;
    let practice = study.practice.iter().map(|practice| &practice.sample);
    unique("samples", study.samples.iter().chain(practice).map(|sample| sample.id.as_str()))?;
    samples(study)?;
    for photo in &study.photos {
        let place = || format!("photos, {}", photo.id);
        photo.camera.to_intrinsics().map_err(|error| StudyError::at(place(), error))?;
    }
    for asset in study.assets() {
        let leads_out = asset.path.split(['/', '\\']).any(|part| part == ".." || part.is_empty());
        if leads_out || asset.path.contains(':') {
            return Err(StudyError::at(asset.path.clone(), "a path beside study.json expected"));
        }
        if asset.bytes > MOST_ASSET_BYTES {
            let (path, bytes) = (asset.path.clone(), asset.bytes);
            return Err(StudyError::TooLarge { path, bytes, most: MOST_ASSET_BYTES });
        }
    }
    protocol(study)
}

fn samples(study: &Study) -> Result<(), StudyError> {
    let practice = study.practice.iter().map(|practice| &practice.sample);
    for sample in study.samples.iter().chain(practice) {
        let place = || format!("samples, {}", sample.id);
        if study.photo(&sample.photo).is_none() || study.object(&sample.object).is_none() {
            return Err(StudyError::at(place(), "its photo or its object is not in the study"));
        }
        if study.start_pose == StartPose::Given && sample.start.is_none() {
            return Err(StudyError::at(place(), "\"start\" expected: each sample has its own start pose"));
        }
    }
    for practice in &study.practice {
        let place = format!("practice, {}", practice.sample.id);
        practice.truth.to_pose().map_err(|error| StudyError::at(place.clone(), error))?;
        let shown = (&practice.sample.photo, &practice.sample.object);
        if study.samples.iter().any(|sample| (&sample.photo, &sample.object) == shown) {
            let reason = "it is one of the study's samples too, and practice comes with the truth";
            return Err(StudyError::at(place, reason));
        }
    }
    Ok(())
}

fn protocol(study: &Study) -> Result<(), StudyError> {
    if study.conditions.is_empty() || study.conditions.iter().any(|condition| condition.tools.is_empty()) {
        return Err(StudyError::at("conditions", "at least one, and each with at least one tool, expected"));
    }
    // A thousand trials are a week of work.
    const MOST_TRIALS: usize = 10_000;
    let Schedule { repeats, .. } = study.schedule;
    let trials = study.samples.len().saturating_mul(repeats as usize).saturating_mul(study.conditions.len());
    if repeats == 0 || trials > MOST_TRIALS {
        return Err(StudyError::at(
            "schedule",
            format!("1 to {MOST_TRIALS} trials expected, found {trials}"),
        ));
    }
    if let StartPose::Random { least_depth_mm, most_depth_mm } = study.start_pose
        && !(least_depth_mm > 0.0 && most_depth_mm >= least_depth_mm && most_depth_mm.is_finite())
    {
        return Err(StudyError::at("start_pose", "two depths above 0, the least first, expected"));
    }
    let sets = study.set_names().len();
    if sets > 0 && study.samples.iter().any(|sample| sample.set.is_none()) {
        return Err(StudyError::at("samples", "some have a sample set and some have none"));
    }
    let asks_for_sets = study.sample_sets != SampleSets::All;
    if asks_for_sets && sets < 2 {
        return Err(StudyError::at("sample_sets", "two sets or more expected to divide them"));
    }
    if study.sample_sets == SampleSets::PerCondition
        && (study.assignment != Assignment::Within || sets < study.conditions.len())
    {
        let reason = "a set for each condition, and conditions within participants, expected";
        return Err(StudyError::at("sample_sets", reason));
    }
    Ok(())
}

fn unique<'a>(what: &str, ids: impl Iterator<Item = &'a str>) -> Result<(), StudyError> {
    let mut seen = BTreeSet::new();
    for id in ids {
        if id.is_empty() || !seen.insert(id) {
            return Err(StudyError::at(what, format!("the id \"{id}\" is empty or comes twice")));
        }
    }
    Ok(())
}
