//! Data sets that nobody on this project made, and our own: recognised, read, and their poses those that others worked out.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use pinpose::formats::dataset::{Contents, Dataset, DatasetKind, Listing, Recognised, recognise};
use pinpose::formats::{Archive, FileKey, NamedFile, PosesAs, read_mesh, read_photo_header};
use pinpose::math::Pose;
use pinpose::session::{Batch, Command, Session};
use serde_json::{Value, json};

use crate::data_folder;
use crate::support::{CAMERA_JSON, NOW_MS, box_mesh, flat_photo};

fn files_below(folder: &Path, prefix: &str, files: &mut Vec<(String, u64)>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let path = format!("{prefix}{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            files_below(&entry.path(), &format!("{path}/"), files);
        } else {
            files.push((path, entry.metadata().unwrap().len()));
        }
    }
}

fn recognised(folder: &Path) -> Recognised {
    let mut files = Vec::new();
    files_below(folder, "", &mut files);
    // The derived truth is what this is compared with.
    files.retain(|(path, _)| path != "case.json");
    let name = folder.file_name().unwrap().to_string_lossy().into_owned();
    recognise(&Arc::new(Listing::new(&name, files).unwrap())).unwrap()
}

fn opened(folder: &Path, chosen: &[usize]) -> Dataset {
    let recognised = recognised(folder);
    let read = |path: String| (path.clone(), Arc::from(std::fs::read(folder.join(path)).unwrap()));
    let contents: Contents = recognised.needed(chosen).into_iter().map(read).collect();
    recognised.interpret(chosen, &contents).unwrap()
}

/// What a drop of the data set would give to a session, with its poses as annotations.
fn session_of(folder: &Path, dataset: &Dataset) -> Session {
    let file = |path: &str| NamedFile {
        name: path.to_owned(),
        bytes: std::fs::read(folder.join(path)).unwrap().into(),
    };
    let mut poses = vec![dataset.setting()];
    poses.extend(dataset.poses.clone());
    let photos = dataset.photos.iter().map(|photo| Arc::new(read_photo_header(&file(&photo.path)).unwrap()));
    let meshes = dataset.meshes.iter().map(|mesh| Arc::new(read_mesh(&file(&mesh.path)).unwrap().0));
    let batch = Batch {
        photos: photos.collect(),
        meshes: meshes.collect(),
        poses,
        poses_as: Some(PosesAs::Annotations),
        ..Batch::default()
    };
    let mut session = Session::default();
    session.apply(Command::Import(Box::new(batch)), NOW_MS).unwrap();
    session
}

fn rows(matrix: &Value) -> [[f64; 4]; 4] {
    std::array::from_fn(|row| std::array::from_fn(|column| matrix[row][column].as_f64().unwrap()))
}

/// The poses of a case by photo and mesh, in its mesh's unit times `mm_per_unit`.
fn truth(folder: &Path, mm_per_unit: f64) -> BTreeMap<(String, String), Pose> {
    let case: Value = serde_json::from_slice(&std::fs::read(folder.join("case.json")).unwrap()).unwrap();
    let mut poses = BTreeMap::new();
    for frame in case["frames"].as_array().unwrap() {
        for object in frame["objects"].as_array().unwrap() {
            let (mut pose, _) = Pose::from_rows(&rows(&object["T_m2c"])).unwrap();
            pose.translation_mm *= mm_per_unit;
            let name = |value: &Value| value.as_str().unwrap().to_owned();
            poses.insert((name(&frame["image"]), name(&object["mesh"])), pose);
        }
    }
    poses
}

/// Every pose of the case is in the session, at its photo and its mesh, and no other is. Both come from the same printed
/// numbers; `rotation_tolerance` is what their ways to a rotation may differ by.
fn assert_poses(session: &Session, truth: &BTreeMap<(String, String), Pose>, tolerance: f64) {
    let scene = session.scene();
    assert_eq!(scene.annotations.len(), truth.len());
    for ((photo, object), annotation) in &scene.annotations {
        let photo = &scene.photo(*photo).unwrap().asset.file_name;
        let mesh = &scene.object(*object).unwrap().mesh.file_name;
        let expected = &truth[&(photo.clone(), mesh.clone())];
        let found = annotation.camera_from_object;
        assert!(
            found.translation_mm.distance(expected.translation_mm) <= tolerance * 1000.0,
            "{photo} {mesh}"
        );
        assert!(found.rotation.abs_diff_eq(expected.rotation, tolerance), "{photo} {mesh}");
    }
}

#[test]
fn lmo16_opens_as_bop() {
    let Some(folder) = data_folder("lmo16") else { return };
    let dataset = opened(&folder, &[0]);
    assert_eq!(dataset.kind, DatasetKind::Bop);
    assert_eq!((dataset.photos.len(), dataset.meshes.len(), dataset.pose_count()), (16, 8, 122));
    let guessed = dataset.guessed.join("\n");
    assert!(guessed.contains("rotations were off orthonormal by up to"), "{guessed}");
    let missing = dataset.missing.join("\n");
    assert!(missing.contains("depth maps") && missing.contains("masks"), "{missing}");
    let session = session_of(&folder, &dataset);
    // Both are projected from the same numbers.
    assert_poses(&session, &truth(&folder, 1.0), 1e-12);
    assert!(
        session
            .scene()
            .photos
            .iter()
            .all(|photo| photo.camera.fx == 572.4114 && photo.camera.cy == 242.04899)
    );
}

#[test]
fn the_demo_scene_opens_with_depth_masks_and_symmetries() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/demo/bop");
    let choices = recognised(&folder).choices;
    let labels: Vec<(&str, usize)> =
        choices.iter().map(|choice| (choice.label.as_str(), choice.photos)).collect();
    assert_eq!(labels, [("test / 000001", 16), ("test / 000002", 12)]);
    let dataset = opened(&folder, &[0]);
    assert_eq!((dataset.photos.len(), dataset.meshes.len(), dataset.pose_count()), (16, 5, 80));
    for photo in &dataset.photos {
        assert_eq!(photo.depth.as_ref().unwrap().mm_per_unit, 1.0);
        assert!(folder.join(&photo.depth.as_ref().unwrap().path).is_file());
        assert_eq!(photo.masks.len(), 5);
        assert!(photo.masks.iter().all(|mask| mask.mesh.is_some() && folder.join(&mask.path).is_file()));
    }
    let symmetries: Vec<(usize, usize)> = dataset
        .meshes
        .iter()
        .map(|mesh| (mesh.symmetries.discrete.len(), mesh.symmetries.continuous.len()))
        .collect();
    assert_eq!(symmetries, [(0, 0), (0, 1), (11, 0), (0, 0), (0, 0)]);
    assert_eq!(dataset.missing, Vec::<String>::new());
    let session = session_of(&folder, &dataset);
    assert_eq!(session.scene().annotations.len(), 80);
    assert_eq!(session.scene().objects[2].symmetries.discrete.len(), 11);
    // Both scenes at once are told apart by their folders.
    let both = opened(&folder, &[0, 1]);
    assert_eq!((both.photos.len(), both.pose_count(), both.meshes.len()), (28, 140, 5));
    assert_eq!(session_of(&folder, &both).scene().annotations.len(), 140);
}

#[test]
fn linemod10_opens_as_a_study_folder() {
    let Some(folder) = data_folder("linemod10") else { return };
    let dataset = opened(&folder, &[0]);
    assert_eq!((dataset.photos.len(), dataset.meshes.len(), dataset.pose_count()), (10, 10, 10));
    let session = session_of(&folder, &dataset);
    assert_poses(&session, &truth(&folder, 1.0), 1e-12);
    assert!(session.scene().photos.iter().all(|photo| photo.camera.fy == 573.57043));
}

#[test]
fn megapose_bbq_opens_with_its_quaternion_and_metres() {
    let Some(folder) = data_folder("megapose_bbq") else { return };
    let dataset = opened(&folder, &[0]);
    assert_eq!(dataset.kind, DatasetKind::MegaPose);
    assert_eq!((dataset.photos.len(), dataset.meshes.len(), dataset.pose_count()), (1, 1, 1));
    assert_eq!(dataset.meshes[0].name, "barbecue-sauce");
    assert!(dataset.meshes[0].companions.contains(&"hope_000002.png".to_owned()));
    let session = session_of(&folder, &dataset);
    // The case's rotation was worked out with other software from the same quaternion.
    assert_poses(&session, &truth(&folder, 1.0), 1e-9);
    assert_eq!(session.scene().photos[0].camera.cx, 319.029052734375);
}

#[test]
fn sixdpat_duck_opens_with_camera_and_pose_by_name() {
    let Some(folder) = data_folder("sixdpat_duck") else { return };
    let dataset = opened(&folder, &[0]);
    let paths: Vec<&str> = dataset.photos.iter().map(|photo| photo.path.as_str()).collect();
    assert_eq!(paths, ["rubberduck.jpg"], "the duck's texture is no photo");
    assert_eq!(dataset.photos[0].camera.as_ref().unwrap().k[1][2], 659.22160257);
    let session = session_of(&folder, &dataset);
    assert_poses(&session, &truth(&folder, 1.0), 1e-9);
}

#[test]
fn visp_rbt14_opens_as_photos_meshes_and_a_camera() {
    let Some(folder) = data_folder("visp_rbt14") else { return };
    let dataset = opened(&folder, &[0]);
    assert_eq!((dataset.photos.len(), dataset.meshes.len()), (14, 2));
    assert!(dataset.photos.iter().all(|photo| photo.camera.as_ref().unwrap().k[0][0] == 607.178466796875));
}

#[test]
fn a_zipped_data_set_is_the_folder() {
    use std::io::Write;
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/demo/bop");
    let mut files = Vec::new();
    files_below(&folder, "demo/", &mut files);
    let mut writer = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (path, _) in files.iter().filter(|(path, _)| !path.contains("test/000002/")) {
        writer.start_file(path, zip::write::SimpleFileOptions::default()).unwrap();
        writer.write_all(&std::fs::read(folder.join(path.strip_prefix("demo/").unwrap())).unwrap()).unwrap();
    }
    let bytes = writer.finish().unwrap().into_inner();
    let mut archive = Archive::open(bytes.into()).unwrap();
    let listing = Arc::new(archive.listing("demo").unwrap());
    let recognised = recognise(&listing).unwrap();
    let contents: Contents = recognised
        .needed(&[0])
        .into_iter()
        .map(|path| (path.clone(), archive.read(&path).unwrap()))
        .collect();
    let zipped = recognised.interpret(&[0], &contents).unwrap();
    let from_folder = opened(&folder, &[0]);
    assert_eq!((zipped.pose_count(), zipped.meshes.len()), (80, 5));
    let poses = |dataset: &Dataset| -> Vec<DVec3> {
        let photos = dataset.poses[0].photos.iter().flat_map(|photo| &photo.poses);
        photos.map(|pose| pose.camera_from_object.translation_mm).collect()
    };
    assert_eq!(poses(&zipped), poses(&from_folder));
    let photo = zipped.photos[3].path.clone();
    assert_eq!(zipped.poses[0].photos[3].key, FileKey::Path(photo.clone()));
    assert!(archive.read(&photo).unwrap().starts_with(&[0xff, 0xd8]));
}

/// A scene of a thousand photos with twenty objects each is listed and read in a moment: nothing is decoded, and nothing
/// grows faster than the scene. The bound leaves an unoptimised build and a busy machine ten times what it takes.
#[test]
fn a_thousand_frames_take_a_moment() {
    let mut names = Vec::new();
    let (mut poses, mut cameras) = (serde_json::Map::new(), serde_json::Map::new());
    let identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    for image in 0..1000 {
        names.push(format!("train/000001/rgb/{image:06}.jpg"));
        names.push(format!("train/000001/depth/{image:06}.png"));
        names.extend((0..20).map(|pose| format!("train/000001/mask_visib/{image:06}_{pose:06}.png")));
        let pose = |id: u32| json!({"cam_R_m2c": identity, "cam_t_m2c": [0.0, 0.0, image], "obj_id": id});
        poses.insert(image.to_string(), (1..=20).map(pose).collect());
        cameras.insert(
            image.to_string(),
            json!({"cam_K": [500, 0, 320, 0, 500, 240, 0, 0, 1], "depth_scale": 1}),
        );
    }
    names.extend((1..=20).map(|id| format!("models/obj_{id:06}.ply")));
    let texts = [("scene_gt.json", poses), ("scene_camera.json", cameras)].map(|(name, content)| {
        (format!("train/000001/{name}"), Arc::<[u8]>::from(Value::Object(content).to_string().into_bytes()))
    });
    names.extend(texts.iter().map(|(path, _)| path.clone()));
    let photo = std::fs::read(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/demo/bop/test/000001/rgb/000000.jpg"),
    );
    let photo: Arc<[u8]> = photo.unwrap().into();

    let start = std::time::Instant::now();
    let listing = Arc::new(Listing::new("big", names.into_iter().map(|path| (path, 10))).unwrap());
    let recognised = recognise(&listing).unwrap();
    assert_eq!(recognised.needed(&[0]).len(), 2);
    let dataset = recognised.interpret(&[0], &Contents::from(texts)).unwrap();
    let interpreted = start.elapsed();
    for photo_of_set in &dataset.photos {
        read_photo_header(&NamedFile { name: photo_of_set.path.clone(), bytes: photo.clone() }).unwrap();
    }
    let all = start.elapsed();
    println!(
        "1,000 frames, 20,000 poses and masks: listed and read in {interpreted:.2?}, with photos' headers in {all:.2?}"
    );
    assert_eq!((dataset.photos.len(), dataset.pose_count(), dataset.meshes.len()), (1000, 20_000, 20));
    assert!(dataset.photos.iter().all(|photo| photo.masks.len() == 20 && photo.depth.is_some()));
    assert!(all.as_secs_f64() < 10.0, "{all:?}");
}

fn pinpose(arguments: &[&str]) -> std::process::Output {
    std::process::Command::new(env!("CARGO_BIN_EXE_pinpose")).args(arguments).output().unwrap()
}

#[test]
fn inspect_tells_what_a_folder_holds() {
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/demo/bop");
    let inspect = |folder: &Path| -> Value {
        let output = pinpose(&["inspect", &folder.display().to_string(), "--json"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice::<Value>(&output.stdout).unwrap()[0].clone()
    };
    let whole = inspect(&demo);
    assert_eq!((&whole["kind"], &whole["content"]["photos"]), (&"BOP data set".into(), &28.into()));
    assert_eq!(whole["content"]["scenes"][1]["name"], "test / 000002");
    // A scene's folder by itself: its meshes are found where its data set has them.
    let scene = inspect(&demo.join("test/000001"));
    assert_eq!((&scene["content"]["photos"], &scene["content"]["poses"]), (&16.into(), &80.into()));
    assert_eq!(scene["content"]["meshes"].as_array().unwrap().len(), 5);
    assert_eq!(scene["missing"], json!([]));
    let plain = pinpose(&["inspect", &demo.display().to_string()]).stdout;
    let plain = String::from_utf8(plain).unwrap();
    assert!(
        plain.contains("  scene: test / 000002, 12 photos\n") && plain.contains("  found: 140 poses"),
        "{plain}"
    );
}

#[test]
fn render_opens_one_scene_and_asks_which_of_several() {
    let demo = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/demo/bop");
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("render-data-set");
    std::fs::remove_dir_all(&out).ok();
    let out_text = out.display().to_string();
    let run = |folder: &Path| {
        pinpose(&["render", &folder.display().to_string(), "--kind", "mask", "--out", &out_text])
    };
    let several = run(&demo);
    assert_eq!(several.status.code(), Some(1));
    let stderr = String::from_utf8_lossy(&several.stderr).into_owned();
    assert!(stderr.contains("several scenes") && stderr.contains("test / 000001"), "{stderr}");
    let one = run(&demo.join("test/000001"));
    assert!(one.status.success(), "{}", String::from_utf8_lossy(&one.stderr));
    assert_eq!(std::fs::read_dir(&out).unwrap().count(), 80);
}

#[test]
fn poses_exported_in_another_convention_are_read_back() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("poses-back");
    std::fs::remove_dir_all(&folder).ok();
    std::fs::create_dir_all(&folder).unwrap();
    for file in [flat_photo("photo.png", 640, 480), box_mesh("box.obj")] {
        std::fs::write(folder.join(file.name), &file.bytes).unwrap();
    }
    let truth = format!("{CAMERA_JSON}\nbox <-> photo\n0 -1 0 5\n1 0 0 6\n0 0 1 700\n0 0 0 1\n");
    std::fs::write(folder.join("truth.txt"), truth).unwrap();
    let path = |name: &str| folder.join(name).display().to_string();
    let run = |arguments: &[&str]| {
        let output = pinpose(arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    let (photo, mesh, out) = (path("photo.png"), path("box.obj"), path("out"));
    let convention = ["--axes", "opengl", "--unit", "m", "--direction", "object_from_camera"];
    let export = ["convert", &photo, &mesh, &path("truth.txt"), &out, "--to", "poses,csv"];
    run(&[&export[..], &convention[..]].concat());
    for name in ["out/poses.json", "out/poses.csv"] {
        run(&["convert", &photo, &mesh, &path(name), &path("again.json")]);
        let again: Value =
            serde_json::from_slice(&std::fs::read(folder.join("again.json")).unwrap()).unwrap();
        let (pose, _) =
            Pose::from_rows(&rows(&again["photos"][0]["poses"][0]["camera_from_object"])).unwrap();
        // There and back are a few products of numbers below 1e3.
        assert!(pose.translation_mm.distance(DVec3::new(5.0, 6.0, 700.0)) < 1e-9, "{name}: {pose:?}");
        assert!((pose.rotation * DVec3::X).distance(DVec3::Y) < 1e-12, "{name}: {pose:?}");
        assert_eq!(again["photos"][0]["K"][0][0], 520.5, "{name}");
    }
}
