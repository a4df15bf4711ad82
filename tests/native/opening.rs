//! Data sets as the program opens them: a folder or a zip that comes in, the dialog, and the scene that comes of it.

use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui_kittest::kittest::Queryable as _;
use pinpose::app::StartWith;
use pinpose::platform::{FileBytes, PageAnswer, PageCall, PageState};
use serde_json::{Value, json};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use crate::data_folder;
use crate::program::Program;
use crate::support::{box_mesh, flat_photo};

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

fn drop_path(program: &mut Program, path: &Path) {
    program.harness.input_mut().dropped_files.push(Arc::new(Dropped(path.to_owned())));
    program.harness.step();
    program.harness.input_mut().dropped_files.clear();
}

fn start() -> Program {
    Program::start_with(&std::rc::Rc::default(), StartWith::Nothing)
}

/// Waits until the dialog knows what is in the data set.
fn wait_for_dialog(program: &mut Program) {
    program.wait("the dialog asks", |state| state.question == Some("data_set"));
    program.harness.run_steps(3);
}

fn click(program: &mut Program, label: &str) {
    program.harness.get_by_label(label).click();
    program.harness.run_steps(2);
}

/// Opens what the dialog shows, and waits until it is saved.
fn open(program: &mut Program) -> Value {
    click(program, "Open");
    let state = program.wait("it is open", |state| !state.busy && state.saved && state.photo.is_some());
    document(&state)
}

fn document(state: &PageState) -> Value {
    serde_json::from_str(&state.document_json).unwrap()
}

fn count(document: &Value, what: &str) -> usize {
    document[what].as_array().map_or(0, Vec::len)
}

fn pose_count(document: &Value) -> usize {
    document["photos"].as_array().unwrap().iter().map(|photo| count(photo, "poses")).sum()
}

fn mask_count(document: &Value) -> usize {
    document["photos"].as_array().unwrap().iter().map(|photo| count(photo, "masks")).sum()
}

fn notices(program: &mut Program) -> String {
    program.state();
    program.said.join("\n")
}

fn zipped(files: &[(String, Vec<u8>)]) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in files {
        writer.start_file(name.as_str(), SimpleFileOptions::default()).unwrap();
        writer.write_all(content).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

/// A BOP scene of two photos with a box in both, a mask of it in the first, and depth for both.
fn small_bop() -> Vec<(String, Vec<u8>)> {
    let gt =
        |z: f64| json!([{ "obj_id": 1, "cam_R_m2c": [1, 0, 0, 0, 1, 0, 0, 0, 1], "cam_t_m2c": [0, 0, z] }]);
    let camera = json!({ "cam_K": [500, 0, 31.5, 0, 510, 23.5, 0, 0, 1], "depth_scale": 0.5 });
    let mesh = box_mesh("obj_000001.obj").bytes.to_vec();
    let mut depth = Vec::new();
    let map = image::ImageBuffer::<image::Luma<u16>, _>::from_pixel(64, 48, image::Luma([1200]));
    map.write_to(&mut Cursor::new(&mut depth), image::ImageFormat::Png).unwrap();
    let mut mask = Vec::new();
    let white = image::GrayImage::from_pixel(64, 48, image::Luma([255]));
    white.write_to(&mut Cursor::new(&mut mask), image::ImageFormat::Png).unwrap();
    let photo = |number: u8| {
        let mut bytes = flat_photo("", 64, 48).bytes.to_vec();
        // Each another file: bytes after a PNG's end are read by nobody.
        bytes.push(number);
        bytes
    };
    let files = [
        ("test/000001/rgb/000000.png", photo(0)),
        ("test/000001/rgb/000001.png", photo(1)),
        ("test/000001/depth/000000.png", depth.clone()),
        ("test/000001/depth/000001.png", depth),
        ("test/000001/mask_visib/000000_000000.png", mask),
        ("test/000001/scene_gt.json", json!({ "0": gt(600.0), "1": gt(700.0) }).to_string().into_bytes()),
        ("test/000001/scene_camera.json", json!({ "0": camera, "1": camera }).to_string().into_bytes()),
        ("test/000002/rgb/000007.png", photo(7)),
        ("models/obj_000001.obj", mesh),
    ];
    files.map(|(path, bytes)| (path.to_owned(), bytes)).into()
}

/// The files in a folder that is removed in the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str, files: &[(String, Vec<u8>)]) -> Self {
        let root = std::env::temp_dir().join(format!("pinpose-opening-{}", std::process::id())).join(name);
        for (path, content) in files {
            let path = root.join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, content).unwrap();
        }
        Self(root)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).ok();
    }
}

#[test]
fn a_folder_is_shown_before_it_is_opened() {
    let folder = Folder::new("small", &small_bop());
    let mut program = start();
    drop_path(&mut program, &folder.0);
    wait_for_dialog(&mut program);
    program.harness.get_by_label("BOP data set");
    program.harness.get_by_label_contains("2 photos, ");
    assert!(program.state().photo.is_none(), "nothing is opened before the user says so");
    let document = open(&mut program);
    assert_eq!((count(&document, "photos"), count(&document, "objects"), pose_count(&document)), (2, 1, 2));
    assert_eq!(mask_count(&document), 1);
    assert_eq!(document["name"], "small");
    let photo = &document["photos"][1];
    assert_eq!(photo["file"], "test/000001/rgb/000001.png");
    assert_eq!(photo["K"][0][0], 500.0);
    assert_eq!(photo["depth"]["mm_per_unit"], 0.5);
    assert_eq!(photo["poses"][0]["camera_from_object"][2][3], 700.0);
    assert!(program.harness.query_by_label("BOP data set").is_none(), "the dialog stays open");

    program.command("undo");
    assert_eq!(count(&document_of(&mut program), "photos"), 0, "one step");
    program.command("redo");
    assert_eq!(mask_count(&document_of(&mut program)), 1);
}

fn document_of(program: &mut Program) -> Value {
    document(&program.state())
}

#[test]
fn what_is_chosen_is_opened() {
    let folder = Folder::new("chosen", &small_bop());
    let mut program = start();
    drop_path(&mut program, &folder.0);
    wait_for_dialog(&mut program);
    click(&mut program, "test / 000002");
    wait_for_dialog(&mut program);
    click(&mut program, "Reference");
    click(&mut program, "Masks (1)");
    click(&mut program, "Depth maps (2)");
    let document = open(&mut program);
    assert_eq!((count(&document, "photos"), mask_count(&document)), (3, 0));
    assert!(document["photos"][0]["depth"].is_null(), "{}", document["photos"][0]);
    let references = document["references"].as_array().unwrap();
    assert_eq!(references.len(), 1);
    assert_eq!(count(&references[0], "poses"), 2);
    // To compare with a reference there has to be a pose of one's own.
    assert_eq!(pose_count(&document), 1);
    assert_eq!(document["photos"][0]["poses"][0]["state"], "untouched");
}

#[test]
fn poses_can_be_left_out_and_a_part_too() {
    let folder = Folder::new("without", &small_bop());
    let mut program = start();
    drop_path(&mut program, &folder.0);
    wait_for_dialog(&mut program);
    click(&mut program, "test / 000001");
    click(&mut program, "test / 000002");
    wait_for_dialog(&mut program);
    let other = open(&mut program);
    assert_eq!(other["photos"][0]["file"], "test/000002/rgb/000007.png");
    drop_path(&mut program, &folder.0);
    wait_for_dialog(&mut program);
    click(&mut program, "Left out");
    let document = open(&mut program);
    assert_eq!((count(&document, "photos"), pose_count(&document)), (2, 1));
    program.list("each is a scene of its own", |scenes| scenes.len() == 2);
}

#[test]
fn a_zip_is_a_data_set_and_opens_by_itself_where_poses_are_told() {
    let mut files = small_bop();
    files.iter_mut().for_each(|(path, _)| path.insert_str(0, "lab/"));
    let file = FileBytes { name: "lab.zip".to_owned(), bytes: zipped(&files) };
    let mut program = start();
    program.ask(PageCall::Load { files: vec![file.clone()], poses_as: None });
    wait_for_dialog(&mut program);
    click(&mut program, "Cancel");
    assert!(program.state().question.is_none());
    let answer = program.ask(PageCall::Load { files: vec![file], poses_as: Some("annotations".to_owned()) });
    let PageAnswer::Loaded(loaded) = answer else { panic!("{answer:?}") };
    assert_eq!((loaded.files, loaded.problems.as_slice()), (6, [].as_slice()));
    let document = document_of(&mut program);
    assert_eq!((count(&document, "photos"), pose_count(&document), mask_count(&document)), (2, 2, 1));
}

#[test]
fn one_bad_file_is_told_and_the_others_open() {
    let mut files = small_bop();
    for (path, bytes) in &mut files {
        if path.ends_with("rgb/000001.png") || path.ends_with("000000_000000.png") {
            *bytes = b"nothing".to_vec();
        }
    }
    let folder = Folder::new("bad", &files);
    std::fs::remove_file(folder.0.join("test/000001/depth/000000.png")).unwrap();
    let mut program = start();
    drop_path(&mut program, &folder.0);
    wait_for_dialog(&mut program);
    let document = open(&mut program);
    assert_eq!((count(&document, "photos"), pose_count(&document), mask_count(&document)), (1, 1, 0));
    let said = notices(&mut program);
    assert!(said.contains("test/000001/rgb/000001.png: "), "{said}");
    assert!(said.contains("mask_visib/000000_000000.png: "), "{said}");
}

#[test]
fn a_file_that_goes_while_it_is_chosen_is_told() {
    let folder = Folder::new("gone", &small_bop());
    let mut program = start();
    drop_path(&mut program, &folder.0);
    wait_for_dialog(&mut program);
    std::fs::remove_file(folder.0.join("test/000001/rgb/000001.png")).unwrap();
    let document = open(&mut program);
    assert_eq!(count(&document, "photos"), 1);
    let said = notices(&mut program);
    assert!(said.contains("test/000001/rgb/000001.png: ") && said.contains("No such file"), "{said}");
}

#[test]
fn a_broken_zip_and_a_folder_of_nothing_are_told() {
    let whole = zipped(&small_bop());
    let half = FileBytes { name: "half.zip".to_owned(), bytes: whole[..whole.len() / 2].to_vec() };
    let mut program = start();
    program.ask(PageCall::Load { files: vec![half], poses_as: None });
    let said = notices(&mut program);
    assert!(said.contains("half.zip"), "{said}");
    let folder = Folder::new("nothing", &[("src/main.rs".to_owned(), b"fn main() {}".to_vec())]);
    drop_path(&mut program, &folder.0);
    program.wait("it is told", |state| !state.busy);
    let said = notices(&mut program);
    assert!(said.contains("nothing: nothing in it can be opened") && said.contains("BOP"), "{said}");
    assert!(program.state().question.is_none());
}

#[test]
fn a_folder_that_is_no_data_set_is_a_drop_of_its_files() {
    let camera = ("k/camera.json".to_owned(), crate::support::CAMERA_JSON.as_bytes().to_vec());
    let folder = Folder::new("loose", &[camera]);
    let mut program = start();
    program.load(&[flat_photo("photo.png", 640, 480)]);
    drop_path(&mut program, &folder.0);
    program.wait("its camera is taken", |state| !state.busy && state.document_json.contains("533.25"));
}

#[test]
fn opening_can_be_cancelled() {
    let mut files = small_bop();
    let template = files[0].1.clone();
    for number in 100..700_u32 {
        let mut bytes = template.clone();
        bytes.extend(number.to_le_bytes());
        files.push((format!("test/000001/rgb/{number:06}.png"), bytes));
    }
    let folder = Folder::new("cancelled", &files);
    let mut program = start();
    drop_path(&mut program, &folder.0);
    wait_for_dialog(&mut program);
    program.harness.get_by_label("Open").click();
    program.harness.step();
    program.harness.step();
    program.harness.get_by_label("Cancel").click();
    program.harness.run_steps(3);
    let state = program.wait("it is over", |state| !state.busy);
    assert!(state.photo.is_none());
    assert!(
        state.notices.iter().any(|text| text == "Cancelled: cancelled was not opened"),
        "{:?}",
        state.notices
    );

    drop_path(&mut program, &folder.0);
    wait_for_dialog(&mut program);
    let document = open(&mut program);
    assert_eq!(count(&document, "photos"), 602);
    let second = document["photos"][2]["file"].as_str().unwrap().to_owned();
    assert_eq!(second, "test/000001/rgb/000100.png", "in the data set's order");
}

#[test]
fn lmo16_opens_with_its_poses() {
    let Some(folder) = data_folder("lmo16") else { return };
    let mut program = start();
    drop_path(&mut program, &folder);
    wait_for_dialog(&mut program);
    let document = open(&mut program);
    assert_eq!(
        (count(&document, "photos"), count(&document, "objects"), pose_count(&document)),
        (16, 8, 122)
    );
    let said = notices(&mut program);
    assert!(said.contains("lmo16: 16 photos, 8 objects, 122 poses"), "{said}");
}

#[test]
fn linemod10_and_megapose_open() {
    let (Some(linemod), Some(megapose)) = (data_folder("linemod10"), data_folder("megapose_bbq")) else {
        return;
    };
    let mut program = start();
    drop_path(&mut program, &linemod);
    wait_for_dialog(&mut program);
    let document = open(&mut program);
    assert_eq!(
        (count(&document, "photos"), count(&document, "objects"), pose_count(&document)),
        (10, 10, 10)
    );
    drop_path(&mut program, &megapose);
    wait_for_dialog(&mut program);
    program.harness.get_by_label("MegaPose example");
    let document = open(&mut program);
    assert_eq!((count(&document, "photos"), count(&document, "objects")), (1, 1));
    let mesh = &document["objects"][0];
    assert!(mesh["mesh_file"].as_str().unwrap().ends_with("hope_000002.ply"), "{mesh}");
}
