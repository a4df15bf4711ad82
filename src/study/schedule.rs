//! Who does what in which order: conditions and sample sets, balanced over participants, and the order of the trials.

use glam::{DMat3, DQuat, DVec2};
use serde::{Deserialize, Serialize};

use super::chance::{Chance, hash, participant_seed};
use super::{Assignment, SampleSets, StartPose, Study, StudyError, TrialOrder};
use crate::math::{Intrinsics, Pose};
use crate::mesh::Mesh;
use crate::scene::untouched_pose;

/// What is in front of one participant.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    pub seed: u64,
    /// In their order.
    pub conditions: Vec<String>,
    /// In the order of the conditions where these have sets of their own; empty in a study without sets.
    pub sample_sets: Vec<String>,
    pub trials: Vec<PlannedTrial>,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedTrial {
    pub sample: String,
    pub condition: String,
    /// How often the sample came before under this condition.
    pub repeat: u32,
}

/// What the page's address asks for; a number is counted from 1.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct AskedFor {
    /// A condition's id or number; where each participant works under all, the number of the order.
    pub condition: Option<String>,
    /// A sample set's name or number.
    pub sample_set: Option<String>,
}

impl Plan {
    /// The plan of one participant. The same words give the same plan, whenever and wherever.
    pub fn new(study: &Study, participant: &str, asked: &AskedFor) -> Result<Self, StudyError> {
        let seed = study.schedule.seed.unwrap_or_else(|| participant_seed(&study.id, participant));
        let conditions = conditions_of(study, participant, asked)?;
        let sets = sets_of(study, participant, asked, conditions.len())?;
        let mut trials: Vec<PlannedTrial> = Vec::new();
        let mut chance = Chance::of(seed, "order");
        for (index, condition) in conditions.iter().enumerate() {
            let set = match study.sample_sets {
                SampleSets::PerCondition => sets.get(index),
                SampleSets::All | SampleSets::Between => None,
            };
            let is_in = |of: Option<&String>| match set {
                Some(set) => of == Some(set),
                None => sets.is_empty() || of.is_some_and(|of| sets.contains(of)),
            };
            let samples: Vec<&str> = study
                .samples
                .iter()
                .filter(|sample| is_in(sample.set.as_ref()))
                .map(|sample| sample.id.as_str())
                .collect();
            let before = trials.last().map(|trial| trial.sample.clone());
            let ordered = order(&samples, study, before.as_deref(), &mut chance);
            trials.extend(ordered.into_iter().map(|(sample, repeat)| PlannedTrial {
                sample: sample.to_owned(),
                condition: condition.clone(),
                repeat,
            }));
        }
        Ok(Self { seed, conditions, sample_sets: sets, trials })
    }

    /// Does another condition begin with this trial?
    pub fn begins_condition(&self, index: usize) -> bool {
        let condition = |index: usize| self.trials.get(index).map(|trial| &trial.condition);
        index.checked_sub(1).is_none_or(|before| condition(before) != condition(index))
    }

    /// Does another repeat, or another condition, begin with this trial?
    pub fn begins_repeat(&self, index: usize) -> bool {
        let repeat = |index: usize| self.trials.get(index).map(|trial| trial.repeat);
        self.begins_condition(index)
            || index.checked_sub(1).is_some_and(|before| repeat(before) != repeat(index))
    }
}

/// Every sample `repeats` times.
fn order<'a>(
    samples: &[&'a str],
    study: &Study,
    before: Option<&str>,
    chance: &mut Chance,
) -> Vec<(&'a str, u32)> {
    let rule = study.schedule.order;
    let mut round = samples.to_vec();
    let mut last = before.map(str::to_owned);
    let mut all = Vec::new();
    for repeat in 0..study.schedule.repeats {
        let is_drawn = match rule {
            TrialOrder::ShuffledEachRepeat => true,
            TrialOrder::ShuffledOnce => repeat == 0,
            TrialOrder::AsListed => false,
        };
        if is_drawn {
            shuffle_after(&mut round, last.as_deref(), chance);
        }
        all.extend(round.iter().map(|sample| (*sample, repeat)));
        last = round.last().map(|sample| (*sample).to_owned());
    }
    all
}

/// Any order that does not begin with `last`, each as likely as the others: orders are drawn until one does not.
fn shuffle_after(round: &mut [&str], last: Option<&str>, chance: &mut Chance) {
    // Of two samples every second draw fits; that a hundred do not is less likely than a broken computer.
    const DRAWS: u32 = 100;
    for _ in 0..DRAWS {
        chance.shuffle(round);
        if round.len() < 2 || round.first().copied() != last {
            return;
        }
    }
}

/// The conditions of a participant, in their order.
fn conditions_of(study: &Study, participant: &str, asked: &AskedFor) -> Result<Vec<String>, StudyError> {
    let ids: Vec<&str> = study.conditions.iter().map(|condition| condition.id.as_str()).collect();
    if ids.is_empty() {
        return Err(StudyError::at("conditions", "at least one expected"));
    }
    let drawn = hash(&["condition", &study.id, participant]);
    match study.assignment {
        Assignment::Between => {
            let index = chosen("condition", &ids, asked.condition.as_deref(), drawn)?;
            Ok(ids.get(index).map(|id| (*id).to_owned()).into_iter().collect())
        }
        Assignment::Within => {
            let orders = balanced_orders(ids.len());
            let index = order_index(&ids, &orders, asked.condition.as_deref(), drawn)?;
            let order = orders.get(index).cloned().unwrap_or_default();
            Ok(order.iter().filter_map(|place| ids.get(*place)).map(|id| (*id).to_owned()).collect())
        }
    }
}

/// By number, or the first order that begins with the condition of this id.
fn order_index(
    ids: &[&str],
    orders: &[Vec<usize>],
    asked: Option<&str>,
    drawn: u64,
) -> Result<usize, StudyError> {
    let begins = |id: &str| {
        orders.iter().position(|order| order.first().and_then(|first| ids.get(*first)) == Some(&id))
    };
    if let Some(index) = asked.and_then(begins) {
        return Ok(index);
    }
    let numbers: Vec<String> = (1..=orders.len()).map(|number| number.to_string()).collect();
    let numbers: Vec<&str> = numbers.iter().map(String::as_str).collect();
    chosen("order of conditions", &numbers, asked, drawn)
}

/// The sample sets of a participant: none in a study without sets.
fn sets_of(
    study: &Study,
    participant: &str,
    asked: &AskedFor,
    conditions: usize,
) -> Result<Vec<String>, StudyError> {
    let names = study.set_names();
    if names.is_empty() {
        return Ok(Vec::new());
    }
    let drawn = hash(&["set", &study.id, participant]);
    let first = match study.sample_sets {
        SampleSets::All => return Ok(names.iter().map(|name| (*name).to_owned()).collect()),
        SampleSets::Between | SampleSets::PerCondition => {
            chosen("sample set", &names, asked.sample_set.as_deref(), drawn)?
        }
    };
    let count = if study.sample_sets == SampleSets::Between { 1 } else { conditions };
    let sets = (first..first + count).map(|place| place % names.len());
    Ok(sets.filter_map(|place| names.get(place)).map(|name| (*name).to_owned()).collect())
}

/// The place in a list that is asked for by name or by number from 1; else one that is drawn.
fn chosen(what: &str, names: &[&str], asked: Option<&str>, drawn: u64) -> Result<usize, StudyError> {
    let Some(asked) = asked.filter(|asked| !asked.is_empty()) else {
        return Ok((drawn % names.len().max(1) as u64) as usize);
    };
    let by_name = names.iter().position(|name| *name == asked);
    let by_number = asked.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
    by_name.or_else(|| by_number.filter(|place| *place < names.len())).ok_or_else(|| {
        let all = names.join(", ");
        StudyError::at("the link", format!("no {what} is called \"{asked}\"; one of {all} expected"))
    })
}

/// Orders of `count` conditions in which each is as often first, second, … and as often right after each other one: `count` orders
/// where that is even, else twice as many. Source: Williams, *Experimental Designs Balanced for the Estimation of Residual Effects
/// of Treatments*, 1949.
fn balanced_orders(count: usize) -> Vec<Vec<usize>> {
    let first: Vec<usize> = (0..count)
        .map(|place| if place % 2 == 1 { place.div_ceil(2) } else { (count - place / 2) % count.max(1) })
        .collect();
    let shifted = |by: usize| -> Vec<usize> { first.iter().map(|place| (place + by) % count).collect() };
    let mut orders: Vec<Vec<usize>> = (0..count).map(shifted).collect();
    if count % 2 == 1 && count > 1 {
        let reversed: Vec<Vec<usize>> =
            orders.iter().map(|order| order.iter().rev().copied().collect()).collect();
        orders.extend(reversed);
    }
    orders
}

/// Where the object of a trial starts. `place` is the trial's in its participant's order; practice takes other words than trials.
pub fn start_pose(
    study: &Study,
    given: Option<Pose>,
    camera: &Intrinsics,
    mesh: &Mesh,
    seed: u64,
    place: &str,
) -> Result<Pose, StudyError> {
    match study.start_pose {
        StartPose::Fixed { pose } => pose.to_pose().map_err(|error| StudyError::at("start_pose", error)),
        StartPose::Centered => Ok(untouched_pose(camera, mesh)),
        StartPose::Random { least_depth_mm, most_depth_mm } => {
            let mut chance = Chance::of(seed, place);
            Ok(random_pose(camera, mesh, [least_depth_mm, most_depth_mm], &mut chance))
        }
        StartPose::Given => given.ok_or_else(|| StudyError::at("start", "each sample needs its start pose")),
    }
}

/// Any rotation, the box's middle at any pixel of the photo's middle half, at a depth between two.
fn random_pose(camera: &Intrinsics, mesh: &Mesh, depths_mm: [f64; 2], chance: &mut Chance) -> Pose {
    let rotation = random_rotation(chance);
    let size = DVec2::new(f64::from(camera.width), f64::from(camera.height));
    let pixel = DVec2::new(chance.between(0.25, 0.75), chance.between(0.25, 0.75)) * size - 0.5;
    let ray = camera.unproject(pixel);
    let center_camera = ray / ray.z * chance.between(depths_mm[0], depths_mm[1]);
    let center_object = mesh.bounds().center();
    Pose { rotation, translation_mm: center_camera - rotation * center_object }
}

/// Every rotation is as likely as the others. Source: Shoemake, *Uniform Random Rotations*, Graphics Gems III, 1992.
fn random_rotation(chance: &mut Chance) -> DMat3 {
    let (radius, first, second) = (chance.unit(), chance.unit(), chance.unit());
    let [(a, b), (c, d)] = [first, second].map(|part| (std::f64::consts::TAU * part).sin_cos());
    let (inner, outer) = ((1.0 - radius).sqrt(), radius.sqrt());
    DMat3::from_quat(DQuat::from_xyzw(inner * a, inner * b, outer * c, outer * d).normalize())
}

#[cfg(test)]
mod tests;
