//! The scripted expert: poses an object by hand, with the mouse and the nudge keys alone, from the start pose to the truth.
//!
//! It sees what a person sees (where the object is, where it should be) as numbers, and answers with gestures. That it gets
//! there proves that every degree of freedom can be steered precisely by hand.

use anyhow::{Context as _, ensure};

use crate::api::{Matrix, PATIENCE, Pose};
use crate::context::Context;
use crate::data::{File, Linemod, Sample};
use crate::input::{Button, Modifier, Point};
use crate::page::Page;
use crate::poses::{
    Vector, add_mm, axis_angle_between, distance_px, projected, rotated_back, rotation, rotation_between,
    transformed,
};

const MAX_GESTURES: u32 = 60;
const WANTED_ADD_MM: f64 = 2.0;

/// A drag of one radius is a radian; the radius on screen is not taken for less than this many pixels.
const MIN_TURN_RADIUS_PX: f64 = 60.0;

/// Moves of a drag: the fewer, the faster on a software renderer; the way is what counts.
const DRAG_STEPS: u32 = 3;

/// Three samples: large, small, and nearly symmetric.
pub fn three_samples(context: &mut Context) -> anyhow::Result<()> {
    let linemod = Linemod::open()?;
    let chosen = linemod.samples.iter().step_by(4).take(3).cloned().collect();
    pose_samples(context, &linemod, chosen)
}

pub fn all_samples(context: &mut Context) -> anyhow::Result<()> {
    let linemod = Linemod::open()?;
    let samples = linemod.samples.clone();
    pose_samples(context, &linemod, samples)
}

fn pose_samples(context: &mut Context, linemod: &Linemod, samples: Vec<Sample>) -> anyhow::Result<()> {
    let page = context.start("")?;
    let mut failed = Vec::new();
    for sample in samples {
        let outcome = pose_sample(page, linemod, &sample).with_context(|| sample.mesh.clone())?;
        println!(
            "   {} in {}: ADD {:.1} mm at the start, {:.2} mm after {} gestures",
            sample.mesh, sample.photo, outcome.start_add_mm, outcome.add_mm, outcome.gestures
        );
        if outcome.add_mm > WANTED_ADD_MM || outcome.gestures > MAX_GESTURES {
            failed.push(sample.mesh);
        }
        page.wait_until_saved()?;
        page.command("new_scene")?;
        page.wait_for_state("!state.busy && state.photos.length === 0", PATIENCE)?;
    }
    ensure!(failed.is_empty(), "Not within {WANTED_ADD_MM} mm in {MAX_GESTURES} gestures: {failed:?}");
    Ok(())
}

struct Outcome {
    start_add_mm: f64,
    add_mm: f64,
    gestures: u32,
}

fn pose_sample(page: &mut Page, linemod: &Linemod, sample: &Sample) -> anyhow::Result<Outcome> {
    let mesh = linemod.file(&sample.mesh)?;
    let shape = Shape::of_ply(&mesh)?;
    page.load(&[linemod.file(&sample.photo)?, mesh, linemod.camera()])?;
    let state = page.wait_until_saved()?;
    let start = state.selected_pose()?;
    ensure!(start.state == "untouched", "The object does not begin at its start pose");
    let k = state.shown_photo()?.k;
    let start_add_mm = add_mm(&start.camera_from_object, &sample.camera_from_object, &shape.vertices);
    let mut expert = Expert::new(page, k, shape, sample.camera_from_object);
    expert.work()?;
    let pose = expert.page.selected_pose()?.camera_from_object;
    let add_mm = add_mm(&pose, &expert.truth, &expert.shape.vertices);
    Ok(Outcome { start_add_mm, add_mm, gestures: expert.gestures })
}

/// What the expert knows of the object.
pub(super) struct Shape {
    pub vertices: Vec<Vector>,
    pub center: Vector,
    pub radius_mm: f64,
}

impl Shape {
    /// Reads the vertices of a PLY; the sphere is that about the middle of their box.
    pub fn of_ply(file: &File) -> anyhow::Result<Shape> {
        let vertices = crate::data::ply_vertices(file)?;
        let ends = |axis: usize| {
            let values = vertices.iter().map(|vertex| vertex[axis]);
            values.fold((f64::MAX, f64::MIN), |(min, max), value| (min.min(value), max.max(value)))
        };
        let center = [0, 1, 2].map(|axis| (ends(axis).0 + ends(axis).1) / 2.0);
        let radius_mm =
            vertices.iter().map(|vertex| crate::poses::distance(*vertex, center)).fold(0.0, f64::max);
        Ok(Shape { vertices, center, radius_mm })
    }
}

pub(super) struct Expert<'a> {
    pub page: &'a mut Page,
    pub k: [[f64; 3]; 3],
    pub shape: Shape,
    truth: Matrix,
    pub gestures: u32,
}

impl<'a> Expert<'a> {
    pub fn new(page: &'a mut Page, k: [[f64; 3]; 3], shape: Shape, truth: Matrix) -> Self {
        Self { page, k, shape, truth, gestures: 0 }
    }
}

impl Expert<'_> {
    /// Coarse by mouse, then fine by mouse, then by keys, until it is near enough or patience ends.
    fn work(&mut self) -> anyhow::Result<()> {
        self.page.key("f", &[])?;
        for fine in [false, true] {
            for _ in 0..2 {
                self.roll(fine)?;
                self.turn(fine)?;
                self.push(fine)?;
                self.carry()?;
            }
        }
        while self.add_mm()? > WANTED_ADD_MM / 2.0 && self.gestures + 5 <= MAX_GESTURES {
            self.nudge_rotation()?;
            self.nudge_depth()?;
            self.nudge_place()?;
        }
        Ok(())
    }

    fn pose(&mut self) -> anyhow::Result<Pose> {
        self.page.selected_pose()
    }

    fn add_mm(&mut self) -> anyhow::Result<f64> {
        Ok(add_mm(&self.pose()?.camera_from_object, &self.truth, &self.shape.vertices))
    }

    /// The rotation that is still missing, as a vector in the frame whose z axis is the view ray of the object's centre.
    fn missing_rotation(&mut self) -> anyhow::Result<Vector> {
        let pose = self.pose()?.camera_from_object;
        let missing = axis_angle_between(&rotation(&pose), &rotation(&self.truth));
        Ok(rotated_back(&rotation_between([0.0, 0.0, 1.0], transformed(&pose, self.shape.center)), missing))
    }

    /// Somewhere on the object, and as near to `wanted` on the page as it goes.
    fn grip(&mut self, wanted: Point) -> anyhow::Result<Point> {
        let pose = self.pose()?.camera_from_object;
        let middle = self.page.page_from_image(projected(&self.k, &pose, self.shape.center))?;
        let object = self.page.state()?.selection.object;
        for share in [1.0, 0.8, 0.6, 0.4, 0.2, 0.0] {
            let at = (
                (middle.0 + (wanted.0 - middle.0) * share).round(),
                (middle.1 + (wanted.1 - middle.1) * share).round(),
            );
            if self.page.pick(at)?.map(|picked| picked.object) == object {
                return Ok(at);
            }
        }
        // A hole in the middle: any vertex that can be seen.
        for vertex in self.shape.vertices.clone().iter().step_by(97) {
            let at = self.page.mouse_place(projected(&self.k, &pose, *vertex))?;
            if self.page.pick(at)?.map(|picked| picked.object) == object {
                return Ok(at);
            }
        }
        anyhow::bail!("Nothing of the object can be grabbed")
    }

    /// Ctrl + right drag about the object's centre on screen.
    pub fn roll(&mut self, fine: bool) -> anyhow::Result<()> {
        let angle = self.missing_rotation()?[2];
        if angle.abs() < if fine { 0.003 } else { 0.05 } {
            return Ok(());
        }
        let pose = self.pose()?.camera_from_object;
        let middle = self.page.page_from_image(projected(&self.k, &pose, self.shape.center))?;
        let radius = self.radius_on_page()?;
        let from = self.grip((middle.0 + radius * 0.7, middle.1))?;
        let arm = (from.0 - middle.0, from.1 - middle.1);
        let modifiers: &[Modifier] =
            if fine { &[Modifier::Control, Modifier::Alt] } else { &[Modifier::Control] };
        let angle = if fine { angle * 10.0 } else { angle };
        if fine && angle.abs() > 1.0 {
            return Ok(());
        }
        let steps = (angle.abs() / 0.4).ceil().max(2.0) as u32;
        let path: Vec<Point> = (1..=steps)
            .map(|step| {
                let (sin, cos) = (angle * f64::from(step) / f64::from(steps)).sin_cos();
                (middle.0 + arm.0 * cos - arm.1 * sin, middle.1 + arm.0 * sin + arm.1 * cos)
            })
            .collect();
        self.gestures += 1;
        self.page.drag_along(from, &path, Button::Right, modifiers)
    }

    /// Right drag: the side that faces the viewer follows the cursor.
    pub fn turn(&mut self, fine: bool) -> anyhow::Result<()> {
        let [x, y, _] = self.missing_rotation()?;
        let radius = self.turn_radius_on_page()?;
        let scale = if fine { 10.0 } else { 1.0 };
        // ω = (dy, −dx) / radius
        let way = (-y * radius * scale, x * radius * scale);
        if way.0.hypot(way.1) < 2.0 || (fine && way.0.hypot(way.1) > 400.0) {
            return Ok(());
        }
        let pose = self.pose()?.camera_from_object;
        let middle = self.page.page_from_image(projected(&self.k, &pose, self.shape.center))?;
        let from = self.grip(middle)?;
        let modifiers: &[Modifier] = if fine { &[Modifier::Alt] } else { &[] };
        self.gestures += 1;
        let to = ((from.0 + way.0).round(), (from.1 + way.1).round());
        self.page.drag(from, to, Button::Right, DRAG_STEPS, modifiers)
    }

    /// Shift + wheel: nearer or farther by pixels of the object's width.
    fn push(&mut self, fine: bool) -> anyhow::Result<()> {
        let notches = self.missing_width_px()? * if fine { 10.0 } else { 1.0 };
        if notches.abs() < 0.5 || notches.abs() > 120.0 {
            return Ok(());
        }
        let pose = self.pose()?.camera_from_object;
        let middle = self.page.page_from_image(projected(&self.k, &pose, self.shape.center))?;
        let at = self.grip(middle)?;
        let modifiers: &[Modifier] =
            if fine { &[Modifier::Shift, Modifier::Alt] } else { &[Modifier::Shift] };
        self.gestures += 1;
        self.page.wheel(at, notches.round() as i32, modifiers)
    }

    /// Left drag: the grabbed point stays under the cursor. Whoever wants to go where the view does not reach looks at the
    /// whole photo first.
    fn carry(&mut self) -> anyhow::Result<()> {
        let pose = self.pose()?.camera_from_object;
        let (mut here, mut there) = self.centers(&pose)?;
        let [x, y, width, height] = self.page.state()?.viewport.rect;
        let is_seen = (x..x + width).contains(&there.0) && (y..y + height).contains(&there.1);
        if !is_seen {
            self.page.key("0", &[])?;
            (here, there) = self.centers(&pose)?;
        }
        let from = self.grip(here)?;
        let to = ((from.0 + there.0 - here.0).round(), (from.1 + there.1 - here.1).round());
        if distance_px(from, to) < 1.0 {
            return Ok(());
        }
        self.gestures += 1;
        self.page.drag(from, to, Button::Left, DRAG_STEPS, &[])?;
        if is_seen { Ok(()) } else { self.page.key("f", &[]) }
    }

    /// Bursts of keys: one for each axis that is more than half a small step off.
    fn nudge_rotation(&mut self) -> anyhow::Result<()> {
        for (axis, [positive, negative]) in [["s", "w"], ["a", "d"], ["e", "q"]].into_iter().enumerate() {
            let pose = self.pose()?.camera_from_object;
            let missing = axis_angle_between(&rotation(&pose), &rotation(&self.truth));
            let key = if missing[axis] > 0.0 { positive } else { negative };
            self.burst(key, missing[axis].to_degrees().abs())?;
        }
        Ok(())
    }

    fn nudge_depth(&mut self) -> anyhow::Result<()> {
        let width_px = self.missing_width_px()?;
        self.burst(if width_px > 0.0 { "]" } else { "[" }, width_px.abs())
    }

    fn nudge_place(&mut self) -> anyhow::Result<()> {
        let pose = self.pose()?.camera_from_object;
        let here = projected(&self.k, &pose, self.shape.center);
        let there = projected(&self.k, &self.truth, self.shape.center);
        let (right, down) = (there.0 - here.0, there.1 - here.1);
        self.burst(if right > 0.0 { "ArrowRight" } else { "ArrowLeft" }, right.abs())?;
        self.burst(if down > 0.0 { "ArrowDown" } else { "ArrowUp" }, down.abs())
    }

    /// So many steps of a key: tens with Shift, whole ones plain, tenths with Alt.
    fn burst(&mut self, key: &str, steps: f64) -> anyhow::Result<()> {
        let tenths = (steps * 10.0).round() as u32;
        // Half a turn is 180 steps of a degree.
        if tenths == 0 || tenths > 1800 {
            return Ok(());
        }
        self.gestures += 1;
        self.page.keys(key, tenths / 100, &[Modifier::Shift])?;
        self.page.keys(key, tenths / 10 % 10, &[])?;
        self.page.keys(key, tenths % 10, &[Modifier::Alt])
    }

    /// By how many pixels the bounding sphere has to look wider.
    fn missing_width_px(&mut self) -> anyhow::Result<f64> {
        let pose = self.pose()?.camera_from_object;
        let focal_px = (self.k[0][0] * self.k[1][1]).sqrt();
        let width =
            |pose: &Matrix| 2.0 * focal_px * self.shape.radius_mm / transformed(pose, self.shape.center)[2];
        Ok(width(&self.truth) - width(&pose))
    }

    fn centers(&mut self, pose: &Matrix) -> anyhow::Result<(Point, Point)> {
        let here = self.page.page_from_image(projected(&self.k, pose, self.shape.center))?;
        let there = self.page.page_from_image(projected(&self.k, &self.truth, self.shape.center))?;
        Ok((here, there))
    }

    fn radius_on_page(&mut self) -> anyhow::Result<f64> {
        let pose = self.pose()?.camera_from_object;
        let depth_mm = transformed(&pose, self.shape.center)[2];
        let focal_px = (self.k[0][0] * self.k[1][1]).sqrt();
        Ok(focal_px * self.shape.radius_mm / depth_mm * self.page.state()?.viewport.zoom)
    }

    fn turn_radius_on_page(&mut self) -> anyhow::Result<f64> {
        Ok(self.radius_on_page()?.max(MIN_TURN_RADIUS_PX))
    }
}
