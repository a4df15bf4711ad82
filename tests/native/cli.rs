//! The command line as a user runs it.

use std::path::PathBuf;

use serde_json::Value;

use crate::support::{CAMERA_JSON, box_mesh, data_folder, empty_folder, flat_photo, pinpose};

/// A photo, a mesh, a camera and a pose in a folder.
fn small_folder(name: &str) -> PathBuf {
    let folder = empty_folder(name);
    for file in [flat_photo("photo.png", 640, 480), box_mesh("box.obj")] {
        std::fs::write(folder.join(file.name), &file.bytes).unwrap();
    }
    let truth = format!("{CAMERA_JSON}\nbox <-> photo\n1 0 0 5\n0 1 0 6\n0 0 1 700\n0 0 0 1\n");
    std::fs::write(folder.join("truth.txt"), truth).unwrap();
    folder
}

#[test]
fn inspect_says_what_files_are() {
    let folder = small_folder("inspect");
    let paths = ["photo.png", "box.obj", "truth.txt"].map(|name| folder.join(name).display().to_string());
    let output = pinpose(&["inspect", &paths[0], &paths[1], &paths[2], "--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found[0]["content"]["width"], 640);
    assert_eq!(found[1]["content"]["triangles"], 12);
    assert_eq!(found[1]["content"]["size_mm"], serde_json::json!([80.0, 60.0, 40.0]));
    assert_eq!(found[2]["content"]["poses"], 1);
}

#[test]
fn bad_input_is_one_line_per_problem_and_exit_code_1() {
    let folder = empty_folder("bad");
    std::fs::write(folder.join("broken.png"), b"\x89PNG\r\n\x1a\n").unwrap();
    std::fs::write(folder.join("empty.ply"), b"").unwrap();
    let paths = ["broken.png", "empty.ply"].map(|name| folder.join(name).display().to_string());
    let output = pinpose(&["inspect", &paths[0], &paths[1]]);
    assert_eq!(output.status.code(), Some(1));
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(stderr.lines().count(), 2, "{stderr}");
    assert!(stderr.contains("broken.png") && stderr.contains("empty.ply: the file is empty"), "{stderr}");
    assert_eq!(pinpose(&["inspect"]).status.code(), Some(2));
    assert_eq!(pinpose(&["frobnicate"]).status.code(), Some(2));
    assert_eq!(pinpose(&["convert", "a", "b.docx"]).status.code(), Some(2));
}

#[test]
fn convert_goes_through_a_workspace_without_loss() {
    let folder = small_folder("convert");
    let path = |name: &str| folder.join(name).display().to_string();
    let run = |arguments: &[&str]| {
        let output = pinpose(arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    run(&["convert", &path("photo.png"), &path("box.obj"), &path("truth.txt"), &path("scene.zip")]);
    run(&["convert", &path("scene.zip"), &path("poses.json")]);
    run(&["convert", &path("photo.png"), &path("box.obj"), &path("poses.json"), &path("again.json")]);
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let poses = |text: &str| serde_json::from_str::<Value>(text).unwrap()["photos"][0]["poses"].clone();
    assert_eq!(poses(&read("poses.json")), poses(&read("again.json")));
    assert_eq!(poses(&read("poses.json"))[0]["t"], serde_json::json!([5.0, 6.0, 700.0]));
}

#[test]
fn convert_writes_folders_archives_and_single_files() {
    let folder = small_folder("convert-to");
    let path = |name: &str| folder.join(name).display().to_string();
    let inputs = ["photo.png", "box.obj", "truth.txt"].map(path);
    let run = |arguments: &[&str]| {
        let inputs = inputs.iter().map(String::as_str);
        let output = pinpose(
            &["convert"].into_iter().chain(inputs).chain(arguments.iter().copied()).collect::<Vec<_>>(),
        );
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    };
    run(&[&path("out"), "--to", "bop,npy", "--axes", "opengl", "--unit", "m", "--photo", "photo"]);
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let truth: Value = serde_json::from_str(&read("out/bop/test/000001/scene_gt.json")).unwrap();
    assert_eq!(truth["0"][0]["cam_t_m2c"], serde_json::json!([5.0, 6.0, 700.0]), "BOP has one convention");
    assert!(folder.join("out/npy/photo-box-camera_from_object_opengl_m.npy").is_file());
    let poses: Value = serde_json::from_str(&read("out/poses.json")).unwrap();
    assert_eq!(poses["photos"][0]["poses"][0]["matrix"][2][3], -0.7);

    run(&[&path("out.zip"), "--to", "csv,meshes"]);
    let archive = zip::ZipArchive::new(std::fs::File::open(folder.join("out.zip")).unwrap()).unwrap();
    let names: Vec<String> = archive.file_names().map(|name| name.unwrap().into_owned()).collect();
    assert!(
        names.contains(&"poses.csv".to_owned()) && names.contains(&"meshes/box.ply".to_owned()),
        "{names:?}"
    );
    run(&[&path("poses.csv")]);
    assert_eq!(read("poses.csv").lines().count(), 2);

    let status = |arguments: &[&str]| pinpose(&[&["convert", &inputs[0]], arguments].concat()).status.code();
    assert_eq!(status(&[&path("out"), "--to", "docx"]), Some(2));
    assert_eq!(status(&[&path("out"), "--to", "bop", "--axes", "up"]), Some(2));
    assert_eq!(status(&[&path("out"), "--to", "bop", "--photo", "nowhere"]), Some(1));
}

#[test]
fn render_draws_masks_and_overlays_of_linemod() {
    let (Some(linemod), Some(_)) = (data_folder("linemod10"), crate::support::renderer()) else { return };
    let out = empty_folder("render");
    let path = |name: &str| linemod.join(name).display().to_string();
    let files = [path("000019.png"), path("obj_000001.ply"), path("groud_truth.txt")];
    for kind in ["overlay", "mask", "depth"] {
        let output = pinpose(&[
            "render",
            &files[0],
            &files[1],
            &files[2],
            "--out",
            &out.display().to_string(),
            "--kind",
            kind,
        ]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let poses = out.join("out").display().to_string();
    let output = pinpose(&["convert", &files[0], &files[1], &files[2], &poses, "--to", "overlays"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let bytes = |name: &str| std::fs::read(out.join(name)).unwrap();
    assert!(bytes("out/overlays/000019.png") == bytes("000019_overlay.png"), "the same picture either way");
    let overlay = image::open(out.join("000019_overlay.png")).unwrap().into_rgb8();
    let photo = image::open(linemod.join("000019.png")).unwrap().into_rgb8();
    assert_eq!(overlay.dimensions(), (640, 480));
    // Away from the object the photo is not touched by a single bit.
    assert_eq!(overlay.get_pixel(400, 400), photo.get_pixel(400, 400));
    assert_ne!(overlay.get_pixel(220, 180), photo.get_pixel(220, 180));
    let mask = image::open(out.join("000019_obj_000001_mask.png")).unwrap().into_luma8();
    let depth = image::open(out.join("000019_depth.png")).unwrap().into_luma16();
    assert_eq!(mask.get_pixel(220, 180).0, [255]);
    // The object is about a metre away; depth is in tenths of a millimetre.
    assert!((9_000..11_000).contains(&depth.get_pixel(220, 180).0[0]));
    assert_eq!(depth.get_pixel(400, 400).0, [0]);
}

#[test]
fn pins_become_a_pose_with_its_residuals_and_covariance() {
    let folder = empty_folder("pins");
    let path = folder.join("pins.json");
    // The pose is a turn of a quarter about z, 700 mm away; pixels follow from K [R|t] by hand.
    let pins =
        [[60.0, 0.0, 0.0], [0.0, 60.0, 0.0], [0.0, 0.0, 60.0], [60.0, 60.0, 30.0], [-60.0, -40.0, 10.0]].map(
            |[x, y, z]: [f64; 3]| {
                let pixel = [520.5 * -y / (700.0 + z) + 301.75, 533.25 * x / (700.0 + z) + 222.5];
                serde_json::json!({"point": [x, y, z], "pixel": pixel})
            },
        );
    let mut input: Value = serde_json::from_str(CAMERA_JSON).unwrap();
    input["pins"] = Value::from(pins.to_vec());
    std::fs::write(&path, input.to_string()).unwrap();
    let output = pinpose(&["pins", &path.display().to_string()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    let expected = [[0.0, -1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 700.0]];
    for (row, numbers) in expected.iter().enumerate() {
        for (column, number) in numbers.iter().enumerate() {
            let found = answer["pose"][row][column].as_f64().unwrap();
            // The iteration ends at a ten-millionth of a pixel.
            assert!((found - number).abs() < 1e-4, "{answer:#}");
        }
    }
    assert!(answer["rms_px"].as_f64().unwrap() < 1e-5);
    assert!(answer["covariance"][5][5].as_f64().unwrap() > 0.0);

    let refused = |change: &dyn Fn(&mut Value), expected: &str| {
        let mut changed = input.clone();
        change(&mut changed);
        std::fs::write(&path, changed.to_string()).unwrap();
        let output = pinpose(&["pins", &path.display().to_string()]);
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!((output.status.code(), stderr.lines().count()), (Some(1), 1), "{stderr}");
        assert!(stderr.contains("pins.json") && stderr.contains(expected), "{stderr}");
    };
    refused(&|value| value["pins"][2]["pixel"] = Value::from("left"), "\"pins\"[2].\"pixel\": 2 numbers");
    refused(&|value| value["pins"] = serde_json::json!([]), "start from");
    refused(&|value| value["start"] = serde_json::json!([1, 2]), "\"start\": four rows");
    refused(&|value| value["pins"][0]["weight"] = Value::from(-1), "\"weight\": a positive number");
    refused(&|value| value["estimate_focal"] = Value::from(true), "six or more");
    refused(&|value| value["fx"] = Value::from(0), "focal length");
}

#[test]
fn poses_are_snapped_to_their_photos() {
    let Some(folder) = data_folder("linemod10") else { return };
    let out = empty_folder("snap").join("poses.json");
    let files = ["000019.png", "obj_000001.ply", "groud_truth.txt"].map(|name| folder.join(name));
    let mut arguments: Vec<String> = vec!["snap".to_owned()];
    arguments.extend(files.iter().map(|path| path.display().to_string()));
    arguments.extend(["--json", "--out"].map(str::to_owned));
    arguments.push(out.display().to_string());
    let output = pinpose(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    let mut wide: Vec<&str> = arguments.iter().map(String::as_str).collect();
    wide.push("--wide");
    let wide: Value = serde_json::from_slice(&pinpose(&wide).stdout).unwrap();
    assert_ne!(wide["snaps"], answer["snaps"], "more starts");
    let snap = &answer["snaps"][0];
    assert_eq!((&snap["photo"], &snap["object"]), (&"000019.png".into(), &"obj_000001".into()));
    // From the truth there is nowhere far to go: the benchmark says how far it goes elsewhere.
    assert!(snap["moved_mm"].as_f64().unwrap() < 30.0, "{snap:#}");
    let written: Value = serde_json::from_slice(&std::fs::read(&out).unwrap()).unwrap();
    assert_eq!(written["photos"][0]["poses"][0]["mesh_file"], "obj_000001.ply");
    // What is confirmed stays, and is no reason to give up.
    let mut confirmed = written.clone();
    confirmed["photos"][0]["poses"][0]["state"] = Value::from("confirmed");
    let saved = out.with_file_name("confirmed.json");
    std::fs::write(&saved, confirmed.to_string()).unwrap();
    let saved = saved.display().to_string();
    let images: Vec<String> =
        files[..2].iter().map(|path| path.display().to_string()).chain([saved]).collect();
    let mut arguments = vec!["snap", "--json"];
    arguments.extend(images.iter().map(String::as_str));
    let output = pinpose(&arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    let verdict = answer["snaps"][0]["verdict"].as_str().unwrap();
    assert!(verdict.contains("confirmed"), "{verdict}");
    arguments.extend(["--photo", "000019.png", "--photo", "00019.png"]);
    let mistyped = pinpose(&arguments);
    assert_eq!(mistyped.status.code(), Some(1));
    let said = String::from_utf8_lossy(&mistyped.stderr);
    assert!(said.contains("00019.png: there is no such photo"), "{said}");
    let nothing = pinpose(&["snap", &folder.join("000019.png").display().to_string()]);
    assert_eq!(nothing.status.code(), Some(1));
}
