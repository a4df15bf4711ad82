use super::*;
use crate::formats::dataset::{Contents, Dataset};
use crate::formats::{FileKey, Incoming};

/// Opens the files of a listing whose contents matter; all others are there by name.
fn opened(name: &str, names: &[&str], texts: &[(&str, &str)], chosen: &[usize]) -> (Recognised, Dataset) {
    let all = names.iter().chain(texts.iter().map(|(path, _)| path));
    let listing = Arc::new(Listing::new(name, all.map(|path| ((*path).to_owned(), 10))).unwrap());
    let recognised = super::super::recognise(&listing).unwrap();
    assert_eq!(recognised.kind, DatasetKind::Bop);
    let needed = recognised.needed(chosen);
    let read = texts.iter().filter(|(path, _)| needed.iter().any(|needed| needed == path));
    let contents: Contents =
        read.map(|(path, text)| ((*path).to_owned(), Arc::from(text.as_bytes()))).collect();
    let dataset = recognised.interpret(chosen, &contents).unwrap();
    (recognised, dataset)
}

const GT: &str = r#"{"3": [{"cam_R_m2c": [1,0,0,0,1,0,0,0,1], "cam_t_m2c": [0,0,700], "obj_id": 5},
    {"cam_R_m2c": [1,0,0,0,1,0,0,0,1], "cam_t_m2c": [0,0,800], "obj_id": 5},
    {"cam_R_m2c": [1,0,0,0,1,0,0,0,1], "cam_t_m2c": [0,0,900], "obj_id": 7}],
    "9": [{"cam_R_m2c": [1,0,0,0,1,0,0,0,1], "cam_t_m2c": [0,0,700], "obj_id": 5}]}"#;
const CAMERAS: &str = r#"{"3": {"cam_K": [500,0,320,0,501,240,0,0,1], "depth_scale": 0.1}}"#;

fn total_poses(dataset: &Dataset) -> usize {
    dataset.poses.iter().map(Incoming::pose_count).sum()
}

#[test]
fn a_whole_data_set_opens() {
    let names = [
        "lm/test/000002/rgb/000003.png",
        "lm/test/000002/rgb/000004.png",
        "lm/test/000002/depth/000003.png",
        "lm/test/000002/mask/000003_000000.png",
        "lm/test/000002/mask_visib/000003_000000.png",
        "lm/test/000002/mask_visib/000003_000001.png",
        "lm/test/000002/mask_visib/000003_000002.png",
        "lm/test/000003/gray/000000.tif",
        "lm/models/obj_000005.ply",
        "lm/models/obj_000005.png",
        "lm/models/obj_000006.ply",
        "lm/models_eval/obj_000005.ply",
    ];
    let info =
        r#"{"5": {"diameter": 1, "symmetries_continuous": [{"axis": [0, 0, 1], "offset": [0, 0, 0]}]}}"#;
    let texts = [
        ("lm/test/000002/scene_gt.json", GT),
        ("lm/test/000002/scene_camera.json", CAMERAS),
        ("lm/models/models_info.json", info),
    ];
    let (recognised, dataset) = opened("lm", &names, &texts, &[0]);
    let labels: Vec<&str> = recognised.choices.iter().map(|choice| choice.label.as_str()).collect();
    assert_eq!(labels, ["test / 000002", "test / 000003"]);
    assert_eq!((recognised.choices[0].photos, recognised.choices[0].bytes), (2, 20));

    let photo = &dataset.photos[0];
    assert_eq!(photo.camera.as_ref().unwrap().k[1], [0.0, 501.0, 240.0]);
    assert_eq!(photo.depth.as_ref().unwrap().mm_per_unit, 0.1);
    let masks: Vec<_> = photo.masks.iter().map(|mask| (mask.mesh, mask.instance)).collect();
    assert_eq!(masks, [(Some(0), 0), (Some(0), 1), (None, 0)]);
    assert!(photo.masks[0].path.contains("mask_visib"));
    assert_eq!(dataset.meshes.len(), 1, "obj_000006 is in no photo");
    assert_eq!(dataset.meshes[0].symmetries.continuous.len(), 1);
    assert_eq!(dataset.meshes[0].companions, ["lm/models/obj_000005.png"]);

    let poses = &dataset.poses[0];
    assert_eq!(poses.file_name, "scene_gt.json");
    assert_eq!(poses.photos[0].key, FileKey::Path("lm/test/000002/rgb/000003.png".to_owned()));
    let keys: Vec<&FileKey> = poses.objects.iter().map(|object| &object.key).collect();
    let mesh = FileKey::Path("lm/models/obj_000005.ply".to_owned());
    assert_eq!(keys, [&mesh, &mesh, &FileKey::BopObject(7)]);
    let missing = dataset.missing.join("\n");
    assert!(missing.contains("obj_000007") && missing.contains("no camera for 1 photo"), "{missing}");
    assert!(missing.contains("the photos of 1 image that have poses"), "{missing}");
}

#[test]
fn sensors_are_told_apart_by_name() {
    let names = [
        "1/rgb_left/000003.png",
        "1/rgb_right/000003.png",
        "1/rgb_right/000009.png",
        "1/depth_right/000003.png",
        "1/scene_gt_coco_left.json",
        "1/scene_gt_info_left.json",
    ];
    let texts =
        [("1/scene_gt_left.json", GT), ("1/scene_gt_right.json", GT), ("1/scene_camera_right.json", CAMERAS)];
    let (recognised, left) = opened("1", &names, &texts, &[0]);
    assert_eq!(recognised.choices[1].label, "1 / rgb_right");
    assert_eq!((left.photos.len(), total_poses(&left)), (1, 3));
    assert!(left.photos[0].camera.is_none() && left.photos[0].depth.is_none());
    let (_, right) = opened("1", &names, &texts, &[1]);
    assert_eq!((right.photos.len(), total_poses(&right)), (2, 4));
    assert!(right.photos[0].camera.is_some() && right.photos[0].depth.is_some());
    let (_, both) = opened("1", &names, &texts, &[0, 1]);
    assert_eq!((both.photos.len(), total_poses(&both)), (3, 7));
}

#[test]
fn a_scene_folder_by_itself_and_what_it_lacks() {
    let (recognised, dataset) = opened("000002", &["rgb/000003.jpg"], &[("scene_gt.json", GT)], &[0]);
    assert_eq!(recognised.choices[0].label, "000002");
    assert_eq!(total_poses(&dataset), 3);
    assert_eq!(dataset.poses[0].objects[0].key, FileKey::BopObject(5));
    let missing = dataset.missing.join("\n");
    for what in ["scene_camera.json", "scene_gt_info.json", "depth maps", "masks", "obj_000005, obj_000007"] {
        assert!(missing.contains(what), "{what}: {missing}");
    }
    // Photos alone are something to annotate.
    let names = ["rgb/000003.jpg", "models/obj_000001.ply"];
    let (_, photos) = opened("000002", &names, &[], &[0]);
    assert_eq!((photos.photos.len(), photos.meshes.len(), photos.poses.len()), (1, 1, 0));
}

#[test]
fn the_camera_of_the_data_set_stands_in_for_a_scene_s_own() {
    let camera =
        r#"{"fx": 500, "fy": 501, "cx": 320, "cy": 240, "width": 640, "height": 480, "depth_scale": 0.5}"#;
    let names = ["a/test/000001/rgb/000003.png", "a/test/000001/depth/000003.png", "a/models/obj_000001.ply"];
    let (_, dataset) = opened("a", &names, &[("a/camera.json", camera)], &[0]);
    let photo = &dataset.photos[0];
    assert_eq!((photo.camera.as_ref().unwrap().k[1][1], photo.camera.as_ref().unwrap().size), (501.0, None));
    assert_eq!(photo.depth.as_ref().unwrap().mm_per_unit, 0.5);
    assert!(dataset.guessed.join("\n").contains("a/camera.json"));
}

#[test]
fn repacked_linemod_is_read_from_yaml() {
    let gt = "3:\n- cam_R_m2c: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n  cam_t_m2c: [0, 0, 700]\n  obj_bb: [1, 2, 3, 4]\n  obj_id: 1\n";
    let info = "3:\n  cam_K: [572.4114, 0, 325.2611, 0, 573.57043, 242.04899, 0, 0, 1]\n  depth_scale: 1.0\n";
    let names = ["l/data/01/rgb/0003.png", "l/data/01/mask/0003.png", "l/models/obj_01.ply"];
    let texts = [
        ("l/data/01/gt.yml", gt),
        ("l/data/01/info.yml", info),
        ("l/models/models_info.yml", "1: {diameter: 1}\n"),
    ];
    let (_, dataset) = opened("l", &names, &texts, &[0]);
    assert_eq!((total_poses(&dataset), dataset.meshes.len()), (1, 1));
    assert_eq!(dataset.photos[0].camera.as_ref().unwrap().k[0][0], 572.4114);
    assert_eq!(dataset.photos[0].masks[0].mesh, Some(0));
}

#[test]
fn broken_files_are_missed_in_words_and_the_rest_opens() {
    let names = ["1/rgb/000003.png", "models/obj_000005.ply"];
    let texts = [
        ("1/scene_gt.json", &GT[..100]),
        ("1/scene_camera.json", "{\"3\": {\"cam_K\": [1, 2]}}"),
        ("models/models_info.json", "[]"),
    ];
    let (_, dataset) = opened("a", &names, &texts, &[0]);
    let missing = dataset.missing.join("\n");
    for what in ["1/scene_gt.json: line", "1/scene_camera.json: line 1", "models/models_info.json: line 1"] {
        assert!(missing.contains(what), "{what}: {missing}");
    }
    assert_eq!((dataset.photos.len(), dataset.meshes.len()), (1, 1));
}
