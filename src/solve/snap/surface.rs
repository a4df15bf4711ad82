//! What the object's surface should look like, pixel by pixel, and what that says of the pose.
//!
//! The light is not known, so it is fitted: a surface without gloss shows its colour times a function of its normal that
//! second-order spherical harmonics describe to a few percent (Ramamoorthi and Hanrahan, *An Efficient Representation for
//! Irradiance Environment Maps*, 2001). The picture's difference from that is lowered by Gauss-Newton steps. Slopes are those
//! of the prediction, not of the picture: then a pattern that the mesh does not know pulls to no side.

use glam::{DVec2, DVec3, Vec3};

use super::look::Look;
use super::measurements::{Measurement, Shared, row_of};
use super::picture::Picture;
use crate::math::Pose;
use crate::solve::contour::{ContourModel, OBJECT_ID};
use crate::solve::least_squares::NormalEquations;
use crate::solve::linear::{Matrix, cholesky, inverse, solve};
use crate::solve::motion::{motion_row, project_with_jacobian, turn_row};
use crate::solve::robust::{biweight, median};

/// Nearer than this to what is not the object, a pixel may show something else.
const BORDER_PX: usize = 3;
const FEWEST_PIXELS: usize = 60;
/// About as many pixels teach the light and pull.
const PIXELS: usize = 250;
/// Differences larger than this many standard deviations count nothing (Tukey's biweight).
const GATE: f64 = 3.0;
/// Standard deviations below this are luck: a channel has steps of 1/255.
const SMALLEST_SIGMA: f64 = 0.01;
/// Slopes of the prediction that are steeper than this, in standard deviations a pixel, are steps.
const STEEPEST: f64 = 2.0;
const ROUNDS: usize = 2;
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

/// What the object's inner pixels want of small motions of `pose` about `pivot_camera_mm`; nothing where there are too few.
pub fn measurements(
    picture: &Picture,
    (look, model): (&Look, &ContourModel),
    (pose, pivot_camera_mm): (&Pose, DVec3),
) -> Vec<Measurement> {
    let surface = Surface { picture, look, model, pose, object_from_camera: pose.inverse() };
    let inner = surface.inner_pixels();
    if inner.len() < FEWEST_PIXELS {
        return Vec::new();
    }
    let every = (inner.len() / PIXELS).max(1);
    let spots: Vec<Spot> = inner.into_iter().step_by(every).filter_map(|index| surface.spot(index)).collect();
    let Some((light, whitening)) = fit_light(picture, &spots) else { return Vec::new() };
    let with_slopes = |spot| {
        let in_picture = surface.picture_slopes(spot, &light)?;
        let rows = slopes(picture, &in_picture, spot, &light, pivot_camera_mm)?;
        is_even(&in_picture, &whitening).then_some((spot, rows))
    };
    let mut pulling: Vec<(&Spot, [[f64; 6]; 3])> = spots.iter().filter_map(with_slopes).collect();
    (0..3).for_each(|channel| leave_to_light(&mut pulling, channel));
    let measurements = pulling
        .iter()
        .map(|(spot, rows)| pixel_measurements(rows, &spot.difference(picture, &light), &whitening));
    measurements.flatten().collect()
}

/// The object as it would be seen in a pose.
struct Surface<'a> {
    picture: &'a Picture,
    look: &'a Look,
    model: &'a ContourModel,
    pose: &'a Pose,
    object_from_camera: Pose,
}

impl Surface<'_> {
    /// Numbers of the pixels that show the object and nothing else.
    fn inner_pixels(&self) -> Vec<usize> {
        let (width, height) = (self.picture.width, self.picture.height);
        let ids = &self.look.view.image.ids;
        let is_inner = |&index: &usize| {
            [0, BORDER_PX, BORDER_PX * width]
                .iter()
                .all(|away| ids[index - away] == OBJECT_ID && ids[index + away] == OBJECT_ID)
        };
        let rows = BORDER_PX..height.saturating_sub(BORDER_PX);
        let columns = BORDER_PX..width.saturating_sub(BORDER_PX);
        rows.flat_map(|y| columns.clone().map(move |x| y * width + x)).filter(is_inner).collect()
    }

    /// `None` where the object is not seen.
    fn spot(&self, index: usize) -> Option<Spot> {
        let face = self.look.faces.get(index)?.checked_sub(1)?;
        let pixel = DVec2::new((index % self.picture.width) as f64, (index / self.picture.width) as f64);
        let ray = self.picture.camera.unproject(pixel);
        let point_camera_mm = ray * (f64::from(*self.look.view.image.depth_mm.get(index)?) / ray.z);
        let point_mm = self.object_from_camera.transform_point(point_camera_mm);
        let (normal, albedo) = self.model.shade_at(face as usize, point_mm)?;
        Some(Spot { index, point_camera_mm, normal: self.pose.rotation * normal, albedo })
    }

    /// How the prediction changes from a pixel to the next, along x and y; `None` where a neighbour is not on the object.
    fn picture_slopes(&self, spot: &Spot, light: &Light) -> Option<[[f64; 3]; 2]> {
        let slope = |stride: usize| {
            let [before, after] = [spot.index.checked_sub(stride)?, spot.index + stride];
            let (before, after) = (self.spot(before)?.predicted(light), self.spot(after)?.predicted(light));
            Some(std::array::from_fn(|c| 0.5 * (after[c] - before[c])))
        };
        Some([slope(1)?, slope(self.picture.width)?])
    }
}

/// Takes out of the slopes of a channel what another light would explain as well: the light is fitted anew after each step, so
/// that says nothing of the pose (variable projection: Golub and Pereyra, 1973).
fn leave_to_light(pulling: &mut [(&Spot, [[f64; 6]; 3])], channel: usize) {
    let mut features = [[0.0; FEATURES]; FEATURES];
    let mut mixed = [[0.0; FEATURES]; 6];
    for (spot, rows) in pulling.iter() {
        let of_spot = spot.features(channel);
        for (sums, a) in features.iter_mut().zip(of_spot) {
            sums.iter_mut().zip(of_spot).for_each(|(sum, b)| *sum += a * b);
        }
        for (sums, slope) in mixed.iter_mut().zip(rows[channel]) {
            sums.iter_mut().zip(of_spot).for_each(|(sum, feature)| *sum += slope * feature);
        }
    }
    let ridge = RIDGE * pulling.len() as f64;
    (0..FEATURES).for_each(|i| features[i][i] += ridge);
    let explained = mixed.map(|sums| solve(&features, &sums).unwrap_or_default());
    for (spot, rows) in pulling {
        let of_spot = spot.features(channel);
        for (slope, weights) in rows[channel].iter_mut().zip(&explained) {
            *slope -= weights.iter().zip(of_spot).map(|(weight, feature)| weight * feature).sum::<f64>();
        }
    }
}

/// The light that explains these pixels best, and the upper factor of the inverse covariance of what it leaves unexplained:
/// times such a difference it has channels that are independent. `None` where the pixels are too uniform.
fn fit_light(picture: &Picture, spots: &[Spot]) -> Option<(Light, Matrix<3>)> {
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
            *weight = biweight(squared / (3.0 * GATE * GATE));
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
    let lower = cholesky(&inverse(&covariance)?)?;
    Some((light, std::array::from_fn(|row| std::array::from_fn(|column| lower[column][row]))))
}

fn fit_channel(
    picture: &Picture,
    spots: &[Spot],
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

/// Where the prediction makes a step, a pixel on the right side of it wants to stay and one on the wrong side is gated: the
/// contour's edges are for that.
fn is_even(slopes: &[[f64; 3]; 2], whitening: &Matrix<3>) -> bool {
    slopes.iter().all(|slope| {
        let whitened = whitening.map(|row| row.iter().zip(slope).map(|(a, b)| a * b).sum::<f64>());
        whitened.iter().map(|value| value * value).sum::<f64>() < 3.0 * STEEPEST * STEEPEST
    })
}

/// How a pixel's differences change with small motions: what the motion brings to the pixel is the prediction beside it,
/// under another light.
fn slopes(
    picture: &Picture,
    [by_column, by_row]: &[[f64; 3]; 2],
    spot: &Spot,
    light: &Light,
    pivot_camera_mm: DVec3,
) -> Option<[[f64; 6]; 3]> {
    let (_, [by_x, by_y]) = project_with_jacobian(&picture.camera, spot.point_camera_mm)?;
    Some(std::array::from_fn(|c| {
        let gradient = by_x * by_column[c] + by_y * by_row[c];
        let moved = motion_row(spot.point_camera_mm - pivot_camera_mm, gradient);
        let turned = turn_row(spot.normal, spot.normal_slope(light, c));
        std::array::from_fn(|k| moved[k] - turned[k])
    }))
}

/// One for each channel, after `whitening` made them independent.
fn pixel_measurements(
    rows: &[[f64; 6]; 3],
    difference: &[f64; 3],
    whitening: &Matrix<3>,
) -> [Measurement; 3] {
    let mix =
        |weights: &[f64; 3], values: [f64; 3]| weights.iter().zip(values).map(|(a, b)| a * b).sum::<f64>();
    let residuals = whitening.map(|weights| mix(&weights, *difference));
    let squared: f64 = residuals.iter().map(|residual| residual * residual).sum();
    std::array::from_fn(|c| Measurement {
        row: row_of(
            &std::array::from_fn(|k| mix(&whitening[c], [rows[0][k], rows[1][k], rows[2][k]])),
            Shared::default(),
        ),
        residual: residuals[c],
        trust: biweight(squared / (3.0 * GATE * GATE)),
    })
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
