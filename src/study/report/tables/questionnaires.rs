//! NASA-TLX and SUS, person by person.

use super::super::{SusAnswers, TLX_SCALES, TlxAnswers};
use super::{Analysis, Cell, Column, Table, spread_cell, table};

pub(super) fn tlx(analysis: &Analysis) -> Table {
    let mut lines = Vec::new();
    for participant in &analysis.participants {
        for answered in &participant.tlx {
            let label = labelled(analysis, &participant.label, answered.condition);
            lines.push((label, numbers_of_tlx(&answered.answers)));
        }
    }
    let mut columns = vec![Column::plain("person")];
    columns.extend(TLX_SCALES.map(|scale| Column::number(scale, "", 2)));
    columns.extend([Column::number("raw", "", 2), Column::number("weighted", "", 2)]);
    let note = "NASA-TLX, 0 to 20 on each scale; performance from perfect (0) to failure (20). Raw: the unweighted mean of the \
        scales. Weighted: Σ w r / 15 with the weights of the 15 comparisons, where these were made. Mean: ± SD (ddof 0) over \
        the rows above"
        .to_owned();
    table("nasa-tlx", "NASA-TLX", note, columns, with_mean(lines))
}

fn numbers_of_tlx(answers: &TlxAnswers) -> Vec<Option<f64>> {
    answers.ratings.into_iter().chain([answers.raw(), answers.weighted()]).collect()
}

pub(super) fn sus(analysis: &Analysis) -> Table {
    let mut lines = Vec::new();
    for participant in &analysis.participants {
        for answered in &participant.sus {
            let label = labelled(analysis, &participant.label, answered.condition);
            lines.push((label, numbers_of_sus(&answered.answers)));
        }
    }
    let mut columns = vec![Column::plain("person")];
    columns.extend((1..=10).map(|item| Column::number(&format!("item {item}"), "", 2)));
    columns.extend([Column::number("score", "", 2), Column::number("unanswered", "", 0)]);
    let note = "SUS, items adjusted so that 5 is good (even ones as 6 − x); an unanswered item counts 3. Score: 2.5 times the sum \
        of the adjusted items less one, 0 to 100; 68 is about the 50th percentile of published studies. Mean: ± SD (ddof 0) \
        over the rows above"
        .to_owned();
    table("sus", "System Usability Scale", note, columns, with_mean(lines))
}

fn numbers_of_sus(answers: &SusAnswers) -> Vec<Option<f64>> {
    let rest = [answers.score(), answers.missing() as f64];
    answers.adjusted().into_iter().chain(rest).map(Some).collect()
}

fn labelled(analysis: &Analysis, label: &str, condition: Option<usize>) -> String {
    match condition.and_then(|condition| analysis.conditions.get(condition)) {
        Some(condition) if analysis.conditions.len() > 1 => format!("{label}, {}", condition.title),
        _ => label.to_owned(),
    }
}

/// The lines, and one with the mean ± SD of each column.
fn with_mean(lines: Vec<(String, Vec<Option<f64>>)>) -> Vec<Vec<Cell>> {
    let Some(width) = lines.iter().map(|(_, numbers)| numbers.len()).max() else { return Vec::new() };
    let column = |at: usize| -> Vec<f64> {
        lines.iter().filter_map(|(_, numbers)| numbers.get(at).copied().flatten()).collect()
    };
    let mut last = vec![Cell::text("mean")];
    last.extend((0..width).map(|at| spread_cell(&column(at))));
    let line = |(label, numbers): &(String, Vec<Option<f64>>)| {
        std::iter::once(Cell::text(label)).chain(numbers.iter().map(|number| Cell::number(*number))).collect()
    };
    let mut rows: Vec<Vec<Cell>> = lines.iter().map(line).collect();
    rows.push(last);
    rows
}
