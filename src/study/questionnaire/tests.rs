use std::collections::BTreeSet;

use super::*;

fn answers(ratings: &[(&str, f64)]) -> Vec<Answer> {
    let answer = |(item, value): &(&str, f64)| Answer {
        item: (*item).to_owned(),
        value: Some(AnswerValue::Number(*value)),
    };
    ratings.iter().map(answer).collect()
}

/// The example of NASA Ames' manual, on marks of 0–20 instead of 0–100: mental 30, physical 15, temporal 60, performance 40,
/// effort 30, frustration 40 with the weights 3, 0, 5, 1, 3, 3.
#[test]
fn weighted_workload_is_the_manuals() {
    let ratings = answers(&[
        ("mental", 6.0),
        ("physical", 3.0),
        ("temporal", 12.0),
        ("performance", 8.0),
        ("effort", 6.0),
        ("frustration", 8.0),
    ]);
    let chosen = [
        ("mental", 3),
        ("physical", 0),
        ("temporal", 5),
        ("performance", 1),
        ("effort", 3),
        ("frustration", 3),
    ];
    let choices: Vec<PairChoice> = chosen
        .into_iter()
        .flat_map(|(id, times)| std::iter::repeat_n(id, times))
        .map(|id| PairChoice { left: String::new(), right: String::new(), chosen: id.to_owned() })
        .collect();
    let scores = tlx_scores(&ratings, &choices);
    // (3·6 + 0·3 + 5·12 + 1·8 + 3·6 + 3·8) / 15.
    assert_eq!(scores["weighted"], 128.0 / 15.0);
    assert_eq!(scores["raw"], 43.0 / 6.0);
    assert!(!tlx_scores(&ratings, &choices[..14]).contains_key("weighted"));
    assert!(tlx_scores(&ratings[..5], &choices).is_empty());
}

#[test]
fn fifteen_pairs_are_shuffled_in_order_and_in_side() {
    let pairs = tlx_pairs(3, "tlx");
    let unordered: BTreeSet<[&str; 2]> = pairs
        .iter()
        .map(|(left, right)| {
            let mut ids = [left.id, right.id];
            ids.sort_unstable();
            ids
        })
        .collect();
    assert_eq!((pairs.len(), unordered.len()), (15, 15));
    assert_eq!(pairs, tlx_pairs(3, "tlx"));
    assert_ne!(pairs, tlx_pairs(4, "tlx"));
    let mental_left = (0..200)
        .filter(|seed| tlx_pairs(*seed, "tlx").iter().any(|(a, b)| (a.id, b.id) == ("mental", "effort")))
        .count();
    // 100 ± 7; five standard deviations.
    assert!(mental_left.abs_diff(100) < 35, "{mental_left}");
}

#[test]
fn usability_is_brookes() {
    let all = |value: f64| -> Vec<Answer> {
        (0..10).map(|index| Answer { item: sus_id(index), value: Some(AnswerValue::Number(value)) }).collect()
    };
    assert_eq!(sus_scores(&all(3.0)), BTreeMap::from([("sus".to_owned(), 50.0)]));
    let best: Vec<f64> = (0..10).map(|index| if index % 2 == 0 { 5.0 } else { 1.0 }).collect();
    let mut answers: Vec<Answer> = best
        .iter()
        .enumerate()
        .map(|(index, value)| Answer { item: sus_id(index), value: Some(AnswerValue::Number(*value)) })
        .collect();
    assert_eq!(sus_scores(&answers)["sus"], 100.0);
    // One of ten that would have been four points counts two: 2.5 · (40 − 2).
    answers[4].value = None;
    assert_eq!(sus_scores(&answers), BTreeMap::from([("sus".to_owned(), 95.0), ("missing".to_owned(), 1.0)]));
}
