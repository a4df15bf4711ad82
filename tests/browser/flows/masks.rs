//! What the GPU draws against what the CPU computes, as silhouettes of real meshes.

use anyhow::ensure;
use image::GrayImage;

use crate::api::Matrix;
use crate::context::Context;
use crate::data::{Linemod, Sample};
use crate::page::Page;
use crate::poses::{axis_rotation, product, rotation, with_translation};

/// Both sample the pixels' centres. A software GPU snaps vertices to 1/16 px, so that one in some twenty pixels along a rim
/// may differ: five of an object as small as 800 px, and a smaller share of larger ones.
const LEAST_IOU: f64 = 0.995;

/// Those with black-box values, and an object that is one of the smallest in its photo.
const THREE: [&str; 3] = ["000019.png", "000057.png", "000034.png"];

pub fn three_samples(context: &mut Context) -> anyhow::Result<()> {
    let linemod = Linemod::open()?;
    let samples = THREE.into_iter().map(|photo| linemod.sample(photo)).collect::<anyhow::Result<Vec<_>>>()?;
    compare(context, &linemod, &samples)
}

pub fn all_samples(context: &mut Context) -> anyhow::Result<()> {
    let linemod = Linemod::open()?;
    let samples: Vec<&Sample> = linemod.samples.iter().collect();
    compare(context, &linemod, &samples)
}

fn compare(context: &mut Context, linemod: &Linemod, samples: &[&Sample]) -> anyhow::Result<()> {
    let page = context.start("")?;
    let (mut worst, mut worst_place) = (1.0, String::new());
    for sample in samples {
        page.load(&linemod.files_of(sample)?)?;
        for (number, pose) in poses_around(&sample.camera_from_object).iter().enumerate() {
            let iou = iou_at(page, pose)?;
            let place = format!("{} at pose {number}", sample.mesh);
            ensure!(iou >= LEAST_IOU, "{place}: the silhouettes' IoU is {iou:.4}");
            if iou < worst {
                (worst, worst_place) = (iou, place);
            }
        }
        page.command("new_scene")?;
    }
    println!("   worst IoU {worst:.4} {worst_place}");
    Ok(())
}

fn iou_at(page: &mut Page, pose: &Matrix) -> anyhow::Result<f64> {
    let state = page.state()?;
    page.set_pose(state.shown_photo()?.id, state.selected_pose()?.object, *pose)?;
    let (drawn, computed) = (page.render_mask("silhouette")?, page.render_mask("mask")?);
    ensure!(
        drawn.dimensions() == computed.dimensions() && drawn.dimensions() == (640, 480),
        "Masks of two sizes"
    );
    Ok(iou(&drawn, &computed))
}

fn iou(a: &GrayImage, b: &GrayImage) -> f64 {
    let pairs = || a.as_raw().iter().zip(b.as_raw()).map(|(&a, &b)| (a > 0, b > 0));
    let both = pairs().filter(|&(a, b)| a && b).count();
    let any = pairs().filter(|&(a, b)| a || b).count();
    both as f64 / any as f64
}

/// The truth, and from there: farther, nearer, turned, and in the photo's upper left corner.
fn poses_around(truth: &Matrix) -> [Matrix; 5] {
    let t = [truth[0][3], truth[1][3], truth[2][3]];
    let rotation = rotation(truth);
    let turned = |axis, angle| product(&axis_rotation(axis, angle), &rotation);
    [
        *truth,
        with_translation(rotation, t.map(|value| value * 1.1)),
        with_translation(turned(1, 0.7), t.map(|value| value * 0.5)),
        with_translation(turned(0, -1.9), [t[0] + 13.7, t[1] - 8.1, t[2]]),
        with_translation(turned(2, 2.5), [-0.55 * t[2], -0.41 * t[2], t[2]]),
    ]
}
