//! A whole report as a job: analysis, pictures, then its files.

use super::figure::{Figure, TupleJob, TuplePictures, figures, svg, tuple_figure};
use super::job::{AnalysisJob, ReportProgress};
use super::page::page;
use super::table::Table;
use super::table_text::{csv, latex};
use super::tables::tables;
use super::{Analysis, ReportInput, ReportOptions};

/// Everything that a report says, ready to be written.
#[derive(Debug, Clone)]
pub struct Report {
    pub analysis: Analysis,
    pub tables: Vec<Table>,
    pub figures: Vec<Figure>,
}

/// From the input to the report.
#[derive(Debug)]
pub struct ReportJob {
    stage: Stage,
    with_pictures: bool,
}

#[derive(Debug)]
enum Stage {
    Analysis(Box<AnalysisJob>),
    Pictures(Box<Analysis>, TupleJob),
    Done,
}

/// How far the analysis is of the whole: pictures take about as long for few participants.
const ANALYSIS_PART: f64 = 0.7;

impl ReportJob {
    pub fn new(input: ReportInput, options: ReportOptions, with_pictures: bool) -> Self {
        Self { stage: Stage::Analysis(Box::new(AnalysisJob::new(input, options))), with_pictures }
    }

    /// Works while `go_on` says so, but for one comparison or one sample's pictures at least; the last step makes tables and
    /// figures. What is done is handed over once: later calls find an empty report.
    pub fn step(&mut self, go_on: &mut dyn FnMut() -> bool) -> ReportProgress<Report> {
        match std::mem::replace(&mut self.stage, Stage::Done) {
            Stage::Analysis(mut job) => match job.step(go_on) {
                ReportProgress::Working(part) => {
                    self.stage = Stage::Analysis(job);
                    ReportProgress::Working(ANALYSIS_PART * part)
                }
                ReportProgress::Done(analysis) if self.with_pictures => {
                    let pictures = TupleJob::new(&analysis);
                    self.stage = Stage::Pictures(analysis, pictures);
                    ReportProgress::Working(ANALYSIS_PART)
                }
                ReportProgress::Done(analysis) => ReportProgress::Done(Box::new(Report::new(*analysis, &[]))),
            },
            Stage::Pictures(analysis, mut job) => match job.step(&analysis, go_on) {
                ReportProgress::Working(part) => {
                    self.stage = Stage::Pictures(analysis, job);
                    ReportProgress::Working(ANALYSIS_PART + (1.0 - ANALYSIS_PART) * part)
                }
                ReportProgress::Done(made) => ReportProgress::Done(Box::new(Report::new(*analysis, &made))),
            },
            Stage::Done => ReportProgress::Done(Box::new(Report::new(Analysis::default(), &[]))),
        }
    }

    /// To the end, however long it takes.
    pub fn run(mut self) -> Report {
        loop {
            if let ReportProgress::Done(report) = self.step(&mut || true) {
                return *report;
            }
        }
    }
}

impl Report {
    fn new(analysis: Analysis, pictures: &[TuplePictures]) -> Self {
        let mut figures = figures(&analysis);
        let of_sets = (0..analysis.sets.len()).filter_map(|set| tuple_figure(&analysis, set, pictures));
        figures.extend(of_sets);
        let mut tables = tables(&analysis);
        if analysis.simulated {
            figures.iter_mut().for_each(Figure::mark_simulated);
            tables.iter_mut().for_each(Table::mark_simulated);
        }
        Self { analysis, tables, figures }
    }

    /// The page and beside it each table as CSV and LaTeX and each figure as SVG: paths and contents.
    pub fn files(&self, generator: &str) -> Vec<(String, String)> {
        let mut files = vec![("report.html".to_owned(), self.page(generator))];
        for table in &self.tables {
            files.push((format!("tables/{}.csv", table.name), csv(table)));
            // Raw rows are for programs: in a paper they would fill a book.
            if !table.is_raw {
                files.push((format!("tables/{}.tex", table.name), latex(table)));
            }
        }
        for figure in &self.figures {
            files.push((format!("figures/{}.svg", figure.name), svg(&figure.drawing, &figure.title)));
        }
        files
    }

    pub fn page(&self, generator: &str) -> String {
        page(&self.analysis, &self.tables, &self.figures, generator)
    }
}
