use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use super::*;
use crate::mesh::test_shapes;
use crate::study::{Condition, Sample};

fn study(samples: usize, sets: &[&str], conditions: usize) -> Study {
    let mut study = Study::new("s", "S");
    study.samples = (0..samples)
        .map(|index| Sample {
            id: format!("S{index}"),
            photo: "p".to_owned(),
            object: "o".to_owned(),
            set: sets.get(index % sets.len().max(1)).map(|set| (*set).to_owned()),
            start: None,
        })
        .collect();
    study.conditions = (0..conditions)
        .map(|index| Condition { id: format!("c{index}"), ..Condition::with_every_tool() })
        .collect();
    study
}

fn plan(study: &Study, participant: &str) -> Plan {
    Plan::new(study, participant, &AskedFor::default()).unwrap()
}

#[test]
fn the_papers_protocol_shows_each_sample_three_times_and_never_twice_in_a_row() {
    let study = study(10, &[], 1);
    for participant in 0..200 {
        let plan = plan(&study, &format!("P{participant}"));
        assert_eq!(plan.trials.len(), 30);
        for repeat in 0..3 {
            let round = plan.trials.iter().filter(|trial| trial.repeat == repeat);
            assert_eq!(round.map(|trial| &trial.sample).collect::<BTreeSet<_>>().len(), 10);
        }
        assert!(plan.trials.windows(2).all(|pair| pair[0].sample != pair[1].sample));
    }
}

#[test]
fn each_repeat_has_an_order_of_its_own_and_the_seed_brings_all_back() {
    let study = study(10, &[], 1);
    let first = plan(&study, "P1");
    let rounds: Vec<Vec<&str>> =
        first.trials.chunks(10).map(|round| round.iter().map(|t| t.sample.as_str()).collect()).collect();
    assert!(rounds[0] != rounds[1] && rounds[1] != rounds[2]);
    assert_eq!(first, plan(&study, "P1"));
    assert_ne!(first.trials, plan(&study, "P2").trials);

    let mut seeded = study.clone();
    seeded.schedule.seed = Some(7);
    assert_eq!(plan(&seeded, "P1"), plan(&seeded, "P2"));
    assert_eq!(plan(&seeded, "P1").seed, 7);
}

#[test]
fn one_sample_repeats_and_two_alternate() {
    assert_eq!(plan(&study(1, &[], 1), "P").trials.len(), 3);
    let two = plan(&study(2, &[], 1), "P");
    assert!(two.trials.windows(2).all(|pair| pair[0].sample != pair[1].sample));
    assert!(plan(&study(0, &[], 1), "P").trials.is_empty());
}

#[test]
fn an_order_that_is_drawn_once_stays() {
    let mut study = study(5, &[], 1);
    study.schedule.order = TrialOrder::ShuffledOnce;
    let shuffled = plan(&study, "P");
    let samples = |plan: &Plan| -> Vec<String> { plan.trials.iter().map(|t| t.sample.clone()).collect() };
    assert_eq!(samples(&shuffled)[..5], samples(&shuffled)[5..10]);
    study.schedule.order = TrialOrder::AsListed;
    assert_eq!(samples(&plan(&study, "P"))[..5], ["S0", "S1", "S2", "S3", "S4"]);
}

#[test]
fn participants_spread_over_conditions_and_sets() {
    let mut study = study(4, &["L", "H"], 2);
    study.sample_sets = SampleSets::Between;
    let mut groups: BTreeMap<(String, String), u32> = BTreeMap::new();
    for participant in 0..400 {
        let plan = plan(&study, &format!("P{participant}"));
        assert_eq!(plan.trials.len(), 6);
        *groups.entry((plan.conditions[0].clone(), plan.sample_sets[0].clone())).or_default() += 1;
    }
    // 100 ± 8.7 of 400 in each of four groups; five standard deviations.
    assert!(groups.len() == 4 && groups.values().all(|count| count.abs_diff(100) < 44), "{groups:?}");
}

#[test]
fn the_link_names_condition_and_set() {
    let mut study = study(4, &["L", "H"], 2);
    study.sample_sets = SampleSets::Between;
    let asked = |condition: &str, set: &str| AskedFor {
        condition: Some(condition.to_owned()),
        sample_set: Some(set.to_owned()),
    };
    let by_name = Plan::new(&study, "P", &asked("c1", "H")).unwrap();
    assert_eq!((by_name.conditions, by_name.sample_sets), (vec!["c1".to_owned()], vec!["H".to_owned()]));
    let by_number = Plan::new(&study, "P", &asked("2", "1")).unwrap();
    assert_eq!((by_number.conditions[0].as_str(), by_number.sample_sets[0].as_str()), ("c1", "L"));
    let error = Plan::new(&study, "P", &asked("9", "1")).unwrap_err().to_string();
    assert!(error.contains("\"9\"") && error.contains("c0, c1"), "{error}");
}

#[test]
fn orders_within_participants_are_balanced_in_place_and_in_sequence() {
    for count in 1..7 {
        let orders = balanced_orders(count);
        let mut at = BTreeMap::new();
        let mut after = BTreeMap::new();
        for order in &orders {
            assert_eq!(order.iter().collect::<BTreeSet<_>>().len(), count, "{order:?}");
            order.iter().enumerate().for_each(|place| *at.entry(place).or_insert(0) += 1);
            order.windows(2).for_each(|pair| *after.entry((pair[0], pair[1])).or_insert(0) += 1);
        }
        let even = |counts: Vec<&i32>| counts.windows(2).all(|pair| pair[0] == pair[1]);
        assert!(at.len() == count * count && even(at.values().collect()), "{orders:?}");
        assert!(after.len() == count * (count - 1) && even(after.values().collect()), "{orders:?}");
    }
}

#[test]
fn within_participants_every_condition_comes_each_with_another_set() {
    let mut study = study(6, &["A", "B", "C"], 3);
    study.assignment = Assignment::Within;
    study.sample_sets = SampleSets::PerCondition;
    let asked = AskedFor { condition: Some("4".to_owned()), sample_set: Some("B".to_owned()) };
    let plan = Plan::new(&study, "P", &asked).unwrap();
    assert_eq!(plan.sample_sets, ["B", "C", "A"]);
    assert_eq!(plan.trials.len(), 3 * 2 * 3);
    let set_of = |id: &str| study.sample(id).unwrap().set.clone().unwrap();
    for (condition, set) in plan.conditions.iter().zip(&plan.sample_sets) {
        let trials = plan.trials.iter().filter(|trial| trial.condition == *condition);
        assert!(trials.clone().count() == 6 && trials.clone().all(|trial| set_of(&trial.sample) == *set));
    }
    assert!(plan.begins_condition(0) && plan.begins_condition(6) && !plan.begins_condition(2));
    assert!(plan.begins_repeat(2) && !plan.begins_repeat(1));
}

#[test]
fn start_poses_are_as_the_study_says() {
    let mut study = study(1, &[], 1);
    let mesh = test_shapes::cube();
    let camera = Intrinsics::pinhole(600.0, 600.0, 319.5, 239.5, 640, 480);
    let start = |study: &Study, place: &str| start_pose(study, None, &camera, &mesh, 5, place);
    assert_eq!(start(&study, "0").unwrap(), Pose::from_translation(DVec3::new(0.0, 0.0, 1000.0)));
    study.start_pose = StartPose::Random { least_depth_mm: 400.0, most_depth_mm: 800.0 };
    let first = start(&study, "0").unwrap();
    assert_eq!(first, start(&study, "0").unwrap());
    assert_ne!(first, start(&study, "1").unwrap());
    for place in 0..100 {
        let pose = start(&study, &place.to_string()).unwrap();
        let center = pose.transform_point(mesh.bounds().center());
        let pixel = camera.project(center).unwrap();
        assert!((400.0..800.0).contains(&center.z));
        assert!((159.0..480.0).contains(&pixel.x) && (119.0..360.0).contains(&pixel.y), "{pixel}");
        // A rotation made from a unit quaternion is one to rounding.
        assert!(crate::math::rotation_defect(&pose.rotation) < 1e-12);
    }
    study.start_pose = StartPose::Given;
    assert!(start(&study, "0").is_err());
}
