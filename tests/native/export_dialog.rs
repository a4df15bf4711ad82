//! The dialog of exports: what it asks for.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::rc::Rc;

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pinpose::formats::Keep;
use pinpose::formats::export::{CameraAxes, ExportOptions, ExportPart, PhotoChoice, PoseDirection};
use pinpose::interact::Hands;
use pinpose::session::{Command, CommandId, Effect, Session};
use pinpose::ui::{self, ExportRequest, UiState};

use crate::support::{NOW_MS, drop_files, flat_photo, quiet_surroundings, small_session};

type Requests = Rc<RefCell<Vec<ExportRequest>>>;

/// The interface with the dialog open, and what it asks for.
fn opened(mut session: Session) -> (Harness<'static>, Requests) {
    let effects = session.apply(Command::Run(CommandId::ExportFiles), NOW_MS).unwrap();
    assert_eq!(effects, [Effect::AskForExport]);
    let requests = Requests::default();
    let asked_for = requests.clone();
    let mut state = UiState::default();
    let mut effects = effects.into_iter();
    let mut harness = Harness::builder().with_size([1024.0, 720.0]).build_ui(move |ui| {
        ui::apply_theme(ui.ctx());
        effects.by_ref().for_each(|effect| assert!(state.take_effect(effect, ui.ctx()).is_none()));
        let hands = Hands::default();
        let asked = ui::draw(ui, &session, &quiet_surroundings(&hands), &mut state);
        asked_for.borrow_mut().extend(asked.export);
    });
    harness.run();
    (harness, requests)
}

fn click(harness: &mut Harness<'_>, label: &str) {
    harness.get_by_label(label).click();
    harness.run();
}

#[test]
fn what_was_chosen_is_asked_for() {
    let session = small_session();
    let photo = session.photo().unwrap().id;
    let (mut harness, requests) = opened(session);
    for label in [
        "PinPose JSON",
        "Poses as CSV",
        "Meshes as PLY",
        "BOP dataset",
        "OpenGL",
        "Camera's pose",
        "The one shown",
        "Untouched and carried poses too",
        "Export",
    ] {
        click(&mut harness, label);
    }
    let options = ExportOptions {
        photos: PhotoChoice::These(BTreeSet::from([photo])),
        keep: Keep::Everything,
        ..ExportOptions::of([ExportPart::Poses, ExportPart::Bop])
    };
    let mut expected = ExportRequest { options, into_folder: false };
    expected.options.convention.axes = CameraAxes::OpenGl;
    expected.options.convention.direction = PoseDirection::ObjectFromCamera;
    assert_eq!(requests.take(), [expected]);
    assert!(harness.query_by_label("Export files").is_none(), "the dialog stays open");
}

#[test]
fn nothing_is_exported_without_a_choice_or_after_cancel() {
    let (mut harness, requests) = opened(small_session());
    for label in ["PinPose JSON", "Poses as JSON", "Poses as CSV", "Meshes as PLY"] {
        click(&mut harness, label);
    }
    click(&mut harness, "Export");
    assert!(requests.take().is_empty(), "there is nothing to export");
    harness.get_by_label("Export files");
    click(&mut harness, "Visible masks");
    click(&mut harness, "Cancel");
    assert!(requests.take().is_empty() && harness.query_by_label("Export files").is_none());
}

#[test]
fn photos_are_chosen_one_by_one() {
    let mut session = small_session();
    let more = (0..4).map(|number| flat_photo(&format!("more-{number}.png"), 64, 48 + number));
    drop_files(&mut session, &more.collect::<Vec<_>>(), None);
    let photos: Vec<_> = session.scene().photos.iter().map(|photo| (photo.id, photo.name.clone())).collect();
    let (mut harness, requests) = opened(session);
    click(&mut harness, "Some");
    click(&mut harness, "Export");
    assert!(requests.take().is_empty(), "no photo is ticked yet");
    for name in ["more-1.png", "more-0.png", "more-1.png", "more-2.png"] {
        let (_, name) =
            photos.iter().find(|(_, known)| known.starts_with(name.trim_end_matches(".png"))).unwrap();
        // The strip of photos shows the name too.
        harness.get_by_role_and_label(Role::CheckBox, name).click();
        harness.run();
    }
    click(&mut harness, "Export");
    let asked = requests.take();
    let ids = |names: [&str; 2]| {
        photos
            .iter()
            .filter(|(_, known)| names.iter().any(|name| known.starts_with(name)))
            .map(|(id, _)| *id)
            .collect()
    };
    assert_eq!(asked[0].options.photos, PhotoChoice::These(ids(["more-0", "more-2"])));
}
