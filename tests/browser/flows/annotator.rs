//! The simulated annotator: turns the object about right, then four pins, with the mouse alone.
//!
//! Its clicks are where the truth has the points, off by as much as a careful hand; they are not people's.

use std::time::Instant;

use anyhow::{Context as _, ensure};

use super::expert::{Expert, Shape};
use crate::api::{PATIENCE, Pose};
use crate::context::Context;
use crate::data::{Linemod, Sample};
use crate::input::{Button, Point};
use crate::page::Page;
use crate::poses::{Vector, add_mm, distance, distance_px, projected};

const PINS: usize = 4;
const MAX_GESTURES: u32 = 15;
/// A press nearer to a pin than its grip would take that pin.
const FREE_PX: f64 = 16.0;

/// Of a click, per axis.
#[derive(Debug, Clone, Copy)]
struct Hand {
    sigma_px: f64,
    state: u64,
}

impl Hand {
    /// A normal variate from twelve uniform ones, times the hand's sigma.
    fn off(&mut self) -> f64 {
        let sum: f64 = (0..12).map(|_| self.uniform()).sum();
        (sum - 6.0) * self.sigma_px
    }

    /// 0 to 1: Steele, Lea, Flood, *Fast Splittable Pseudorandom Number Generators*, 2014.
    fn uniform(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// With a hand that does not err, four pins are the pose.
pub fn pins(context: &mut Context) -> anyhow::Result<()> {
    let linemod = Linemod::open()?;
    let page = context.start("")?;
    let sample = linemod.samples.first().context("No samples")?;
    let outcome = pose(page, &linemod, sample, Hand { sigma_px: 0.0, state: 1 })?;
    println!(
        "   {}: ADD {:.2} mm with {PINS} exact pins, after {} gestures",
        sample.mesh, outcome.add_mm, outcome.gestures
    );
    // The mouse goes in whole pixels of the page, a tenth of a photo pixel or so when zoomed in. Of an object of 60 px a pin
    // that is off by a pixel takes the depth off by some 35 mm, as the panel says.
    ensure!(outcome.add_mm < 8.0, "Four exact pins end at {:.2} mm", outcome.add_mm);
    panel(page)
}

/// A hand like a person's, and then one key: every sample. Where the snap is led astray, it may be worse than the pins.
pub fn pins_and_snap(context: &mut Context) -> anyhow::Result<()> {
    let linemod = Linemod::open()?;
    let page = context.start("")?;
    let (mut pinned_mm, mut snapped_mm) = (Vec::new(), Vec::new());
    for (number, sample) in linemod.samples.iter().enumerate() {
        let hand = Hand { sigma_px: 2.0, state: number as u64 };
        let outcome = pose(page, &linemod, sample, hand).with_context(|| sample.mesh.clone())?;
        let clock = Instant::now();
        page.key(" ", &[])?;
        page.wait_for_state("!state.busy", PATIENCE)?;
        let snap_ms = clock.elapsed().as_millis();
        let snapped = page.selected_pose()?;
        let vertices = Shape::of_ply(&linemod.file(&sample.mesh)?)?.vertices;
        let add_mm = add_mm(&snapped.camera_from_object, &sample.camera_from_object, &vertices);
        println!(
            "   {}: ADD {:.1} mm with {PINS} pins, {add_mm:.1} mm after the snap ({}, {snap_ms} ms from key to end), {} gestures",
            sample.mesh,
            outcome.add_mm,
            if snapped.source == "snap" { "taken" } else { "refused" },
            outcome.gestures + 1
        );
        pinned_mm.push(outcome.add_mm);
        snapped_mm.push(add_mm);
        page.wait_until_saved()?;
        page.command("new_scene")?;
        page.wait_for_state("!state.busy && state.photos.length === 0", PATIENCE)?;
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    println!(
        "   mean ADD {:.1} mm with pins of 2 px, {:.1} mm after the snap (the paper's people: 15.3 mm; these are no people)",
        mean(&pinned_mm),
        mean(&snapped_mm)
    );
    ensure!(mean(&snapped_mm) < mean(&pinned_mm), "The snap makes it worse");
    Ok(())
}

/// Pins in the panel: switched off, on, removed, taken back.
fn panel(page: &mut Page) -> anyhow::Result<()> {
    // Room for all of the list.
    page.click_widget("Fold output")?;
    page.wait_for_widgets(&["Pin 1", "Pin 4", "Remove pin 4"])?;
    let solved = page.selected_pose()?.camera_from_object;
    page.click_widget("Pin 4")?;
    let three = page.selected_pose()?;
    ensure!(three.source == "pins", "A pin that was switched off leaves the source {}", three.source);
    page.click_widget("Pin 4")?;
    let four = page.selected_pose()?.camera_from_object;
    let apart = four.iter().flatten().zip(solved.iter().flatten()).map(|(a, b)| (a - b).abs());
    let apart = apart.fold(0.0, f64::max);
    // The same minimum, from two sides: what the solver's last step leaves.
    ensure!(apart < 1e-3, "Switched off and on again, a pin moves the pose by {apart}");
    page.click_widget("Remove pin 4")?;
    page.wait_for_widgets(&["Pin 3"])?;
    ensure!(!page.widgets()?.iter().any(|widget| widget.label == "Pin 4"), "The pin is still there");
    page.key("z", &[crate::input::Modifier::Control])?;
    page.wait_for_widgets(&["Pin 4"])?;
    let saved = page.wait_until_saved()?;
    page.reload()?;
    page.wait_until_ready()?;
    let back = page.wait_for_state("!state.busy && state.photos.length === 1", PATIENCE)?;
    ensure!(back.scene() == saved.scene(), "The scene is another one after a reload");
    page.click_widget("Fold output")?;
    page.wait_for_widgets(&["Pin 4"])?;
    Ok(())
}

struct Outcome {
    add_mm: f64,
    gestures: u32,
}

fn pose(page: &mut Page, linemod: &Linemod, sample: &Sample, mut hand: Hand) -> anyhow::Result<Outcome> {
    let mesh = linemod.file(&sample.mesh)?;
    let shape = Shape::of_ply(&mesh)?;
    page.load(&[linemod.file(&sample.photo)?, mesh, linemod.camera()])?;
    let state = page.wait_until_saved()?;
    let k = state.shown_photo()?.k;
    let points = seen_points(page, sample, &shape)?;
    let mut expert = Expert::new(page, k, shape, sample.camera_from_object);
    expert.page.key("f", &[])?;
    expert.roll(false)?;
    expert.turn(false)?;
    expert.page.key("0", &[])?;
    expert.page.key("x", &[])?;
    let mut chosen: Vec<Vector> = Vec::new();
    let mut clicked = Vec::new();
    for _ in 0..PINS {
        let (from, point) = next_point(&mut expert, &points, &chosen)?;
        chosen.push(point);
        let (u, v) = projected(&k, &sample.camera_from_object, point);
        clicked.push((u + hand.off(), v + hand.off()));
        pin(&mut expert, from, clicked[clicked.len() - 1])?;
        // The first pin has brought the object to its place: from there on it is looked at closely.
        expert.page.key("f", &[])?;
        expert.page.next_frame()?;
        let pins = expert.page.selected_pose()?.pins.len();
        ensure!(pins == chosen.len(), "{pins} pins after {} drags of a point", chosen.len());
    }
    // The first pin was set from afar, where a pixel of the page is more than one of the photo.
    let first = expert.page.selected_pose()?.pins.first().context("No pin")?.pixel;
    let from = expert.page.mouse_place(first)?;
    pin(&mut expert, from, clicked[0])?;
    let pose = expert.page.selected_pose()?;
    ensure!(pose.source == "pins", "The pose's source is {}", pose.source);
    let add_mm = add_mm(&pose.camera_from_object, &sample.camera_from_object, &expert.shape.vertices);
    let outcome = Outcome { add_mm, gestures: expert.gestures };
    ensure!(outcome.gestures <= MAX_GESTURES, "It took {} gestures", outcome.gestures);
    Ok(outcome)
}

/// Points of the object that the photo shows: what a person recognises in it.
fn seen_points(page: &mut Page, sample: &Sample, shape: &Shape) -> anyhow::Result<Vec<Vector>> {
    let state = page.state()?;
    let (photo, object) = (state.shown_photo()?.id, state.selection.object.context("No object")?);
    let k = state.shown_photo()?.k;
    page.set_pose(photo, object, sample.camera_from_object)?;
    let mut points = Vec::new();
    for vertex in shape.vertices.iter().step_by(shape.vertices.len().div_ceil(80)) {
        let at = page.page_from_image(projected(&k, &sample.camera_from_object, *vertex))?;
        if let Some(picked) = page.pick(at)?
            && distance(picked.point, *vertex) < 0.02 * shape.radius_mm
        {
            points.push(picked.point);
        }
    }
    page.command("undo")?;
    ensure!(points.len() > 2 * PINS, "The photo shows {} points of the object", points.len());
    Ok(points)
}

/// The point that can be grabbed now and is farthest from those that are pinned.
fn next_point(
    expert: &mut Expert<'_>,
    points: &[Vector],
    chosen: &[Vector],
) -> anyhow::Result<(Point, Vector)> {
    let Pose { camera_from_object: pose, pins, .. } = expert.page.selected_pose()?;
    let mut pinned = Vec::new();
    for pin in pins {
        pinned.push(expert.page.page_from_image(pin.pixel)?);
    }
    let apart = |point: &Vector| {
        let others = chosen.iter().copied().map(|other| distance(*point, other));
        // The first one: far from the middle.
        others
            .fold(if chosen.is_empty() { distance(*point, expert.shape.center) } else { f64::MAX }, f64::min)
    };
    let mut by_distance: Vec<Vector> = points.to_vec();
    by_distance.sort_by(|a, b| apart(b).total_cmp(&apart(a)));
    let near_mm = 0.04 * expert.shape.radius_mm;
    for point in by_distance {
        let at = expert.page.mouse_place(projected(&expert.k, &pose, point))?;
        if pinned.iter().any(|pin| distance_px(*pin, at) < FREE_PX) {
            continue;
        }
        if let Some(picked) = expert.page.pick(at)?
            && distance(picked.point, point) < near_mm
        {
            return Ok((at, picked.point));
        }
    }
    anyhow::bail!("No point can be grabbed")
}

/// Drags a point of the object to a pixel; a short way goes out and back, for a short drag is a click.
fn pin(expert: &mut Expert<'_>, from: Point, pixel: Point) -> anyhow::Result<()> {
    let to = expert.page.mouse_place(pixel)?;
    let aside = ((from.0 + to.0) / 2.0 + 8.0, (from.1 + to.1) / 2.0 + 8.0);
    expert.gestures += 1;
    expert.page.drag_along(from, &[aside, to], Button::Left, &[])
}
