//! How long annotations took.

use super::super::statistics::{Spread, mean};
use super::errors::set_members;
use super::{Analysis, Cell, Column, Table, set_name, spread_cell, table};

pub(super) fn times(analysis: &Analysis) -> Table {
    let mut rows = Vec::new();
    for (set, person) in set_members(analysis) {
        let seconds = analysis.seconds_of(person, set);
        rows.push(vec![
            Cell::text(set_name(analysis, set)),
            Cell::text(analysis.label_of(person)),
            Cell::Count(seconds.len()),
            spread_cell(&seconds),
            Cell::number(Spread::of(&seconds).map(|spread| spread.median)),
        ]);
    }
    let means_of = |set: usize| -> Vec<f64> {
        let members = analysis.members(set);
        members.iter().filter_map(|person| mean(&analysis.seconds_of(*person, set))).collect()
    };
    let mut overall = |name: &str, means: &[f64]| {
        rows.push(vec![
            Cell::text(name),
            Cell::text("persons' means"),
            Cell::Count(means.len()),
            spread_cell(means),
            Cell::number(Spread::of(means).map(|spread| spread.median)),
        ]);
    };
    for set in 0..analysis.sets.len() {
        overall(set_name(analysis, set), &means_of(set));
    }
    if analysis.sets.len() > 1 {
        overall("all sets", &(0..analysis.sets.len()).flat_map(means_of).collect::<Vec<_>>());
    }
    let columns = vec![
        Column::plain("set"),
        Column::plain("person"),
        Column::plain("n"),
        Column::number("time", "s", 2),
        Column::number("median", "s", 2),
    ];
    let note = "From the first drawn frame to the confirmation, without pauses and hidden tabs; no trial is left out. Mean ± SD \
        (population, ddof 0): of a person over trials; in the last rows over the persons' means"
        .to_owned();
    table("times", "Time per annotation", note, columns, rows)
}
