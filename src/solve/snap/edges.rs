//! Edges in the picture near the contour's points: the clearest one, and for an outline against a clear background the
//! exact place of its middle.

use glam::{DVec2, DVec3};

use super::colors::ColorModel;
use super::picture::Picture;
use super::pull::Pull;
use crate::solve::contour::{ContourPoint, EdgeKind};

/// Edges less clear than this (see [`Picture::edge`]) are noise.
const FAINTEST: f64 = 0.3;

/// The edge that each point most likely belongs to, in the manner of Drummond and Cipolla (*Real-Time Visual Tracking of
/// Complex Structures*, 2002): clear and near. `reach_px` is how far is looked.
pub fn search(picture: &Picture, colors: &ColorModel, points: &[ContourPoint], reach_px: f64) -> Vec<Pull> {
    points.iter().filter_map(|point| search_line(picture, colors, point, reach_px)).collect()
}

fn search_line(picture: &Picture, colors: &ColorModel, point: &ContourPoint, reach_px: f64) -> Option<Pull> {
    let reach = reach_px.ceil() as i32 + 1;
    let edges: Option<Vec<f64>> = (-reach..=reach)
        .map(|k| picture.edge(point.pixel + point.normal * f64::from(k), point.normal).map(f64::from))
        .collect();
    let edges = edges?;
    let mut best: Option<(f64, Pull)> = None;
    for (k, window) in (1 - reach..).zip(edges.windows(3)) {
        let &[before, here, after] = window else { continue };
        if here < FAINTEST || here < before || here <= after {
            continue;
        }
        // The top of the parabola through three samples.
        let offset_px = f64::from(k) + 0.5 * (before - after) / (before - 2.0 * here + after);
        let near = (-0.5 * (offset_px / (0.5 * reach_px)).powi(2)).exp();
        let liking = here * near * fitness(picture, colors, point, offset_px);
        if best.is_none_or(|(most, _)| liking > most) {
            // Within the object many a silhouette has hardly an edge in the picture, and a weak one may be something else.
            let kind_sigma_px = match point.kind {
                EdgeKind::Outline => 1.0,
                EdgeKind::Inner | EdgeKind::Crease => 1.5,
            };
            let variance_px2 = (kind_sigma_px * 0.8 / here).powi(2);
            best = Some((liking, Pull { point: *point, offset_px, variance_px2, tone_px: 0.0 }));
        }
    }
    best.map(|(_, pull)| pull)
}

/// How well the colours on the two sides of an edge are those of object and background: for an outline from 0 to 1.
fn fitness(picture: &Picture, colors: &ColorModel, point: &ContourPoint, offset_px: f64) -> f64 {
    if point.kind != EdgeKind::Outline {
        return 1.0;
    }
    let sector = colors.sector(point.pixel);
    let odds = |side: f64| -> f64 {
        let at = |k: f64| picture.index(point.pixel + point.normal * (offset_px + side * k));
        let indices = [1.0, 2.0, 3.0].into_iter().filter_map(at);
        indices.map(|index| f64::from(colors.log_odds(picture, index, sector))).sum()
    };
    1.0 / (1.0 + (0.5 * (odds(1.0) - odds(-1.0))).exp())
}

/// Where the mask's border is across each point of the outline: the nearest one within `reach_px` with the mask on the object's
/// side. Nothing without a mask.
pub fn follow_mask(picture: &Picture, points: &[ContourPoint], reach_px: f64) -> Vec<Pull> {
    if picture.masked(0).is_none() {
        return Vec::new();
    }
    let outline = points.iter().filter(|point| point.kind == EdgeKind::Outline);
    outline.filter_map(|point| mask_border(picture, point, reach_px)).collect()
}

fn mask_border(picture: &Picture, point: &ContourPoint, reach_px: f64) -> Option<Pull> {
    let is_object = |offset_px: f64| {
        picture.index(point.pixel + point.normal * offset_px).and_then(|index| picture.masked(index))
    };
    let steps = (2.0 * reach_px) as i32;
    let borders = (-steps..steps)
        .map(|half| 0.5 * f64::from(half) + 0.25)
        .filter(|border| is_object(border - 0.25) == Some(true) && is_object(border + 0.25) == Some(false));
    let nearest = borders.min_by(|a, b| a.abs().total_cmp(&b.abs()));
    nearest.map(|offset_px| Pull {
        point: *point,
        offset_px,
        variance_px2: MASK_SIGMA_PX * MASK_SIGMA_PX,
        tone_px: 0.0,
    })
}

/// Masks have whole pixels, and are drawn by hands.
const MASK_SIGMA_PX: f64 = 0.7;

/// Samples per pixel along the line of an exact measurement.
const COVERAGE_STEPS_PER_PX: usize = 2;
/// Of object and background on a line, to tell them apart: in linear light.
const SMALLEST_CONTRAST: f64 = 0.04;
/// How far a line may be from the one clear step that it should be, root mean square, as a part of the step: about its
/// middle, and about each end.
const WORST_FIT: f64 = 0.16;
const WORST_END: f64 = 0.3;
/// What is left in pixels where all is clear.
const COVERAGE_SIGMA_PX: f64 = 0.1;

/// What cameras do is between sRGB and no curve at all, and nearer to sRGB.
pub(super) const USUAL_TONE: f64 = 0.2;

/// The exact place of the outline on each line where the picture shows one clear step: a pixel that the object covers by a
/// part has that part of its light, so the sum over a line says where the object ends, whatever the blur.
///
/// Lines go `reach_px` to either side. The outer half of each side says what object and background look like here.
pub fn measure_coverage(picture: &Picture, points: &[ContourPoint], reach_px: usize) -> Vec<Pull> {
    let outline = points.iter().filter(|point| point.kind == EdgeKind::Outline);
    outline.filter_map(|point| measure_line(picture, point, reach_px)).collect()
}

fn measure_line(picture: &Picture, point: &ContourPoint, reach_px: usize) -> Option<Pull> {
    let in_light = Step::on_line(|place| picture.light(place), point, reach_px)?;
    let in_code = Step::on_line(|place| picture.coded(place), point, reach_px)?;
    let tone_px = in_code.offset_px - in_light.offset_px;
    let sigma_px = COVERAGE_SIGMA_PX + 0.5 * (in_light.unclear + in_code.unclear);
    Some(Pull {
        point: *point,
        offset_px: in_light.offset_px + USUAL_TONE * tone_px,
        variance_px2: sigma_px * sigma_px,
        tone_px,
    })
}

/// The one clear step on a line.
struct Step {
    offset_px: f64,
    /// How far from that the line is, as a part of the step.
    unclear: f64,
}

impl Step {
    fn on_line(
        color_at: impl Fn(DVec2) -> Option<[f32; 3]>,
        point: &ContourPoint,
        reach_px: usize,
    ) -> Option<Self> {
        let steps_per_px = COVERAGE_STEPS_PER_PX as f64;
        let end = (reach_px * COVERAGE_STEPS_PER_PX) as i32;
        let colors: Option<Vec<DVec3>> = (-end..=end)
            .map(|k| {
                color_at(point.pixel + point.normal * (f64::from(k) / steps_per_px))
                    .map(|color| DVec3::from_array(color.map(f64::from)))
            })
            .collect();
        let colors = colors?;
        // Half of either side, with the sample at its border.
        let outer = reach_px * COVERAGE_STEPS_PER_PX / 2;
        let [inside_part, outside_part] = [colors.get(..=outer)?, colors.get(colors.len() - 1 - outer..)?];
        let (inside, inside_spread) = mean_and_spread(inside_part);
        let (outside, outside_spread) = mean_and_spread(outside_part);
        let step = inside - outside;
        let contrast = step.length();
        if contrast < SMALLEST_CONTRAST {
            return None;
        }
        let noise = (0.5 * (inside_spread + outside_spread)).sqrt() / contrast;
        let middle = colors.get(outer..colors.len() - outer)?;
        let half_px = (middle.len() - 1) as f64 / (2.0 * steps_per_px);
        let coverage = |color: &DVec3| (*color - outside).dot(step) / step.length_squared();
        let [first, .., last] = middle else { return None };
        // The trapezium rule from one end to the other: as if the object covered all up to there and nothing beyond.
        let inner = middle.iter().map(coverage).sum::<f64>() - 0.5 * (coverage(first) + coverage(last));
        let offset_px = inner / steps_per_px - half_px;
        // A step blurred over some two pixels, as lenses do it.
        let ideal = |x: f64| 0.5 - 0.5 * (1.2 * (x - offset_px)).tanh();
        let misfit = middle.iter().enumerate().map(|(k, color)| {
            let expected = outside + step * ideal(k as f64 / steps_per_px - half_px);
            color.distance_squared(expected) / step.length_squared()
        });
        let fit = (misfit.sum::<f64>() / middle.len() as f64).sqrt();
        let is_clear = fit < WORST_FIT && noise < WORST_END && offset_px.abs() < 0.7 * half_px;
        is_clear.then_some(Self { offset_px, unclear: fit + noise })
    }
}

/// The mean of colours and their mean squared distance from it.
fn mean_and_spread(colors: &[DVec3]) -> (DVec3, f64) {
    let count = colors.len() as f64;
    let mean = colors.iter().sum::<DVec3>() / count;
    (mean, colors.iter().map(|color| color.distance_squared(mean)).sum::<f64>() / count)
}
