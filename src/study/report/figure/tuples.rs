//! The qualitative pictures: photo, annotation in lime, truth in magenta, and where the two silhouettes differ.

use std::sync::Arc;

use super::drawing::{Anchor, Drawing, Shape, Text};
use super::{Figure, figure};
use crate::math::Pose;
use crate::photo::{Pixels, decode, png_rgba};
use crate::raster::{Mask, PixelRegion, RasterItem, rasterize};
use crate::scene::{Rgb, object_color, reference_color};
use crate::study::report::{Analysis, Measure, ReportProgress, ReportSample, Rows, TrialErrors};

/// Of a picture on the page, in its own pixels: finer than it is printed. What has fewer in the photo keeps them.
const MOST_WIDTH: u32 = 320;
/// How much of the photo an object's colour covers.
const COVER: f64 = 0.5;
/// And where the silhouettes differ.
const COVER_XOR: f64 = 0.9;
/// Free room around the object, as a part of its box.
const MARGIN: f64 = 0.35;
const CELL_WIDTH: f64 = 186.0;
const LABEL_SIZE: f64 = 11.0;

/// The four pictures of one trial.
#[derive(Debug, Clone, PartialEq)]
pub struct TuplePictures {
    pub set: usize,
    pub sample: String,
    /// Photo, annotation, truth, difference: PNG files of one size.
    pub png: [Arc<[u8]>; 4],
    /// Of each of them.
    pub size: [u32; 2],
    /// The errors, beneath.
    pub lines: [String; 2],
}

/// Draws a row of pictures for each sample: of the person whose ADD is the median, so that it is a typical one.
#[derive(Debug)]
pub struct TupleJob {
    /// The next one last.
    rows: Vec<TrialErrors>,
    count: usize,
    made: Vec<TuplePictures>,
}

impl TupleJob {
    pub fn new(analysis: &Analysis) -> Self {
        let mut rows: Vec<TrialErrors> =
            (0..analysis.samples.len()).filter_map(|sample| median_row(analysis, sample)).collect();
        rows.reverse();
        Self { count: rows.len(), rows, made: Vec::new() }
    }

    /// Works while `go_on` says so, but for one sample at least. `analysis` is the one that it was made of.
    pub fn step(
        &mut self,
        analysis: &Analysis,
        go_on: &mut dyn FnMut() -> bool,
    ) -> ReportProgress<Vec<TuplePictures>> {
        loop {
            let Some(row) = self.rows.pop() else {
                return ReportProgress::Done(Box::new(std::mem::take(&mut self.made)));
            };
            self.made.extend(pictures(analysis, &row));
            if !go_on() {
                return ReportProgress::Working(1.0 - self.rows.len() as f64 / self.count.max(1) as f64);
            }
        }
    }

    /// To the end, however long it takes.
    pub fn run(mut self, analysis: &Analysis) -> Vec<TuplePictures> {
        loop {
            if let ReportProgress::Done(made) = self.step(analysis, &mut || true) {
                return *made;
            }
        }
    }
}

/// Of the best trials of a sample, the one whose ADD is the (lower) median.
fn median_row(analysis: &Analysis, sample: usize) -> Option<TrialErrors> {
    let set = analysis.set_of(sample)?;
    let mut rows: Vec<&TrialErrors> =
        analysis.best_of_set(set, Rows::All).filter(|row| row.sample == sample).collect();
    rows.sort_by(|a, b| a.errors.get(Measure::Add).total_cmp(&b.errors.get(Measure::Add)));
    rows.get(rows.len().saturating_sub(1) / 2).map(|row| (*row).clone())
}

/// `None` where the photo is missing, cannot be read or is of another size than its camera.
fn pictures(analysis: &Analysis, row: &TrialErrors) -> Option<TuplePictures> {
    let sample = analysis.samples.get(row.sample)?;
    let view = sample.view.as_ref()?;
    let photo = decode(&view.photo).ok()?.pixels;
    if (photo.width, photo.height) != (view.camera.width, view.camera.height) {
        return None;
    }
    let participant = analysis.participants.get(row.participant)?;
    let pose = participant.trials.get(row.trial)?.pose;
    let [annotated, truth] = [&pose, &sample.truth].map(|pose| silhouette(sample, pose));
    let (annotated, truth) = (annotated?, truth?);
    let region = region_around(&photo, &[&annotated, &truth]);
    let (lime, magenta) = (object_color(0), reference_color());
    let difference = |x: u32, y: u32| match (annotated.get(x, y), truth.get(x, y)) {
        (true, false) => Some((lime, COVER_XOR)),
        (false, true) => Some((magenta, COVER_XOR)),
        (true, true) => Some((Rgb([255, 255, 255]), COVER)),
        (false, false) => None,
    };
    let drawn = [
        cut(&photo, region, |_, _| None)?,
        cut(&photo, region, |x, y| annotated.get(x, y).then_some((lime, COVER)))?,
        cut(&photo, region, |x, y| truth.get(x, y).then_some((magenta, COVER)))?,
        cut(&photo, region, difference)?,
    ];
    let size = [drawn[0].width, drawn[0].height];
    let [a, b, c, d] = drawn.map(|pixels| png_rgba(&pixels).map(Arc::<[u8]>::from));
    let error = |measure: Measure| row.errors.get(measure);
    Some(TuplePictures {
        set: sample.set,
        sample: sample.label.clone(),
        png: [a?, b?, c?, d?],
        size,
        lines: [
            format!("{:.1}°, {:.1} mm", error(Measure::Rotation), error(Measure::Translation)),
            format!("ADD {:.1} mm ({})", error(Measure::Add), participant.label),
        ],
    })
}

fn silhouette(sample: &ReportSample, camera_from_object: &Pose) -> Option<Mask> {
    let camera = &sample.view.as_ref()?.camera;
    let item = RasterItem { mesh: &sample.mesh, camera_from_object: *camera_from_object, id: 1 };
    Some(rasterize(camera, &[item], PixelRegion::of_camera(camera)).mask(1))
}

/// A part of the photo in its own proportions around the masks; all of it where they are empty.
fn region_around(photo: &Pixels, masks: &[&Mask]) -> PixelRegion {
    let whole = PixelRegion { x0: 0, y0: 0, width: photo.width, height: photo.height };
    let boxes: Vec<PixelRegion> = masks.iter().filter_map(|mask| mask.bounding_box()).collect();
    let Some(first) = boxes.first() else { return whole };
    let (mut low, mut high) = ([first.x0, first.y0], [first.x0, first.y0]);
    for found in &boxes {
        low = [low[0].min(found.x0), low[1].min(found.y0)];
        high = [high[0].max(found.x0 + found.width as i32), high[1].max(found.y0 + found.height as i32)];
    }
    let part = [0, 1].map(|axis| {
        let side = f64::from(if axis == 0 { photo.width } else { photo.height });
        f64::from(high[axis] - low[axis]) * (1.0 + 2.0 * MARGIN) / side
    });
    let part = part[0].max(part[1]).min(1.0);
    let side = |whole: u32| ((f64::from(whole) * part).round() as u32).clamp(1, whole);
    let (width, height) = (side(photo.width), side(photo.height));
    let start = |axis: usize, side: u32, whole: u32| {
        ((low[axis] + high[axis] - side as i32) / 2).clamp(0, (whole - side) as i32)
    };
    PixelRegion { x0: start(0, width, photo.width), y0: start(1, height, photo.height), width, height }
}

/// The region of the photo with a colour over it, scaled to the size of a picture: pixels of it are the means of the photo's
/// beneath them.
fn cut(
    photo: &Pixels,
    region: PixelRegion,
    color: impl Fn(u32, u32) -> Option<(Rgb, f64)>,
) -> Option<Pixels> {
    let width = region.width.clamp(1, MOST_WIDTH);
    let height = (u64::from(width) * u64::from(region.height)).div_ceil(u64::from(region.width.max(1)));
    let height = u32::try_from(height).ok()?.clamp(1, 4 * MOST_WIDTH);
    let mut rgba = Vec::with_capacity(4 * width as usize * height as usize);
    for y in 0..height {
        for x in 0..width {
            let pixel = mean_pixel(photo, region, [x, y], [width, height], &color)?;
            rgba.extend(pixel);
        }
    }
    Some(Pixels { width, height, rgba })
}

fn mean_pixel(
    photo: &Pixels,
    region: PixelRegion,
    place: [u32; 2],
    size: [u32; 2],
    color: &impl Fn(u32, u32) -> Option<(Rgb, f64)>,
) -> Option<[u8; 4]> {
    // The photo's pixels from the place's start to its end, one at least.
    let span = |at: u32, of: u32, length: u32, start: i32| {
        let first = u64::from(at) * u64::from(length) / u64::from(of);
        let last = (u64::from(at + 1) * u64::from(length)).div_ceil(u64::from(of));
        let start = start.unsigned_abs();
        start + first as u32..start + (last.max(first + 1) as u32).min(length)
    };
    let mut sum = [0.0; 3];
    let mut count = 0.0;
    for y in span(place[1], size[1], region.height, region.y0) {
        for x in span(place[0], size[0], region.width, region.x0) {
            let at = 4 * (y as usize * photo.width as usize + x as usize);
            let own = photo.rgba.get(at..at + 3)?;
            let over = color(x, y);
            for (channel, total) in sum.iter_mut().enumerate() {
                let own = f64::from(own[channel]);
                *total +=
                    over.map_or(own, |(Rgb(over), cover)| own + (f64::from(over[channel]) - own) * cover);
            }
            count += 1.0;
        }
    }
    let [r, g, b] = sum.map(|total| (total / f64::max(count, 1.0)).round() as u8);
    Some([r, g, b, 255])
}

/// A figure of a set's rows; `None` where it has none.
pub(in super::super) fn tuple_figure(
    analysis: &Analysis,
    set: usize,
    made: &[TuplePictures],
) -> Option<Figure> {
    let rows: Vec<&TuplePictures> = made.iter().filter(|row| row.set == set).collect();
    if rows.is_empty() {
        return None;
    }
    let mut parts = vec![head()];
    parts.extend(rows.iter().map(|row| draw_row(row)));
    let name = analysis.sets.get(set).filter(|name| !name.is_empty());
    let title = name
        .map_or_else(|| "Annotations and truth".to_owned(), |name| format!("Annotations and truth, {name}"));
    let caption = "For each sample the best trial of the person whose ADD is the median: the photo, the annotation (lime), the truth \
        (magenta), and both silhouettes: white where they agree, lime or magenta where only one of them is; beneath, the errors.";
    let stem = if analysis.sets.len() > 1 { format!("pictures-{}", set + 1) } else { "pictures".to_owned() };
    Some(figure(&stem, &title, caption, Drawing::stacked(parts)))
}

fn cell_x(column: usize) -> f64 {
    28.0 + column as f64 * (CELL_WIDTH + 4.0)
}

fn head() -> Drawing {
    let mut drawing = Drawing::new(cell_x(4), 22.0);
    for (column, name) in ["Photo", "Annotated", "Truth", "Difference"].into_iter().enumerate() {
        let at = [cell_x(column) + CELL_WIDTH / 2.0, 15.0];
        drawing.text(Text::new(at, name, LABEL_SIZE + 1.0, Anchor::Middle).bold());
    }
    drawing
}

fn draw_row(row: &TuplePictures) -> Drawing {
    let height = CELL_WIDTH * f64::from(row.size[1]) / f64::from(row.size[0].max(1));
    let mut drawing = Drawing::new(cell_x(4), height + 36.0);
    drawing.text(Text::new([16.0, height / 2.0], &row.sample, LABEL_SIZE + 1.0, Anchor::Middle).upright());
    for (column, png) in row.png.iter().enumerate() {
        let at = [cell_x(column), 0.0];
        drawing.shapes.push(Shape::Picture { at, size: [CELL_WIDTH, height], png: png.clone() });
    }
    for (line, text) in row.lines.iter().enumerate() {
        let at = [cell_x(3) + CELL_WIDTH / 2.0, height + 13.0 + 13.0 * line as f64];
        drawing.text(Text::new(at, text, LABEL_SIZE, Anchor::Middle));
    }
    drawing
}
