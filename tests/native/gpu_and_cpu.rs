//! The renderer against the CPU rasteriser, and both against K (R X + t) in f64.
//!
//! The pixel-centre rule: pixel (u, v) of a photo is sampled at (u, v) of the `image` frame, and covers half a pixel on
//! each side. A shift of half a pixel anywhere between camera and screen shows here.

use std::sync::Arc;

use glam::{DMat3, DQuat, DVec2, DVec3, Vec3};
use pinpose::math::{Distortion, ImageRect, Intrinsics, Pose};
use pinpose::mesh::{Bvh, Mesh, MeshData};
use pinpose::raster::{Mask, PixelRegion, RasterItem, rasterize};
use pinpose::render::{Item, Layer, LineWidths, Picture, Renderer};
use pinpose::scene::{Look, MeshAsset, Rgb, Sha256};

use crate::support::{linemod_session, renderer};

/// Edges fall on sample points differently in f32 and on the CPU's grid; of an outline of some hundred pixels, a few.
const LEAST_IOU: f64 = 0.995;

#[test]
fn gpu_masks_agree_with_cpu_masks_on_linemod() {
    let (Some(session), Some(mut renderer)) = (linemod_session(), renderer()) else { return };
    let scene = session.scene();
    let mut worst: f64 = 1.0;
    for photo in &scene.photos {
        for (object, annotation) in scene.objects_in(photo.id) {
            for pose in poses_around(&annotation.camera_from_object) {
                let iou = compare(&mut renderer, &photo.camera, &object.mesh, pose);
                worst = worst.min(iou);
                assert!(iou >= LEAST_IOU, "{} in {}: {iou}", object.name, photo.asset.file_name);
            }
        }
    }
    println!("worst IoU of GPU and CPU masks over 50 poses: {worst:.5}");
}

#[test]
fn gpu_masks_agree_with_cpu_masks_under_lens_distortion() {
    let (Some(session), Some(mut renderer)) = (linemod_session(), renderer()) else { return };
    let scene = session.scene();
    let photo = &scene.photos[0];
    let (object, annotation) = scene.objects_in(photo.id).next().unwrap();
    let distortion = Distortion { k1: -0.2, k2: 0.05, p1: 0.002, p2: -0.001, k3: 0.01 };
    let camera = Intrinsics { distortion, skew: 1.5, ..photo.camera };
    let iou = compare(&mut renderer, &camera, &object.mesh, annotation.camera_from_object);
    assert!(iou >= LEAST_IOU, "{iou}");
}

/// The truth and four others: turned, nearer, farther, partly out of the picture.
fn poses_around(truth: &Pose) -> [Pose; 5] {
    let turn = |x: f64, y: f64| {
        let rotation = DMat3::from_quat(DQuat::from_scaled_axis(DVec3::new(x, y, 0.3)));
        Pose::rotation_about(truth.translation_mm, rotation) * *truth
    };
    let nearer = truth.translated(truth.translation_mm * -0.4);
    let farther = truth.translated(truth.translation_mm * 0.5);
    let aside = truth.translated(DVec3::new(-truth.translation_mm.x - 560.0, 0.0, 0.0));
    [
        *truth,
        turn(0.5, -0.2),
        turn(-1.1, 0.9),
        if aside.translation_mm.z > 900.0 { aside } else { nearer },
        farther,
    ]
}

fn compare(renderer: &mut Renderer, camera: &Intrinsics, mesh: &Arc<MeshAsset>, pose: Pose) -> f64 {
    let region = PixelRegion::of_camera(camera);
    let raster =
        rasterize(camera, &[RasterItem { mesh: &mesh.mesh, camera_from_object: pose, id: 1 }], region);
    let picture = picture(*camera, ImageRect::of_photo(camera.width, camera.height), mesh.clone(), pose);
    let pending = renderer.draw_and_read(&picture, [camera.width, camera.height], Layer::Ids);
    let ids = pending.wait(renderer.gpu()).unwrap();
    let drawn = ids.rgba.chunks_exact(4).map(|texel| texel[3] > 0);
    let drawn = Mask::from_pixels(camera.width, camera.height, drawn);
    let expected = raster.mask(1);
    assert!(expected.count() > 200, "the object is hardly in the picture");
    drawn.iou(&expected).unwrap()
}

pub fn picture(camera: Intrinsics, rect: ImageRect, mesh: Arc<MeshAsset>, pose: Pose) -> Picture {
    let item =
        Item { mesh, camera_from_object: pose, color: Rgb([255; 3]), opacity: 1.0, id: 1, selected: false };
    Picture {
        camera,
        rect,
        photo: None,
        photo_opacity: 1.0,
        items: vec![item],
        ghosts: Vec::new(),
        eye_from_camera: Pose::IDENTITY,
        masks: None,
        occluder: None,
        look: Look { outline: false, ..Look::default() },
        widths: LineWidths::for_scale(1.0),
        surroundings: None,
        background: Rgb([0; 3]),
        in_motion: false,
    }
}

/// Discs at known points, each by itself: the centroid of what the picture covers is where the point projects to.
#[test]
fn small_discs_are_drawn_where_their_centres_project() {
    let Some(mut renderer) = renderer() else { return };
    let camera =
        Intrinsics { skew: 0.8, ..Intrinsics::pinhole(572.4114, 591.57043, 305.2611, 251.04899, 640, 480) };
    let mut worst: f64 = 0.0;
    for (u, v) in [(60.3, 40.7), (320.0, 240.0), (501.5, 130.25), (611.11, 455.9), (33.3, 402.5)] {
        let pixel = DVec2::new(u, v);
        let pose = Pose::from_translation(camera.unproject(pixel) * 900.0);
        let disc = disc(6.0);
        for zoom in [1.0, 8.0] {
            let size = DVec2::new(320.0, 240.0);
            // A view whose corner is at no whole pixel.
            let rect = ImageRect {
                min: pixel - size / (2.3 * zoom),
                max: pixel - size / (2.3 * zoom) + size / zoom,
            };
            let pending = renderer.draw_and_read(
                &picture(camera, rect, disc.clone(), pose),
                [320, 240],
                Layer::Picture,
            );
            let pixels = pending.wait(renderer.gpu()).unwrap();
            let centroid = centroid(&pixels.rgba, 320);
            // A pixel's centre is half a target pixel from its corner; the `image` frame begins at `rect.min`.
            let seen = rect.min + (centroid + 0.5) / zoom;
            let error_on_screen = seen.distance(pixel) * zoom;
            worst = worst.max(error_on_screen);
            // 4 samples a pixel around a disc of some 25 px: the centroid is found to a few hundredths of a pixel.
            assert!(error_on_screen < 0.1, "at {pixel}, zoom {zoom}: off by {error_on_screen:.3} px");
        }
    }
    println!("worst offset of a disc's centroid: {worst:.4} screen px");
}

/// A disc of so many millimetres about the origin, facing the camera.
pub fn disc(radius_mm: f32) -> Arc<MeshAsset> {
    let count = 96_u32;
    let mut positions_mm = vec![Vec3::ZERO];
    positions_mm.extend((0..count).map(|i| {
        let angle = i as f32 / count as f32 * std::f32::consts::TAU;
        Vec3::new(angle.cos(), angle.sin(), 0.0) * radius_mm
    }));
    let triangles = (0..count).map(|i| [0, 1 + i, 1 + (i + 1) % count]).collect();
    let mesh = Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() }).unwrap();
    let bvh = Bvh::build(&mesh);
    Arc::new(MeshAsset {
        file_name: "disc".to_owned(),
        sha256: Sha256::of(b"disc"),
        bytes: Arc::from([]),
        companions: Vec::new(),
        mesh,
        search_tree: bvh.into(),
        untransformed: None,
        drawn: Default::default(),
    })
}

/// The brightness-weighted mean of pixel coordinates; the disc has one brightness, so that is its coverage.
pub fn centroid(rgba: &[u8], width: usize) -> DVec2 {
    let (mut sum, mut weight) = (DVec2::ZERO, 0.0);
    for (index, texel) in rgba.chunks_exact(4).enumerate() {
        let value = f64::from(texel[0]);
        sum += DVec2::new((index % width) as f64, (index / width) as f64) * value;
        weight += value;
    }
    assert!(weight > 0.0, "nothing was drawn");
    sum / weight
}

/// A reference is drawn as a dashed outline, also where the objects' own outlines are switched off.
#[test]
fn references_are_outlined_whether_or_not_objects_are() {
    let Some(mut renderer) = renderer() else { return };
    let camera = Intrinsics::pinhole(500.0, 500.0, 99.5, 74.5, 200, 150);
    let whole = ImageRect::of_photo(200, 150);
    let mut picture = picture(camera, whole, disc(40.0), Pose::from_translation(DVec3::Z * 500.0));
    picture.ghosts = std::mem::take(&mut picture.items);
    picture.ghosts[0].color = Rgb([255, 64, 220]);
    picture.widths.ghost_px = 2.0;
    let pending = renderer.draw_and_read(&picture, [200, 150], Layer::Picture);
    let pixels = pending.wait(renderer.gpu()).unwrap();
    let drawn = pixels.rgba.chunks_exact(4).filter(|texel| texel[0] > 128).count();
    // Around a circle of 40 px: some 250 px long, 2 px wide, three fifths of it dashes.
    assert!((200..400).contains(&drawn), "{drawn} pixels of the line are drawn");
}
