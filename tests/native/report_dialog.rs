//! The researcher's dialogs: the report from its files to its tables, results that are kept here, and a rehearsal.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

use egui_kittest::kittest::Queryable as _;
use egui_kittest::{Harness, SnapshotOptions};
use pinpose::formats::NamedFile;
use pinpose::interact::Hands;
use pinpose::platform::{SceneHeading, SceneId, SceneSummary};
use pinpose::session::{Command, CommandId, Effect};
use pinpose::study::pack::StudyFiles;
use pinpose::study::report::{
    Overview, Report, ReportFiles, ReportJob, ReportOptions, gather, mesh_of_study,
};
use pinpose::study::simulate::{Simulation, simulate};
use pinpose::ui::{self, KeptRequest, KeptView, ReportRequest, ReportStage, ReportView, UiState};

use crate::studies::example_pack;
use crate::support::{NOW_MS, quiet_surroundings, small_session};

/// The example with so many simulated participants.
fn rehearsed(participants: usize) -> ReportFiles {
    let pack = example_pack();
    let study = StudyFiles::from_zip(pack.zip().unwrap().into()).unwrap();
    let meshes: BTreeMap<_, _> = study
        .study
        .objects
        .iter()
        .map(|object| {
            let companions: Vec<NamedFile> =
                object.companions.iter().map(|asset| study.file(asset).unwrap()).collect();
            let file = study.file(&object.mesh).unwrap();
            let mesh = mesh_of_study(&file, &companions, &object.mesh_from_file).unwrap();
            (object.id.clone(), Arc::new(mesh))
        })
        .collect();
    let simulation = Simulation { participants, seed: 1, began_ms: NOW_MS };
    let results = simulate(&study.study, &study.sha256, &pack.truth, &meshes, simulation).unwrap();
    let mut files = ReportFiles::of_study(&study, pack.truth);
    files.results = results.into_iter().map(|one| (format!("{}.json", one.participant.id), one)).collect();
    files
}

fn report(mut files: ReportFiles) -> Report {
    while files.read_next_mesh() {}
    ReportJob::new(gather(&files).unwrap(), ReportOptions::default(), false).run()
}

/// The interface with the dialog open, and what it asks for.
fn harness(overview: Overview, done: Option<Report>) -> (Harness<'static>, Rc<RefCell<Vec<ReportRequest>>>) {
    pinpose::platform::keep_preferences_in_memory();
    let requests: Rc<RefCell<Vec<ReportRequest>>> = Rc::default();
    let asked_for = requests.clone();
    let mut state = UiState::default();
    state.report_dialog.show();
    let session = small_session();
    let mut harness = Harness::builder().with_size([1024.0, 720.0]).build_ui(move |ui| {
        ui::apply_theme(ui.ctx());
        let hands = Hands::default();
        let stage = match &done {
            Some(report) => ReportStage::Done(report),
            None => ReportStage::Collecting { problem: None },
        };
        let view = ReportView { overview: &overview, stage };
        let around = ui::Surroundings { report: Some(view), ..quiet_surroundings(&hands) };
        asked_for.borrow_mut().extend(ui::draw(ui, &session, &around, &mut state).report);
    });
    harness.run_steps(4);
    (harness, requests)
}

fn options() -> SnapshotOptions {
    SnapshotOptions::new().threshold(2.0).output_path("tests/snapshots")
}

#[test]
fn nothing_can_be_made_of_nothing() {
    let (mut harness, requests) = harness(Overview::of(&ReportFiles::default()), None);
    harness.get_by_label("No result file yet");
    harness.get_by_label("Make the report").click();
    harness.run_steps(3);
    assert!(requests.borrow().is_empty());
    harness.get_by_label("Add files…").click();
    harness.run_steps(3);
    assert_eq!(*requests.borrow(), [ReportRequest::AddFiles]);
}

#[test]
fn what_was_read_is_shown_and_made_into_a_report() {
    let mut files = rehearsed(3);
    files
        .unreadable
        .push("cut.json: the file ends in the middle: it was cut short; it is left out".to_owned());
    let overview = Overview::of(&files);
    assert!(overview.is_enough());
    let (mut harness, requests) = harness(overview, None);
    for label in ["3 participants, 12 trials, 3 simulated", "2 samples", "2 objects, 2 photos"] {
        harness.get_by_label(label);
    }
    harness.snapshot_options("study-report-files", &options());
    harness.get_by_label("Make the report").click();
    harness.run_steps(3);
    assert_eq!(*requests.borrow(), [ReportRequest::Make(ReportOptions::default())]);
}

#[test]
fn the_reports_tables_are_shown_and_it_is_offered_whole() {
    let files = rehearsed(3);
    let overview = Overview::of(&files);
    let (mut harness, requests) = harness(overview, Some(report(files)));
    harness.get_by_label("Simulated participants: no person made these results");
    harness.get_by_label("Time per annotation");
    harness.snapshot_options("study-report-done", &options());
    for label in ["Open the report", "Download all", "Page only", "Back to the files"] {
        harness.get_by_label(label).click();
        harness.run_steps(3);
    }
    let expected =
        [ReportRequest::Open, ReportRequest::DownloadAll, ReportRequest::DownloadPage, ReportRequest::Back];
    assert_eq!(*requests.borrow(), expected);
}

#[test]
fn a_simulated_report_says_so_everywhere() {
    let report = report(rehearsed(2));
    for (path, text) in report.files("PinPose") {
        let is_raw = path.ends_with(".csv");
        assert!(is_raw || text.contains("Simulated participants"), "{path}");
    }
}

#[test]
fn kept_results_are_listed_and_removed_only_when_that_is_meant() {
    let heading = SceneHeading {
        name: "Ten objects, P1".to_owned(),
        changed_at_ms: NOW_MS - 6e6,
        ..Default::default()
    };
    let id = SceneId::new("study-ten-P1");
    let list = [SceneSummary { id: id.clone(), heading, bytes: 40_000 }];
    let requests: Rc<RefCell<Vec<KeptRequest>>> = Rc::default();
    let asked_for = requests.clone();
    let mut state = UiState::default();
    state.kept_dialog.show();
    let session = small_session();
    let mut harness = Harness::builder().with_size([1024.0, 720.0]).build_ui(move |ui| {
        ui::apply_theme(ui.ctx());
        let hands = Hands::default();
        let view = KeptView { list: Some(&list), now_ms: NOW_MS };
        let around = ui::Surroundings { kept: Some(view), ..quiet_surroundings(&hands) };
        asked_for.borrow_mut().extend(ui::draw(ui, &session, &around, &mut state).kept);
    });
    harness.run_steps(4);
    harness.snapshot_options("study-kept", &options());
    let mut press = |label: &str| {
        harness.get_by_label(label).click();
        harness.run_steps(3);
    };
    press("Remove");
    press("Keep it");
    assert!(requests.borrow().is_empty());
    press("Remove");
    press("Remove it");
    press("Download");
    press("Report");
    let expected =
        [KeptRequest::Remove(id.clone()), KeptRequest::Download(id.clone()), KeptRequest::Report(id)];
    assert_eq!(*requests.borrow(), expected);
}

#[test]
fn the_menu_leads_to_each_of_them() {
    let mut session = small_session();
    for (command, effect) in [
        (CommandId::StudyReport, Effect::ShowStudyReport),
        (CommandId::KeptResults, Effect::ShowKeptResults),
        (CommandId::ChangeStudy, Effect::PickStudy),
    ] {
        assert_eq!(session.apply(Command::Run(command), NOW_MS).unwrap(), [effect]);
    }
}
