//! A drawing of lines, boxes and texts, as plain data.

use std::sync::Arc;

use crate::scene::Rgb;

/// Points are in units of 1/96 inch from the top left, x to the right, y down.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    pub width: f64,
    pub height: f64,
    /// From back to front.
    pub shapes: Vec<Shape>,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    Line {
        from: [f64; 2],
        to: [f64; 2],
        stroke: Stroke,
    },
    Rect {
        at: [f64; 2],
        size: [f64; 2],
        fill: Option<Rgb>,
        stroke: Option<Stroke>,
    },
    Circle {
        center: [f64; 2],
        radius: f64,
        stroke: Stroke,
    },
    /// A square on its corner: the sign of a mean.
    Diamond {
        center: [f64; 2],
        radius: f64,
        fill: Rgb,
        stroke: Stroke,
    },
    Text(Text),
    /// A PNG file.
    Picture {
        at: [f64; 2],
        size: [f64; 2],
        png: Arc<[u8]>,
    },
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    pub width: f64,
    pub color: Rgb,
    pub is_dashed: bool,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Text {
    /// On the baseline.
    pub at: [f64; 2],
    pub text: String,
    pub size: f64,
    pub anchor: Anchor,
    /// A quarter turn against the clock.
    pub is_upright: bool,
    pub is_bold: bool,
    pub color: Rgb,
}

/// Which end of a text is at its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

pub(super) const BLACK: Rgb = Rgb([30, 30, 30]);
pub(super) const GREY: Rgb = Rgb([110, 110, 110]);
pub(super) const PALE: Rgb = Rgb([222, 222, 222]);

/// Of what nobody may overlook.
pub(super) const WARNING: Rgb = Rgb([213, 94, 0]);

/// Apart for colour-blind eyes, and in grey. (Okabe and Ito, *Color Universal Design*, 2008.)
pub(super) const COLORS: [Rgb; 7] = [
    Rgb([86, 180, 233]),
    Rgb([230, 159, 0]),
    Rgb([0, 158, 115]),
    Rgb([204, 121, 167]),
    Rgb([0, 114, 178]),
    Rgb([213, 94, 0]),
    Rgb([240, 228, 66]),
];

/// The colour of thing number `index`.
pub(super) fn color(index: usize) -> Rgb {
    COLORS[index % COLORS.len()]
}

/// About how wide a text is: digits and small letters of a sans-serif take half their size and a little.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    text.chars().count() as f64 * size * 0.53
}

impl Stroke {
    pub fn thin(color: Rgb) -> Self {
        Self { width: 1.0, color, is_dashed: false }
    }

    pub fn thick(color: Rgb) -> Self {
        Self { width: 2.0, color, is_dashed: false }
    }
}

impl Text {
    pub fn new(at: [f64; 2], text: &str, size: f64, anchor: Anchor) -> Self {
        Self { at, text: text.to_owned(), size, anchor, is_upright: false, is_bold: false, color: BLACK }
    }

    pub fn upright(self) -> Self {
        Self { is_upright: true, ..self }
    }

    pub fn bold(self) -> Self {
        Self { is_bold: true, ..self }
    }
}

impl Drawing {
    pub fn new(width: f64, height: f64) -> Self {
        Self { width, height, shapes: Vec::new() }
    }

    pub fn line(&mut self, from: [f64; 2], to: [f64; 2], stroke: Stroke) {
        self.shapes.push(Shape::Line { from, to, stroke });
    }

    /// Between any two corners.
    pub fn rect(&mut self, from: [f64; 2], to: [f64; 2], fill: Option<Rgb>, stroke: Option<Stroke>) {
        let at = [from[0].min(to[0]), from[1].min(to[1])];
        let size = [(from[0] - to[0]).abs(), (from[1] - to[1]).abs()];
        self.shapes.push(Shape::Rect { at, size, fill, stroke });
    }

    pub fn text(&mut self, text: Text) {
        self.shapes.push(Shape::Text(text));
    }

    /// All of another drawing with its top left at a point.
    pub fn place(&mut self, other: Self, [x, y]: [f64; 2]) {
        let moved = |[a, b]: [f64; 2]| [a + x, b + y];
        self.shapes.extend(other.shapes.into_iter().map(|shape| match shape {
            Shape::Line { from, to, stroke } => Shape::Line { from: moved(from), to: moved(to), stroke },
            Shape::Rect { at, size, fill, stroke } => Shape::Rect { at: moved(at), size, fill, stroke },
            Shape::Circle { center, radius, stroke } => {
                Shape::Circle { center: moved(center), radius, stroke }
            }
            Shape::Diamond { center, radius, fill, stroke } => {
                Shape::Diamond { center: moved(center), radius, fill, stroke }
            }
            Shape::Text(text) => Shape::Text(Text { at: moved(text.at), ..text }),
            Shape::Picture { at, size, png } => Shape::Picture { at: moved(at), size, png },
        }));
    }

    /// Drawings under one another, each as wide as it is.
    pub fn stacked(drawings: Vec<Self>) -> Self {
        let width = drawings.iter().map(|drawing| drawing.width).fold(0.0, f64::max);
        let mut all = Self::new(width, 0.0);
        for drawing in drawings {
            let (y, height) = (all.height, drawing.height);
            all.place(drawing, [0.0, y]);
            all.height = y + height;
        }
        all
    }
}
