//! Symmetries: found on the example's objects and on real ones, edited, saved, in the panel.

use std::cell::RefCell;
use std::rc::Rc;

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use glam::{DVec3, Vec3};
use pinpose::formats::{Keep, read_mesh};
use pinpose::interact::Hands;
use pinpose::math::Pose;
use pinpose::mesh::{Mesh, MeshData};
use pinpose::scene::{Fold, PoseSource, Symmetries, SymmetryAxis};
use pinpose::session::{Command, CommandId, Effect, ObjectChange, Opening, Session};
use pinpose::solve::symmetry::{FoundSymmetries, FoundSymmetry, find_symmetries};
use pinpose::ui::{self, SymmetryView, UiState};

use crate::data_folder;
use crate::support::{NOW_MS, named_file, quiet_surroundings, small_session};

/// For a look at what was found, with `--no-capture`.
fn words(found: &FoundSymmetries) -> String {
    let one = |found_axis: &FoundSymmetry| {
        let SymmetryAxis { axis, fold, .. } = found_axis.axis;
        format!("{fold} {axis:.2} {:.2} %", 100.0 * found_axis.worst_mm / found.diameter_mm)
    };
    let list = |axes: &[FoundSymmetry]| axes.iter().map(one).collect::<Vec<_>>().join(", ");
    format!("found [{}], nearly [{}]", list(&found.found), list(&found.nearly))
}

#[test]
fn real_objects_have_no_symmetry() {
    let Some(folder) = data_folder("linemod10") else { return };
    for number in [1, 2, 4, 5, 7, 9, 11, 13, 14, 15] {
        let (asset, _) = read_mesh(&named_file(&folder.join(format!("obj_{number:06}.ply")))).unwrap();
        let found = find_symmetries(&asset.mesh);
        println!("{number}: {}", words(&found));
        assert!(found.found.is_empty(), "{number}: {}", words(&found));
    }
}

#[test]
fn the_examples_tin_and_nut_have_the_symmetries_that_they_were_made_with() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/demo/bop/models");
    let folds = [2, 3].map(|number| {
        let (asset, _) = read_mesh(&named_file(&folder.join(format!("obj_{number:06}.ply")))).unwrap();
        let found = find_symmetries(&asset.mesh);
        println!("{number}: {}", words(&found));
        found.found.iter().map(|found| found.axis.fold).collect::<Vec<Fold>>()
    });
    // A tin has a lid at one end; a nut can be turned over.
    assert_eq!(folds, [vec![Fold::Continuous], vec![Fold::Times(6), Fold::Times(2)]]);
}

/// A sphere pressed into a body of five lobes, which can be turned over.
fn lobed(rings: u32, segments: u32) -> Mesh {
    let mut positions_mm = Vec::new();
    for (ring, segment) in (0..=rings).flat_map(|ring| (0..segments).map(move |segment| (ring, segment))) {
        let polar = std::f32::consts::PI * ring as f32 / rings as f32;
        let azimuth = std::f32::consts::TAU * segment as f32 / segments as f32;
        let across = polar.sin() * (50.0 + 8.0 * (5.0 * azimuth).cos() * polar.sin());
        positions_mm.push(Vec3::new(across * azimuth.cos(), across * azimuth.sin(), 30.0 * polar.cos()));
    }
    let vertex = |ring: u32, segment: u32| ring * segments + segment % segments;
    let quad = |(ring, segment): (u32, u32)| {
        let [a, b] = [vertex(ring, segment), vertex(ring, segment + 1)];
        let [c, d] = [vertex(ring + 1, segment), vertex(ring + 1, segment + 1)];
        [[a, c, b], [b, c, d]]
    };
    let quads = (0..rings).flat_map(|ring| (0..segments).map(move |segment| (ring, segment)));
    let triangles = quads.flat_map(quad).collect();
    Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() }).unwrap()
}

#[test]
fn fifty_thousand_faces_take_no_second() {
    let mesh = lobed(160, 160);
    let start = std::time::Instant::now();
    let found = find_symmetries(&mesh);
    let duration = start.elapsed();
    println!("{} faces: {} in {duration:?}", mesh.triangles().len(), words(&found));
    let folds: Vec<Fold> = found.found.iter().map(|found| found.axis.fold).collect();
    assert_eq!(folds, [Fold::Times(5), Fold::Times(2)]);
    // It takes no second in an optimised build; this one is hardly optimised, and the machine may be shared.
    assert!(duration.as_secs_f64() < 10.0, "{duration:?}");
}

/// A can of 50,000 triangles, all of them slivers: a fan in each end, and twice as many around. No axis is a coordinate axis.
fn fine_can() -> Mesh {
    const AROUND: u32 = 12_500;
    let turn = glam::Quat::from_scaled_axis(glam::Vec3::new(0.4, -0.9, 1.3));
    let rim = |z: f32| {
        (0..AROUND).map(move |number| {
            let (sin, cos) = (number as f32 / AROUND as f32 * std::f32::consts::TAU).sin_cos();
            glam::Vec3::new(40.0 * cos, 40.0 * sin, z)
        })
    };
    let ends = [-50.0, 50.0].map(|z| glam::Vec3::Z * z);
    let positions_mm = rim(-50.0).chain(rim(50.0)).chain(ends).map(|position| turn * position).collect();
    let side = |i: u32| {
        let (next, top) = ((i + 1) % AROUND, i + AROUND);
        let next_top = next + AROUND;
        [[i, next, next_top], [i, next_top, top], [next, i, 2 * AROUND], [top, next_top, 2 * AROUND + 1]]
    };
    let triangles = (0..AROUND).flat_map(side).collect();
    Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() }).unwrap()
}

#[test]
fn fans_of_slivers_are_no_hard_case() {
    let can = fine_can();
    let start = std::time::Instant::now();
    let found = find_symmetries(&can);
    let duration = start.elapsed();
    println!("{} faces: {} in {duration:?}", can.triangles().len(), words(&found));
    let folds: Vec<Fold> = found.found.iter().map(|found| found.axis.fold).collect();
    assert_eq!(folds, [Fold::Continuous, Fold::Times(2)]);
    // Corners may be moved by a fifth of the tolerance where slivers are searched, and nothing else is off.
    assert!(found.found[0].worst_mm < 0.002 * found.diameter_mm, "{}", found.found[0].worst_mm);
    // Half a minute where every place is in the boxes of thousands, and a second at most otherwise, in an optimised build; this
    // one is hardly optimised, and the machine may be shared.
    assert!(duration.as_secs_f64() < 10.0, "{duration:?}");
}

fn axis(axis: DVec3, fold: Fold) -> SymmetryAxis {
    SymmetryAxis { axis, through_mm: DVec3::ZERO, fold }
}

fn add(session: &mut Session, axis: SymmetryAxis) -> Result<Vec<Effect>, pinpose::session::CommandError> {
    let object = session.selected().unwrap();
    session.apply(Command::EditObject(object, ObjectChange::AddSymmetry(axis)), NOW_MS)
}

fn symmetries(session: &Session) -> Symmetries {
    session.scene().object(session.selected().unwrap()).unwrap().symmetries.clone()
}

#[test]
fn an_axis_brings_all_that_follows_and_goes_by_undo() {
    let mut session = small_session();
    add(&mut session, axis(DVec3::Z, Fold::Times(4))).unwrap();
    add(&mut session, axis(DVec3::X, Fold::Times(2))).unwrap();
    assert_eq!(symmetries(&session).discrete.len(), 7);
    let refused = add(&mut session, axis(DVec3::X, Fold::Times(5))).unwrap_err();
    assert!(refused.to_string().contains("remove one of them first"), "{refused}");
    session.apply(Command::Run(CommandId::Undo), NOW_MS).unwrap();
    assert_eq!(symmetries(&session).discrete.len(), 3);
    session.apply(Command::Run(CommandId::Undo), NOW_MS).unwrap();
    assert!(symmetries(&session).is_empty());
    let asked = session.apply(Command::Run(CommandId::FindSymmetries), NOW_MS).unwrap();
    assert_eq!(asked, [Effect::FindSymmetries(session.selected().unwrap())]);
}

#[test]
fn symmetries_are_the_meshs_and_are_saved() {
    let mut session = small_session();
    session.apply(Command::Run(CommandId::DuplicateObject), NOW_MS).unwrap();
    let through_mm = DVec3::new(1.0, 2.0, 3.0);
    let round = SymmetryAxis { through_mm, ..axis(DVec3::Y, Fold::Continuous) };
    add(&mut session, round).unwrap();
    let of_all = |session: &Session| -> Vec<Symmetries> {
        session.scene().objects.iter().map(|object| object.symmetries.clone()).collect()
    };
    let [first, second] = &of_all(&session)[..] else { panic!("two objects") };
    assert_eq!(first, second);
    assert_eq!((first.continuous[0].axis, first.continuous[0].offset_mm), (DVec3::Y, through_mm));
    let opening = Opening {
        document: session.document(Keep::Everything),
        photos: session.scene().photos.iter().map(|photo| photo.asset.clone()).collect(),
        meshes: vec![session.scene().objects[0].mesh.clone()],
        restored: false,
    };
    let mut reopened = Session::default();
    reopened.apply(Command::Open(Box::new(opening)), NOW_MS).unwrap();
    assert_eq!(of_all(&reopened), of_all(&session));
}

#[test]
fn several_snaps_are_one_step_and_leave_what_was_confirmed() {
    let mut session = small_session();
    let (photo, object, annotation) = session.selected_annotation().unwrap();
    let start = annotation.camera_from_object;
    assert!(session.unavailable(CommandId::SnapAll).is_some(), "nothing is posed yet");
    let posed = start.translated(DVec3::X * 5.0);
    let set = Command::SetPose { photo, object, camera_from_object: posed, source: PoseSource::Manual };
    session.apply(set, NOW_MS).unwrap();
    let asked = session.apply(Command::Run(CommandId::SnapAll), NOW_MS).unwrap();
    assert_eq!(asked, [Effect::SnapAll(vec![(photo, object)])]);

    let snapped = posed.translated(DVec3::Y);
    let take = || Command::TakeSnaps {
        snaps: vec![((photo, object), snapped, None)],
        summary: "Snapped 1 of 1 poses".into(),
        least_sure: (photo, object),
    };
    session.apply(take(), NOW_MS).unwrap();
    let pose = |session: &Session| session.selected_annotation().unwrap().2.camera_from_object;
    assert_eq!(pose(&session), snapped);
    let [.., of_pose, of_all] = session.log() else { panic!("two lines") };
    assert_eq!((of_pose.label, of_pose.summary.as_deref()), ("Snap on all photos", None));
    assert_eq!(
        (of_all.label, of_all.summary.as_deref()),
        ("Snap on all photos", Some("Snapped 1 of 1 poses"))
    );
    assert_eq!((of_all.photo, of_all.object, of_all.camera_from_object), (photo, object, snapped));
    session.apply(Command::Run(CommandId::Undo), NOW_MS).unwrap();
    assert_eq!(pose(&session), posed);

    session.apply(Command::Run(CommandId::ConfirmAndNext), NOW_MS).unwrap();
    session.apply(take(), NOW_MS).unwrap();
    assert_eq!(pose(&session), posed, "a confirmed pose stays");
}

/// With its session and the turn that was asked for last.
type Panel = (Harness<'static>, Rc<RefCell<Session>>, Rc<RefCell<Option<SymmetryAxis>>>);

/// The panel beside a search that found the box's axes.
fn panel(session: Session) -> Panel {
    let mesh = session.scene().objects[0].mesh.clone();
    let found = find_symmetries(&mesh.mesh);
    let (session, asked_turn) = (Rc::new(RefCell::new(session)), Rc::new(RefCell::new(None)));
    let (shared, turn) = (session.clone(), asked_turn.clone());
    let mut state = UiState::default();
    let harness = Harness::builder().with_size([1024.0, 1500.0]).build_ui(move |ui| {
        ui::apply_theme(ui.ctx());
        let hands = Hands::default();
        let mut around = quiet_surroundings(&hands);
        around.symmetries = SymmetryView { found: Some((&mesh, &found)) };
        let asked = ui::draw(ui, &shared.borrow(), &around, &mut state);
        asked.commands.into_iter().for_each(|command| {
            shared.borrow_mut().apply(command, NOW_MS).unwrap();
        });
        if let Some(ui::ShownMotion::Turn(axis)) = asked.show_motion {
            *turn.borrow_mut() = Some(axis);
        }
    });
    (harness, session, asked_turn)
}

fn click(harness: &mut Harness<'static>, label: &str) {
    harness.get_by_label(label).click();
    harness.run();
}

#[test]
fn the_panel_shows_what_was_found_and_takes_what_is_accepted() {
    let (mut harness, session, asked_turn) = panel(small_session());
    click(&mut harness, "Symmetry");
    // A box of three different sides: three half turns, of which two tell all.
    let found: Vec<String> = ["x", "y", "z"].map(|letter| format!("Accept 2-fold about {letter}")).to_vec();
    let offered: Vec<&String> =
        found.iter().filter(|label| harness.query_by_label(label).is_some()).collect();
    assert_eq!(offered.len(), 2, "{offered:?}");
    harness.get_by_label_contains("Colours count");
    let shown = offered[0].replace("Accept", "Show");
    click(&mut harness, &shown);
    assert_eq!(asked_turn.borrow().map(|axis| axis.fold), Some(Fold::Times(2)));
    if let Ok(picture) = harness.render() {
        picture.save(std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("symmetry-panel.png")).unwrap();
    }
    click(&mut harness, "Accept all");
    assert_eq!(symmetries(&session.borrow()).discrete.len(), 3);
    click(&mut harness, "Remove 2-fold about z");
    assert_eq!(symmetries(&session.borrow()).discrete.len(), 2);
}

#[test]
fn an_axis_is_written_by_hand() {
    let (mut harness, session, asked_turn) = panel(small_session());
    click(&mut harness, "Symmetry");
    click(&mut harness, "Add axis…");
    click(&mut harness, "Axis along y");
    click(&mut harness, "Any turn");
    click(&mut harness, "Try it");
    assert_eq!(asked_turn.borrow().unwrap().axis, DVec3::Y);
    if let Ok(picture) = harness.render() {
        picture.save(std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("symmetry-axis.png")).unwrap();
    }
    click(&mut harness, "Add");
    let symmetries = symmetries(&session.borrow());
    assert_eq!((symmetries.continuous.len(), symmetries.continuous[0].axis), (1, DVec3::Y));
    // What the errors make of it: a turn about that axis is none.
    let object = session.borrow().scene().objects[0].clone();
    let pose = Pose::from_translation(DVec3::new(0.0, 0.0, 700.0));
    let turned = pose * symmetries.continuous[0].turn(0.7);
    let error = pinpose::metrics::PoseError::between(&turned, &pose, &object.mesh.mesh, &symmetries, 1000);
    // Rounding of 80 mm.
    assert!(error.rotation_rad < 1e-6 && error.add_mm < 1e-6, "{error:?}");
}
