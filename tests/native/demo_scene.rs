//! The demo scene against a renderer that is not ours: Blender's masks and depth maps, made from the same meshes and poses.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use glam::{DMat3, DVec3};
use pinpose::formats::{FileWithCompanions, classify, read_mesh_with, read_photo, read_workspace};
use pinpose::math::{Intrinsics, Pose};
use pinpose::mesh::{self, Mesh};
use pinpose::raster::{Mask, PixelRegion, RasterImage, RasterItem, rasterize};
use pinpose::scene::{AnnotationState, Object, Scene, untouched_pose};
use pinpose::session::{Command, Opening, Session};
use serde::Deserialize;
use serde::de::DeserializeOwned;

/// What all of it may weigh, and the page's example.
const MAX_FOLDER_BYTES: u64 = 6_000_000;
/// Waited for by whoever follows its link.
const MAX_STUDY_BYTES: u64 = 600_000;
const MAX_EXAMPLE_BYTES: u64 = 600_000;

/// Objects with fewer visible pixels are too small for a ratio of areas to mean much.
const ENOUGH_PIXELS: usize = 1000;
const LEAST_IOU: f64 = 0.99;
/// How far inside a mask a depth has to agree: away from edges, where a hair of difference jumps to the background.
const EROSION: i64 = 3;
const DEPTH_TOLERANCE_MM: f64 = 1.0;
const LEAST_DEPTH_SHARE: f64 = 0.99;
/// What is nearer than an object's surface by more than this hides it.
const OCCLUSION_MARGIN_MM: f64 = 2.0;

type PerImage<T> = BTreeMap<u32, T>;

#[derive(Deserialize)]
struct SceneCamera {
    #[serde(rename = "cam_K")]
    k: [f64; 9],
    depth_scale: f64,
    #[serde(rename = "cam_R_w2c")]
    rotation: [f64; 9],
    #[serde(rename = "cam_t_w2c")]
    translation_mm: [f64; 3],
}

#[derive(Deserialize)]
struct Truth {
    obj_id: u32,
    #[serde(rename = "cam_R_m2c")]
    rotation: [f64; 9],
    #[serde(rename = "cam_t_m2c")]
    translation_mm: [f64; 3],
}

#[derive(Deserialize)]
struct TruthInfo {
    bbox_visib: [i32; 4],
    px_count_all: usize,
    px_count_visib: usize,
}

#[derive(Deserialize)]
struct ModelInfo {
    diameter: f64,
    min_x: f64,
    min_y: f64,
    min_z: f64,
    size_x: f64,
    size_y: f64,
    size_z: f64,
    #[serde(default)]
    symmetries_discrete: Vec<[f64; 16]>,
    #[serde(default)]
    symmetries_continuous: Vec<ContinuousSymmetry>,
}

#[derive(Deserialize)]
struct ContinuousSymmetry {
    axis: [f64; 3],
    offset: [f64; 3],
}

/// One image of a scene with everything that is known of it.
struct Frame {
    folder: PathBuf,
    id: u32,
    camera: Intrinsics,
    objects: Vec<(u32, Pose)>,
    depth_mm: Vec<f64>,
}

fn demo_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/demo")
}

fn read_json<T: DeserializeOwned>(path: &Path) -> T {
    let bytes = fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_slice(&bytes).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn model_infos() -> PerImage<ModelInfo> {
    read_json(&demo_folder().join("bop/models/models_info.json"))
}

fn load_mesh(name: &str) -> Mesh {
    let bytes = fs::read(demo_folder().join("bop/models").join(name)).unwrap();
    let texture = |key: &str| fs::read(demo_folder().join("bop/models").join(key)).ok().map(Into::into);
    let loaded = mesh::load(name, &bytes, &texture).unwrap();
    if name.ends_with("ply") {
        assert_eq!(loaded.warnings, Vec::<String>::new(), "{name}");
    }
    loaded.mesh
}

fn load_meshes() -> PerImage<Mesh> {
    model_infos().keys().map(|&id| (id, load_mesh(&format!("obj_{id:06}.ply")))).collect()
}

fn matrix(rows: &[f64; 9]) -> DMat3 {
    DMat3::from_cols_array(rows).transpose()
}

/// As the file has it: truth needs no correction.
fn proper_pose(rotation: &[f64; 9], translation_mm: [f64; 3]) -> Pose {
    let (pose, defect) = Pose::from_parts(matrix(rotation), DVec3::from_array(translation_mm)).unwrap();
    assert!(defect < 1e-12, "a rotation that is {defect:e} from orthonormal");
    pose
}

fn frames(scene_id: u32) -> Vec<Frame> {
    let folder = demo_folder().join(format!("bop/test/{scene_id:06}"));
    let cameras: PerImage<SceneCamera> = read_json(&folder.join("scene_camera.json"));
    let truths: PerImage<Vec<Truth>> = read_json(&folder.join("scene_gt.json"));
    cameras
        .iter()
        .map(|(&id, camera)| {
            let photo = image::open(folder.join(format!("rgb/{id:06}.jpg"))).unwrap();
            let depth = image::open(folder.join(format!("depth/{id:06}.png"))).unwrap().into_luma16();
            assert_eq!((photo.width(), photo.height()), depth.dimensions());
            let [k0, k1, k2] = [0, 3, 6].map(|start| [0, 1, 2].map(|column| camera.k[start + column]));
            Frame {
                folder: folder.clone(),
                id,
                camera: Intrinsics::from_k_rows(&[k0, k1, k2], photo.width(), photo.height()).unwrap(),
                objects: truths[&id]
                    .iter()
                    .map(|truth| (truth.obj_id, proper_pose(&truth.rotation, truth.translation_mm)))
                    .collect(),
                depth_mm: depth.pixels().map(|pixel| f64::from(pixel.0[0]) * camera.depth_scale).collect(),
            }
        })
        .collect()
}

impl Frame {
    fn stored_mask(&self, kind: &str, index: usize) -> Mask {
        let path = self.folder.join(format!("{kind}/{:06}_{index:06}.png", self.id));
        let picture =
            image::open(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display())).into_luma8();
        Mask::from_pixels(picture.width(), picture.height(), picture.pixels().map(|pixel| pixel.0[0] > 0))
    }

    fn rasterized(&self, camera: &Intrinsics, meshes: &PerImage<Mesh>) -> RasterImage {
        let items: Vec<_> = self
            .objects
            .iter()
            .map(|&(id, camera_from_object)| RasterItem { mesh: &meshes[&id], camera_from_object, id })
            .collect();
        rasterize(camera, &items, PixelRegion::of_camera(camera))
    }

    /// Where this object is the nearest of those with a pose, and nothing else that the depth map knows is before it.
    fn visible(&self, raster: &RasterImage, id: u32) -> Mask {
        let pixels = raster.ids.iter().zip(&raster.depth_mm).zip(&self.depth_mm);
        let is_visible = pixels.map(|((&found, &ours), &theirs)| {
            found == id && (theirs == 0.0 || theirs >= f64::from(ours) - OCCLUSION_MARGIN_MM)
        });
        Mask::from_pixels(raster.width, raster.height, is_visible)
    }
}

/// The pixels whose whole neighbourhood is set.
fn eroded(mask: &Mask) -> Vec<usize> {
    let (width, height) = (i64::from(mask.width()), i64::from(mask.height()));
    let is_set = |x: i64, y: i64| x >= 0 && y >= 0 && mask.get(x as u32, y as u32);
    let is_inside =
        |x: i64, y: i64| (-EROSION..=EROSION).all(|dy| (-EROSION..=EROSION).all(|dx| is_set(x + dx, y + dy)));
    (0..width * height).filter(|i| is_inside(i % width, i / width)).map(|i| i as usize).collect()
}

#[test]
fn masks_and_depth_are_those_of_the_other_renderer() {
    let meshes = load_meshes();
    for (scene_id, frame_count) in [(1, 16), (2, 12)] {
        let frames = frames(scene_id);
        assert_eq!(frames.len(), frame_count);
        let infos: PerImage<Vec<TruthInfo>> = read_json(&frames[0].folder.join("scene_gt_info.json"));
        let (mut least_visible, mut least_whole, mut least_share) = (1.0_f64, 1.0_f64, 1.0_f64);
        let (mut compared, mut largest_error_mm) = (0, 0.0_f64);
        for frame in &frames {
            let raster = frame.rasterized(&frame.camera, &meshes);
            for (index, &(id, pose)) in frame.objects.iter().enumerate() {
                let name = format!("scene {scene_id}, image {}, object {id}", frame.id);
                let stored = frame.stored_mask("mask_visib", index);
                let whole = frame.stored_mask("mask", index);
                let info = &infos[&frame.id][index];
                assert_eq!(
                    (stored.count(), whole.count()),
                    (info.px_count_visib, info.px_count_all),
                    "{name}"
                );
                if stored.count() <= ENOUGH_PIXELS {
                    continue;
                }
                compared += 1;
                let bounds = stored.bounding_box().unwrap();
                let size = [bounds.width as i32, bounds.height as i32];
                assert_eq!([bounds.x0, bounds.y0, size[0], size[1]], info.bbox_visib, "{name}");

                let visible_iou = frame.visible(&raster, id).iou(&stored).unwrap();
                let alone = [RasterItem { mesh: &meshes[&id], camera_from_object: pose, id }];
                let alone = rasterize(&frame.camera, &alone, PixelRegion::of_camera(&frame.camera));
                let whole_iou = alone.mask(id).iou(&whole).unwrap();
                assert!(
                    visible_iou >= LEAST_IOU && whole_iou >= LEAST_IOU,
                    "{name}: {visible_iou} {whole_iou}"
                );

                let errors: Vec<f64> = eroded(&stored)
                    .into_iter()
                    .map(|pixel| (f64::from(raster.depth_mm[pixel]) - frame.depth_mm[pixel]).abs())
                    .collect();
                let within = errors.iter().filter(|&&error| error <= DEPTH_TOLERANCE_MM).count();
                let share = within as f64 / errors.len() as f64;
                assert!(share >= LEAST_DEPTH_SHARE, "{name}: depth agrees at {share}");

                least_visible = least_visible.min(visible_iou);
                least_whole = least_whole.min(whole_iou);
                least_share = least_share.min(share);
                largest_error_mm = errors.iter().copied().fold(largest_error_mm, f64::max);
            }
        }
        eprintln!(
            "scene {scene_id}: {compared} masks; least IoU visible {least_visible:.5}, whole {least_whole:.5}; depth within \
             {DEPTH_TOLERANCE_MM} mm at {least_share:.5} or more, largest difference {largest_error_mm:.3} mm"
        );
        // Nearly all: a test that skips everything proves nothing.
        assert!(compared >= frame_count * 4, "only {compared} masks are large enough");
    }
}

/// The comparison is sharp enough to tell a convention from its neighbour: half a pixel off is worse each way.
#[test]
fn half_a_pixel_would_be_noticed() {
    let meshes = load_meshes();
    let frames = frames(1);
    let mean_iou = |du: f64, dv: f64| {
        let mut ious = Vec::new();
        for frame in frames.iter().step_by(5) {
            let camera = Intrinsics { cx: frame.camera.cx + du, cy: frame.camera.cy + dv, ..frame.camera };
            for (index, &(id, camera_from_object)) in frame.objects.iter().enumerate() {
                let item = [RasterItem { mesh: &meshes[&id], camera_from_object, id }];
                let alone = rasterize(&camera, &item, PixelRegion::of_camera(&camera)).mask(id);
                ious.push(alone.iou(&frame.stored_mask("mask", index)).unwrap());
            }
        }
        ious.iter().sum::<f64>() / ious.len() as f64
    };
    let exact = mean_iou(0.0, 0.0);
    for (du, dv) in [(0.5, 0.0), (-0.5, 0.0), (0.0, 0.5), (0.0, -0.5)] {
        let shifted = mean_iou(du, dv);
        eprintln!("mean IoU {exact:.5}; principal point off by ({du}, {dv}): {shifted:.5}");
        assert!(1.0 - shifted > 5.0 * (1.0 - exact));
    }
}

#[test]
fn the_world_stands_still_where_it_should() {
    for (scene_id, moving) in [(1, None), (2, Some(5))] {
        let frames = frames(scene_id);
        let cameras: PerImage<SceneCamera> = read_json(&frames[0].folder.join("scene_camera.json"));
        let world_from_object = |frame: &Frame, index: usize| {
            let camera = &cameras[&frame.id];
            proper_pose(&camera.rotation, camera.translation_mm).inverse() * frame.objects[index].1
        };
        for (index, &(id, _)) in frames[0].objects.iter().enumerate() {
            let first = world_from_object(&frames[0], index);
            let largest_mm = frames
                .iter()
                .map(|frame| (world_from_object(frame, index).translation_mm - first.translation_mm).length())
                .fold(0.0, f64::max);
            let should_move = moving == Some(id);
            assert!(
                if should_move { largest_mm > 50.0 } else { largest_mm < 1e-9 },
                "object {id}: {largest_mm} mm"
            );
        }
    }
}

#[test]
fn the_cameras_are_not_the_easy_case() {
    let frame = &frames(1)[0];
    let Intrinsics { fx, fy, cx, cy, width, height, .. } = frame.camera;
    assert_eq!((width, height), (960, 720));
    assert!((fx - fy).abs() > 1.0);
    assert!((cx - 479.5).abs() > 5.0 && (cy - 359.5).abs() > 5.0);
}

#[test]
fn models_are_as_their_info_says() {
    for (id, info) in model_infos() {
        let mesh = load_mesh(&format!("obj_{id:06}.ply"));
        let bounds = mesh.bounds();
        let low = DVec3::new(info.min_x, info.min_y, info.min_z);
        let size = DVec3::new(info.size_x, info.size_y, info.size_z);
        assert!((bounds.min - low).length() < 1e-6 && (bounds.size() - size).length() < 1e-6, "object {id}");
        let diameter = largest_distance(mesh.positions_mm());
        assert!((diameter - info.diameter).abs() < 1e-3, "object {id}: {diameter}");
        assert!((2_000..=12_000).contains(&mesh.triangles().len()));
    }
}

#[test]
fn the_glb_is_the_same_car() {
    let (ply, glb) = (load_mesh("obj_000005.ply"), load_mesh("obj_000005.glb"));
    assert_eq!(ply.triangles(), glb.triangles());
    for (of_ply, of_glb) in ply.positions_mm().iter().zip(glb.positions_mm()) {
        // glTF's y points up, our z does.
        let turned = glam::Vec3::new(of_glb.x, -of_glb.z, of_glb.y);
        assert!((turned - *of_ply).length() < 1e-3, "{of_ply} {of_glb}");
    }
}

#[test]
fn symmetries_map_the_meshes_onto_themselves() {
    let infos = model_infos();
    assert!(infos.values().any(|info| info.symmetries_discrete.len() >= 2));
    assert!(infos.values().any(|info| !info.symmetries_continuous.is_empty()));
    for (id, info) in infos {
        let mesh = load_mesh(&format!("obj_{id:06}.ply"));
        let mut symmetries: Vec<Pose> = info.symmetries_discrete.iter().map(pose_of_16).collect();
        for ContinuousSymmetry { axis, offset } in &info.symmetries_continuous {
            // Some angles, among them such as lie between the turned segments.
            symmetries.extend([0.0436, 0.7, 1.9, 3.3, 4.1, 5.9].map(|angle: f64| {
                let rotation = DMat3::from_axis_angle(DVec3::from_array(*axis), angle);
                Pose::rotation_about(DVec3::from_array(*offset), rotation)
            }));
        }
        let worst = symmetries.iter().map(|symmetry| worst_distance(&mesh, symmetry)).fold(0.0, f64::max);
        if !symmetries.is_empty() {
            eprintln!(
                "object {id}: {} symmetries, {worst:.4} mm of {:.1} mm",
                symmetries.len(),
                info.diameter
            );
        }
        assert!(worst < 0.01 * info.diameter, "object {id}: {worst} mm");
    }
}

fn pose_of_16(rows: &[f64; 16]) -> Pose {
    let rows = [0, 4, 8, 12].map(|start| [0, 1, 2, 3].map(|column| rows[start + column]));
    Pose::from_rows(&rows).unwrap().0
}

/// The largest distance from a moved vertex to the nearest unmoved one.
fn worst_distance(mesh: &Mesh, symmetry: &Pose) -> f64 {
    let positions = mesh.positions_mm();
    let nearest = |point: glam::Vec3| {
        positions.iter().map(|position| position.distance_squared(point)).fold(f32::INFINITY, f32::min)
    };
    let moved = positions.iter().map(|position| symmetry.transform_point(position.as_dvec3()).as_vec3());
    f64::from(moved.map(nearest).fold(0.0, f32::max)).sqrt()
}

fn largest_distance(positions: &[glam::Vec3]) -> f64 {
    let farthest = |point: &glam::Vec3| {
        positions.iter().map(|position| position.distance_squared(*point)).fold(0.0, f32::max)
    };
    f64::from(positions.iter().map(farthest).fold(0.0, f32::max)).sqrt()
}

#[test]
fn the_example_opens_with_one_object_posed_and_one_to_do() {
    let bytes = fs::read(demo_folder().join("example.zip")).unwrap();
    assert!((bytes.len() as u64) < MAX_EXAMPLE_BYTES, "{} bytes", bytes.len());
    let session = open_example(&bytes);
    let scene = session.scene();
    assert_eq!((scene.photos.len(), scene.objects.len()), (1, 2));
    let photo = &scene.photos[0];

    let in_state = |state| only_in_state(scene, state);
    let (posed, pose) = in_state(AnnotationState::Posed);
    let (waiting, start) = in_state(AnnotationState::Untouched);
    let truth = &frames(1)[6];
    assert_eq!(photo.camera.k_rows(), truth.camera.k_rows());
    let (_, true_pose) = truth.objects.iter().find(|(id, _)| *id == 1).unwrap();
    assert_eq!(pose, *true_pose, "{}", posed.name);
    let expected = untouched_pose(&photo.camera, &waiting.mesh.mesh);
    assert_eq!(start.rotation, DMat3::IDENTITY);
    assert!((start.translation_mm - expected.translation_mm).length() < 1e-3, "{start:?}, not {expected:?}");
}

fn open_example(bytes: &[u8]) -> Session {
    let workspace = read_workspace(bytes).unwrap();
    assert_eq!(workspace.document.name, "Example");
    let of_kind = |kind| {
        workspace
            .files
            .iter()
            .filter(move |entry: &&FileWithCompanions| classify(&entry.file.name, &entry.file.bytes) == kind)
    };
    let opening = Opening {
        photos: of_kind(pinpose::formats::FileKind::Photo)
            .map(|entry| read_photo(&entry.file).unwrap().0.into())
            .collect(),
        meshes: of_kind(pinpose::formats::FileKind::Mesh)
            .map(|entry| {
                let (mesh, warnings) = read_mesh_with(&entry.file, &entry.companions).unwrap();
                assert_eq!(warnings, Vec::<String>::new());
                mesh.into()
            })
            .collect(),
        document: workspace.document.clone(),
        restored: true,
    };
    let mut session = Session::default();
    session.apply(Command::Open(Box::new(opening)), crate::support::NOW_MS).unwrap();
    session
}

fn only_in_state(scene: &Scene, state: AnnotationState) -> (&Object, Pose) {
    let mut found = scene.objects_in(scene.photos[0].id).filter(|(_, annotation)| annotation.state == state);
    let (object, annotation) = found.next().unwrap();
    assert!(found.next().is_none());
    (object, annotation.camera_from_object)
}

#[test]
fn the_folder_is_small() {
    let study: u64 = ["study.zip", "study_truth.json"]
        .iter()
        .map(|name| demo_folder().join(name).metadata().unwrap().len())
        .sum();
    let bytes = folder_bytes(&demo_folder()) - study;
    eprintln!("examples/demo: {bytes} bytes, and {study} of the example study");
    assert!(bytes <= MAX_FOLDER_BYTES, "{bytes} bytes");
    assert!(study <= MAX_STUDY_BYTES, "{study} bytes");
}

/// Python's compiled leftovers are not counted: they are never checked in.
fn folder_bytes(folder: &Path) -> u64 {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let counted = entries.filter(|path| !path.ends_with("__pycache__"));
    counted.map(|path| if path.is_dir() { folder_bytes(&path) } else { path.metadata().unwrap().len() }).sum()
}
