//! A report's first look: who it is made of, and its tables. Figures are in the page.

use egui::{Grid, RichText, ScrollArea, Ui};

use crate::study::report::{Cell, Report, Table};
use crate::ui::theme;

pub fn draw(ui: &mut Ui, report: &Report) {
    let analysis = &report.analysis;
    if analysis.simulated {
        let text = "Simulated participants: no person made these results";
        ui.label(RichText::new(text).strong().color(theme::warning(ui.visuals())));
    }
    let [people, samples, trials] =
        [analysis.participants.len(), analysis.samples.len(), analysis.trials.len()];
    let text = format!(
        "{people} participants, {samples} samples, {trials} trials; {} figures and {} tables are in the report",
        report.figures.len(),
        report.tables.len()
    );
    ui.label(RichText::new(text).weak());
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        for remark in &analysis.remarks {
            ui.label(RichText::new(remark).color(theme::warning(ui.visuals())));
        }
        for table in report.tables.iter().filter(|table| !table.is_raw) {
            one(ui, table);
        }
    });
}

fn one(ui: &mut Ui, table: &Table) {
    ui.add_space(6.0);
    ui.label(RichText::new(&table.title).strong());
    Grid::new(("report table", &table.name)).striped(true).spacing([18.0, 4.0]).show(ui, |ui| {
        for column in &table.columns {
            ui.label(RichText::new(column.heading()).small().strong());
        }
        ui.end_row();
        for row in &table.rows {
            for (cell, column) in row.iter().zip(&table.columns) {
                let text = RichText::new(cell.shown(column.decimals)).small();
                ui.label(if matches!(cell, Cell::Missing) { text.weak() } else { text });
            }
            ui.end_row();
        }
    });
}
