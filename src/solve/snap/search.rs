//! Where a start may really belong, before anything is refined.
//!
//! A refinement goes to whatever is near. So the outlines of a few views are first shifted, turned and scaled over a small
//! copy of the picture, without drawing anything anew, and each place is rated by the edges under it and by how different
//! the colours on its two sides are.

use glam::{DVec2, DVec3};

use super::SnapReach;
use super::look::{Density, Look};
use super::palette::COLORS;
use super::picture::Picture;
use super::prior::Prior;
use super::sight::Sight;
use crate::math::{Pose, rotation_from_rotation_vector};
use crate::solve::contour::{ContourModel, ContourPoint, EdgeKind};

/// How far is looked about the start.
struct Reach {
    /// In pixels of the photo, and as a part of the object's size: the larger.
    shift_px: f64,
    shift: f64,
    /// To either side, as a part of the distance, and about the view ray.
    depth: f64,
    roll_rad: f64,
    /// About axes across the view ray: each ring of views is turned so far.
    rings_rad: &'static [f64],
}

const NEAR: Reach = Reach { shift_px: 13.0, shift: 0.1, depth: 0.04, roll_rad: 0.1, rings_rad: &[0.14] };
const WIDE: Reach =
    Reach { shift_px: 26.0, shift: 0.2, depth: 0.07, roll_rad: 0.25, rings_rad: &[0.23, 0.115] };
/// Views of a near and of a wide ring.
const VIEWS_PER_RING: [usize; 2] = [4, 8];
/// Pins say where the object is: then no farther than what their clicks leave open is looked. That is most of all the depth.
const SHIFT_IN_PIN_SIGMAS: f64 = 2.0;
const DEPTH_WITH_PINS: f64 = 2.0;
/// Between tried places, in pixels of the small copy: an edge is two of them wide there.
const STEP_PX: i32 = 2;
/// At first every so many points of an outline are looked at, and then all, where one place in so many is left.
const ROUGHLY: usize = 3;
const PLACES_PER_PROMISING: usize = 16;
/// Colours are looked at so far from the outline on either side, in pixels of the small copy.
const BESIDE_PX: [f64; 3] = [1.5, 2.5, 4.0];
/// Nearer than this to the picture's border a point is not looked at.
const BORDER_PX: i32 = 5;
/// Of the outline's points; with fewer in the picture a place is not rated.
const SMALLEST_PART: f32 = 0.6;
const FEWEST_POINTS: usize = 12;

/// Goes through the views, one at a time.
#[derive(Debug, Clone)]
pub struct Search {
    /// About the object's middle, from the start.
    turns: Vec<DVec3>,
    next: usize,
    /// The best place of each view, with its rating.
    found: Vec<(f32, Pose)>,
}

impl Search {
    pub fn new(reach: SnapReach) -> Self {
        let mut turns = vec![DVec3::ZERO];
        for &ring_rad in of(reach).rings_rad {
            let count = VIEWS_PER_RING[usize::from(reach == SnapReach::Wide)];
            turns.extend((0..count).map(|k| {
                let direction = DVec2::from_angle(std::f64::consts::TAU * k as f64 / count as f64);
                direction.extend(0.0) * ring_rad
            }));
        }
        Self { turns, next: 0, found: Vec::new() }
    }

    /// How many steps it takes in all.
    pub fn steps(&self) -> u32 {
        self.turns.len() as u32
    }

    pub fn is_done(&self) -> bool {
        self.next >= self.turns.len()
    }

    /// Looks at the next view.
    pub fn advance(&mut self, sight: &Sight, model: &ContourModel, prior: &Prior) {
        if let Some(turn) = self.turns.get(self.next) {
            self.found.extend(best_place(sight, model, prior, *turn));
        }
        self.next += 1;
    }

    /// The most promising poses, best first; the start alone where no outline can be seen.
    pub fn best(&mut self, count: usize, prior: &Prior) -> Vec<Pose> {
        self.found.sort_by(|a, b| b.0.total_cmp(&a.0));
        let best: Vec<Pose> = self.found.iter().take(count).map(|(_, pose)| *pose).collect();
        if best.is_empty() { vec![prior.start] } else { best }
    }
}

/// How far is looked along the view ray, as a part of the distance.
pub fn depth_reach(reach: SnapReach) -> f64 {
    of(reach).depth
}

fn of(reach: SnapReach) -> &'static Reach {
    match reach {
        SnapReach::Near => &NEAR,
        SnapReach::Wide => &WIDE,
    }
}

fn best_place(sight: &Sight, model: &ContourModel, prior: &Prior, turn: DVec3) -> Option<(f32, Pose)> {
    let (picture, reach) = (&sight.picture, of(prior.reach));
    let center = prior.start.transform_point(model.center_mm());
    let middle = picture.camera.project(center)?;
    let view = Pose::rotation_about(center, rotation_from_rotation_vector(turn)) * prior.start;
    let look = Look::at(sight, model, &view, Density::Coarse);
    let points: Vec<&ContourPoint> =
        look.points.iter().filter(|point| point.kind == EdgeKind::Outline).collect();
    if points.len() < FEWEST_POINTS {
        return None;
    }
    let depth = if prior.is_pinned() { DEPTH_WITH_PINS * reach.depth } else { reach.depth };
    let sides = [-1.0, 0.0, 1.0];
    let outlines: Vec<Outline> = sides
        .into_iter()
        .flat_map(|roll| sides.map(|scale| (reach.roll_rad * roll, 1.0 + depth * scale)))
        .map(|(roll_rad, factor)| Outline::new(picture, &points, middle, roll_rad, factor))
        .collect();
    let shift_px = if prior.pins.len() > 1 {
        SHIFT_IN_PIN_SIGMAS * prior.pin_sigma_px / picture.photo_px
    } else {
        (reach.shift_px / picture.photo_px).max(reach.shift * look.size_px)
    };
    let (rating, outline, [right, down]) = best_of(picture, &outlines, shift_px)?;
    let pixel = middle + DVec2::new(f64::from(right), f64::from(down));
    let place = picture.camera.unproject(pixel) * (center.z / outline.factor);
    let rolled = rotation_from_rotation_vector(center.normalize_or(DVec3::Z) * outline.roll_rad);
    Some((rating, (Pose::rotation_about(center, rolled) * view).translated(place - center)))
}

/// The best of these outlines, shifted by `shift_px` at most; with its rating and its shift in pixels.
fn best_of<'a>(
    picture: &Picture,
    outlines: &'a [Outline],
    shift_px: f64,
) -> Option<(f32, &'a Outline, [i32; 2])> {
    let labels = picture.labels();
    let shifts = (shift_px / f64::from(STEP_PX)).ceil() as i32;
    let shifts = || (-shifts..=shifts).map(|step| step * STEP_PX);
    let places = shifts().flat_map(|down| shifts().map(move |right| [right, down]));
    let mut rated: Vec<(f32, &Outline, [i32; 2])> = Vec::new();
    for outline in outlines {
        let rate = |shift| rate(picture, &labels, outline.probes.iter().step_by(ROUGHLY), shift);
        rated.extend(places.clone().map(|shift| (rate(shift), outline, shift)));
    }
    // Most places are far worse than the best, and a part of the outline is enough to tell.
    let promising = rated.len().div_ceil(PLACES_PER_PROMISING);
    rated.select_nth_unstable_by(promising.checked_sub(1)?, |a, b| b.0.total_cmp(&a.0));
    let rate = |outline: &Outline, shift| rate(picture, &labels, outline.probes.iter(), shift);
    let promising = rated.into_iter().take(promising);
    promising
        .map(|(_, outline, shift)| (rate(outline, shift), outline, shift))
        .max_by(|a, b| a.0.total_cmp(&b.0))
}

/// A view's outline, turned and scaled about the object's middle.
struct Outline {
    roll_rad: f64,
    factor: f64,
    probes: Vec<Probe>,
}

impl Outline {
    fn new(picture: &Picture, points: &[&ContourPoint], middle: DVec2, roll_rad: f64, factor: f64) -> Self {
        let turn = DVec2::from_angle(roll_rad);
        let probe = |point: &&ContourPoint| {
            let place = middle + turn.rotate(point.pixel - middle) * factor;
            Probe::new(picture, place, turn.rotate(point.normal))
        };
        Self { roll_rad, factor, probes: points.iter().map(probe).collect() }
    }
}

/// A point of an outline in whole pixels, which can be shifted without looking at anything again.
struct Probe {
    x: i32,
    y: i32,
    normal: [f32; 2],
    /// From its pixel's number to those beside the outline.
    inside: [i32; 3],
    outside: [i32; 3],
}

impl Probe {
    fn new(picture: &Picture, place: DVec2, normal: DVec2) -> Self {
        let whole = |place: DVec2| [place.x.round() as i32, place.y.round() as i32];
        let [x, y] = whole(place);
        let beside = |side: f64| {
            BESIDE_PX.map(|distance| {
                let [there_x, there_y] = whole(place + normal * (side * distance));
                (there_y - y) * picture.width as i32 + there_x - x
            })
        };
        Self { x, y, normal: normal.as_vec2().to_array(), inside: beside(-1.0), outside: beside(1.0) }
    }
}

/// From 0 to 2: the edges under the outline, and how little the colours on its two sides have in common (Bhattacharyya).
fn rate<'a>(
    picture: &Picture,
    labels: &[u8],
    probes: impl ExactSizeIterator<Item = &'a Probe>,
    [right, down]: [i32; 2],
) -> f32 {
    let (width, height) = (picture.width as i32, picture.height as i32);
    let (mut inside, mut outside) = ([0_u32; COLORS], [0_u32; COLORS]);
    let (mut edges, mut count) = (0.0_f32, 0.0_f32);
    let fewest = SMALLEST_PART * probes.len() as f32;
    let label = |index: i32| labels.get(index as usize).map_or(0, |&label| usize::from(label) % COLORS);
    for probe in probes {
        let (x, y) = (probe.x + right, probe.y + down);
        if x < BORDER_PX || y < BORDER_PX || x >= width - BORDER_PX || y >= height - BORDER_PX {
            continue;
        }
        let index = y * width + x;
        edges += picture.edge_at(index as usize, probe.normal);
        count += 1.0;
        for k in 0..BESIDE_PX.len() {
            inside[label(index + probe.inside[k])] += 1;
            outside[label(index + probe.outside[k])] += 1;
        }
    }
    if count < fewest {
        return 0.0;
    }
    let common = inside.iter().zip(&outside).map(|(&a, &b)| (a as f32 * b as f32).sqrt()).sum::<f32>();
    edges / count + 1.0 - common / (BESIDE_PX.len() as f32 * count)
}
