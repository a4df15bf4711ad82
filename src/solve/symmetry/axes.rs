//! Candidate axes, fitted and judged.

use glam::DVec3;

use super::surface::{Care, Deviation, Surface};
use super::{FoundSymmetry, NEARLY, TOLERANCE};
use crate::math::{Pose, sort_short};
use crate::scene::{Fold, SymmetryAxis};

/// How many turns are looked for, most first: one with more has them all.
const FOLDS: [u32; 10] = [12, 10, 9, 8, 7, 6, 5, 4, 3, 2];
/// Each of those is a multiple of one of these.
const PRIME_FOLDS: [u32; 4] = [2, 3, 5, 7];
/// Principal moments that differ by less than this part are alike: the directions between them tell nothing then.
const ALIKE: f64 = 0.1;
/// Before it is fitted, an axis may be off by this part of the diameter in what it moves.
const UNFITTED: f64 = 0.04;
/// An axis from a net of directions this far apart in radians (4°), besides.
const NET_RAD: f64 = 0.07;
/// Of the net's best axes of each fold, so many are fitted: a dodecahedron has fifteen axes of one kind.
const MOST_FITTED: usize = 15;
/// Axes nearer to each other than this in radians (10°) are fitted once.
const APART_RAD: f64 = 0.17;
const FIT_STEPS: usize = 6;
/// Turns that a continuous symmetry is judged by: no regular polygon's corners are met by all of them.
const TURNS: usize = 12;
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// What became of an axis.
#[derive(Debug, Clone, Copy)]
pub struct Judged {
    pub passed: Option<FoundSymmetry>,
    /// The one with most turns, more than passed.
    pub nearly: Option<FoundSymmetry>,
}

/// All axes that may be symmetries, each judged.
pub fn judged_axes(surface: &Surface<'_>) -> Vec<Judged> {
    let mut judged: Vec<Judged> = surface.axes.iter().map(|axis| judge(surface, *axis)).collect();
    let continuous: Vec<SymmetryAxis> =
        passed(&judged).filter(|found| found.axis.fold == Fold::Continuous).map(|found| found.axis).collect();
    match continuous.as_slice() {
        [] => {}
        // A second axis follows for each across it, if for one.
        [only] => {
            judged.push(judge(surface, only.axis.any_orthonormal_vector()));
            return judged;
        }
        // A sphere.
        _ => return judged,
    }
    let [least, middle, largest] = surface.moments;
    let alike = |a: f64, b: f64| (b - a) < ALIKE * largest;
    let directions = match (alike(least, middle), alike(middle, largest)) {
        (true, true) => over_half_sphere(surface),
        (true, false) => across(surface, surface.axes[2]),
        (false, true) => across(surface, surface.axes[0]),
        (false, false) => Vec::new(),
    };
    for direction in directions {
        let is_known = |found: FoundSymmetry| found.axis.axis.cross(direction).length() < APART_RAD / 2.0;
        if !passed(&judged).any(is_known) {
            judged.push(judge(surface, direction));
        }
    }
    judged
}

fn passed(judged: &[Judged]) -> impl Iterator<Item = FoundSymmetry> + '_ {
    judged.iter().filter_map(|judged| judged.passed)
}

/// Directions across an axis about which a half turn may be a symmetry: another turn would make all moments alike.
fn across(surface: &Surface<'_>, axis: DVec3) -> Vec<DVec3> {
    const STEPS: u32 = 90;
    let (x, y) = axis.any_orthonormal_pair();
    let direction = |step: u32| {
        let (sin, cos) = (f64::from(step) / f64::from(STEPS) * std::f64::consts::PI).sin_cos();
        x * cos + y * sin
    };
    best(surface, 2, (0..STEPS).map(direction))
}

/// Directions all around, for each fold.
fn over_half_sphere(surface: &Surface<'_>) -> Vec<DVec3> {
    // A spiral: equal steps along z are equal areas.
    let count = (std::f64::consts::TAU / (NET_RAD * NET_RAD)) as u32;
    let direction = move |number: u32| {
        let z = (f64::from(number) + 0.5) / f64::from(count);
        let (sin, cos) = (f64::from(number) * GOLDEN * std::f64::consts::TAU).sin_cos();
        DVec3::new(cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt(), z)
    };
    PRIME_FOLDS.iter().flat_map(|&fold| best(surface, fold, (0..count).map(direction))).collect()
}

/// The directions about which one turn of this fold leaves the surface nearest to itself, well apart from each other.
fn best(surface: &Surface<'_>, fold: u32, directions: impl Iterator<Item = DVec3>) -> Vec<DVec3> {
    let within_mm = (NEARLY + UNFITTED) * surface.diameter_mm;
    let mut scored: Vec<(f64, DVec3)> = directions
        .filter_map(|direction| {
            let axis = axis(surface, direction, Fold::Times(fold));
            let deviation = surface.deviation(&first_turn(&axis), Care::Glance, within_mm)?;
            Some((deviation.mean_mm, direction))
        })
        .collect();
    sort_short(&mut scored, |a, b| a.0.total_cmp(&b.0));
    let mut best: Vec<DVec3> = Vec::new();
    for (_, direction) in scored {
        if best.len() < MOST_FITTED && best.iter().all(|known| known.cross(direction).length() > APART_RAD) {
            best.push(direction);
        }
    }
    best
}

fn axis(surface: &Surface<'_>, direction: DVec3, fold: Fold) -> SymmetryAxis {
    SymmetryAxis { axis: direction, through_mm: surface.center, fold }
}

/// The smallest turn; of a continuous axis one that moves points far.
fn first_turn(axis: &SymmetryAxis) -> Pose {
    let part = match axis.fold {
        Fold::Times(times) => 1.0 / f64::from(times.max(1)),
        Fold::Continuous => GOLDEN / 2.0,
    };
    axis.turn(part * std::f64::consts::TAU)
}

/// The turns that an axis is judged by. What a turn does, the opposite one does too.
fn turns(axis: &SymmetryAxis) -> Vec<Pose> {
    let parts: Vec<f64> = match axis.fold {
        Fold::Times(times) => (1..=times / 2).map(|step| f64::from(step) / f64::from(times)).collect(),
        Fold::Continuous => (1..=TURNS).map(|number| (number as f64 * GOLDEN).fract()).collect(),
    };
    parts.into_iter().map(|part| axis.turn(part * std::f64::consts::TAU)).collect()
}

/// Finds with how many turns a direction is a symmetry.
fn judge(surface: &Surface<'_>, direction: DVec3) -> Judged {
    let mut nearly: Option<FoundSymmetry> = None;
    let folds = std::iter::once(Fold::Continuous).chain(FOLDS.map(Fold::Times));
    for fold in folds {
        let candidate = axis(surface, direction, fold);
        let unfitted_mm = (NEARLY + UNFITTED) * surface.diameter_mm;
        if worst_of(surface, &candidate, Care::Glance, unfitted_mm).is_none() {
            continue;
        }
        let fitted = fitted(surface, &candidate);
        let Some(deviation) = worst_of(surface, &fitted, Care::Full, NEARLY * surface.diameter_mm) else {
            continue;
        };
        let Deviation { worst_mm, mean_mm } = deviation;
        let found = FoundSymmetry { axis: fitted, worst_mm, mean_mm };
        if worst_mm < TOLERANCE * surface.diameter_mm {
            return Judged { passed: Some(found), nearly };
        }
        nearly.get_or_insert(found);
    }
    Judged { passed: None, nearly }
}

fn worst_of(surface: &Surface<'_>, axis: &SymmetryAxis, care: Care, within_mm: f64) -> Option<Deviation> {
    let mut worst = Deviation { worst_mm: 0.0, mean_mm: 0.0 };
    for turn in turns(axis) {
        let deviation = surface.deviation(&turn, care, within_mm)?;
        worst.worst_mm = worst.worst_mm.max(deviation.worst_mm);
        worst.mean_mm = worst.mean_mm.max(deviation.mean_mm);
    }
    Some(worst)
}

/// The axis of the turn that brings the surface onto itself best.
fn fitted(surface: &Surface<'_>, axis: &SymmetryAxis) -> SymmetryAxis {
    let within_mm = (NEARLY + UNFITTED) * surface.diameter_mm;
    let mut best = *axis;
    for _ in 0..FIT_STEPS {
        let step = surface.step_towards_itself(&first_turn(&best), within_mm);
        let Some((next, _)) = step.and_then(|turn| SymmetryAxis::of_screw(&turn)) else { break };
        let direction = if next.axis.dot(best.axis) < 0.0 { -next.axis } else { next.axis };
        // The line's point beside the middle says more than that beside the mesh's origin.
        let along = direction * direction.dot(surface.center - next.through_mm);
        best = SymmetryAxis { axis: direction, through_mm: next.through_mm + along, fold: axis.fold };
    }
    best
}
