//! How far annotations are from the truth, from their repeats and from one another.

use super::super::statistics::mean;
use super::{
    AD, Analysis, Cell, Column, Difference, KEPT, Measure, Rows, SYMMETRIC, Table, columns_of, row_labels,
    set_name, spread_cell, spreads, table,
};

pub(super) fn inter(analysis: &Analysis) -> Table {
    let mut rows = Vec::new();
    for set in 0..analysis.sets.len() {
        for kept in Rows::BOTH {
            let found: Vec<&Difference> = analysis.best_of_set(set, kept).map(|row| &row.errors).collect();
            let mut cells = row_labels(set_name(analysis, set), kept);
            cells.push(Cell::Count(found.len()));
            cells.extend(spreads(&found, &Measure::ALL));
            rows.push(cells);
        }
    }
    let mut columns = vec![Column::plain("set"), Column::plain("rows"), Column::plain("n")];
    columns.extend(columns_of(&Measure::ALL));
    let note = format!(
        "Each person's best trial of each sample by ADD against the truth; mean ± SD (population, ddof 0) over persons and \
         samples. {KEPT}. {SYMMETRIC}. {AD}. Depth is signed: positive where the pose is too far"
    );
    table(
        "inter-personal",
        "Inter-personal errors: best of the repeats against the truth",
        note,
        columns,
        rows,
    )
}

pub(super) fn inter_by_sample(analysis: &Analysis) -> Table {
    let mut rows = Vec::new();
    for set in 0..analysis.sets.len() {
        for (at, sample) in analysis.samples_of(set) {
            for kept in Rows::BOTH {
                let of_sample = analysis.best_of_set(set, kept).filter(|row| row.sample == at);
                let found: Vec<&Difference> = of_sample.map(|row| &row.errors).collect();
                let mut cells = row_labels(set_name(analysis, set), kept);
                cells.insert(1, Cell::text(&sample.label));
                cells.insert(2, Cell::text(&sample.name));
                cells.push(Cell::number(analysis.diameters_mm.get(at).copied()));
                cells.push(Cell::Count(found.len()));
                cells.extend(spreads(&found, &Measure::ALL));
                rows.push(cells);
            }
        }
    }
    let mut columns = ["set", "sample", "object in photo", "rows"].map(Column::plain).to_vec();
    columns.extend([Column::number("diameter", "mm", 1), Column::plain("n")]);
    columns.extend(columns_of(&Measure::ALL));
    let note = format!("As the inter-personal errors of all, sample by sample, over persons. {KEPT}");
    table("inter-by-sample", "Inter-personal errors by sample", note, columns, rows)
}

pub(super) fn inter_by_person(analysis: &Analysis) -> Table {
    let mut rows = Vec::new();
    for (set, person) in set_members(analysis) {
        for kept in Rows::BOTH {
            let of_person = analysis.best_of_set(set, kept).filter(|row| row.participant == person);
            let found: Vec<&Difference> = of_person.map(|row| &row.errors).collect();
            let mut cells = row_labels(set_name(analysis, set), kept);
            cells.insert(1, Cell::text(analysis.label_of(person)));
            cells.push(Cell::Count(found.len()));
            cells.extend(spreads(&found, &Measure::ALL));
            rows.push(cells);
        }
    }
    let mut columns = ["set", "person", "rows", "n"].map(Column::plain).to_vec();
    columns.extend(columns_of(&Measure::ALL));
    let note = format!("As the inter-personal errors of all, person by person, over samples. {KEPT}");
    table("inter-by-person", "Inter-personal errors by person", note, columns, rows)
}

pub(super) fn intra(analysis: &Analysis) -> Table {
    let mut rows = Vec::new();
    for set in 0..analysis.sets.len() {
        for kept in Rows::BOTH {
            let members = analysis.members(set);
            let of_person = |measure: Measure, person: &usize| {
                let pairs = analysis.pairs_of(*person, set, kept).map(|row| row.differences.get(measure));
                mean(&pairs.collect::<Vec<_>>())
            };
            let means = |measure: &Measure| {
                members.iter().filter_map(|person| of_person(*measure, person)).collect::<Vec<_>>()
            };
            let mut cells = row_labels(set_name(analysis, set), kept);
            cells.push(Cell::Count(means(&Measure::Add).len()));
            cells.extend(Measure::BETWEEN.iter().map(|measure| spread_cell(&means(measure))));
            rows.push(cells);
        }
    }
    let mut columns = vec![Column::plain("set"), Column::plain("rows"), Column::plain("persons")];
    columns.extend(columns_of(&Measure::BETWEEN));
    let note = format!(
        "All pairs of a person's trials of the same sample (three of three repeats), averaged per person; mean ± SD (ddof 0) \
         over the persons' means. Best 90 %: the floor(0.9 n) of a person's pairs (27 of 30) with the lowest ADD. {SYMMETRIC}"
    );
    table("intra-personal", "Intra-personal differences: repeats against one another", note, columns, rows)
}

pub(super) fn intra_by_person(analysis: &Analysis) -> Table {
    let mut rows = Vec::new();
    for (set, person) in set_members(analysis) {
        for kept in Rows::BOTH {
            let found: Vec<&Difference> =
                analysis.pairs_of(person, set, kept).map(|row| &row.differences).collect();
            let mut cells = row_labels(set_name(analysis, set), kept);
            cells.insert(1, Cell::text(analysis.label_of(person)));
            cells.push(Cell::Count(found.len()));
            cells.extend(spreads(&found, &Measure::BETWEEN));
            rows.push(cells);
        }
    }
    let mut columns = ["set", "person", "rows", "pairs"].map(Column::plain).to_vec();
    columns.extend(columns_of(&Measure::BETWEEN));
    let note = "As the intra-personal differences of all, person by person: mean ± SD (ddof 0) over the person's pairs".to_owned();
    table("intra-by-person", "Intra-personal differences by person", note, columns, rows)
}

pub(super) fn agreement(analysis: &Analysis) -> Table {
    let mut rows = Vec::new();
    for set in 0..analysis.sets.len() {
        let in_set = || analysis.agreement.iter().filter(move |row| analysis.set_of(row.sample) == Some(set));
        let all: Vec<&Difference> = in_set().map(|row| &row.differences).collect();
        if all.is_empty() {
            continue;
        }
        let mut line = |label: &str, found: &[&Difference]| {
            let mut cells = vec![Cell::text(set_name(analysis, set)), Cell::text(label)];
            cells.push(Cell::Count(found.len()));
            cells.extend(spreads(found, &Measure::BETWEEN));
            rows.push(cells);
        };
        line("all", &all);
        for (at, sample) in analysis.samples_of(set) {
            let of_sample = in_set().filter(|row| row.sample == at);
            line(&sample.label, &of_sample.map(|row| &row.differences).collect::<Vec<_>>());
        }
    }
    let mut columns = ["set", "sample", "pairs"].map(Column::plain).to_vec();
    columns.extend(columns_of(&Measure::BETWEEN));
    let note = format!(
        "Differences between the best trials (lowest ADD to the truth) of two persons for the same sample under the same \
         condition; mean ± SD (ddof 0) over pairs of persons. Each person is compared with up to {} others before and after in \
         the list: all pairs up to {} persons",
        super::super::PARTNERS,
        2 * super::super::PARTNERS + 1
    );
    table("agreement", "Agreement between annotators", note, columns, rows)
}

/// Everybody who worked on a set, set by set.
pub(super) fn set_members(analysis: &Analysis) -> impl Iterator<Item = (usize, usize)> {
    (0..analysis.sets.len())
        .flat_map(|set| analysis.members(set).into_iter().map(move |person| (set, person)))
}
