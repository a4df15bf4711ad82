//! Edges in the picture near the contour's points: the strongest change of colour, and for an outline against a clear
//! background the exact place of its middle.

use glam::{DVec2, DVec3};

use super::colors::ColorModel;
use super::picture::Picture;
use crate::math::Pose;
use crate::solve::contour::{ContourPoint, EdgeKind};
use crate::solve::least_squares::NormalEquations;
use crate::solve::motion::{motion_row, project_with_jacobian};

/// An edge of the picture, on the line across a contour point.
#[derive(Debug, Clone, Copy)]
pub struct EdgeResult {
    pub point: ContourPoint,
    /// Where it is, counted along the point's normal.
    pub offset_px: f64,
    /// One standard deviation of that.
    pub sigma_px: f64,
}

/// Changes of colour below this, over two pixels, are noise. Colours are from 0 to 1.
const WEAKEST_CHANGE: f32 = 0.04;

/// The edge that each point most likely belongs to, in the manner of Drummond and Cipolla (*Real-Time Visual Tracking of
/// Complex Structures*, 2002): strong and near. `reach_px` is how far is looked.
pub fn search(
    picture: &Picture,
    colors: &ColorModel,
    points: &[ContourPoint],
    reach_px: f64,
) -> Vec<EdgeResult> {
    points.iter().filter_map(|point| search_line(picture, colors, point, reach_px)).collect()
}

fn search_line(
    picture: &Picture,
    colors: &ColorModel,
    point: &ContourPoint,
    reach_px: f64,
) -> Option<EdgeResult> {
    let changes = changes_along(picture, point.pixel, point.normal, reach_px)?;
    let middle = (changes.len() / 2) as f64;
    let liking = |k: usize| {
        let offset = k as f64 - middle;
        let near = (-0.5 * (offset / (0.5 * reach_px)).powi(2)).exp();
        f64::from(changes[k]) * near * fitness(picture, colors, point, offset)
    };
    let peaks = (1..changes.len() - 1).filter(|&k| {
        changes[k] >= changes[k - 1] && changes[k] > changes[k + 1] && changes[k] > WEAKEST_CHANGE
    });
    let best = peaks.max_by(|&a, &b| liking(a).total_cmp(&liking(b)))?;
    // The top of the parabola through three samples.
    let [before, here, after] = [changes[best - 1], changes[best], changes[best + 1]].map(f64::from);
    let top = 0.5 * (before - after) / (before - 2.0 * here + after);
    // Within the object many a silhouette has hardly an edge in the picture, and a weak one may be something else.
    let kind_sigma_px = if point.kind == EdgeKind::Outline { 1.0 } else { 1.5 };
    let sigma_px = kind_sigma_px * (0.3 / f64::from(changes[best])).max(1.0);
    Some(EdgeResult { point: *point, offset_px: best as f64 - middle + top, sigma_px })
}

/// How well the colours on the two sides of an edge are those of object and background: for an outline from 0 to 1.
fn fitness(picture: &Picture, colors: &ColorModel, point: &ContourPoint, offset_px: f64) -> f64 {
    if point.kind != EdgeKind::Outline {
        return 1.0;
    }
    let sector = colors.sector(point.pixel);
    let odds = |side: f64| -> f64 {
        let at = |k: f64| picture.index(point.pixel + point.normal * (offset_px + side * k));
        [1.0, 2.0, 3.0]
            .into_iter()
            .filter_map(at)
            .map(|index| f64::from(colors.log_odds(&picture.colors()[index], sector)))
            .sum()
    };
    1.0 / (1.0 + (0.5 * (odds(1.0) - odds(-1.0))).exp())
}

/// How much the colour changes from one pixel before to one pixel behind each place of a line, a pixel apart.
fn changes_along(picture: &Picture, from: DVec2, along: DVec2, reach_px: f64) -> Option<Vec<f32>> {
    let reach = reach_px.ceil() as i32 + 1;
    let colors: Option<Vec<[f32; 3]>> =
        (-reach - 1..=reach + 1).map(|k| picture.color(from + along * f64::from(k))).collect();
    let change = |window: &[[f32; 3]]| {
        let [before, _, after] = window else { return 0.0 };
        before.iter().zip(after).map(|(a, b)| (a - b).powi(2)).sum::<f32>().sqrt()
    };
    Some(colors?.windows(3).map(change).collect())
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
pub fn measure_coverage(picture: &Picture, points: &[ContourPoint]) -> Vec<EdgeResult> {
    let outline = points.iter().filter(|point| point.kind == EdgeKind::Outline);
    outline.filter_map(|point| measure_line(picture, point)).collect()
}

fn measure_line(picture: &Picture, point: &ContourPoint) -> Option<EdgeResult> {
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
    is_clear.then_some(EdgeResult { point: *point, offset_px, sigma_px: 0.3 + 3.0 * fit })
}

/// From sRGB.
fn linear_light(color: [f32; 3]) -> DVec3 {
    let linear = |value: f32| {
        let value = f64::from(value);
        if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    };
    DVec3::from_array(color.map(linear))
}

/// Adds the edges to the normal equations. What is farther off than some `width_px` counts less and less, and beyond it not
/// at all (Tukey's kernel).
pub fn add_edges(
    equations: &mut NormalEquations<6>,
    picture: &Picture,
    pose: &Pose,
    pivot_camera_mm: DVec3,
    edges: &[EdgeResult],
    (width_px, share): (f64, f64),
) {
    for edge in edges {
        let seen = pose.transform_point(edge.point.point_mm);
        let Some((pixel, [by_x, by_y])) = project_with_jacobian(&picture.camera, seen) else { continue };
        let normal = edge.point.normal;
        let residual = (pixel - edge.point.pixel).dot(normal) - edge.offset_px;
        let rest = 1.0 - (residual / width_px).powi(2);
        if rest > 0.0 {
            let weight = share * rest * rest / (edge.sigma_px * edge.sigma_px);
            equations.add(
                &motion_row(seen - pivot_camera_mm, by_x * normal.x + by_y * normal.y),
                residual,
                weight,
            );
        }
    }
}
