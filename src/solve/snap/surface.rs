//! What the object's surface should look like, pixel by pixel, and what that says of the pose.
//!
//! The light is not known, so it is fitted: a surface without gloss shows its colour times a function of its normal that
//! second-order spherical harmonics describe to a few percent (Ramamoorthi and Hanrahan, *An Efficient Representation for
//! Irradiance Environment Maps*, 2001). The picture's difference from that is lowered by Gauss-Newton steps. Slopes are those
//! of the prediction, not of the picture: then a pattern that the mesh does not know pulls to no side.

use glam::{DVec2, DVec3, Vec3};

use super::look::Look;
use super::picture::Picture;
use crate::math::Pose;
use crate::solve::contour::{ContourModel, OBJECT_ID};
use crate::solve::least_squares::NormalEquations;
use crate::solve::linear::{Matrix, inverse, solve};
use crate::solve::motion::{motion_row, project_with_jacobian, turn_row};

/// Nearer than this to what is not the object, a pixel may show something else.
const BORDER_PX: usize = 2;
const FEWEST_PIXELS: usize = 60;
/// About as many pixels teach the light, and as many pull.
const TEACHING_PIXELS: usize = 500;
const PULLING_PIXELS: usize = 1000;
/// Differences larger than this many standard deviations count nothing (Tukey's biweight).
const GATE: f64 = 3.0;
/// Standard deviations below this are luck: a channel has steps of 1/255.
const SMALLEST_SIGMA: f64 = 0.01;
const ROUNDS: usize = 4;
/// What each coefficient of the light is held to zero with, as a part of the pixels' weight.
const RIDGE: f64 = 1e-3;

/// One, and what light from all sides does to a colour.
const FEATURES: usize = 10;
type Light = [[f64; FEATURES]; 3];

/// A pixel on the surface.
struct Spot {
    index: usize,
    point_camera_mm: DVec3,
    /// In camera axes.
    normal: DVec3,
    albedo: Vec3,
    is_inner: bool,
}

impl Spot {
    fn features(&self, channel: usize) -> [f64; FEATURES] {
        let (n, albedo) = (self.normal, f64::from(self.albedo[channel]));
        let [x, y, z] = n.to_array();
        let shades = [1.0, x, y, z, x * y, x * z, y * z, x * x - y * y, z * z];
        let mut features = [1.0; FEATURES];
        features[1..].iter_mut().zip(shades).for_each(|(feature, shade)| *feature = albedo * shade);
        features
    }

    fn predicted(&self, light: &Light) -> [f64; 3] {
        std::array::from_fn(|c| self.features(c).iter().zip(&light[c]).map(|(a, b)| a * b).sum())
    }

    /// How the prediction of a channel changes with the normal.
    fn normal_slope(&self, light: &Light, channel: usize) -> DVec3 {
        let [x, y, z] = self.normal.to_array();
        let w = &light[channel];
        let slope = DVec3::new(
            w[2] + w[5] * y + w[6] * z + 2.0 * w[8] * x,
            w[3] + w[5] * x + w[7] * z - 2.0 * w[8] * y,
            w[4] + w[6] * x + w[7] * y + 2.0 * w[9] * z,
        );
        slope * f64::from(self.albedo[channel])
    }

    /// Picture minus prediction.
    fn difference(&self, picture: &Picture, light: &Light) -> [f64; 3] {
        let (color, predicted) = (picture.smooth_color(self.index), self.predicted(light));
        std::array::from_fn(|c| f64::from(color[c]) - predicted[c])
    }
}

/// Adds what the object's inner pixels want to the normal equations of small motions of `pose` about `pivot_camera_mm`, and
/// returns for how many measurements that counts. `share` is what part of a measurement each pixel is.
pub fn add_surface(
    equations: &mut NormalEquations<6>,
    picture: &Picture,
    (look, model): (&Look, &ContourModel),
    (pose, pivot_camera_mm): (&Pose, DVec3),
    share: f64,
) -> f64 {
    let spots = spots(picture, look, model, pose);
    let inner: Vec<&Spot> = spots.iter().filter(|spot| spot.is_inner).collect();
    if inner.len() < FEWEST_PIXELS {
        return 0.0;
    }
    let teaching: Vec<&Spot> =
        inner.iter().copied().step_by((inner.len() / TEACHING_PIXELS).max(1)).collect();
    let Some((light, precision)) = fit_light(picture, &teaching) else { return 0.0 };
    let mut predicted = vec![None; picture.width * picture.height];
    for spot in &spots {
        predicted[spot.index] = Some(spot.predicted(&light));
    }
    let every = (inner.len() / PULLING_PIXELS).max(1);
    let weight = share * every as f64;
    for spot in inner.into_iter().step_by(every) {
        let rows = slopes(picture, &predicted, spot, &light, pivot_camera_mm);
        let Some(rows) = rows else { continue };
        add_pixel(equations, &rows, &spot.difference(picture, &light), &precision, weight);
    }
    share * spots.len() as f64
}

/// All pixels on which the object is seen.
fn spots(picture: &Picture, look: &Look, model: &ContourModel, pose: &Pose) -> Vec<Spot> {
    let (width, height) = (picture.width, picture.height);
    let object_from_camera = pose.inverse();
    let ids = &look.view.image.ids;
    let mut spots = Vec::new();
    for y in BORDER_PX..height.saturating_sub(BORDER_PX) {
        for x in BORDER_PX..width.saturating_sub(BORDER_PX) {
            let index = y * width + x;
            let Some(face) = look.faces[index].checked_sub(1) else { continue };
            let beside =
                [index - BORDER_PX, index + BORDER_PX, index - BORDER_PX * width, index + BORDER_PX * width];
            let ray = picture.camera.unproject(DVec2::new(x as f64, y as f64));
            let point_camera_mm = ray * (f64::from(look.view.image.depth_mm[index]) / ray.z);
            let point_mm = object_from_camera.transform_point(point_camera_mm);
            let Some((normal, albedo)) = model.shade_at(face as usize, point_mm) else { continue };
            spots.push(Spot {
                index,
                point_camera_mm,
                normal: pose.rotation * normal,
                albedo,
                is_inner: beside.iter().all(|&i| ids[i] == OBJECT_ID),
            });
        }
    }
    spots
}

/// The light that explains these pixels best, and the inverse covariance of what it leaves unexplained. `None` where they
/// are too uniform.
fn fit_light(picture: &Picture, spots: &[&Spot]) -> Option<(Light, Matrix<3>)> {
    let mut weights = vec![1.0; spots.len()];
    let mut light = [[0.0; FEATURES]; 3];
    let mut differences = Vec::new();
    for _ in 0..ROUNDS {
        for (channel, light) in light.iter_mut().enumerate() {
            *light = fit_channel(picture, spots, &weights, channel)?;
        }
        differences = spots.iter().map(|spot| spot.difference(picture, &light)).collect::<Vec<[f64; 3]>>();
        let sigmas: [f64; 3] = std::array::from_fn(|c| {
            // The median of absolute values is 0.67 standard deviations of normal ones.
            (1.4826 * median(differences.iter().map(|d| d[c].abs()).collect())).max(SMALLEST_SIGMA)
        });
        for (weight, difference) in weights.iter_mut().zip(&differences) {
            let squared: f64 = difference.iter().zip(sigmas).map(|(d, sigma)| (d / sigma).powi(2)).sum();
            *weight = biweight(squared / 3.0);
        }
    }
    let total: f64 = weights.iter().sum();
    let mut covariance = [[0.0; 3]; 3];
    for (difference, weight) in differences.iter().zip(&weights) {
        for (row, a) in covariance.iter_mut().zip(difference) {
            row.iter_mut().zip(difference).for_each(|(sum, b)| *sum += weight * a * b / total);
        }
    }
    for (channel, row) in covariance.iter_mut().enumerate() {
        // Channels that go together exactly would make their difference seem exact.
        row[channel] = 1.1 * row[channel] + 0.25 * SMALLEST_SIGMA * SMALLEST_SIGMA;
    }
    Some((light, inverse(&covariance)?))
}

fn fit_channel(
    picture: &Picture,
    spots: &[&Spot],
    weights: &[f64],
    channel: usize,
) -> Option<[f64; FEATURES]> {
    let mut equations = NormalEquations::<FEATURES>::ZERO;
    for (spot, &weight) in spots.iter().zip(weights) {
        let color = f64::from(picture.smooth_color(spot.index)[channel]);
        equations.add(&spot.features(channel), -color, weight);
    }
    let ridge = RIDGE * weights.iter().sum::<f64>();
    (0..FEATURES).for_each(|i| equations.h[i][i] += ridge);
    solve(&equations.h, &equations.g.map(|g| -g))
}

fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// Of a difference in standard deviations, squared.
fn biweight(squared: f64) -> f64 {
    (1.0 - squared / (GATE * GATE)).max(0.0).powi(2)
}

/// How a pixel's differences change with small motions: what the motion brings to the pixel is the prediction beside it,
/// under another light. `None` where a neighbour is not on the object.
fn slopes(
    picture: &Picture,
    predicted: &[Option<[f64; 3]>],
    spot: &Spot,
    light: &Light,
    pivot_camera_mm: DVec3,
) -> Option<[[f64; 6]; 3]> {
    let (_, [by_x, by_y]) = project_with_jacobian(&picture.camera, spot.point_camera_mm)?;
    let (left, right) = (predicted[spot.index - 1]?, predicted[spot.index + 1]?);
    let (above, below) = (predicted[spot.index - picture.width]?, predicted[spot.index + picture.width]?);
    Some(std::array::from_fn(|c| {
        let (slope_x, slope_y) = (0.5 * (right[c] - left[c]), 0.5 * (below[c] - above[c]));
        let moved = motion_row(spot.point_camera_mm - pivot_camera_mm, by_x * slope_x + by_y * slope_y);
        let turned = turn_row(spot.normal, spot.normal_slope(light, c));
        std::array::from_fn(|k| moved[k] - turned[k])
    }))
}

fn add_pixel(
    equations: &mut NormalEquations<6>,
    rows: &[[f64; 6]; 3],
    difference: &[f64; 3],
    precision: &Matrix<3>,
    weight: f64,
) {
    let weighted = precision.map(|row| row.iter().zip(difference).map(|(p, d)| p * d).sum::<f64>());
    let squared: f64 = weighted.iter().zip(difference).map(|(a, b)| a * b).sum();
    let weight = weight * biweight(squared / 3.0);
    if weight == 0.0 {
        return;
    }
    equations.cost += weight * squared;
    for (i, row) in rows.iter().enumerate() {
        let whitened: [f64; 6] =
            std::array::from_fn(|k| (0..3).map(|j| precision[i][j] * rows[j][k]).sum::<f64>() * weight);
        for ((h_row, g), value) in equations.h.iter_mut().zip(&mut equations.g).zip(row) {
            *g += weight * value * weighted[i];
            h_row.iter_mut().zip(&whitened).for_each(|(h, other)| *h += value * other);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_by_the_normal_is_that_of_the_prediction() {
        let light: Light =
            std::array::from_fn(|c| std::array::from_fn(|k| 0.1 * (c as f64 + 1.0) - 0.07 * k as f64));
        let spot = |normal: DVec3| Spot {
            index: 0,
            point_camera_mm: DVec3::Z,
            normal,
            albedo: Vec3::new(0.9, 0.5, 0.2),
            is_inner: true,
        };
        let normal = DVec3::new(0.3, -0.5, -0.8);
        for (axis, step) in [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis * 1e-4).into_iter().enumerate() {
            let [plus, minus] = [1.0, -1.0].map(|sign| spot(normal + step * sign).predicted(&light));
            for c in 0..3 {
                let slope = spot(normal).normal_slope(&light, c)[axis];
                // Central differences of a polynomial of second order: exact but for rounding of 1e-16 over 1e-4.
                assert!(((plus[c] - minus[c]) / 2e-4 - slope).abs() < 1e-10);
            }
        }
    }
}
