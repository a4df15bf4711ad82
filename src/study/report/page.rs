//! The report as one HTML page that needs nothing else.

use super::figure::{Figure, svg};
use super::table::Table;
use super::table_text::{html, html_text};
use super::{Analysis, Measure, Rows, TrialErrors};

const STYLE: &str = include_str!("page.css");

/// All tables and figures of an analysis, numbered.
pub fn page(analysis: &Analysis, tables: &[Table], figures: &[Figure], generator: &str) -> String {
    let title = html_text(&analysis.title);
    let mut text = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\">\n<link rel=\"icon\" href=\"data:,\">\n<title>{title}: \
         report</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n"
    );
    if analysis.simulated {
        text += "<div class=\"simulated\">Simulated participants: no person made these results.</div>\n";
    }
    text += &format!("<main>\n<h1>{title}</h1>\n");
    text += &abstract_of(analysis);
    let shown: Vec<&Table> = tables.iter().filter(|table| !table.is_raw).collect();
    // Results first, then what they are made of.
    let (first, rest) = shown.split_at(shown.len().min(3));
    text += "<h2>Results</h2>\n";
    first.iter().zip(1..).for_each(|(table, number)| text += &html(table, number));
    text += "<h2>Figures</h2>\n";
    figures.iter().zip(1..).for_each(|(figure, number)| text += &figure_html(figure, number));
    text += "<h2>Details</h2>\n";
    rest.iter().zip(first.len() + 1..).for_each(|(table, number)| text += &html(table, number));
    text += &remarks(analysis);
    text += &format!(
        "<footer>Made by {}. Errors over all vertices of each mesh; bootstrap seed {}.</footer>\n</main>\n</body>\n</html>\n",
        html_text(generator),
        analysis.options.seed
    );
    text
}

fn figure_html(figure: &Figure, number: usize) -> String {
    format!(
        "<figure id=\"figure-{}\">\n{}<figcaption><b>Figure {number}.</b> {}. {}</figcaption>\n</figure>\n",
        html_text(&figure.name),
        svg(&figure.drawing, &figure.title),
        html_text(&figure.title),
        html_text(&figure.caption)
    )
}

/// Who, what and how much.
fn abstract_of(analysis: &Analysis) -> String {
    let trials = analysis.trials.len();
    let people = analysis.participants.len();
    let simulated = analysis.participants.iter().filter(|participant| participant.simulated).count();
    let of_them = if simulated == 0 { String::new() } else { format!(" ({simulated} of them simulated)") };
    let mut text = format!(
        "<p class=\"abstract\">{people} participants{of_them}, {} samples, {trials} trials. ",
        analysis.samples.len()
    );
    for (set, name) in analysis.sets.iter().enumerate() {
        let best: Vec<&TrialErrors> = analysis.best_of_set(set, Rows::All).collect();
        let adds: Vec<f64> = best.iter().map(|row| row.errors.get(Measure::Add)).collect();
        let Some(spread) = super::Spread::of(&adds) else { continue };
        let name = if name.is_empty() { "Mean".to_owned() } else { format!("{}: mean", html_text(name)) };
        text += &format!(
            "{name} ADD of the best trials {:.2} ± {:.2} mm (median {:.2} mm, n = {}, all rows). ",
            spread.mean, spread.standard_deviation, spread.median, spread.count
        );
    }
    text + "</p>\n"
}

fn remarks(analysis: &Analysis) -> String {
    if analysis.remarks.is_empty() {
        return String::new();
    }
    let lines: String =
        analysis.remarks.iter().map(|remark| format!("<li>{}</li>\n", html_text(remark))).collect();
    format!("<h2>Remarks</h2>\n<ul class=\"remarks\">\n{lines}</ul>\n")
}
