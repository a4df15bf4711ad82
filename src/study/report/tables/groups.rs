//! Conditions against one another, and persons by what they said of themselves.

use crate::math::sort_short;
use std::collections::BTreeSet;

use super::super::quantity::{ConditionOrAll, Quantity};
use super::{Analysis, Cell, Column, Table, spread_cell, table};

/// A question whose answers are all different (a free text) divides nobody.
const MOST_LEVELS: usize = 8;

fn quantity_columns() -> impl Iterator<Item = Column> {
    Quantity::ALL.into_iter().map(|quantity| Column::number(quantity.name(), quantity.unit(), 2))
}

/// Mean ± SD of each quantity over some persons.
fn quantities(analysis: &Analysis, persons: &[usize], condition: ConditionOrAll) -> Vec<Cell> {
    let of = |quantity: Quantity| {
        let values = persons.iter().filter_map(|person| quantity.of(analysis, *person, condition));
        spread_cell(&values.collect::<Vec<_>>())
    };
    Quantity::ALL.into_iter().map(of).collect()
}

const PERSONS: &str = "A person's number is the mean over the person's trials (time), best trials (errors against the truth) or \
    pairs of repeats; mean ± SD (ddof 0) over persons";

/// Empty where there is only one.
pub(super) fn conditions(analysis: &Analysis) -> Table {
    let mut rows = Vec::new();
    if analysis.conditions.len() > 1 {
        for (at, condition) in analysis.conditions.iter().enumerate() {
            let worked = |person: &usize| Quantity::Seconds.of(analysis, *person, Some(at)).is_some();
            let persons: Vec<usize> = (0..analysis.participants.len()).filter(worked).collect();
            let mut cells = vec![Cell::text(&condition.title), Cell::Count(persons.len())];
            cells.extend(quantities(analysis, &persons, Some(at)));
            rows.push(cells);
        }
    }
    let mut columns = vec![Column::plain("condition"), Column::plain("persons")];
    columns.extend(quantity_columns());
    table("conditions", "Conditions", PERSONS.to_owned(), columns, rows)
}

pub(super) fn condition_differences(analysis: &Analysis) -> Table {
    let title_of = |at: usize| analysis.conditions.get(at).map_or("", |condition| condition.title.as_str());
    let rows = analysis
        .contrasts
        .iter()
        .map(|contrast| {
            let [first, second] = contrast.conditions;
            let [n, m] = contrast.counts;
            let unit = contrast.quantity.unit();
            let name = contrast.quantity.name();
            let named = Column::number(name, unit, 2).heading();
            vec![
                Cell::text(&format!("{} − {}", title_of(first), title_of(second))),
                Cell::Text(named),
                Cell::text(if contrast.is_paired { "within persons" } else { "between persons" }),
                Cell::Count(n),
                Cell::Count(m),
                Cell::Number(contrast.difference),
                Cell::Between(contrast.interval.low, contrast.interval.high),
            ]
        })
        .collect();
    let mut columns =
        ["conditions", "quantity", "comparison", "n first", "n second"].map(Column::plain).to_vec();
    columns.extend([Column::number("difference", "", 2), Column::number("95 % interval", "", 2)]);
    let note = format!(
        "Difference of the persons' means, first minus second, with its 95 % percentile bootstrap interval: persons are drawn \
         with replacement {} times, seed {}. Where all worked under both conditions, persons' own differences are drawn",
        super::super::RESAMPLES,
        analysis.options.seed
    );
    table("condition-differences", "Differences between conditions", note, columns, rows)
}

/// One table for each question that divides the participants; expertise first.
pub(super) fn traits(analysis: &Analysis) -> Vec<Table> {
    let traits =
        analysis.participants.iter().flat_map(|person| person.traits.iter().map(|(item, _)| item.as_str()));
    let mut items: Vec<&str> = traits.collect::<BTreeSet<_>>().into_iter().collect();
    let is_other = |item: &str| !item.to_lowercase().contains("expert");
    sort_short(&mut items, |a, b| is_other(a).cmp(&is_other(b)));
    items.into_iter().enumerate().filter_map(|(at, item)| by_trait(analysis, at, item)).collect()
}

/// `None` where all say the same, or all something else.
fn by_trait(analysis: &Analysis, at: usize, item: &str) -> Option<Table> {
    let answer_of = |person: usize| {
        let traits = &analysis.participants.get(person)?.traits;
        traits.iter().find(|(name, _)| name == item).map(|(_, answer)| answer.as_str())
    };
    let persons = 0..analysis.participants.len();
    let levels: BTreeSet<&str> = persons.clone().filter_map(answer_of).collect();
    if !(2..=MOST_LEVELS).contains(&levels.len()) {
        return None;
    }
    let rows = levels.into_iter().map(|level| {
        let persons: Vec<usize> =
            persons.clone().filter(|person| answer_of(*person) == Some(level)).collect();
        let mut cells = vec![Cell::text(level), Cell::Count(persons.len())];
        cells.extend(quantities(analysis, &persons, None));
        cells
    });
    let mut columns = vec![Column::plain("answer"), Column::plain("persons")];
    columns.extend(quantity_columns());
    let title = format!("Persons by their answer to “{item}”");
    Some(table(&format!("by-answer-{}", at + 1), &title, PERSONS.to_owned(), columns, rows.collect()))
}
