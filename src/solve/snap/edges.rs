//! Edges in the picture near the contour's points: the clearest one, and for an outline against a clear background the
//! exact place of its middle.

use glam::DVec3;

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
            let variance_px = (kind_sigma_px * 0.8 / here).powi(2);
            best = Some((liking, Pull { point: *point, offset_px, variance_px }));
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

/// How far the line of an exact measurement goes to either side, in pixels.
const COVERAGE_REACH: i32 = 6;
/// Half a pixel between samples.
const COVERAGE_STEPS_PER_PX: i32 = 2;
/// Of object and background on a line, to tell them apart: in linear light.
const SMALLEST_CONTRAST: f64 = 0.04;
/// How far a line may be from the one clear step that it should be, root mean square, as a part of the step.
const WORST_FIT: f64 = 0.16;

/// The exact place of the outline on each line where the picture shows one clear step: a pixel that the object covers by a
/// part has that part of its light, so the sum over a line says where the object ends, whatever the blur.
pub fn measure_coverage(picture: &Picture, points: &[ContourPoint]) -> Vec<Pull> {
    let outline = points.iter().filter(|point| point.kind == EdgeKind::Outline);
    outline.filter_map(|point| measure_line(picture, point)).collect()
}

fn measure_line(picture: &Picture, point: &ContourPoint) -> Option<Pull> {
    let last = COVERAGE_REACH * COVERAGE_STEPS_PER_PX;
    let place = |k: i32| f64::from(k) / f64::from(COVERAGE_STEPS_PER_PX);
    let light: Option<Vec<DVec3>> = (-last..=last)
        .map(|k| picture.color(point.pixel + point.normal * place(k)).map(linear_light))
        .collect();
    let light = light?;
    let ends = (2 * COVERAGE_STEPS_PER_PX + 1) as usize;
    let mean = |part: &[DVec3]| part.iter().sum::<DVec3>() / part.len() as f64;
    let (inside, outside) = (mean(&light[..ends]), mean(&light[light.len() - ends..]));
    let step = inside - outside;
    if step.length() < SMALLEST_CONTRAST {
        return None;
    }
    let coverage: Vec<f64> =
        light.iter().map(|light| (*light - outside).dot(step) / step.length_squared()).collect();
    // The trapezium rule from one end to the other: as if the object covered all up to there and nothing beyond.
    let inner: f64 = coverage.iter().sum::<f64>() - 0.5 * (coverage[0] + coverage[coverage.len() - 1]);
    let offset_px = inner / f64::from(COVERAGE_STEPS_PER_PX) - f64::from(COVERAGE_REACH);
    // A step blurred over some two pixels, as lenses do it.
    let ideal = |x: f64| 0.5 - 0.5 * (1.2 * (x - offset_px)).tanh();
    let misfit = (-last..=last).zip(light.iter()).map(|(k, light)| {
        (*light - (outside + step * ideal(place(k)))).length_squared() / step.length_squared()
    });
    let fit = (misfit.sum::<f64>() / light.len() as f64).sqrt();
    let is_clear = fit < WORST_FIT && offset_px.abs() < f64::from(COVERAGE_REACH) / 2.0;
    is_clear.then(|| Pull { point: *point, offset_px, variance_px: (0.3 + 3.0 * fit).powi(2) })
}

/// From sRGB.
fn linear_light(color: [f32; 3]) -> DVec3 {
    let linear = |value: f32| {
        let value = f64::from(value);
        if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    };
    DVec3::from_array(color.map(linear))
}
