//! A mesh's surface as points to be turned, and how far a turned point is from it.

use glam::{DVec3, Vec3};

use crate::math::Pose;
use crate::mesh::{Bvh, Mesh, PointTree, SurfacePoint, weld};
use crate::solve::least_squares::NormalEquations;
use crate::solve::linear::{Matrix, solve, symmetric_eigen};
use crate::solve::motion::{motion_row, moved_about};
use crate::solve::symmetry::pieces::Pieces;

/// Points of the surface, evenly over its area, in an order in which every beginning is even too.
const AREA_POINTS: usize = 2000;
/// And so many of its vertices at most: what sticks out farthest is one of them.
const VERTEX_POINTS: usize = 2000;
/// A step from one area point to the next: prime, so that all are met, and some golden part of them all.
const STRIDE: usize = 1237;

pub struct Surface<'a> {
    mesh: &'a Mesh,
    tree: &'a Bvh,
    /// In place of the tree, where that would be slow.
    pieces: Option<Pieces>,
    pub diameter_mm: f64,
    /// Of the surface's area: every symmetry leaves it where it is.
    pub center: DVec3,
    /// From the direction in which the surface reaches least far to that in which it reaches farthest.
    pub axes: [DVec3; 3],
    /// The mean squares of those reaches.
    pub moments: [f64; 3],
    area_points: Vec<DVec3>,
    vertex_points: Vec<DVec3>,
}

/// How far a turned surface is from the surface.
#[derive(Debug, Clone, Copy)]
pub struct Deviation {
    pub worst_mm: f64,
    pub mean_mm: f64,
}

/// How many points are looked at.
#[derive(Debug, Clone, Copy)]
pub enum Care {
    /// To leave out what is far off.
    Glance,
    /// To fit.
    Fit,
    /// To judge.
    Full,
}

impl<'a> Surface<'a> {
    /// `None` for a mesh without area.
    pub fn of(mesh: &'a Mesh, tree: &'a Bvh) -> Option<Self> {
        let ends = area_sums(mesh);
        let area = ends.last().copied().filter(|area| *area > 0.0 && area.is_finite())?;
        let (center, covariance) = moments(mesh, area);
        let (moments, axes) = symmetric_eigen(&covariance);
        let points = distinct_corners(mesh);
        let step = points.len().div_ceil(VERTEX_POINTS).max(1);
        let diameter_mm = PointTree::build(&points)?.diameter();
        Some(Self {
            mesh,
            tree,
            pieces: Pieces::of(mesh, diameter_mm),
            diameter_mm,
            center,
            axes: axes.map(DVec3::from_array),
            moments,
            area_points: area_points(mesh, &ends, area),
            vertex_points: points.into_iter().step_by(step).map(Vec3::as_dvec3).collect(),
        })
    }

    fn nearest(&self, place: DVec3, within_mm: f64) -> Option<SurfacePoint> {
        match &self.pieces {
            Some(pieces) => pieces.nearest(place, within_mm),
            None => self.tree.nearest(self.mesh, place, within_mm),
        }
    }

    fn points(&self, care: Care) -> impl Iterator<Item = DVec3> + '_ {
        let (area, vertices) = match care {
            Care::Glance => (64, 0),
            Care::Fit => (400, 0),
            Care::Full => (AREA_POINTS, VERTEX_POINTS),
        };
        self.area_points.iter().take(area).chain(self.vertex_points.iter().take(vertices)).copied()
    }

    /// `None` as soon as a point is farther off than `within_mm`.
    pub fn deviation(&self, turn: &Pose, care: Care, within_mm: f64) -> Option<Deviation> {
        let (mut worst_mm, mut sum, mut count) = (0.0_f64, 0.0, 0);
        for point in self.points(care) {
            let distance_mm = self.nearest(turn.transform_point(point), within_mm)?.distance_mm;
            worst_mm = worst_mm.max(distance_mm);
            sum += distance_mm;
            count += 1;
        }
        Some(Deviation { worst_mm, mean_mm: sum / f64::from(count.max(1)) })
    }

    /// One step towards the turn that brings the surface onto itself best, point to plane (Chen and Medioni, *Object
    /// Modelling by Registration of Multiple Range Images*, 1992). Points farther off than `within_mm` do not pull.
    pub fn step_towards_itself(&self, turn: &Pose, within_mm: f64) -> Option<Pose> {
        let mut equations = NormalEquations::<6>::ZERO;
        let mut count = 0.0;
        for point in self.points(Care::Fit) {
            let turned = turn.transform_point(point);
            let Some(nearest) = self.nearest(turned, within_mm) else { continue };
            let [a, b, c] = self.mesh.corners(*self.mesh.triangles().get(nearest.triangle as usize)?);
            let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
            let row = motion_row(turned - self.center, normal);
            equations.add(&row, normal.dot(turned - nearest.point), 1.0);
            count += 1.0;
        }
        // What slides along itself, as a round side does when it is turned, stays where it is.
        let damping = 1e-3 * count;
        for (axis, row) in equations.h.iter_mut().enumerate() {
            let arm = if axis < 3 { self.diameter_mm / 4.0 } else { 1.0 };
            row[axis] += damping * arm * arm;
        }
        let step = solve(&equations.h, &equations.g.map(|g| -g))?;
        Some(moved_about(turn, self.center, &step))
    }
}

/// Each place once, however many triangles meet at it: the middle of a fan is a corner of all of them.
fn distinct_corners(mesh: &Mesh) -> Vec<Vec3> {
    let named = mesh.triangles().iter().flatten();
    let corners: Vec<Vec3> =
        named.filter_map(|index| mesh.positions_mm().get(*index as usize).copied()).collect();
    let (places, count) = weld(&corners);
    let mut distinct = Vec::with_capacity(count);
    for (corner, place) in corners.iter().zip(places) {
        // Places are numbered as they come.
        if place as usize == distinct.len() {
            distinct.push(*corner);
        }
    }
    distinct
}

/// The area up to each triangle's end.
fn area_sums(mesh: &Mesh) -> Vec<f64> {
    let mut sum = 0.0;
    let area = |&triangle: &[u32; 3]| {
        let [a, b, c] = mesh.corners(triangle);
        sum += (b - a).cross(c - a).length() / 2.0;
        sum
    };
    mesh.triangles().iter().map(area).collect()
}

/// The area's middle, and the mean of products of coordinates about it, exactly.
fn moments(mesh: &Mesh, area: f64) -> (DVec3, Matrix<3>) {
    // About some point of the mesh, so that little is lost for one far from its origin.
    let origin = mesh.bounds().center();
    let (mut first, mut second) = (DVec3::ZERO, [[0.0; 3]; 3]);
    for &triangle in mesh.triangles() {
        let [a, b, c] = mesh.corners(triangle).map(|corner| corner - origin);
        let part = (b - a).cross(c - a).length() / 2.0 / area;
        let sum = a + b + c;
        first += sum * (part / 3.0);
        // Over a triangle the mean of x xᵀ is (Σ v vᵀ + (Σ v)(Σ v)ᵀ) / 12.
        for (i, row) in second.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                *entry += part / 12.0 * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + sum[i] * sum[j]);
            }
        }
    }
    for (i, row) in second.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry -= first[i] * first[j];
        }
    }
    (origin + first, second)
}

/// One point from each of equal parts of the area.
fn area_points(mesh: &Mesh, ends: &[f64], area: f64) -> Vec<DVec3> {
    // The plastic number's powers spread points evenly over a square (Roberts, *The Unreasonable Effectiveness of
    // Quasirandom Sequences*, 2018).
    const SPREAD: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];
    let point = |number: usize| {
        let part = (number * STRIDE) % AREA_POINTS;
        let place = (part as f64 + 0.5) / AREA_POINTS as f64 * area;
        let triangle = ends.partition_point(|end| *end < place);
        let [a, b, c] = mesh.corners(*mesh.triangles().get(triangle)?);
        let [u, v] = SPREAD.map(|step| (number as f64 * step).fract());
        // Folded from the square into the triangle.
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        Some(a + (b - a) * u + (c - a) * v)
    };
    (0..AREA_POINTS).filter_map(point).collect()
}
