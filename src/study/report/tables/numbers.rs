//! Every number: the rows that all other tables are made of.

use super::super::statistics::BoxStatistics;
use super::{Analysis, Cell, Column, Difference, Measure, Rows, Table, columns_of, set_name, table};
use crate::metrics::Statistics;

/// Digits where somebody prints them all the same.
const DECIMALS: usize = 4;

fn raw(name: &str, title: &str, columns: Vec<Column>, rows: Vec<Vec<Cell>>) -> Table {
    let table = table(name, title, String::new(), columns, rows);
    Table { is_raw: true, ..table }
}

/// Of the inter-personal rows everything that is said of many numbers, one line per set, rows and measure.
pub(super) fn inter(analysis: &Analysis) -> Table {
    let mut lines = Vec::new();
    for set in 0..analysis.sets.len() {
        for kept in Rows::BOTH {
            for measure in Measure::ALL {
                let values: Vec<f64> =
                    analysis.best_of_set(set, kept).map(|row| row.errors.get(measure)).collect();
                let named = [set_name(analysis, set), kept.label(), measure.name(), measure.unit()];
                lines.extend(
                    distribution(&values)
                        .map(|cells| named.into_iter().map(Cell::text).chain(cells).collect::<Vec<_>>()),
                );
            }
        }
    }
    let mut columns = ["set", "rows", "measure", "unit", "n"].map(Column::plain).to_vec();
    let numbers = ["mean", "sd", "median", "lower quartile", "upper quartile", "p90", "max"];
    columns.extend(numbers.map(|name| Column::number(name, "", DECIMALS)));
    raw("inter-distributions", "Distributions of the inter-personal errors", columns, lines)
}

fn distribution(values: &[f64]) -> Option<Vec<Cell>> {
    let (all, boxed) = (Statistics::of(values.iter().copied())?, BoxStatistics::of(values)?);
    let numbers = [
        all.mean,
        all.standard_deviation,
        all.median,
        boxed.lower_quartile,
        boxed.upper_quartile,
        all.p90,
        all.max,
    ];
    Some(std::iter::once(Cell::Count(all.count)).chain(numbers.map(Cell::Number)).collect())
}

pub(super) fn trials(analysis: &Analysis) -> Table {
    let rows = analysis.trials.iter().map(|row| {
        let trial =
            analysis.participants.get(row.participant).and_then(|person| person.trials.get(row.trial));
        let mut cells = named(analysis, row.participant, row.sample, row.condition);
        cells.extend([
            Cell::Count(row.repeat + 1),
            Cell::Number(row.seconds),
            flag(trial.is_some_and(|trial| trial.timed_out)),
            flag(row.is_best),
            flag(row.is_kept),
        ]);
        cells.extend(numbers(&row.errors, &Measure::ALL));
        cells
    });
    let mut columns = named_columns();
    columns.push(Column::plain("repeat"));
    columns.push(Column::number("time", "s", DECIMALS));
    columns.extend(["timed out", "best of repeats", "best 90 percent"].map(Column::plain));
    columns.extend(columns_of(&Measure::ALL));
    raw("trials", "Every trial against the truth", columns, rows.collect())
}

pub(super) fn pairs(analysis: &Analysis) -> Table {
    let rows = analysis.pairs.iter().map(|row| {
        let mut cells = named(analysis, row.participant, row.sample, row.condition);
        cells.extend(row.repeats.map(|repeat| Cell::Count(repeat + 1)));
        cells.push(flag(row.is_kept));
        cells.extend(numbers(&row.differences, &Measure::BETWEEN));
        cells
    });
    let mut columns = named_columns();
    columns.extend(["first repeat", "second repeat", "best 90 percent"].map(Column::plain));
    columns.extend(columns_of(&Measure::BETWEEN));
    raw("pairs", "Every pair of repeats", columns, rows.collect())
}

pub(super) fn agreement(analysis: &Analysis) -> Table {
    let rows = analysis.agreement.iter().map(|row| {
        let [first, second] = row.participants;
        let mut cells = named(analysis, first, row.sample, row.condition);
        cells.push(Cell::text(analysis.label_of(second)));
        cells.extend(numbers(&row.differences, &Measure::BETWEEN));
        cells
    });
    let mut columns = named_columns();
    columns.push(Column::plain("other person"));
    columns.extend(columns_of(&Measure::BETWEEN));
    raw("agreement-pairs", "Every pair of persons", columns, rows.collect())
}

fn named_columns() -> Vec<Column> {
    ["set", "person", "participant", "simulated", "condition", "sample", "object in photo"]
        .map(Column::plain)
        .to_vec()
}

fn named(analysis: &Analysis, participant: usize, sample: usize, condition: usize) -> Vec<Cell> {
    let set = analysis.set_of(sample).map_or("", |set| set_name(analysis, set));
    let person = analysis.participants.get(participant);
    let shown = analysis.samples.get(sample);
    vec![
        Cell::text(set),
        Cell::text(analysis.label_of(participant)),
        Cell::text(person.map_or("", |person| &person.id)),
        flag(person.is_some_and(|person| person.simulated)),
        Cell::text(analysis.conditions.get(condition).map_or("", |condition| &condition.id)),
        Cell::text(shown.map_or("", |sample| &sample.label)),
        Cell::text(shown.map_or("", |sample| &sample.name)),
    ]
}

fn flag(is_set: bool) -> Cell {
    Cell::Count(usize::from(is_set))
}

fn numbers(row: &Difference, measures: &[Measure]) -> Vec<Cell> {
    measures.iter().map(|measure| Cell::Number(row.get(*measure))).collect()
}
