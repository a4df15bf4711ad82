//! Differences between conditions with their intervals.

use super::axis::Axis;
use super::chart::WIDTH;
use super::drawing::{Anchor, BLACK, Drawing, GREY, PALE, Shape, Stroke, Text, color};
use super::{Figure, figure};
use crate::study::report::{Analysis, Contrast, Quantity, RESAMPLES};

const LEFT: f64 = 250.0;
const RIGHT: f64 = 24.0;
const ROW: f64 = 20.0;
const SIZE: f64 = 11.0;

/// `None` where there is only one condition.
pub(super) fn differences(analysis: &Analysis) -> Option<Figure> {
    let panels: Vec<Drawing> = Quantity::ALL
        .into_iter()
        .filter_map(|quantity| {
            let of: Vec<&Contrast> =
                analysis.contrasts.iter().filter(|contrast| contrast.quantity == quantity).collect();
            (!of.is_empty()).then(|| panel(analysis, quantity, &of))
        })
        .collect();
    let caption = format!(
        "Differences of the persons' means between conditions, first minus second, with 95 % percentile bootstrap intervals \
         ({RESAMPLES} draws of persons, seed {}). Where an interval leaves out zero, the conditions differ.",
        analysis.options.seed
    );
    (!panels.is_empty()).then(|| {
        figure("condition-differences", "Differences between conditions", &caption, Drawing::stacked(panels))
    })
}

fn panel(analysis: &Analysis, quantity: Quantity, contrasts: &[&Contrast]) -> Drawing {
    let ends = contrasts.iter().flat_map(|contrast| [contrast.interval.low, contrast.interval.high]);
    let (low, high) = ends.fold((0.0_f64, 0.0_f64), |(low, high), end| (low.min(end), high.max(end)));
    let axis = Axis::around(low, high, 6.0);
    let bottom = 10.0 + ROW * contrasts.len() as f64;
    let mut drawing = Drawing::new(WIDTH, bottom + 44.0);
    let x = |value: f64| LEFT + (WIDTH - LEFT - RIGHT) * axis.part(value);
    for tick in &axis.ticks {
        drawing.line([x(*tick), 6.0], [x(*tick), bottom], Stroke { width: 0.7, ..Stroke::thin(PALE) });
        let at = [x(*tick), bottom + SIZE + 3.0];
        drawing.text(Text::new(at, &axis.label(*tick), SIZE, Anchor::Middle));
    }
    drawing.line([LEFT, bottom], [WIDTH - RIGHT, bottom], Stroke::thin(BLACK));
    drawing.line([x(0.0), 6.0], [x(0.0), bottom], Stroke { is_dashed: true, ..Stroke::thin(GREY) });
    let unit = match quantity.unit() {
        "" => String::new(),
        "deg" => " (°)".to_owned(),
        unit => format!(" ({unit})"),
    };
    let at = [(LEFT + WIDTH - RIGHT) / 2.0, bottom + 2.0 * SIZE + 8.0];
    drawing.text(Text::new(at, &format!("{}{unit}", quantity.name()), SIZE + 1.0, Anchor::Middle));
    for (row, contrast) in contrasts.iter().enumerate() {
        let y = 10.0 + ROW * (row as f64 + 0.5);
        let title = |at: usize| analysis.conditions.get(at).map_or("", |condition| condition.title.as_str());
        let [first, second] = contrast.conditions;
        let label = format!("{} − {}", title(first), title(second));
        drawing.text(Text::new([LEFT - 10.0, y + 0.35 * SIZE], &label, SIZE, Anchor::End));
        let ends = [contrast.interval.low, contrast.interval.high].map(x);
        drawing.line([ends[0], y], [ends[1], y], Stroke { width: 1.6, ..Stroke::thin(BLACK) });
        for end in ends {
            drawing.line([end, y - 4.0], [end, y + 4.0], Stroke::thin(BLACK));
        }
        let center = [x(contrast.difference), y];
        drawing.shapes.push(Shape::Diamond {
            center,
            radius: 5.0,
            fill: color(0),
            stroke: Stroke::thin(BLACK),
        });
    }
    drawing
}
