//! The paper's first hypothesis: annotations are comparable with the truth.

use glam::DVec3;

use super::super::statistics::{Equivalence, mean};
use super::{Analysis, Cell, Column, Measure, Table, set_name, table};
use crate::math::{Pose, rotation_vector_from_rotation};

/// What is tested, per person.
const OFFSETS: [(&str, &str); 6] = [
    ("offset to the right", "%"),
    ("offset downwards", "%"),
    ("offset away from the camera", "%"),
    ("rotation about the camera's x", "deg"),
    ("rotation about the camera's y", "deg"),
    ("rotation about the camera's z", "deg"),
];

pub(super) fn equivalence(analysis: &Analysis) -> Table {
    let options = &analysis.options;
    let mut rows = Vec::new();
    for set in 0..analysis.sets.len() {
        let persons: Vec<[f64; 6]> = analysis
            .members(set)
            .into_iter()
            .filter_map(|person| mean_offsets(analysis, person, set))
            .collect();
        for (at, (name, unit)) in OFFSETS.into_iter().enumerate() {
            let values: Vec<f64> = persons.iter().map(|offsets| offsets[at]).collect();
            let margin = if unit == "%" { options.margin_percent } else { options.margin_deg };
            rows.extend(
                Equivalence::within(&values, margin)
                    .map(|found| line(set_name(analysis, set), name, unit, &format!("±{margin}"), &found)),
            );
        }
        let shares: Vec<f64> = analysis
            .members(set)
            .into_iter()
            .filter_map(|person| mean_share(analysis, person, set))
            .collect();
        let margin = options.margin_percent;
        rows.extend(Equivalence::below(&shares, margin).map(|found| {
            line(set_name(analysis, set), "AD, one-sided", "%", &format!("below {margin}"), &found)
        }));
    }
    let mut columns = ["set", "quantity", "unit", "persons"].map(Column::plain).to_vec();
    columns.extend([Column::number("mean", "", 2), Column::number("90 % interval", "", 2)]);
    columns.extend([Column::plain("margin"), Column::number("p", "", 4), Column::plain("equivalent")]);
    let note = format!(
        "Two one-sided t tests (Schuirmann, 1987) over the persons' means of all their trials, level {}: equivalent where the \
         mean's 90 % interval lies within the margin. Offsets are those of the middle of the object's box, in the camera's axes \
         and in per cent of the object's diameter (margin {} %: ADD under a tenth of the diameter is the field's \"correct\"); \
         rotations are the components of the rotation vector from the truth (margin {}°), at the nearest of the object's \
         symmetries. AD (ADI for an object with symmetries, else ADD) has no sign and is tested from below the margin alone",
        Equivalence::LEVEL,
        options.margin_percent,
        options.margin_deg
    );
    table("equivalence", "Equivalence of annotations and truth", note, columns, rows)
}

fn line(set: &str, name: &str, unit: &str, margin: &str, found: &Equivalence) -> Vec<Cell> {
    vec![
        Cell::text(set),
        Cell::text(name),
        Cell::text(if unit == "deg" { "°" } else { "% of diameter" }),
        Cell::Count(found.count),
        Cell::Number(found.mean),
        Cell::Between(found.interval.low, found.interval.high),
        Cell::text(margin),
        Cell::Chance(found.p),
        Cell::text(if found.is_equivalent() { "yes" } else { "no" }),
    ]
}

/// The means of [`OFFSETS`] over a person's trials of a set.
fn mean_offsets(analysis: &Analysis, person: usize, set: usize) -> Option<[f64; 6]> {
    let participant = analysis.participants.get(person)?;
    let in_set = participant.trials.iter().filter(|trial| analysis.set_of(trial.sample) == Some(set));
    let offsets: Vec<[f64; 6]> =
        in_set.filter_map(|trial| offsets(analysis, trial.sample, &trial.pose)).collect();
    let mut means = [0.0; 6];
    for (at, place) in means.iter_mut().enumerate() {
        *place = mean(&offsets.iter().map(|offset| offset[at]).collect::<Vec<_>>())?;
    }
    Some(means)
}

fn offsets(analysis: &Analysis, sample: usize, pose: &Pose) -> Option<[f64; 6]> {
    let diameter_mm = analysis.diameters_mm.get(sample).copied().filter(|diameter| *diameter > 0.0)?;
    let sample = analysis.samples.get(sample)?;
    let twins = sample.symmetries.expanded().into_iter().map(|symmetry| sample.truth * symmetry);
    let truth = twins.min_by(|a, b| pose.angle_to(a).total_cmp(&pose.angle_to(b)))?;
    let center = sample.mesh.bounds().center();
    let moved: DVec3 = (pose.transform_point(center) - truth.transform_point(center)) * (100.0 / diameter_mm);
    let turned = rotation_vector_from_rotation(&(pose.rotation * truth.rotation.transpose()));
    let [x, y, z] = moved.to_array();
    let [rx, ry, rz] = turned.to_array().map(f64::to_degrees);
    Some([x, y, z, rx, ry, rz])
}

/// The mean AD of a person's trials of a set, in per cent of the diameter.
fn mean_share(analysis: &Analysis, person: usize, set: usize) -> Option<f64> {
    let own = analysis
        .trials
        .iter()
        .filter(|row| row.participant == person && analysis.set_of(row.sample) == Some(set));
    let share = |row: &super::super::TrialErrors| {
        let diameter_mm = analysis.diameters_mm.get(row.sample).filter(|diameter| **diameter > 0.0)?;
        Some(100.0 * row.errors.get(Measure::Ad) / diameter_mm)
    };
    mean(&own.filter_map(share).collect::<Vec<_>>())
}
