//! Poses that pins cannot tell apart: the photo ranks them, through the whole program.

use std::rc::Rc;
use std::sync::Arc;

use egui_kittest::kittest::Queryable as _;
use glam::{DVec2, DVec3};
use pinpose::formats::{NamedFile, write_pins};
use pinpose::math::{Intrinsics, Pose};
use pinpose::platform::{MemoryStorage, PageCall};
use pinpose::scene::Pin;

use crate::program::Program;
use crate::support::{CAMERA_JSON, Noise, box_mesh, text_file};

const HALF_SIZES_MM: DVec3 = DVec3::new(40.0, 30.0, 20.0);

fn camera() -> Intrinsics {
    Intrinsics::pinhole(520.5, 533.25, 301.75, 222.5, 640, 480)
}

/// A box with a plate of four pins towards the camera, turned aside by 0.45 rad.
fn truth() -> Pose {
    Pose::exp(DVec3::new(0.0, 0.45, 0.0), DVec3::ZERO).translated(DVec3::new(15.0, -10.0, 800.0))
}

/// The same plate turned to the other side.
fn mirrored() -> Pose {
    Pose::exp(DVec3::new(0.0, -0.45, 0.0), DVec3::ZERO).translated(DVec3::new(15.0, -10.0, 800.0))
}

/// What the box shows on a ray: a shade for each of its sides. Slabs, not the rasteriser that the scores are made with.
fn shade(direction: DVec3) -> Option<f64> {
    let object_from_camera = truth().inverse();
    let (origin, along) = (object_from_camera.translation_mm, object_from_camera.rotation * direction);
    let (to_low, to_high) = ((-HALF_SIZES_MM - origin) / along, (HALF_SIZES_MM - origin) / along);
    let entries = to_low.min(to_high);
    let is_hit = entries.max_element() < to_low.max(to_high).min_element();
    is_hit.then(|| [0.85, 0.6, 0.7][entries.max_position()])
}

/// Nine rays a pixel, before grey, with noise.
fn photo() -> NamedFile {
    let mut noise = Noise(11);
    let picture = image::RgbImage::from_fn(640, 480, |x, y| {
        let rays = (0..9).map(|k| DVec2::new(f64::from(k % 3) - 1.0, f64::from(k / 3) - 1.0) / 3.0);
        let light = rays.map(|off| {
            let place = DVec2::new(f64::from(x), f64::from(y)) + off;
            shade(camera().unproject(place))
                .map_or(DVec3::splat(0.35), |shade| DVec3::new(1.0, 0.5, 0.3) * shade)
        });
        let light = light.sum::<DVec3>() / 9.0 + 0.02 * noise.next();
        image::Rgb(light.to_array().map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8))
    });
    let mut bytes = Vec::new();
    picture.write_to(&mut std::io::Cursor::new(&mut bytes), image::ImageFormat::Png).unwrap();
    NamedFile { name: "photo.png".to_owned(), bytes: Arc::from(bytes) }
}

/// On the corners of the side towards the camera, exactly where they are seen.
fn pins() -> NamedFile {
    let corner = |x: f64, y: f64| {
        let point = DVec3::new(x, y, -20.0);
        Pin::new(point, camera().project(truth().transform_point(point)).unwrap())
    };
    let pins = [corner(-40.0, -30.0), corner(40.0, -30.0), corner(40.0, 30.0), corner(-40.0, 30.0)];
    text_file("pins.json", &write_pins(&camera(), &truth(), &pins))
}

/// The list's names in their order on screen, once it says so of them.
fn listed(start: &Pose, says: &str) -> Vec<&'static str> {
    let mut program = Program::start(&Rc::new(MemoryStorage::default()));
    program.load(&[photo(), box_mesh("box.obj"), text_file("camera.json", CAMERA_JSON)]);
    program.ask(PageCall::SetPose { photo: 1, object: 2, camera_from_object: start.to_rows() });
    program.load(&[pins()]);
    for _ in 0..300 {
        program.harness.step();
        if program.harness.query_by_label(says).is_some() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    if let Ok(picture) = program.harness.render() {
        picture.save(std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("ghosts.png")).unwrap();
    }
    program.harness.get_by_label(says);
    let height = |name| Some((program.harness.query_by_label(name)?.rect().min.y, name));
    let mut rows: Vec<_> = ["Present fit", "Other fit 1"].into_iter().filter_map(height).collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    rows.into_iter().map(|(_, name)| name).collect()
}

#[test]
fn of_two_fits_of_a_plate_the_photo_is_for_the_true_one() {
    let names = listed(&mirrored(), "The photo supports the other fit 1 most.");
    assert_eq!(names, ["Other fit 1", "Present fit"]);
    let names = listed(&truth(), "The photo supports the present fit most.");
    assert_eq!(names, ["Present fit", "Other fit 1"]);
}
