//! What a participant and a researcher see, screen by screen.

use egui_kittest::kittest::Queryable as _;
use egui_kittest::{Harness, SnapshotOptions, SnapshotResults};
use pinpose::interact::Hands;
use pinpose::session::{Command, CommandId, Session};
use pinpose::study::check::Finding;
use pinpose::study::questionnaire::tlx_pairs;
use pinpose::study::{AnswerValue, Condition, Feedback, ItemKind, Study, Tool};
use pinpose::ui::study::{
    FinishView, Pictures, Rehearsal, Sending, StudyRequest, StudyScreen, StudyView, TrialView, draw,
};
use pinpose::ui::{self, BuilderView, StudyBuild, UiState};

use crate::studies::example_pack;
use crate::support::{NOW_MS, quiet_surroundings, small_session};

/// Pictures as a practice pose leaves them.
fn feedback_pictures(ctx: &egui::Context) -> Pictures {
    let mut pictures = Pictures::default();
    for (number, name) in ui::study::FEEDBACK_PICTURES.iter().enumerate() {
        let rgba = [60 + 60 * number as u8, 150, 90, 255].repeat(40 * 30);
        pictures.insert(ctx, name, &pinpose::photo::Pixels { width: 40, height: 30, rgba });
    }
    pictures
}

struct Shown {
    session: Session,
    study: Study,
    pictures: Pictures,
    state: UiState,
    requests: Vec<StudyRequest>,
}

/// A screen of a study.
type Screen = for<'a> fn(&'a Study) -> StudyScreen<'a>;

/// One screen of the example study.
fn harness(screen: Screen) -> Harness<'static, Shown> {
    let shown = Shown {
        session: small_session(),
        study: example_pack().study,
        pictures: Pictures::default(),
        state: UiState::default(),
        requests: Vec::new(),
    };
    let mut harness = Harness::builder().with_size([1024.0, 720.0]).build_ui_state(
        move |ui, shown: &mut Shown| {
            ui::apply_theme(ui.ctx());
            if shown.pictures.get(ui::study::FEEDBACK_PICTURES[0]).is_none() {
                shown.pictures = feedback_pictures(ui.ctx());
            }
            let hands = Hands::default();
            let view = StudyView {
                title: &shown.study.title,
                contact: "study@example.org",
                screen: screen(&shown.study),
                pictures: &shown.pictures,
                page: 1,
                is_preview: false,
                can_rehearse: false,
            };
            let around = quiet_surroundings(&hands);
            draw(ui, &shown.session, &view, &around, &mut shown.state, &mut shown.requests);
        },
        shown,
    );
    harness.run_steps(4);
    harness
}

fn click(harness: &mut Harness<'_, Shown>, label: &str) {
    harness.get_by_label(label).click_accesskit();
    harness.run_steps(3);
}

const FEEDBACK: Feedback = Feedback { rotation_deg: 4.2, translation_mm: 12.3, add_mm: 11.9, is_good: false };

fn trial(study: &Study) -> StudyScreen<'_> {
    StudyScreen::Trial(TrialView {
        number: 3,
        count: 30,
        is_practice: false,
        tools: &study.conditions[0].tools,
        may_pause: true,
        is_paused: false,
        can_confirm: true,
        seconds_left: None,
        suggests_pause: false,
        busy: None,
    })
}

fn instructions(study: &Study) -> StudyScreen<'_> {
    StudyScreen::Instructions {
        text: &study.texts.instructions,
        condition: &study.conditions[0],
        practice: 1,
        trials: 4,
    }
}

fn tlx(study: &Study) -> StudyScreen<'_> {
    StudyScreen::Questionnaire { questionnaire: &study.questionnaires[0], about: None, pairs: &[] }
}

fn problem(_: &Study) -> StudyScreen<'_> {
    StudyScreen::Problem {
        text: "A part of this study is not where it should be. Please check that the link is complete.",
        details: "assets/4ab1.ply: the server says that there is no such file.",
        can_retry: true,
    }
}

fn finish(study: &Study) -> StudyScreen<'_> {
    StudyScreen::Finish(FinishView {
        thanks: &study.texts.thanks,
        sending: Sending::Failed { reason: "It was tried 3 times: the server answered 503." },
        code: Some("TABLE-42"),
        can_redirect: false,
        redirect_in: None,
        is_kept_here: true,
    })
}

#[test]
fn the_screens_look_as_they_did() {
    let screens: [(&str, Screen); 7] = [
        ("study-consent", |study| StudyScreen::Consent { text: &study.texts.consent }),
        ("study-instructions", instructions),
        ("study-trial", trial),
        ("study-feedback", |_| StudyScreen::Feedback { feedback: &FEEDBACK, may_try_again: true }),
        ("study-tlx", tlx),
        ("study-problem", problem),
        ("study-finish", finish),
    ];
    let mut results = SnapshotResults::new();
    for (name, screen) in screens {
        let mut harness = harness(screen);
        // Anti-aliased text differs a little from one driver to the next.
        let options = SnapshotOptions::new().threshold(2.0).output_path("tests/snapshots");
        results.add(harness.try_snapshot_options(name, &options));
    }
}

#[test]
fn nobody_takes_part_without_agreeing() {
    let mut harness = harness(|study| StudyScreen::Consent { text: &study.texts.consent });
    click(&mut harness, "Agree and continue");
    assert!(harness.state().requests.is_empty());
    click(&mut harness, "I do not agree");
    assert_eq!(harness.state_mut().requests.split_off(0), [StudyRequest::Decline]);
    click(&mut harness, "I have read this and agree to take part");
    click(&mut harness, "Agree and continue");
    assert_eq!(harness.state().requests, [StudyRequest::Agree]);
}

#[test]
fn a_trial_shows_what_is_allowed_and_nothing_else() {
    let mut manual = harness(|_| {
        const MANUAL: &[Tool] = &[Tool::Move, Tool::Rotate];
        let StudyScreen::Trial(trial) = StudyScreen::Trial(TrialView {
            number: 1,
            count: 2,
            is_practice: true,
            tools: MANUAL,
            may_pause: false,
            is_paused: false,
            can_confirm: false,
            seconds_left: Some(9.0),
            suggests_pause: false,
            busy: None,
        }) else {
            unreachable!()
        };
        StudyScreen::Trial(trial)
    });
    for label in ["Move", "Rotate", "Help", "Confirm", "Practice 1 of 2", "0:09 left"] {
        manual.get_by_label(label);
    }
    for label in ["Pin", "Snap", "Undo", "Start over", "Pause", "File", "Scene", "Both"] {
        assert!(manual.query_by_label(label).is_none(), "{label}");
    }
    click(&mut manual, "Confirm");
    assert!(manual.state().requests.is_empty(), "nothing was moved yet");
    assert!(harness(trial).query_by_label("Snap").is_some());
}

#[test]
fn pairs_come_one_by_one_and_then_the_scales() {
    let mut harness = harness(|study| {
        let pairs: &'static [_] = Vec::leak(tlx_pairs(3, "tlx"));
        StudyScreen::Questionnaire { questionnaire: &study.questionnaires[0], about: None, pairs }
    });
    let pairs = tlx_pairs(3, "tlx");
    for (left, _) in &pairs {
        click(&mut harness, left.title);
    }
    for scale in ["mental", "physical", "temporal", "performance", "effort", "frustration"] {
        click(&mut harness, &format!("{scale} 20"));
    }
    click(&mut harness, "Continue");
    let [StudyRequest::Questionnaire(answers, chosen)] = &harness.state().requests[..] else { panic!() };
    assert!(answers.iter().all(|answer| answer.value == Some(AnswerValue::Number(20.0))));
    let expected: Vec<&str> = pairs.iter().map(|(left, _)| left.id).collect();
    assert_eq!(chosen.iter().map(|pair| pair.chosen.as_str()).collect::<Vec<_>>(), expected);
}

/// The builder over a small scene, what it asks for, and a view of the check.
fn builder(findings: &'static [Finding]) -> Harness<'static, (UiState, Vec<StudyBuild>)> {
    pinpose::platform::keep_preferences_in_memory();
    let mut session = small_session();
    let effects = session.apply(Command::Run(CommandId::BuildStudy), NOW_MS).unwrap();
    let mut effects = effects.into_iter();
    let mut harness = Harness::builder().with_size([1024.0, 720.0]).build_ui_state(
        move |ui, (state, builds): &mut (UiState, Vec<StudyBuild>)| {
            ui::apply_theme(ui.ctx());
            effects.by_ref().for_each(|effect| assert!(state.take_effect(effect, ui.ctx()).is_none()));
            let hands = Hands::default();
            let view = BuilderView { findings, download_bytes: Some(1_200_000), packing: None };
            let around = ui::Surroundings { builder: Some(view), ..quiet_surroundings(&hands) };
            builds.extend(ui::draw(ui, &session, &around, state).study_build);
        },
        Default::default(),
    );
    harness.run_steps(4);
    harness
}

#[test]
fn a_study_is_built_page_by_page() {
    let mut harness = builder(&[]);
    let options = SnapshotOptions::new().threshold(2.0).output_path("tests/snapshots");
    harness.snapshot_options("study-builder", &options);
    let mut press = |label: &str| {
        // Some words are in the bar beneath the dialog too, which comes first.
        harness.get_all_by_label(label).last().unwrap().click_accesskit();
        harness.run_steps(3);
    };
    press("Sample");
    press("Tools");
    press("Snap");
    press("Add a condition");
    press("work under all conditions, in a balanced order");
    press("Protocol");
    press("In the middle, a third of the photo's height");
    press("Questions");
    press("NASA-TLX");
    press("SUS");
    press("Check and export");
    press("Export study");
    let builds = &harness.state().1;
    let [StudyBuild::Check(_), StudyBuild::Export(draft)] = &builds[..] else { panic!("{builds:?}") };
    let study = &draft.study;
    assert!(draft.chosen.iter().all(|chosen| chosen.role == pinpose::study::pack::Role::Sample));
    assert!(!study.conditions[0].allows(Tool::Snap) && study.conditions[1].allows(Tool::Snap));
    assert_eq!(study.assignment, pinpose::study::Assignment::Within);
    assert_eq!(study.start_pose, pinpose::study::StartPose::Centered);
    assert_eq!(study.questionnaires.len(), 2);
    assert!(matches!(study.items_before[0].answer, ItemKind::Choice { .. }));
    assert_eq!(study.conditions[1], Condition { id: "c2".to_owned(), ..study.conditions[1].clone() });
}

#[test]
fn an_incomplete_study_is_not_exported() {
    let findings: &'static [Finding] =
        Vec::leak(vec![Finding { is_error: true, text: "The study has no title".to_owned() }]);
    let mut harness = builder(findings);
    harness.get_by_label("Check and export").click();
    harness.run_steps(3);
    harness.get_by_label("The study has no title");
    harness.get_by_label("Export study").click();
    harness.run_steps(3);
    assert!(harness.state().1.iter().all(|build| matches!(build, StudyBuild::Check(_))));
}

#[test]
fn a_preview_is_rehearsed_with_as_many_as_are_asked_for() {
    let mut harness = Harness::builder().with_size([1024.0, 720.0]).build_ui_state(
        |ui, shown: &mut Shown| {
            ui::apply_theme(ui.ctx());
            let hands = Hands::default();
            let view = StudyView {
                title: &shown.study.title,
                contact: "",
                screen: StudyScreen::Consent { text: "# Welcome" },
                pictures: &shown.pictures,
                page: 1,
                is_preview: true,
                can_rehearse: true,
            };
            let around = quiet_surroundings(&hands);
            draw(ui, &shown.session, &view, &around, &mut shown.state, &mut shown.requests);
        },
        Shown {
            session: small_session(),
            study: example_pack().study,
            pictures: Pictures::default(),
            state: UiState::default(),
            requests: Vec::new(),
        },
    );
    harness.run_steps(4);
    click(&mut harness, "Simulate participants…");
    let options = SnapshotOptions::new().threshold(2.0).output_path("tests/snapshots");
    harness.snapshot_options("study-rehearsal", &options);
    click(&mut harness, "See the report");
    let expected = Rehearsal { participants: 11, seed: 1, as_files: false };
    assert_eq!(harness.state_mut().requests.split_off(0), [StudyRequest::Rehearse(expected)]);
    click(&mut harness, "Simulate participants…");
    click(&mut harness, "Download files");
    let expected = Rehearsal { as_files: true, ..expected };
    assert_eq!(harness.state().requests, [StudyRequest::Rehearse(expected)]);
}
