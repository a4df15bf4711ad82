use super::*;
use crate::math::Pose;
use crate::study::{
    AskedFor, Asset, CameraRecord, Condition, EventKind, Item, ItemKind, Outcome, PracticeSample,
    Questionnaire, QuestionnaireKind, Sample, StudyObject, StudyPhoto, TrialResult,
};

fn asset(name: &str) -> Asset {
    Asset { name: name.to_owned(), path: format!("assets/{name}"), sha256: "0".repeat(64), bytes: 1 }
}

fn sample(id: &str) -> Sample {
    Sample { id: id.to_owned(), photo: "p".to_owned(), object: "o".to_owned(), set: None, start: None }
}

/// Two samples, each twice, with everything that a study can have.
fn study() -> Study {
    let mut study = Study::new("demo", "Demo");
    study.texts.consent = "I agree.".to_owned();
    let k = [[600.0, 0.0, 320.0], [0.0, 600.0, 240.0], [0.0, 0.0, 1.0]];
    let camera = CameraRecord { k, distortion: None, width: 640, height: 480 };
    study.photos = vec![StudyPhoto { id: "p".to_owned(), asset: asset("p.png"), camera }];
    let identity = Pose::IDENTITY.to_rows();
    study.objects = vec![StudyObject {
        id: "o".to_owned(),
        name: "cup".to_owned(),
        mesh: asset("cup.ply"),
        companions: Vec::new(),
        mesh_from_file: identity,
        color: None,
    }];
    study.samples = vec![sample("A"), sample("B")];
    study.practice = vec![PracticeSample {
        sample: sample("X"),
        truth: Pose::IDENTITY.into(),
        good_add_of_diameter: 0.1,
        most_attempts: 2,
    }];
    study.items_before = vec![Item {
        id: "age".to_owned(),
        text: "Age?".to_owned(),
        optional: true,
        answer: ItemKind::Text { long: false },
    }];
    study.questionnaires = vec![
        Questionnaire {
            id: "tlx".to_owned(),
            when: QuestionnaireTime::EachCondition,
            kind: QuestionnaireKind::NasaTlx { weighted: false },
        },
        Questionnaire { id: "sus".to_owned(), when: QuestionnaireTime::End, kind: QuestionnaireKind::Sus },
    ];
    study.schedule.repeats = 2;
    study
}

fn begun(study: &Study) -> Participation {
    let plan = Plan::new(study, "P1", &AskedFor::default()).unwrap();
    let record = StudyRecord { id: study.id.clone(), title: study.title.clone(), sha256: "0".repeat(64) };
    let participant = Participant { id: "P1".to_owned(), recruiter: Default::default() };
    Participation::begin(record, plan, participant, Environment::default(), 1000.0)
}

fn confirm(one: &mut Participation, study: &Study, now_ms: f64) -> TrialResult {
    let Step::Trial(index) = one.step(study) else { panic!("{:?}", one.step(study)) };
    let planned = one.plan.trials[index].clone();
    let place = TrialPlace { index, repeat: planned.repeat, condition: &planned.condition };
    let sample = study.sample(&planned.sample).unwrap();
    let result = one.trial().unwrap().result(study, sample, place, Outcome::Confirmed, now_ms).unwrap();
    one.finish_trial(result.clone(), now_ms);
    result
}

fn to_first_trial(one: &mut Participation, study: &Study) {
    one.agree(2000.0);
    one.answer_items(vec![Answer { item: "age".to_owned(), value: None }], 3000.0);
    one.go_on(study, 4000.0);
    one.go_on(study, 5000.0);
    one.go_on(study, 6000.0);
    assert_eq!(one.step(study), Step::Trial(0));
}

#[test]
fn the_way_through_a_study() {
    let study = study();
    let one = begun(&study);
    let tlx = Step::Questionnaire { questionnaire: 0, condition: Some(0) };
    let sus = Step::Questionnaire { questionnaire: 1, condition: None };
    let expected = [
        Step::Consent,
        Step::Questions,
        Step::Instructions,
        Step::Practice(0),
        Step::Begin { trial: 0 },
        Step::Trial(0),
        Step::Trial(1),
        Step::Rest { trial: 2 },
        Step::Trial(2),
        Step::Trial(3),
        tlx,
        sus,
        Step::Finish,
    ];
    assert_eq!(steps(&study, &one.plan), expected);
}

#[test]
fn each_condition_begins_and_ends_by_itself() {
    let mut study = study();
    study.assignment = super::super::Assignment::Within;
    study.conditions =
        ["manual", "pins"].map(|id| Condition { id: id.to_owned(), ..Condition::with_every_tool() }).to_vec();
    study.limits.break_after_trials = Some(3);
    let plan = Plan::new(&study, "P1", &AskedFor::default()).unwrap();
    let way = steps(&study, &plan);
    let places = |wanted: fn(&Step) -> bool| way.iter().filter(|step| wanted(step)).count();
    assert_eq!(places(|step| matches!(step, Step::Begin { .. })), 2);
    assert_eq!(places(|step| matches!(step, Step::Questionnaire { .. })), 3);
    // Three of a condition's four trials, then a rest.
    let rests: Vec<&Step> = way.iter().filter(|step| matches!(step, Step::Rest { .. })).collect();
    assert_eq!(rests, [&Step::Rest { trial: 3 }, &Step::Rest { trial: 7 }]);
}

#[test]
fn a_trial_counts_from_its_first_frame_and_its_pauses_apart() {
    let study = study();
    let mut one = begun(&study);
    to_first_trial(&mut one, &study);
    one.start_trial(RunningTrial::new(Pose::IDENTITY));
    let trial = one.trial_mut().unwrap();
    // Nothing counts before the first frame.
    trial.tick(9000.0);
    trial.record(EventKind::Move, None, 9500.0);
    trial.show(10_000.0);
    trial.show(10_500.0);
    let moved = Pose::from_translation(glam::DVec3::new(0.1, 0.2, 0.3));
    trial.input(11_000.0);
    trial.record(EventKind::Move, Some(moved), 12_000.0);
    trial.pause(13_000.0);
    let pause = trial.go_on(0, 20_000.0).unwrap();
    assert_eq!((pause.seconds, pause.began_at.as_str()), (7.0, "1970-01-01T00:00:13.000Z"));
    one.add_pause(pause, 20_000.0);
    let result = confirm(&mut one, &study, 21_000.0);
    assert_eq!((result.time_s, result.paused_s, result.active_s), (4.0, 7.0, 4.0));
    assert_eq!(result.final_pose.to_pose().unwrap(), moved);
    assert_eq!(result.gestures, [("move".to_owned(), 1)].into());
    let kinds: Vec<EventKind> = result.events.iter().map(|event| event.kind).collect();
    let expected =
        [EventKind::Shown, EventKind::Move, EventKind::Paused, EventKind::Resumed, EventKind::Confirmed];
    assert_eq!(kinds, expected);
    assert_eq!(result.events[1].pose().unwrap().unwrap(), moved);
    assert_eq!(one.step(&study), Step::Trial(1));
}

#[test]
fn a_reload_goes_on_in_the_same_trial_with_its_clock() {
    let study = study();
    let mut one = begun(&study);
    to_first_trial(&mut one, &study);
    one.start_trial(RunningTrial::new(Pose::IDENTITY));
    let moved = Pose::from_translation(glam::DVec3::new(1.0 / 3.0, 0.0, 700.0));
    let trial = one.trial_mut().unwrap();
    trial.show(10_000.0);
    trial.input(11_000.0);
    trial.record(EventKind::Rotate, Some(moved), 12_000.0);
    trial.tick(12_500.0);

    let stored = Participation::from_json(&one.to_json()).unwrap();
    assert_eq!(stored, one);
    let Reopened::GoesOn(again) = stored.reopen(ResumePolicy::Resume, 60_000.0) else { panic!() };
    let mut again = *again;
    assert_eq!(again.step(&study), Step::Trial(0));
    assert_eq!(again.trial().unwrap().pose(), Some(moved));
    again.trial_mut().unwrap().input(61_000.0);
    let result = confirm(&mut again, &study, 62_000.0);
    assert_eq!((result.time_s, result.closed_s), (4.5, 47.5));
    assert_eq!(again.results.pauses[0].kind, PauseKind::Closed);
    assert!(result.events.iter().any(|event| event.kind == EventKind::Reopened));
}

#[test]
fn other_policies_begin_anew_or_end() {
    let study = study();
    let mut one = begun(&study);
    to_first_trial(&mut one, &study);
    // Nothing is lost yet: everybody goes on.
    assert!(matches!(one.clone().reopen(ResumePolicy::Block, 7000.0), Reopened::GoesOn(_)));
    one.start_trial(RunningTrial::new(Pose::IDENTITY));
    assert_eq!(one.clone().reopen(ResumePolicy::Restart, 7000.0), Reopened::Restarts);
    assert_eq!(one.clone().reopen(ResumePolicy::Block, 7000.0), Reopened::Blocked);
    one.finish(8000.0);
    assert!(matches!(one.reopen(ResumePolicy::Block, 9000.0), Reopened::Done(_)));
}

#[test]
fn practice_is_kept_apart_and_can_be_tried_again() {
    let study = study();
    let mut one = begun(&study);
    one.agree(2000.0);
    one.answer_items(Vec::new(), 3000.0);
    one.go_on(&study, 4000.0);
    let practice = &study.practice[0].sample;
    for attempt in 0..2 {
        assert_eq!((one.step(&study), one.attempts("X")), (Step::Practice(0), attempt));
        one.start_trial(RunningTrial::new(Pose::IDENTITY));
        one.trial_mut().unwrap().show(5000.0);
        let place = TrialPlace { index: 0, repeat: 0, condition: "all" };
        let trial = one.trial().unwrap().result(&study, practice, place, Outcome::Confirmed, 6000.0).unwrap();
        let feedback = Feedback { rotation_deg: 1.0, translation_mm: 2.0, add_mm: 2.0, is_good: true };
        one.finish_practice(trial, feedback);
        assert!(one.feedback().is_some() && one.trial().is_none());
        if attempt == 0 {
            one.try_again();
        }
    }
    one.go_on(&study, 7000.0);
    assert_eq!(one.step(&study), Step::Begin { trial: 0 });
    assert_eq!((one.results.practice.len(), one.results.trials.len()), (2, 0));
}
