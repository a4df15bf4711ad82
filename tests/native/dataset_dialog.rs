//! The dialog of a data set: what it says, and what it asks for by mouse and by keyboard.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::rc::Rc;
use std::sync::Arc;

use egui::Key;
use egui_kittest::kittest::Queryable as _;
use egui_kittest::{Harness, SnapshotOptions};
use pinpose::formats::PosesAs;
use pinpose::formats::dataset::{Contents, Dataset, Listing, Recognised, recognise};
use pinpose::interact::Hands;
use pinpose::session::Session;
use pinpose::ui::{self, DatasetRequest, DatasetView, Surroundings, UiState};

use crate::support::quiet_surroundings;

type Requests = Rc<RefCell<Vec<DatasetRequest>>>;

/// Of what the dialog shows, what differs between tests.
#[derive(Clone, Default)]
struct Shown {
    chosen: BTreeSet<usize>,
    error: Option<&'static str>,
    progress: Option<(usize, usize)>,
    is_being_read: bool,
}

fn chosen(parts: &[usize]) -> Shown {
    Shown { chosen: parts.iter().copied().collect(), ..Shown::default() }
}

/// Two scenes of a BOP data set with poses, depth and masks.
fn recognised(scenes: usize) -> Recognised {
    let mut files = vec![("models/obj_000001.ply".to_owned(), 10)];
    for scene in 1..=scenes {
        let folder = format!("test/{scene:06}");
        for image in 0..1200 {
            files.push((format!("{folder}/rgb/{image:06}.png"), 400_000));
            files.push((format!("{folder}/depth/{image:06}.png"), 300_000));
        }
        files.push((format!("{folder}/mask_visib/000000_000000.png"), 100));
        files.push((format!("{folder}/scene_gt.json"), 100));
    }
    recognise(&Arc::new(Listing::new("shelf", files).unwrap())).unwrap()
}

fn dataset(recognised: &Recognised, chosen: &BTreeSet<usize>) -> Option<Dataset> {
    let truth = r#"{"0": [{"obj_id": 1, "cam_R_m2c": [1,0,0,0,1,0,0,0,1], "cam_t_m2c": [0,0,600]}]}"#;
    let chosen: Vec<usize> = chosen.iter().copied().collect();
    let truth = |path: String| (path, Arc::from(truth.as_bytes()));
    let needed = recognised.needed(&chosen).into_iter().filter(|path| path.ends_with("scene_gt.json"));
    let contents: Contents = needed.map(truth).collect();
    recognised.interpret(&chosen, &contents).ok()
}

fn harness(scenes: usize, shown: Shown) -> (Harness<'static>, Requests) {
    let requests = Requests::default();
    let asked_for = requests.clone();
    let recognised = recognised(scenes);
    let dataset = dataset(&recognised, &shown.chosen);
    let mut state = UiState::default();
    let session = Session::default();
    let mut harness = Harness::builder().with_size([1024.0, 720.0]).build_ui(move |ui| {
        ui::apply_theme(ui.ctx());
        let hands = Hands::default();
        let read = match shown.error {
            Some(problem) => Some(Err(problem)),
            None => dataset.as_ref().filter(|_| !shown.is_being_read).map(Ok),
        };
        let view = DatasetView {
            recognised: &recognised,
            chosen: &shown.chosen,
            dataset: read,
            poses_as: Some(PosesAs::Annotations),
            with_depth_maps: true,
            with_masks: true,
            progress: shown.progress,
        };
        let around = Surroundings { dataset: Some(view), ..quiet_surroundings(&hands) };
        let asked = ui::draw(ui, &session, &around, &mut state);
        asked_for.borrow_mut().extend(asked.dataset_requests);
    });
    harness.run_steps(4);
    (harness, requests)
}

fn taken(requests: &Requests) -> Vec<DatasetRequest> {
    requests.borrow_mut().drain(..).collect()
}

fn click(harness: &mut Harness<'static>, label: &str) {
    harness.get_by_label(label).click();
    harness.run_steps(2);
}

#[test]
fn parts_are_listed_with_what_is_in_them() {
    let (mut harness, requests) = harness(2, chosen(&[0]));
    harness.get_by_label("shelf");
    harness.get_by_label("BOP data set");
    assert_eq!(harness.query_all_by_label("1,200 photos, 480 MB").count(), 2);
    harness.get_by_label("FOUND");
    harness.get_by_label("MISSING");
    harness.get_by_label("Depth maps (1,200)");
    assert!(harness.query_by_label("All").is_none(), "two parts are ticked by hand");
    click(&mut harness, "test / 000002");
    assert_eq!(taken(&requests), [DatasetRequest::Choose(BTreeSet::from([0, 1]))]);
    click(&mut harness, "test / 000001");
    assert_eq!(taken(&requests), [DatasetRequest::Choose(BTreeSet::new())]);
}

#[test]
fn choices_are_asked_for() {
    let (mut harness, requests) = harness(1, chosen(&[0]));
    for (label, request) in [
        ("Reference", DatasetRequest::PosesAs(Some(PosesAs::Reference))),
        ("Left out", DatasetRequest::PosesAs(None)),
        ("Masks (1)", DatasetRequest::Masks(false)),
        ("Depth maps (1,200)", DatasetRequest::DepthMaps(false)),
        ("Open", DatasetRequest::Open),
        ("Cancel", DatasetRequest::Cancel),
    ] {
        click(&mut harness, label);
        assert_eq!(taken(&requests), [request]);
    }
    click(&mut harness, "Start poses");
    assert_eq!(taken(&requests), [], "they are that already");
}

#[test]
fn the_keyboard_opens_and_cancels() {
    let (mut harness, requests) = harness(1, chosen(&[0]));
    harness.key_press(Key::Enter);
    harness.run_steps(2);
    assert_eq!(taken(&requests), [DatasetRequest::Open]);
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert_eq!(taken(&requests), [DatasetRequest::Cancel]);
    // A focused choice has the keys for itself.
    harness.key_press(Key::Tab);
    harness.run_steps(2);
    harness.key_press(Key::Space);
    harness.run_steps(2);
    assert_ne!(taken(&requests), [DatasetRequest::Open]);
}

#[test]
fn nothing_can_be_opened_before_it_is_known_or_where_it_is_wrong() {
    let reading = Shown { is_being_read: true, ..chosen(&[0]) };
    let wrong = Shown { error: Some("shelf: neither photos nor meshes were found"), ..chosen(&[0]) };
    for (shown, text) in [
        (reading, "Reading what is in it…"),
        (chosen(&[]), "Choose a part."),
        (wrong, "shelf: neither photos nor meshes were found"),
    ] {
        let (mut harness, requests) = harness(3, shown);
        harness.get_by_label(text);
        harness.key_press(Key::Enter);
        harness.run_steps(2);
        click(&mut harness, "Open");
        assert_eq!(taken(&requests), [], "{text}");
    }
}

#[test]
fn many_parts_are_ticked_together() {
    let (mut harness, requests) = harness(40, chosen(&[0]));
    harness.get_by_label("PARTS (1 OF 40)");
    assert!(harness.query_by_label("test / 000040").is_none(), "it is scrolled to");
    click(&mut harness, "All");
    click(&mut harness, "None");
    assert_eq!(
        taken(&requests),
        [DatasetRequest::Choose((0..40).collect()), DatasetRequest::Choose(BTreeSet::new())]
    );
}

#[test]
fn progress_is_shown_and_can_be_cancelled() {
    let shown = Shown { progress: Some((1234, 2400)), ..chosen(&[0]) };
    let (mut harness, requests) = harness(1, shown);
    harness.get_by_label("Reading files: 1,234 of 2,400");
    assert!(harness.query_by_label("Open").is_none());
    click(&mut harness, "Cancel");
    assert_eq!(taken(&requests), [DatasetRequest::Cancel]);
}

#[test]
fn it_looks_as_it_should() {
    let (mut harness, _) = harness(5, chosen(&[0, 1]));
    // Letters differ by a level or two between renderers.
    harness
        .snapshot_options("data-set", &SnapshotOptions::new().threshold(1.5).output_path("tests/snapshots"));
}
