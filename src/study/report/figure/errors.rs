//! Distributions of errors and times, per sample and per person.

use super::chart::{Chart, Glyph, Group, Scale};
use super::{BOXES, Drawing, Figure, figure};
use crate::study::report::{Analysis, BoxStatistics, Measure, Rows};

/// One plot under another for each of the paper's measures.
fn panels(groups_of: impl Fn(Measure) -> Vec<Group>) -> Drawing {
    let panel = |measure: Measure| {
        let unit = if measure.unit() == "deg" { "°" } else { measure.unit() };
        let y_label = format!("{} ({unit})", measure.name());
        Chart { y_label, y: Scale::FromZero, groups: groups_of(measure), legend: Vec::new() }.draw()
    };
    Drawing::stacked(Measure::PAPER.map(panel).to_vec())
}

fn groups(analysis: &Analysis, of_set: impl Fn(usize) -> Vec<(String, Glyph)>) -> Vec<Group> {
    let sets = analysis.sets.iter().enumerate();
    sets.map(|(set, name)| Group { name: name.clone(), categories: of_set(set) }).collect()
}

fn boxed(values: impl Iterator<Item = f64>) -> Glyph {
    Glyph::Box(BoxStatistics::of(&values.collect::<Vec<_>>()))
}

pub(super) fn by_sample(analysis: &Analysis) -> Figure {
    let drawing = panels(|measure| {
        groups(analysis, |set| {
            let of_sample = |at: usize| {
                let rows = analysis.best_of_set(set, Rows::All).filter(move |row| row.sample == at);
                boxed(rows.map(|row| row.errors.get(measure)))
            };
            analysis.samples_of(set).map(|(at, sample)| (sample.label.clone(), of_sample(at))).collect()
        })
    });
    let caption = format!(
        "Each person's best trial of each sample against the truth, over persons, all rows (100 %). {BOXES}."
    );
    figure("errors-by-sample", "Inter-personal errors by sample", &caption, drawing)
}

pub(super) fn by_person(analysis: &Analysis) -> Figure {
    let drawing = panels(|measure| {
        groups(analysis, |set| {
            let of_person = |person: usize| {
                let rows = analysis.best_of_set(set, Rows::All).filter(move |row| row.participant == person);
                boxed(rows.map(|row| row.errors.get(measure)))
            };
            labelled(analysis, set, of_person)
        })
    });
    let caption = format!(
        "Each person's best trial of each sample against the truth, over samples, all rows (100 %). {BOXES}."
    );
    figure("errors-by-person", "Inter-personal errors by person", &caption, drawing)
}

pub(super) fn intra_by_person(analysis: &Analysis) -> Figure {
    let drawing = panels(|measure| {
        groups(analysis, |set| {
            labelled(analysis, set, |person| {
                let rows = analysis.pairs_of(person, set, Rows::All);
                boxed(rows.map(|row| row.differences.get(measure)))
            })
        })
    });
    let caption = format!("All pairs of a person's trials of the same sample, all rows (100 %). {BOXES}.");
    figure("intra-by-person", "Intra-personal differences by person", &caption, drawing)
}

pub(super) fn times(analysis: &Analysis) -> Figure {
    let groups = groups(analysis, |set| {
        labelled(analysis, set, |person| boxed(analysis.seconds_of(person, set).into_iter()))
    });
    let chart = Chart { y_label: "time (s)".to_owned(), y: Scale::FromZero, groups, legend: Vec::new() };
    let caption = format!("Time per annotation, over all of a person's trials. {BOXES}.");
    figure("times", "Time per annotation", &caption, chart.draw())
}

fn labelled(analysis: &Analysis, set: usize, glyph: impl Fn(usize) -> Glyph) -> Vec<(String, Glyph)> {
    let members = analysis.members(set).into_iter();
    members.map(|person| (analysis.label_of(person).to_owned(), glyph(person))).collect()
}
