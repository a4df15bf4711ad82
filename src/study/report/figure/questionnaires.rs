//! Bars per participant for the scales of NASA-TLX and the items of SUS.

use super::chart::{Bar, Chart, Glyph, Group, Scale};
use super::drawing::{COLORS, Drawing};
use super::{BOXES, Figure, figure};
use crate::scene::Rgb;
use crate::study::report::input::PERFORMANCE;
use crate::study::report::statistics::mean;
use crate::study::report::{
    Analysis, BoxStatistics, ReportParticipant, SusAnswers, TLX_SCALES, TLX_TOP, TlxAnswers,
};

/// More bars than those of so many participants cannot be told apart: then each scale is a box over all of them.
const MOST_BARRED: usize = 14;

pub(super) fn tlx(analysis: &Analysis) -> Option<Figure> {
    // High is to mean success in the plot.
    let names =
        TLX_SCALES.map(|scale| if scale == "Performance" { "Success (20 − performance)" } else { scale });
    let of = |participant: &ReportParticipant| {
        let plotted = |answers: &TlxAnswers| {
            let mut ratings = answers.ratings;
            ratings[PERFORMANCE] = ratings[PERFORMANCE].map(|rating| TLX_TOP - rating);
            ratings.to_vec()
        };
        averaged(participant.tlx.iter().map(|answered| plotted(&answered.answers)))
    };
    let legend: Vec<(String, Rgb)> =
        names.iter().zip(COLORS).map(|(name, fill)| ((*name).to_owned(), fill)).collect();
    let caption = "NASA-TLX ratings, 0 to 20, per participant. Performance is shown as 20 − x, so that high means success";
    let drawing = draw(analysis, "rating", Scale::Fixed(0.0, TLX_TOP, 5.0), legend, of)?;
    Some(figure("nasa-tlx", "NASA-TLX", &captioned(analysis, caption), drawing))
}

pub(super) fn sus(analysis: &Analysis) -> Option<Figure> {
    let of = |participant: &ReportParticipant| {
        let plotted = |answers: &SusAnswers| answers.adjusted().map(Some).to_vec();
        averaged(participant.sus.iter().map(|answered| plotted(&answered.answers)))
    };
    // Odd items, which are positive, in blues; even ones, which are negative and turned round, in oranges.
    let fill = |item: u8| match item {
        odd if odd % 2 == 1 => Rgb([30 + 18 * odd, 110 + 12 * odd, 178 + 7 * odd]),
        even => Rgb([213 + 4 * even, 84 + 14 * even, 10 + 16 * even]),
    };
    let legend = (1..=10_u8).map(|item| (format!("item {item}"), fill(item))).collect();
    let caption = "SUS items, 1 to 5, per participant; even items as 6 − x, so that 5 is good for all";
    let drawing = draw(analysis, "adjusted answer", Scale::Fixed(0.0, 5.0, 1.0), legend, of)?;
    Some(figure("sus", "System Usability Scale", &captioned(analysis, caption), drawing))
}

/// `None` where nobody answered.
fn draw(
    analysis: &Analysis,
    y_label: &str,
    y: Scale,
    legend: Vec<(String, Rgb)>,
    of: impl Fn(&ReportParticipant) -> Vec<Option<f64>>,
) -> Option<Drawing> {
    let answered: Vec<(&str, Vec<Option<f64>>)> = analysis
        .participants
        .iter()
        .map(|participant| (participant.label.as_str(), of(participant)))
        .filter(|(_, answers)| !answers.is_empty())
        .collect();
    if answered.is_empty() {
        return None;
    }
    let is_crowded = answered.len() > MOST_BARRED;
    let categories = if is_crowded {
        let boxed = |at: usize| {
            let values = answered.iter().filter_map(|(_, answers)| answers.get(at).copied().flatten());
            Glyph::Box(BoxStatistics::of(&values.collect::<Vec<_>>()))
        };
        legend.iter().enumerate().map(|(at, (name, _))| (name.clone(), boxed(at))).collect()
    } else {
        let bars = |answers: &[Option<f64>]| {
            Glyph::Bars(answers.iter().map(|value| Bar { value: *value, deviation: None }).collect())
        };
        answered.iter().map(|(label, answers)| ((*label).to_owned(), bars(answers))).collect()
    };
    let groups = vec![Group { name: String::new(), categories }];
    let legend = if is_crowded { Vec::new() } else { legend };
    Some(Chart { y_label: y_label.to_owned(), y, groups, legend }.draw())
}

fn captioned(analysis: &Analysis, caption: &str) -> String {
    if analysis.participants.len() > MOST_BARRED {
        format!("{caption}, over participants. {BOXES}.")
    } else {
        format!("{caption}.")
    }
}

/// The mean of each number over a participant's questionnaires, of which there may be one per condition.
fn averaged(lists: impl Iterator<Item = Vec<Option<f64>>>) -> Vec<Option<f64>> {
    let lists: Vec<Vec<Option<f64>>> = lists.collect();
    let width = lists.iter().map(Vec::len).max().unwrap_or_default();
    let at = |at: usize| lists.iter().filter_map(move |list| list.get(at).copied().flatten());
    (0..width).map(|index| mean(&at(index).collect::<Vec<_>>())).collect()
}
