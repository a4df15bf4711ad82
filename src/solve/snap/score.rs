//! How well a pose agrees with a picture: what a snap has to make better.

use super::colors::ColorModel;
use super::picture::Picture;
use crate::solve::contour::{ContourPoint, DepthView, EdgeKind, OBJECT_ID};

/// From 0, as good as chance, to 1, every contour point where colours and edges want it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SnapScore {
    /// How well the colours on the two sides of the outline are told apart.
    pub regions: f64,
    /// What part of the edges has an edge of the picture on it.
    pub edges: f64,
}

impl SnapScore {
    pub fn total(&self) -> f64 {
        0.5 * (self.regions + self.edges)
    }
}

/// Samples on either side of the outline, in pixels.
const REACH_PX: i32 = 6;

/// Scores a pose by the contour points that it has.
pub fn score(picture: &Picture, view: &DepthView, colors: &ColorModel, points: &[ContourPoint]) -> SnapScore {
    let regions: Vec<f64> = points
        .iter()
        .filter(|point| point.kind == EdgeKind::Outline)
        .filter_map(|point| separation(picture, view, colors, point))
        .collect();
    let edges: Vec<f64> = points.iter().filter_map(|point| sharpness(picture, point)).collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / (values.len() as f64).max(1.0);
    SnapScore { regions: mean(&regions), edges: mean(&edges) }
}

/// The mean probability of being right about pixels beside the outline, minus chance.
fn separation(picture: &Picture, view: &DepthView, colors: &ColorModel, point: &ContourPoint) -> Option<f64> {
    let sector = colors.sector(point.pixel);
    let (mut sum, mut count) = (0.0, 0);
    for k in -REACH_PX..REACH_PX {
        let distance = f64::from(k) + 0.5;
        let place = point.pixel + point.normal * distance;
        let Some(index) = picture.index(place) else { continue };
        let owner = view.at(place).map_or(0, |(id, _)| id);
        let wanted = if distance < 0.0 { OBJECT_ID } else { 0 };
        if distance.abs() > 2.0 && owner != wanted {
            continue;
        }
        let odds = f64::from(colors.log_odds(&picture.colors()[index], sector));
        // tanh(odds / 2) is twice the probability minus one.
        sum += (0.5 * odds).tanh() * -distance.signum();
        count += 1;
    }
    (count > 3).then(|| sum / f64::from(count))
}

/// Is the change of colour here larger than a few pixels away? 1 where it stands out clearly, 0 where it does not.
fn sharpness(picture: &Picture, point: &ContourPoint) -> Option<f64> {
    let change = |offset: f64| -> Option<f64> {
        let middle = point.pixel + point.normal * offset;
        let (before, after) = (picture.color(middle - point.normal)?, picture.color(middle + point.normal)?);
        Some(f64::from(before.iter().zip(after).map(|(a, b)| (a - b).powi(2)).sum::<f32>()).sqrt())
    };
    let here = change(-0.5)?.max(change(0.0)?).max(change(0.5)?);
    let around = [-6.0, -4.5, -3.0, 3.0, 4.5, 6.0].into_iter().map(change).collect::<Option<Vec<f64>>>()?;
    let around = around.iter().sum::<f64>() / around.len() as f64;
    Some(((here - around) / (here + around + 0.05)).max(0.0))
}
