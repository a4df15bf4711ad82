//! How well a pose agrees with a picture: what a snap has to make better.

use super::colors::ColorModel;
use super::picture::Picture;
use crate::solve::contour::{ContourPoint, DepthView, EdgeKind, OBJECT_ID};

/// From 0, as good as chance, to 1, every contour point where colours and edges want it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SnapScore {
    /// How well the colours on the two sides of the outline are told apart.
    pub regions: f64,
    /// How clear the edges of the picture are under those of the object.
    pub edges: f64,
}

impl SnapScore {
    pub fn total(&self) -> f64 {
        0.5 * (self.regions + self.edges)
    }
}

/// Samples on either side of the outline, in pixels.
const REACH_PX: i32 = 6;

/// Scores a pose by the contour points that it has and by colours that were learnt from it: a pose that puts the contour
/// where colours change is one whose colours are well told apart. So no other pose is the judge, and scores of any two poses
/// can be compared.
pub fn score(picture: &Picture, view: &DepthView, colors: &ColorModel, points: &[ContourPoint]) -> SnapScore {
    let regions: Vec<f64> = points
        .iter()
        .filter(|point| point.kind == EdgeKind::Outline)
        .filter_map(|point| separation(picture, view, colors, point))
        .collect();
    let (mut sum, mut total) = (0.0, 0.0);
    for point in points {
        let weight = match point.kind {
            EdgeKind::Outline => 1.0,
            EdgeKind::Inner => 0.6,
            EdgeKind::Crease => 0.4,
        };
        if let Some(clearness) = clearness(picture, point) {
            sum += weight * clearness;
            total += weight;
        }
    }
    let mean = regions.iter().sum::<f64>() / (regions.len() as f64).max(1.0);
    SnapScore { regions: mean, edges: sum / f64::max(total, 1.0) }
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
        let odds = f64::from(colors.log_odds(picture, index, sector));
        // tanh(odds / 2) is twice the probability minus one.
        sum += (0.5 * odds).tanh() * -distance.signum();
        count += 1;
    }
    (count > 3).then(|| sum / f64::from(count))
}

/// Of the edge here, allowing for half a pixel to either side.
fn clearness(picture: &Picture, point: &ContourPoint) -> Option<f64> {
    let at = |offset: f64| picture.edge(point.pixel + point.normal * offset, point.normal).map(f64::from);
    Some(0.25 * at(-0.8)? + 0.5 * at(0.0)? + 0.25 * at(0.8)?)
}
