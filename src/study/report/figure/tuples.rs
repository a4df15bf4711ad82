//! The qualitative pictures: photo, annotation in lime, truth in magenta, and where the two silhouettes differ.

use std::sync::Arc;

use super::drawing::{Anchor, Drawing, Shape, Text};
use super::{Figure, figure};
use crate::math::sort_short;
use crate::photo::{decode, png_rgba};
use crate::study::comparison::comparison;
use crate::study::report::{Analysis, Measure, ReportProgress, Rows, TrialErrors};

/// Of a picture on the page, in its own pixels: finer than it is printed. What has fewer in the photo keeps them.
const MOST_WIDTH: u32 = 320;
const CELL_WIDTH: f64 = 186.0;
const LABEL_SIZE: f64 = 11.0;

/// The four pictures of one trial.
#[derive(Debug, Clone, PartialEq)]
pub struct TuplePictures {
    pub set: usize,
    pub sample: String,
    /// Photo, annotation, truth, difference: PNG files of one size.
    pub png: [Arc<[u8]>; 4],
    /// Of each of them.
    pub size: [u32; 2],
    /// The errors, beneath.
    pub lines: [String; 2],
}

/// Draws a row of pictures for each sample: of the person whose ADD is the median, so that it is a typical one.
#[derive(Debug)]
pub struct TupleJob {
    /// The next one last.
    rows: Vec<TrialErrors>,
    count: usize,
    made: Vec<TuplePictures>,
}

impl TupleJob {
    pub fn new(analysis: &Analysis) -> Self {
        let mut rows: Vec<TrialErrors> =
            (0..analysis.samples.len()).filter_map(|sample| median_row(analysis, sample)).collect();
        rows.reverse();
        Self { count: rows.len(), rows, made: Vec::new() }
    }

    /// Works while `go_on` says so, but for one sample at least. `analysis` is the one that it was made of.
    pub fn step(
        &mut self,
        analysis: &Analysis,
        go_on: &mut dyn FnMut() -> bool,
    ) -> ReportProgress<Vec<TuplePictures>> {
        loop {
            let Some(row) = self.rows.pop() else {
                return ReportProgress::Done(Box::new(std::mem::take(&mut self.made)));
            };
            self.made.extend(pictures(analysis, &row));
            if !go_on() {
                return ReportProgress::Working(1.0 - self.rows.len() as f64 / self.count.max(1) as f64);
            }
        }
    }

    /// To the end, however long it takes.
    pub fn run(mut self, analysis: &Analysis) -> Vec<TuplePictures> {
        loop {
            if let ReportProgress::Done(made) = self.step(analysis, &mut || true) {
                return *made;
            }
        }
    }
}

/// Of the best trials of a sample, the one whose ADD is the (lower) median.
fn median_row(analysis: &Analysis, sample: usize) -> Option<TrialErrors> {
    let set = analysis.set_of(sample)?;
    let mut rows: Vec<&TrialErrors> =
        analysis.best_of_set(set, Rows::All).filter(|row| row.sample == sample).collect();
    sort_short(&mut rows, |a, b| a.errors.get(Measure::Add).total_cmp(&b.errors.get(Measure::Add)));
    rows.get(rows.len().saturating_sub(1) / 2).map(|row| (*row).clone())
}

/// `None` where the photo is missing, cannot be read or is of another size than its camera.
fn pictures(analysis: &Analysis, row: &TrialErrors) -> Option<TuplePictures> {
    let sample = analysis.samples.get(row.sample)?;
    let view = sample.view.as_ref()?;
    let photo = decode(&view.photo).ok()?.pixels;
    let participant = analysis.participants.get(row.participant)?;
    let pose = participant.trials.get(row.trial)?.pose;
    let drawn = comparison(&photo, &view.camera, &sample.mesh, [&pose, &sample.truth], MOST_WIDTH)?;
    let size = [drawn[0].width, drawn[0].height];
    let [a, b, c, d] = drawn.map(|pixels| png_rgba(&pixels).map(Arc::<[u8]>::from));
    let error = |measure: Measure| row.errors.get(measure);
    Some(TuplePictures {
        set: sample.set,
        sample: sample.label.clone(),
        png: [a?, b?, c?, d?],
        size,
        lines: [
            format!("{:.1}°, {:.1} mm", error(Measure::Rotation), error(Measure::Translation)),
            format!("ADD {:.1} mm ({})", error(Measure::Add), participant.label),
        ],
    })
}

/// A figure of a set's rows; `None` where it has none.
pub(in super::super) fn tuple_figure(
    analysis: &Analysis,
    set: usize,
    made: &[TuplePictures],
) -> Option<Figure> {
    let rows: Vec<&TuplePictures> = made.iter().filter(|row| row.set == set).collect();
    if rows.is_empty() {
        return None;
    }
    let mut parts = vec![head()];
    parts.extend(rows.iter().map(|row| draw_row(row)));
    let name = analysis.sets.get(set).filter(|name| !name.is_empty());
    let title = name
        .map_or_else(|| "Annotations and truth".to_owned(), |name| format!("Annotations and truth, {name}"));
    let caption = "For each sample the best trial of the person whose ADD is the median: the photo, the annotation (lime), the truth \
        (magenta), and both silhouettes: white where they agree, lime or magenta where only one of them is; beneath, the errors.";
    let stem = if analysis.sets.len() > 1 { format!("pictures-{}", set + 1) } else { "pictures".to_owned() };
    Some(figure(&stem, &title, caption, Drawing::stacked(parts)))
}

fn cell_x(column: usize) -> f64 {
    28.0 + column as f64 * (CELL_WIDTH + 4.0)
}

fn head() -> Drawing {
    let mut drawing = Drawing::new(cell_x(4), 22.0);
    for (column, name) in ["Photo", "Annotated", "Truth", "Difference"].into_iter().enumerate() {
        let at = [cell_x(column) + CELL_WIDTH / 2.0, 15.0];
        drawing.text(Text::new(at, name, LABEL_SIZE + 1.0, Anchor::Middle).bold());
    }
    drawing
}

fn draw_row(row: &TuplePictures) -> Drawing {
    let height = CELL_WIDTH * f64::from(row.size[1]) / f64::from(row.size[0].max(1));
    let mut drawing = Drawing::new(cell_x(4), height + 36.0);
    drawing.text(Text::new([16.0, height / 2.0], &row.sample, LABEL_SIZE + 1.0, Anchor::Middle).upright());
    for (column, png) in row.png.iter().enumerate() {
        let at = [cell_x(column), 0.0];
        drawing.shapes.push(Shape::Picture { at, size: [CELL_WIDTH, height], png: png.clone() });
    }
    for (line, text) in row.lines.iter().enumerate() {
        let at = [cell_x(3) + CELL_WIDTH / 2.0, height + 13.0 + 13.0 * line as f64];
        drawing.text(Text::new(at, text, LABEL_SIZE, Anchor::Middle));
    }
    drawing
}
