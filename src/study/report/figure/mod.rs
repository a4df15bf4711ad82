//! The figures of a report: pure functions of its analysis, and the drawings that they are made of.

mod axis;
mod chart;
mod drawing;
mod errors;
mod forest;
mod questionnaires;
mod svg;
mod tuples;

pub use drawing::{Anchor, Drawing, Shape, Stroke, Text};
pub use svg::{PNG_SCALE, svg};
pub(super) use tuples::tuple_figure;
pub use tuples::{TupleJob, TuplePictures};

use super::Analysis;
use super::table::SIMULATED;

/// A drawing with what is said of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// The stem of its files: letters, digits and `-`.
    pub name: String,
    pub title: String,
    pub caption: String,
    pub drawing: Drawing,
}

impl Figure {
    /// A figure leaves its page, so it says itself what it is made of.
    pub(super) fn mark_simulated(&mut self) {
        let Drawing { width, height, .. } = self.drawing;
        let mark = Text::new([width - 8.0, height + 10.0], SIMULATED, 11.0, Anchor::End).bold();
        self.drawing.text(Text { color: drawing::WARNING, ..mark });
        self.drawing.height = height + 16.0;
    }
}

/// How a box is to be read.
const BOXES: &str = "Boxes: quartiles and median; diamonds: means; whiskers: the farthest values within 1.5 interquartile ranges; \
    circles: beyond";

/// All figures but the pictures, in the order in which the page has them. Those that would be empty are left out.
pub fn figures(analysis: &Analysis) -> Vec<Figure> {
    let mut figures = vec![
        errors::by_sample(analysis),
        errors::by_person(analysis),
        errors::intra_by_person(analysis),
        errors::times(analysis),
    ];
    figures.extend(questionnaires::tlx(analysis));
    figures.extend(questionnaires::sus(analysis));
    figures.extend(forest::differences(analysis));
    figures
}

fn figure(name: &str, title: &str, caption: &str, drawing: Drawing) -> Figure {
    Figure { name: name.to_owned(), title: title.to_owned(), caption: caption.to_owned(), drawing }
}
