//! Exports: what is written is what the scene holds, in every convention, and others read it as it is meant.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DVec2, DVec3};
use pinpose::formats::export::{
    CameraAxes, Convention, ExportJob, ExportOptions, ExportPart, Exported, LengthUnit, PICTURES_SCHEMA,
    POSES_SCHEMA, PhotoChoice, PoseDirection,
};
use pinpose::formats::{NamedFile, ViewSettings};
use pinpose::math::{Distortion, Intrinsics};
use pinpose::raster::Mask;
use pinpose::scene::{PhotoAsset, Scene};
use serde_json::Value;

use crate::bop_folder::BopFolder;
use crate::support::{data_folder, empty_folder, named_file, numpy, pinpose};

/// What masks of two renderers have in common where the object is large enough for a ratio to mean much.
const LEAST_IOU: f64 = 0.99;
const ENOUGH_PIXELS: usize = 1000;

/// Of numbers up to some thousand pixels, computed in f64 in two ways.
const PIXEL_TOLERANCE: f64 = 1e-6;

fn demo(scene_id: u32) -> BopFolder {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/demo/bop/test");
    BopFolder(folder.join(format!("{scene_id:06}")))
}

fn job(scene: &Scene, options: ExportOptions) -> ExportJob {
    ExportJob::new(scene, &ViewSettings::default(), options)
}

/// An overlay, which takes a renderer, comes without bytes.
fn file(made: Exported) -> NamedFile {
    match made {
        Exported::File(file) => file,
        Exported::Overlay(request) => NamedFile { name: request.path, bytes: Arc::default() },
    }
}

fn files(scene: &Scene, options: ExportOptions) -> impl Iterator<Item = NamedFile> {
    job(scene, options).map(|made| file(made.unwrap()))
}

/// Exports into an empty folder.
fn export_into(name: &str, scene: &Scene, options: ExportOptions) -> PathBuf {
    let folder = empty_folder(name);
    for file in files(scene, options) {
        let path = folder.join(&file.name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, &*file.bytes).unwrap();
    }
    folder
}

/// The scene with its first photos alone.
fn first_photos(scene: &Scene, count: usize) -> PhotoChoice {
    PhotoChoice::These(scene.photos.iter().take(count).map(|photo| photo.id).collect())
}

#[test]
fn the_demo_as_bop_is_what_it_was() {
    for scene_id in [1, 2] {
        let original = demo(scene_id);
        let scene = original.scene();
        let name = format!("bop-demo-{scene_id}");
        let options = ExportOptions { scene_id, ..ExportOptions::of([ExportPart::Bop]) };
        let written = BopFolder(export_into(&name, &scene, options).join(format!("bop/test/{scene_id:06}")));

        assert_eq!(written.truths(), original.truths(), "poses, bit for bit");
        for (image, camera) in original.cameras() {
            let ours = &written.cameras()[&image];
            assert_eq!((ours.k, ours.depth_scale), (camera.k, camera.depth_scale));
            let same_bytes =
                |a: PathBuf, b: PathBuf| assert_eq!(std::fs::read(a).unwrap(), std::fs::read(b).unwrap());
            same_bytes(written.photo(image), original.photo(image));
            let depth = format!("depth/{image:06}.png");
            same_bytes(written.0.join(&depth), original.0.join(&depth));
        }
        for name in ["obj_000001.ply", "obj_000001.png", "obj_000004.ply"] {
            let file = |folder: &BopFolder| std::fs::read(folder.models().join(name)).unwrap();
            assert!(file(&written) == file(&original), "{name} is not the file that was opened");
        }
        for (id, info) in original.model_infos() {
            let ours = &written.model_infos()[&id];
            // Theirs was computed in f64 from the coordinates before they were rounded to f32.
            assert!((ours.diameter - info.diameter).abs() < 1e-4, "{} {}", ours.diameter, info.diameter);
            assert_eq!((ours.min_x, ours.size_y), (info.min_x, info.size_y));
            assert_eq!(ours.symmetries_continuous, info.symmetries_continuous);
            assert_eq!(ours.symmetries_discrete, info.symmetries_discrete);
        }
        masks_agree(&original, &written);
        coco_agrees(&written);
        // Read again, it is the same scene.
        let again = written.scene();
        assert_eq!(again.annotations.len(), scene.annotations.len());
        for (ours, theirs) in again.annotations.values().zip(scene.annotations.values()) {
            assert_eq!(ours.camera_from_object, theirs.camera_from_object);
        }
        assert!(again.photos.iter().zip(&scene.photos).all(|(ours, theirs)| ours.camera == theirs.camera));
    }
}

/// Our masks and counts against those of the path tracer.
fn masks_agree(original: &BopFolder, written: &BopFolder) {
    let (ours, theirs) = (written.infos(), original.infos());
    let (mut least, mut compared) = (1.0_f64, 0);
    for (image, infos) in &theirs {
        for (index, info) in infos.iter().enumerate().filter(|(_, info)| info.px_count_visib > ENOUGH_PIXELS)
        {
            let name = format!("image {image}, object {index}");
            for folder in ["mask", "mask_visib"] {
                let iou =
                    written.mask(folder, *image, index).iou(&original.mask(folder, *image, index)).unwrap();
                assert!(iou >= LEAST_IOU, "{name}: {folder} {iou}");
                least = least.min(iou);
            }
            let found = &ours[image][index];
            let visible = written.mask("mask_visib", *image, index);
            assert_eq!(found.px_count_visib, visible.count(), "{name}");
            let near = |a: usize, b: usize| a.abs_diff(b) as f64 <= (1.0 - LEAST_IOU) * b as f64;
            assert!(near(found.px_count_visib, info.px_count_visib), "{name}");
            assert!(
                near(found.px_count_all, info.px_count_all),
                "{name}: {} {}",
                found.px_count_all,
                info.px_count_all
            );
            assert!(found.px_count_valid <= found.px_count_all && found.px_count_valid > 0);
            assert!((found.visib_fract - info.visib_fract).abs() <= 1.0 - LEAST_IOU, "{name}");
            // A hair of difference at an edge moves a side by a pixel; a thin tip may be seen by one renderer alone.
            for (ours, theirs) in [(found.bbox_obj, info.bbox_obj), (found.bbox_visib, info.bbox_visib)] {
                assert!(
                    ours.iter().zip(theirs).all(|(a, b)| a.abs_diff(b) <= 3),
                    "{name}: {ours:?} {theirs:?}"
                );
            }
            compared += 1;
        }
    }
    println!("{compared} objects; least IoU {least:.5}");
    assert!(compared >= theirs.len() * 4, "only {compared} masks are large enough");
}

fn coco_agrees(written: &BopFolder) {
    let coco: Value = crate::bop_folder::read_json(&written.0.join("scene_gt_coco.json"));
    let (infos, truths) = (written.infos(), written.truths());
    let seen: usize = infos.values().flatten().filter(|info| info.px_count_visib > 0).count();
    let annotations = coco["annotations"].as_array().unwrap();
    assert_eq!(annotations.len(), seen);
    let mut at = annotations.iter();
    for (image, infos) in &infos {
        for (index, info) in infos.iter().enumerate().filter(|(_, info)| info.px_count_visib > 0) {
            let annotation = at.next().unwrap();
            assert_eq!(annotation["image_id"], *image);
            assert_eq!(annotation["category_id"], truths[image][index].obj_id);
            assert_eq!(annotation["bbox"], serde_json::json!(info.bbox_obj));
            assert_eq!(annotation["ignore"], info.visib_fract < 0.1);
            let mask = written.mask("mask_visib", *image, index);
            assert_eq!(decode_runs(&annotation["segmentation"]), mask);
        }
    }
}

/// COCO's uncompressed runs: down the columns, the first run not set.
fn decode_runs(segmentation: &Value) -> Mask {
    let size = |at: usize| segmentation["size"][at].as_u64().unwrap() as u32;
    let (height, width) = (size(0), size(1));
    let mut pixels = Vec::new();
    for (run, length) in segmentation["counts"].as_array().unwrap().iter().enumerate() {
        pixels.extend(std::iter::repeat_n(run % 2 == 1, length.as_u64().unwrap() as usize));
    }
    assert_eq!(pixels.len(), (width * height) as usize);
    let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x * height + y) as usize));
    Mask::from_pixels(width, height, rows.map(|at| pixels[at]))
}

#[test]
fn lmo_comes_back_from_bop_with_its_poses_and_cameras() {
    let Some(folder) = data_folder("lmo16") else { return };
    let original = BopFolder(folder.join("test/000002"));
    let scene = original.scene();
    let options = ExportOptions { scene_id: 2, ..ExportOptions::of([ExportPart::Bop]) };
    let written = BopFolder(export_into("bop-lmo", &scene, options).join("bop/test/000002"));
    let (ours, theirs) = (written.truths(), original.truths());
    let mut poses = 0;
    for (image, truths) in &theirs {
        assert_eq!(written.cameras()[image].k, original.cameras()[image].k);
        for (found, truth) in ours[image].iter().zip(truths) {
            assert_eq!(found.obj_id, truth.obj_id);
            let (found, truth) = (found.pose(), truth.pose());
            assert!(
                found.angle_to(&truth) < 1e-9 && found.translation_mm.distance(truth.translation_mm) < 1e-9
            );
            poses += 1;
        }
    }
    assert_eq!(poses, 122);
    let results = std::fs::read_to_string(written.0.join("../../pinpose_ascene-test.csv")).unwrap();
    assert_eq!(results.lines().count(), 1 + 122);
    assert!(results.lines().skip(1).all(|line| line.split(',').count() == 7 && line.ends_with(",-1")));
}

/// A data set that is opened, written and opened again, all by the command line, is the same: poses, cameras, symmetries,
/// depth.
#[test]
fn a_data_set_survives_opening_and_writing() {
    let lmo = data_folder("lmo16").map(|folder| (folder.join("test/000002"), false, 122));
    let demo = (demo(2).0, true, 60);
    for (number, (scene, has_depth, poses)) in [Some(demo), lmo].into_iter().flatten().enumerate() {
        let out = empty_folder(&format!("survives-{number}"));
        let convert = |from: &Path, to: &Path, rest: &[&str]| {
            let [from, to] = [from, to].map(|path| path.display().to_string());
            let output = pinpose(&[&["convert", &from, &to], rest].concat());
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        };
        convert(&scene, &out.join("export"), &["--to", "bop"]);
        let written = out.join("export/bop/test/000001");
        convert(&scene, &out.join("first.json"), &[]);
        convert(&written, &out.join("second.json"), &[]);
        let [first, second] =
            ["first.json", "second.json"].map(|name| crate::bop_folder::read_json::<Value>(&out.join(name)));
        let mut compared = 0;
        let list = |value: &Value, key: &str| value[key].as_array().unwrap().clone();
        for (ours, theirs) in list(&second, "photos").iter().zip(list(&first, "photos")) {
            assert_eq!(ours["K"], theirs["K"]);
            assert_eq!(ours["depth"]["mm_per_unit"], theirs["depth"]["mm_per_unit"]);
            assert_eq!(ours["depth"]["sha256"], theirs["depth"]["sha256"]);
            assert_eq!(theirs["depth"].is_object(), has_depth);
            for (ours, theirs) in list(ours, "poses").iter().zip(list(&theirs, "poses")) {
                // Bit for bit: the first import has projected the rotations onto SO(3).
                assert_eq!(ours["camera_from_object"], theirs["camera_from_object"]);
                compared += 1;
            }
        }
        assert_eq!(compared, poses);
        for (ours, theirs) in list(&second, "objects").iter().zip(list(&first, "objects")) {
            assert_eq!((&ours["name"], &ours["symmetries"]), (&theirs["name"], &theirs["symmetries"]));
            assert_eq!(ours["mesh_sha256"], theirs["mesh_sha256"], "the very file");
        }
    }
}

/// Every convention, through the script that comes with the files.
#[test]
fn the_script_projects_where_we_do() {
    let Some(python) = numpy() else { return };
    let mut scene = demo(1).scene();
    // One photo has a lens.
    let photo = scene.photos[1].id;
    let distortion = Distortion { k1: -0.11, k2: 0.04, p1: 0.001, p2: -0.002, k3: 0.003 };
    let camera = Intrinsics { distortion, ..scene.photos[1].camera };
    scene.set_camera(photo, camera, scene.photos[1].camera_origin.clone());
    let mut opencv = Value::Null;
    for (number, convention) in conventions().enumerate() {
        let parts =
            [ExportPart::Poses, ExportPart::Npy, ExportPart::Csv, ExportPart::Meshes, ExportPart::Document];
        let options =
            ExportOptions { convention, photos: first_photos(&scene, 2), ..ExportOptions::of(parts) };
        let folder = export_into(&format!("script-{number}"), &scene, options);
        let run = |file: &str, rest: &[&str]| -> Value {
            let folder = folder.display().to_string();
            serde_json::from_str(&python.run("project_all.py", &[&[folder.as_str(), file], rest].concat()))
                .unwrap()
        };
        let printed = run("poses.json", &[]);
        opencv = printed["opencv"].clone();
        assert_eq!(printed["npy"], 10, "a .npy for each pose");
        pixels_agree(&scene, 2, &printed);
        csv_agrees(&folder, &scene, convention);
        if number == 0 {
            let models = demo(1).models().display().to_string();
            let printed = run("pinpose.json", &[&models]);
            assert_eq!(printed["poses"].as_array().unwrap().len(), 10, "of the chosen photos");
        }
    }
    println!("the script agrees; OpenCV: {opencv}");
}

#[test]
fn the_script_reads_bop_folders() {
    let Some(python) = numpy() else { return };
    let scene = demo(2).scene();
    let options = ExportOptions {
        photos: first_photos(&scene, 2),
        ..ExportOptions::of([ExportPart::Bop, ExportPart::Poses])
    };
    let folder = export_into("script-bop", &scene, options).display().to_string();
    let printed: Value =
        serde_json::from_str(&python.run("project_all.py", &[&folder, "bop/test/000001"])).unwrap();
    pixels_agree(&scene, 2, &printed);
}

fn conventions() -> impl Iterator<Item = Convention> {
    let axes = [CameraAxes::OpenCv, CameraAxes::OpenGl];
    let units = [LengthUnit::Millimetre, LengthUnit::Metre];
    let directions = [PoseDirection::CameraFromObject, PoseDirection::ObjectFromCamera];
    (0..8).map(move |i: usize| Convention {
        axes: axes[i & 1],
        unit: units[i >> 1 & 1],
        direction: directions[i >> 2],
    })
}

/// What the script printed, pose by pose in the scene's order, against our own projection.
fn pixels_agree(scene: &Scene, photos: usize, printed: &Value) {
    let mut found = printed["poses"].as_array().unwrap().iter();
    let mut largest = 0.0_f64;
    for photo in scene.photos.iter().take(photos) {
        for (object, annotation) in scene.objects_in(photo.id) {
            let pixels = found.next().unwrap()["pixels"].as_array().unwrap();
            let vertices = object.mesh.mesh.positions_mm().iter().step_by(50);
            assert_eq!(pixels.len(), vertices.len());
            for (pixel, vertex) in pixels.iter().zip(vertices) {
                let ours = photo
                    .camera
                    .project(annotation.camera_from_object.transform_point(vertex.as_dvec3()))
                    .unwrap();
                let theirs = DVec2::new(pixel[0].as_f64().unwrap(), pixel[1].as_f64().unwrap());
                largest = largest.max(ours.distance(theirs));
            }
        }
    }
    assert!(found.next().is_none());
    assert!(largest < PIXEL_TOLERANCE, "{largest} px");
}

fn csv_agrees(folder: &Path, scene: &Scene, convention: Convention) {
    let text = std::fs::read_to_string(folder.join("poses.csv")).unwrap();
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 1 + 10);
    let column = |name: &str| rows[0].iter().position(|head| *head == name).unwrap();
    let (photo, row) = (&scene.photos[0], &rows[1]);
    let (object, annotation) = scene.objects_in(photo.id).next().unwrap();
    let expected = convention.rows(&annotation.camera_from_object);
    let number = |name: &str| row[column(name)].parse::<f64>().unwrap();
    assert_eq!(
        (row[column("photo")], row[column("object")]),
        (photo.asset.file_name.as_str(), object.name.as_str())
    );
    assert_eq!(
        [number("r12"), number("r31"), number("tz"), number("fy")],
        [expected[0][1], expected[2][0], expected[2][3], photo.camera.fy]
    );
    assert_eq!(row[column("direction")], convention.direction.name());
    assert_eq!(
        (row[column("camera_axes")], row[column("length_unit")]),
        (convention.axes.name(), convention.unit.name())
    );
}

#[test]
fn what_is_ours_is_as_its_schema_says() {
    let scene = demo(1).scene();
    let options = ExportOptions { photos: first_photos(&scene, 2), ..ExportOptions::of(all_parts()) };
    let files: Vec<NamedFile> = files(&scene, options).collect();
    for (name, schema) in [("poses.json", POSES_SCHEMA), ("pictures.json", PICTURES_SCHEMA)] {
        let schema: Value = serde_json::from_str(schema).unwrap();
        let validator = jsonschema::validator_for(&schema).unwrap();
        let file = files.iter().find(|file| file.name == name).unwrap();
        let mut value: Value = serde_json::from_slice(&file.bytes).unwrap();
        let errors: Vec<String> = validator.iter_errors(&value).map(|error| error.to_string()).collect();
        assert!(errors.is_empty(), "{name}: {errors:?}");
        value["photos"][0]["K"] = Value::Null;
        assert!(!validator.is_valid(&value), "{name}: the schema takes anything");
        // Every file that is named is there.
        let text = String::from_utf8_lossy(&file.bytes);
        for named in text.split('"').filter(|word| word.starts_with("npy/") || word.ends_with(".png")) {
            assert!(
                files.iter().any(|file| file.name == named || !named.contains('/')),
                "{name} names {named}"
            );
        }
    }
}

fn all_parts() -> impl Iterator<Item = ExportPart> {
    ExportPart::ALL.into_iter().map(|(part, ..)| part)
}

#[test]
fn a_job_tells_how_far_it_is_and_goes_on_after_an_error() {
    let mut scene = demo(1).scene();
    let asset = PhotoAsset { bytes: Arc::from(&b"\x89PNG broken"[..]), ..(*scene.photos[0].asset).clone() };
    scene.photos[0].asset = Arc::new(asset);
    let options = ExportOptions { photos: first_photos(&scene, 2), ..ExportOptions::of(all_parts()) };
    let mut job = job(&scene, options);
    assert_eq!(job.pose_count(), 10);
    let total = job.total();
    let (mut names, mut errors) = (BTreeSet::new(), Vec::new());
    for done in 1..=total {
        match job.next().unwrap() {
            Ok(made) => {
                let name = file(made).name;
                assert!(names.insert(name.to_lowercase()), "{name} comes twice");
            }
            Err(error) => errors.push(error.to_string()),
        }
        assert_eq!(job.done(), done);
    }
    assert!(job.next().is_none());
    // The photo with boxes on it, and the photo itself written anew for BOP.
    assert_eq!(errors.len(), 2, "{errors:?}");
    assert!(errors[0].contains("boxes/000000.png") && errors[1].contains("rgb/000000"), "{errors:?}");
    for name in [
        "readme.txt",
        "project.py",
        "pinpose.json",
        "bop/test/000001/scene_gt.json",
        "meshes/obj_000003.ply",
        "overlays/000001.png",
    ] {
        assert!(names.contains(name), "{name}");
    }
}

#[test]
fn pictures_hold_what_they_say() {
    let scene = demo(1).scene();
    let parts =
        [ExportPart::Masks, ExportPart::VisibleMasks, ExportPart::Depth, ExportPart::Nocs, ExportPart::Boxes];
    let options = ExportOptions { photos: first_photos(&scene, 1), ..ExportOptions::of(parts) };
    let folder = export_into("pictures", &scene, options);
    let listed: Value = crate::bop_folder::read_json(&folder.join("pictures.json"));
    let listed = &listed["photos"][0];
    assert_eq!(listed["pictures"].as_array().unwrap().len(), 5 + 5 + 3);
    let depth = image::open(folder.join("depth/000000.png")).unwrap().into_luma16();
    let nocs = image::open(folder.join("nocs/000000.png")).unwrap().into_rgba8();
    let boxes = image::open(folder.join("boxes/000000.png")).unwrap().into_rgb8();
    let photo = &scene.photos[0];
    let scale =
        listed["pictures"].as_array().unwrap().iter().find_map(|picture| picture["mm_per_step"].as_f64());
    assert_eq!(scale, Some(0.1));
    for (index, (object, annotation)) in scene.objects_in(photo.id).enumerate() {
        let info = &listed["objects"][index];
        let mask = image::open(folder.join(format!("visible_masks/000000-{}.png", object.name)))
            .unwrap()
            .into_luma8();
        let whole =
            image::open(folder.join(format!("masks/000000-{}.png", object.name))).unwrap().into_luma8();
        let center = DVec3::from_array([0, 1, 2].map(|axis| info["nocs_center_mm"][axis].as_f64().unwrap()));
        let size = info["nocs_size_mm"].as_f64().unwrap();
        let mut seen = 0;
        for (x, y, value) in mask.enumerate_pixels().filter(|(_, _, value)| value.0[0] > 0) {
            assert_eq!((value.0[0], whole.get_pixel(x, y).0[0]), (255, 255));
            let color = nocs.get_pixel(x, y).0;
            let point =
                (DVec3::new(color[0].into(), color[1].into(), color[2].into()) / 255.0 - 0.5) * size + center;
            let point = annotation.camera_from_object.transform_point(point);
            // Half a step of 1/255 of the object's size in each axis, and half of a step of depth.
            let tolerance_mm = size / 255.0 / 2.0 * 3.0_f64.sqrt() + 0.05;
            let z = f64::from(depth.get_pixel(x, y).0[0]) * 0.1;
            assert!((point.z - z).abs() < tolerance_mm, "{}: {} {z}", object.name, point.z);
            let place = photo.camera.unproject(DVec2::new(x.into(), y.into())) * z;
            assert!(point.distance(place) < 2.0 * tolerance_mm, "{}", object.name);
            seen += 1;
        }
        assert!(seen > ENOUGH_PIXELS, "{}: {seen}", object.name);
        // The upper side of the box is in the object's colour, but where another one's lines cross it.
        let [x, y, width] = [0, 1, 2].map(|at| info["box_visible"][at].as_u64().unwrap() as u32);
        let drawn = (x..x + width).filter(|x| boxes.get_pixel(*x, y).0 == object.color.0).count();
        assert!(drawn as f64 > 0.9 * f64::from(width), "{}: {drawn} of {width}", object.name);
    }
}

/// A photo that others would show lying on its side is written upright.
#[test]
fn a_rotated_photo_is_written_upright() {
    let Some(folder) = data_folder("images_misc") else { return };
    let mut rotated = 0;
    for path in jpegs(&folder) {
        let file = named_file(&path);
        let Ok((asset, pixels)) = pinpose::formats::read_photo(&file) else { continue };
        let mut scene = Scene::default();
        let is_plain = pinpose::photo::plain_extension(&file.bytes).is_some();
        scene.add_photo(Arc::new(asset));
        let files: Vec<NamedFile> = files(&scene, ExportOptions::of([ExportPart::Bop])).collect();
        let photo = files.iter().find(|file| file.name.contains("/rgb/")).unwrap();
        if is_plain {
            assert_eq!(photo.bytes, file.bytes);
        } else {
            rotated += 1;
            let written = image::load_from_memory(&photo.bytes).unwrap().into_rgba8();
            assert_eq!((written.width(), written.height()), (pixels.width, pixels.height), "{}", file.name);
            assert!(written.into_raw() == pixels.rgba, "{}", file.name);
        }
    }
    assert!(rotated >= 7, "{rotated} of the eight orientations but one are not upright");
}

fn jpegs(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(jpegs(&path));
        } else if path.extension().is_some_and(|extension| extension == "jpg" || extension == "jpeg") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Of a scene without colours BOP's folder is another one, and it is found there again.
#[test]
fn grey_photos_go_into_the_folder_that_bop_has_for_them() {
    let mut scene = demo(1).scene();
    let options = ExportOptions { photos: first_photos(&scene, 2), ..ExportOptions::of([ExportPart::Bop]) };
    let mut grey_first = |count: usize| {
        for photo in scene.photos.iter_mut().take(count) {
            let grey = image::load_from_memory(&photo.asset.bytes).unwrap().into_luma8();
            let mut bytes = std::io::Cursor::new(Vec::new());
            grey.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
            let asset = PhotoAsset { bytes: Arc::from(bytes.into_inner()), ..(*photo.asset).clone() };
            photo.asset = Arc::new(asset);
        }
        let names: BTreeSet<String> = files(&scene, options.clone()).map(|file| file.name).collect();
        ["rgb", "gray"]
            .map(|folder| names.iter().filter(|name| name.contains(&format!("/{folder}/"))).count())
    };
    assert_eq!(grey_first(1), [2, 0], "one has colours still");
    assert_eq!(grey_first(2), [0, 2]);
}
