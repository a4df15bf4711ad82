//! Box plots and grouped bars over named categories, the sets side by side.

use super::axis::Axis;
use super::drawing::{Anchor, BLACK, Drawing, GREY, PALE, Shape, Stroke, Text, color, text_width};
use crate::scene::Rgb;
use crate::study::report::BoxStatistics;

/// As wide as a page of two columns.
pub(super) const WIDTH: f64 = 760.0;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 12.0;
const TOP: f64 = 14.0;
const PLOT_HEIGHT: f64 = 170.0;
const LABEL_SIZE: f64 = 11.0;
/// The gap between two groups, in categories.
const GROUP_GAP: f64 = 0.8;

/// One plot.
#[derive(Debug, Clone)]
pub(super) struct Chart {
    pub y_label: String,
    pub y: Scale,
    pub groups: Vec<Group>,
    /// What the bars of a category are, with their colours: the legend.
    pub legend: Vec<(String, Rgb)>,
}

/// The range of the numbers.
#[derive(Debug, Clone, Copy)]
pub(super) enum Scale {
    FromZero,
    /// From, to, and the step of the ticks.
    Fixed(f64, f64, f64),
}

/// Categories that stand together: those of one set.
#[derive(Debug, Clone)]
pub(super) struct Group {
    pub name: String,
    pub categories: Vec<(String, Glyph)>,
}

#[derive(Debug, Clone)]
pub(super) enum Glyph {
    /// `None`: nothing was measured.
    Box(Option<BoxStatistics>),
    /// As many as the legend has.
    Bars(Vec<Bar>),
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Bar {
    pub value: Option<f64>,
    /// Half the length of the error bar.
    pub deviation: Option<f64>,
}

impl Glyph {
    fn reach(&self) -> f64 {
        match self {
            Self::Box(Some(found)) => {
                found.outliers.iter().copied().fold(found.whiskers[1].max(found.mean), f64::max)
            }
            Self::Box(None) => 0.0,
            Self::Bars(bars) => {
                let tops = bars.iter().map(|bar| bar.value.unwrap_or(0.0) + bar.deviation.unwrap_or(0.0));
                tops.fold(0.0, f64::max)
            }
        }
    }
}

/// Where a chart's numbers and categories are on its drawing.
struct Frame {
    axis: Axis,
    category_width: f64,
    bottom: f64,
}

impl Frame {
    fn y(&self, value: f64) -> f64 {
        self.bottom - PLOT_HEIGHT * self.axis.part(value)
    }
}

impl Chart {
    pub fn draw(&self) -> Drawing {
        let reach = self.groups.iter().flat_map(|group| &group.categories).map(|(_, glyph)| glyph.reach());
        let axis = match self.y {
            Scale::FromZero => Axis::around(0.0, reach.fold(0.0, f64::max), 5.0),
            Scale::Fixed(low, high, step) => Axis::fixed(low, high, step),
        };
        let categories: usize = self.groups.iter().map(|group| group.categories.len()).sum();
        let gaps = self.groups.len().saturating_sub(1) as f64 * GROUP_GAP;
        let category_width = (WIDTH - LEFT - RIGHT) / (categories as f64 + gaps).max(1.0);
        let legend_height = if self.legend.is_empty() { 0.0 } else { legend_height(&self.legend) };
        let bottom = TOP + legend_height + PLOT_HEIGHT;
        let frame = Frame { axis, category_width, bottom };
        let labels_height = self.labels_height(category_width);
        let names_height = if self.groups.len() > 1 { 18.0 } else { 0.0 };
        let mut drawing = Drawing::new(WIDTH, bottom + labels_height + names_height + 10.0);
        self.draw_axis(&mut drawing, &frame);
        draw_legend(&mut drawing, &self.legend);
        let mut x = LEFT;
        for (at, group) in self.groups.iter().enumerate() {
            let start = x;
            for (index, (label, glyph)) in group.categories.iter().enumerate() {
                let middle = x + category_width / 2.0;
                match glyph {
                    Glyph::Box(Some(found)) => draw_box(&mut drawing, &frame, middle, found, color(at)),
                    Glyph::Box(None) => {}
                    Glyph::Bars(bars) => self.draw_bars(&mut drawing, &frame, middle, bars, at),
                }
                self.draw_label(&mut drawing, &frame, middle, index, label);
                x += category_width;
            }
            if self.groups.len() > 1 {
                let at = [(start + x) / 2.0, bottom + labels_height + 16.0];
                drawing.text(Text::new(at, &group.name, LABEL_SIZE + 1.0, Anchor::Middle).bold());
            }
            x += category_width * GROUP_GAP;
        }
        drawing
    }

    fn draw_axis(&self, drawing: &mut Drawing, frame: &Frame) {
        for tick in &frame.axis.ticks {
            let y = frame.y(*tick);
            drawing.line([LEFT, y], [WIDTH - RIGHT, y], Stroke { width: 0.7, ..Stroke::thin(PALE) });
            let at = [LEFT - 6.0, y + 0.35 * LABEL_SIZE];
            drawing.text(Text::new(at, &frame.axis.label(*tick), LABEL_SIZE, Anchor::End));
        }
        drawing.line([LEFT, frame.bottom - PLOT_HEIGHT], [LEFT, frame.bottom], Stroke::thin(BLACK));
        drawing.line([LEFT, frame.bottom], [WIDTH - RIGHT, frame.bottom], Stroke::thin(BLACK));
        let at = [16.0, frame.bottom - PLOT_HEIGHT / 2.0];
        drawing.text(Text::new(at, &self.y_label, LABEL_SIZE + 1.0, Anchor::Middle).upright());
    }

    fn longest_label(&self) -> f64 {
        let labels = self.groups.iter().flat_map(|group| &group.categories).map(|(label, _)| label);
        labels.map(|label| text_width(label, LABEL_SIZE)).fold(0.0, f64::max)
    }

    /// Labels stand upright where they have no room side by side.
    fn is_crowded(&self, category_width: f64) -> bool {
        self.longest_label() > category_width - 3.0
    }

    fn labels_height(&self, category_width: f64) -> f64 {
        if self.is_crowded(category_width) { self.longest_label() + 10.0 } else { LABEL_SIZE + 6.0 }
    }

    fn draw_label(&self, drawing: &mut Drawing, frame: &Frame, middle: f64, index: usize, label: &str) {
        if !self.is_crowded(frame.category_width) {
            let at = [middle, frame.bottom + LABEL_SIZE + 4.0];
            drawing.text(Text::new(at, label, LABEL_SIZE, Anchor::Middle));
            return;
        }
        let every = (LABEL_SIZE / frame.category_width).ceil().max(1.0) as usize;
        if index.is_multiple_of(every) {
            let at = [middle + 0.35 * LABEL_SIZE, frame.bottom + 6.0];
            drawing.text(Text::new(at, label, LABEL_SIZE, Anchor::End).upright());
        }
    }

    fn draw_bars(&self, drawing: &mut Drawing, frame: &Frame, middle: f64, bars: &[Bar], group: usize) {
        let width = (frame.category_width * 0.84 / bars.len().max(1) as f64).min(40.0);
        let mut x = middle - width * bars.len() as f64 / 2.0;
        for (at, bar) in bars.iter().enumerate() {
            let fill = self.legend.get(at).map_or_else(|| color(group), |(_, fill)| *fill);
            if let Some(value) = bar.value {
                let (from, to) = ([x, frame.bottom], [x + width, frame.y(value)]);
                drawing.rect(from, to, Some(fill), Some(Stroke { width: 0.6, ..Stroke::thin(BLACK) }));
                if let Some(deviation) = bar.deviation {
                    let [low, high] = [value - deviation, value + deviation].map(|end| frame.y(end));
                    whisker(drawing, x + width / 2.0, low, high, (width / 4.0).min(4.0));
                }
            }
            x += width;
        }
    }
}

fn draw_box(drawing: &mut Drawing, frame: &Frame, middle: f64, found: &BoxStatistics, fill: Rgb) {
    let half = (frame.category_width * 0.32).min(18.0);
    let y = |value: f64| frame.y(value);
    whisker(drawing, middle, y(found.whiskers[0]), y(found.lower_quartile), half / 2.0);
    whisker(drawing, middle, y(found.whiskers[1]), y(found.upper_quartile), half / 2.0);
    let (from, to) = ([middle - half, y(found.lower_quartile)], [middle + half, y(found.upper_quartile)]);
    drawing.rect(from, to, Some(fill), Some(Stroke::thin(BLACK)));
    let median = y(found.median);
    drawing.line([middle - half, median], [middle + half, median], Stroke::thick(BLACK));
    let stroke = Stroke { width: 0.8, ..Stroke::thin(BLACK) };
    drawing.shapes.push(Shape::Diamond {
        center: [middle, y(found.mean)],
        radius: half.min(3.5),
        fill: Rgb([255, 255, 255]),
        stroke,
    });
    let radius = half.min(2.2);
    drawing.shapes.extend(found.outliers.iter().map(|value| Shape::Circle {
        center: [middle, y(*value)],
        radius,
        stroke,
    }));
}

/// A line with a cap at its first end, and at the second where that is a whisker's too.
fn whisker(drawing: &mut Drawing, x: f64, end: f64, start: f64, half: f64) {
    drawing.line([x, start], [x, end], Stroke::thin(BLACK));
    drawing.line([x - half, end], [x + half, end], Stroke::thin(BLACK));
    drawing.line([x - half, start], [x + half, start], Stroke::thin(BLACK));
}

/// Where each entry of a legend begins: rows are filled from the left.
fn legend_places(legend: &[(String, Rgb)]) -> Vec<[f64; 2]> {
    let (mut x, mut y) = (LEFT, TOP);
    let mut places = Vec::new();
    for (name, _) in legend {
        let width = text_width(name, LABEL_SIZE) + 24.0;
        if x + width > WIDTH - RIGHT && x > LEFT {
            (x, y) = (LEFT, y + 16.0);
        }
        places.push([x, y]);
        x += width;
    }
    places
}

fn legend_height(legend: &[(String, Rgb)]) -> f64 {
    legend_places(legend).last().map_or(0.0, |[_, y]| y - TOP + 22.0)
}

fn draw_legend(drawing: &mut Drawing, legend: &[(String, Rgb)]) {
    for ([x, y], (name, fill)) in legend_places(legend).into_iter().zip(legend) {
        drawing.rect([x, y], [x + 10.0, y + 10.0], Some(*fill), Some(Stroke::thin(GREY)));
        drawing.text(Text::new([x + 15.0, y + 9.0], name, LABEL_SIZE, Anchor::Start));
    }
}
