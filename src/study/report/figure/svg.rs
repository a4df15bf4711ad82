//! A drawing as SVG.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::drawing::{Anchor, Drawing, Shape, Stroke, Text};
use crate::scene::Rgb;
use crate::study::report::table_text::html_text;

/// What a reader's machine has: the metric twins of Helvetica.
const FONTS: &str = "Helvetica, Arial, Liberation Sans, DejaVu Sans, sans-serif";

/// Of a figure as PNG, pixels for each of its units: 192 dots an inch.
pub const PNG_SCALE: f64 = 2.0;

/// A document of its own, on white.
pub fn svg(drawing: &Drawing, title: &str) -> String {
    let (width, height) = (number(drawing.width), number(drawing.height));
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"{FONTS}\" role=\"img\"><title>{}</title><rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
        html_text(title)
    );
    for shape in &drawing.shapes {
        text += &element(shape);
        text.push('\n');
    }
    text + "</svg>\n"
}

fn element(shape: &Shape) -> String {
    match shape {
        Shape::Line { from: [x1, y1], to: [x2, y2], stroke } => format!(
            "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"{}/>",
            number(*x1),
            number(*y1),
            number(*x2),
            number(*y2),
            stroked(stroke)
        ),
        Shape::Rect { at: [x, y], size: [width, height], fill, stroke } => format!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"{}/>",
            number(*x),
            number(*y),
            number(*width),
            number(*height),
            fill.map_or_else(|| "none".to_owned(), hex),
            stroke.as_ref().map(stroked).unwrap_or_default()
        ),
        Shape::Circle { center: [x, y], radius, stroke } => format!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"none\"{}/>",
            number(*x),
            number(*y),
            number(*radius),
            stroked(stroke)
        ),
        Shape::Diamond { center: [x, y], radius, fill, stroke } => {
            let corners = [[0.0, -radius], [*radius, 0.0], [0.0, *radius], [-radius, 0.0]]
                .map(|[dx, dy]| format!("{},{}", number(x + dx), number(y + dy)));
            format!("<polygon points=\"{}\" fill=\"{}\"{}/>", corners.join(" "), hex(*fill), stroked(stroke))
        }
        Shape::Text(text) => text_element(text),
        Shape::Picture { at: [x, y], size: [width, height], png } => format!(
            "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" href=\"data:image/png;base64,{}\"/>",
            number(*x),
            number(*y),
            number(*width),
            number(*height),
            STANDARD.encode(png)
        ),
    }
}

fn text_element(text: &Text) -> String {
    let [x, y] = text.at.map(number);
    let anchor = match text.anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    let turn = if text.is_upright { format!(" transform=\"rotate(-90 {x} {y})\"") } else { String::new() };
    let weight = if text.is_bold { " font-weight=\"bold\"" } else { "" };
    format!(
        "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\" text-anchor=\"{anchor}\" fill=\"{}\"{weight}{turn}>{}</text>",
        number(text.size),
        hex(text.color),
        html_text(&text.text)
    )
}

fn stroked(stroke: &Stroke) -> String {
    let dashes = if stroke.is_dashed { " stroke-dasharray=\"4 3\"" } else { "" };
    format!(" stroke=\"{}\" stroke-width=\"{}\"{dashes}", hex(stroke.color), number(stroke.width))
}

pub(super) fn hex(Rgb([r, g, b]): Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A hundredth of a unit is finer than any printer's dot.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_cannot_break_out_and_numbers_are_short() {
        let mut drawing = Drawing::new(100.0, 50.25);
        drawing.text(Text::new([1.0 / 3.0, 2.0], "a<b> & \"c\"", 10.0, Anchor::End).upright());
        let text = svg(&drawing, "<title>");
        assert!(text.contains("a&lt;b&gt; &amp; &quot;c&quot;</text>") && text.contains("&lt;title&gt;"));
        assert!(text.contains("height=\"50.25\"") && text.contains("rotate(-90 0.33 2)"));
    }
}
