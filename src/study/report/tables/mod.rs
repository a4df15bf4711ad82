//! The tables of a report: pure functions of its analysis.

mod errors;
mod groups;
mod numbers;
mod questionnaires;
mod tests_of_truth;
mod times;

use super::statistics::Spread;
use super::table::{Cell, Column, Table};
use super::{Analysis, Difference, Measure, Rows};

/// All tables, in the order in which the page has them. Those that would be empty are left out.
pub fn tables(analysis: &Analysis) -> Vec<Table> {
    let mut tables = vec![
        errors::inter(analysis),
        errors::intra(analysis),
        times::times(analysis),
        errors::inter_by_sample(analysis),
        errors::inter_by_person(analysis),
        errors::intra_by_person(analysis),
        errors::agreement(analysis),
        tests_of_truth::equivalence(analysis),
        questionnaires::tlx(analysis),
        questionnaires::sus(analysis),
        groups::conditions(analysis),
        groups::condition_differences(analysis),
    ];
    tables.extend(groups::traits(analysis));
    tables.extend([
        numbers::inter(analysis),
        numbers::trials(analysis),
        numbers::pairs(analysis),
        numbers::agreement(analysis),
    ]);
    tables.retain(|table| !table.rows.is_empty());
    tables
}

/// Which rows are kept, in words.
const KEPT: &str = "Best 90 %: the floor(0.9 n) rows of a set with the lowest ADD, the same rows for every measure; the \
    paper says only that the best 90 % were kept";

/// What the symmetric measures are, in words.
const SYMMETRIC: &str = "Rotation (sym.): the smallest angle over the object's symmetries. MSSD: the largest vertex distance, least \
    over the symmetries";

/// And the one that only truth has.
const AD: &str = "AD: ADI (ADD-S) for an object with symmetries, ADD for any other";

/// One column per measure.
fn columns_of(measures: &[Measure]) -> impl Iterator<Item = Column> {
    measures.iter().map(|measure| Column::number(measure.name(), measure.unit(), 2))
}

/// Mean ± SD of each measure over some rows.
fn spreads(rows: &[&Difference], measures: &[Measure]) -> Vec<Cell> {
    let of = |measure: &Measure| spread_cell(&rows.iter().map(|row| row.get(*measure)).collect::<Vec<_>>());
    measures.iter().map(of).collect()
}

/// Mean ± SD.
fn spread_cell(values: &[f64]) -> Cell {
    Spread::of(values)
        .map_or(Cell::Missing, |spread| Cell::MeanAndDeviation(spread.mean, spread.standard_deviation))
}

/// A set's name where there are several; "all" for a set without one.
fn set_name(analysis: &Analysis, set: usize) -> &str {
    analysis.sets.get(set).map(String::as_str).filter(|name| !name.is_empty()).unwrap_or("all")
}

fn table(name: &str, title: &str, note: String, columns: Vec<Column>, rows: Vec<Vec<Cell>>) -> Table {
    Table { name: name.to_owned(), title: title.to_owned(), note, columns, rows, is_raw: false }
}

fn row_labels(set: &str, rows: Rows) -> Vec<Cell> {
    vec![Cell::text(set), Cell::text(rows.label())]
}
