//! Which turns leave a mesh as it is.
//!
//! Every such turn is about an axis through the middle of the surface that is also a principal axis of it; where two or
//! three principal moments are alike, as those of a prism or a cube, the directions between them are looked through too.
//! Each candidate is fitted by turning the surface onto itself, and judged by the farthest that any point of the turned
//! surface is from the surface.

mod axes;
mod pieces;
mod surface;

use crate::math::sort_short;
use crate::mesh::{Bvh, Mesh};
use crate::scene::{Fold, Symmetries, SymmetryAxis};
use surface::Surface;

/// A turned surface that is nowhere farther from itself than this part of the diameter looks the same.
pub const TOLERANCE: f64 = 0.01;
/// Up to this part it is worth telling that it nearly does.
const NEARLY: f64 = 0.03;

/// An axis with what speaks for it: how far the turned surface is from the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoundSymmetry {
    pub axis: SymmetryAxis,
    pub worst_mm: f64,
    pub mean_mm: f64,
}

/// What was found of a mesh.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FoundSymmetries {
    pub diameter_mm: f64,
    /// From which all others follow: continuous ones first, then those with most turns. The user says whether they count,
    /// for colour may break them.
    pub found: Vec<FoundSymmetry>,
    /// Which come near, but are off by more than the tolerance somewhere.
    pub nearly: Vec<FoundSymmetry>,
}

/// Looks for all of a mesh's axes. Nothing here is by chance: the same mesh gives the same axes.
pub fn find_symmetries(mesh: &Mesh) -> FoundSymmetries {
    find_with(mesh, &Bvh::build(mesh))
}

/// The same for a mesh whose tree is there already.
pub fn find_with(mesh: &Mesh, tree: &Bvh) -> FoundSymmetries {
    let Some(surface) = Surface::of(mesh, tree) else { return FoundSymmetries::default() };
    let judged = axes::judged_axes(&surface);
    let around = mesh.sphere();
    let (mut found, mut symmetries) = (Vec::new(), Symmetries::default());
    for candidate in in_order(judged.iter().filter_map(|judged| judged.passed)) {
        let follows = candidate.axis.turns().iter().all(|turn| symmetries.holds(turn, &around));
        // A sphere has all three listed: the turns about one or two are no more than those.
        let is_needed = !follows || is_continuous(&candidate);
        if is_needed && symmetries.add_axis(&candidate.axis, &around).is_ok() {
            found.push(candidate);
        }
    }
    let mut nearly: Vec<FoundSymmetry> = Vec::new();
    for near in in_order(judged.iter().filter_map(|judged| judged.nearly)) {
        let follows = near.axis.turns().iter().all(|turn| symmetries.holds(turn, &around));
        let is_known = nearly.iter().any(|known| known.axis.is_along(&near.axis, &around));
        if !follows && !is_known && nearly.len() < MOST_NEARLY {
            nearly.push(near);
        }
    }
    FoundSymmetries { diameter_mm: surface.diameter_mm, found, nearly }
}

/// Of those that are no symmetries, so many are told.
const MOST_NEARLY: usize = 3;

fn is_continuous(found: &FoundSymmetry) -> bool {
    found.axis.fold == Fold::Continuous
}

fn in_order(found: impl Iterator<Item = FoundSymmetry>) -> Vec<FoundSymmetry> {
    let mut found: Vec<FoundSymmetry> = found.collect();
    sort_short(&mut found, |a, b| b.axis.fold.cmp(&a.axis.fold).then(a.worst_mm.total_cmp(&b.worst_mm)));
    found
}

#[cfg(test)]
mod tests;
