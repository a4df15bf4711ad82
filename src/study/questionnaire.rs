//! NASA-TLX and SUS: their words, their order, their scores.
//!
//! Sources: Hart and Staveland, *Development of NASA-TLX*, 1988, and the paper-and-pencil package of NASA Ames; Brooke, *SUS: A
//! Quick and Dirty Usability Scale*, 1996.

use std::collections::BTreeMap;

use super::chance::Chance;
use super::{Answer, AnswerValue, PairChoice};

/// One of NASA-TLX's six scales.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TlxScale {
    /// In results.
    pub id: &'static str,
    pub title: &'static str,
    pub question: &'static str,
    /// At marks 0 and 20.
    pub ends: [&'static str; 2],
}

/// The marks of a scale are 0 to this.
pub const TLX_MOST: i32 = 20;

pub const TLX_SCALES: [TlxScale; 6] = [
    TlxScale {
        id: "mental",
        title: "Mental demand",
        question: "How mentally demanding was the task?",
        ends: ["Very low", "Very high"],
    },
    TlxScale {
        id: "physical",
        title: "Physical demand",
        question: "How physically demanding was the task?",
        ends: ["Very low", "Very high"],
    },
    TlxScale {
        id: "temporal",
        title: "Temporal demand",
        question: "How hurried or rushed was the pace of the task?",
        ends: ["Very low", "Very high"],
    },
    TlxScale {
        id: "performance",
        title: "Performance",
        question: "How successful were you in accomplishing what you were asked to do?",
        ends: ["Perfect", "Failure"],
    },
    TlxScale {
        id: "effort",
        title: "Effort",
        question: "How hard did you have to work to accomplish your level of performance?",
        ends: ["Very low", "Very high"],
    },
    TlxScale {
        id: "frustration",
        title: "Frustration",
        question: "How insecure, discouraged, irritated, stressed and annoyed were you?",
        ends: ["Very low", "Very high"],
    },
];

/// 1: strongly disagree, 5: strongly agree. The odd ones are said in favour.
pub const SUS_ITEMS: [&str; 10] = [
    "I think that I would like to use this system frequently.",
    "I found the system unnecessarily complex.",
    "I thought the system was easy to use.",
    "I think that I would need the support of a technical person to be able to use this system.",
    "I found the various functions in this system were well integrated.",
    "I thought there was too much inconsistency in this system.",
    "I would imagine that most people would learn to use this system very quickly.",
    "I found the system very cumbersome to use.",
    "I felt very confident using the system.",
    "I needed to learn a lot of things before I could get going with this system.",
];

/// In results: `sus1` to `sus10`.
pub fn sus_id(index: usize) -> String {
    format!("sus{}", index + 1)
}

/// The fifteen pairs of scales, their order and their sides shuffled.
pub fn tlx_pairs(seed: u64, questionnaire: &str) -> Vec<(&'static TlxScale, &'static TlxScale)> {
    let mut pairs = Vec::with_capacity(15);
    let mut chance = Chance::of(seed, questionnaire);
    for (index, first) in TLX_SCALES.iter().enumerate() {
        for second in &TLX_SCALES[index + 1..] {
            pairs.push(if chance.below(2) == 0 { (first, second) } else { (second, first) });
        }
    }
    chance.shuffle(&mut pairs);
    pairs
}

/// The number that an item was answered with.
fn number(answers: &[Answer], item: &str) -> Option<f64> {
    match &answers.iter().find(|answer| answer.item == item)?.value {
        Some(AnswerValue::Number(number)) => Some(*number),
        _ => None,
    }
}

/// `raw`: the mean of the six scales; `weighted`: Σ(weight · rating) / 15, the weight of a scale being how often it was chosen of
/// its five pairs. 0–20 both; nothing where a scale has no answer.
pub fn tlx_scores(answers: &[Answer], pairs: &[PairChoice]) -> BTreeMap<String, f64> {
    const PAIRS: usize = 15;
    let ratings: Option<Vec<f64>> = TLX_SCALES.iter().map(|scale| number(answers, scale.id)).collect();
    let Some(ratings) = ratings else { return BTreeMap::new() };
    let mut scores =
        BTreeMap::from([("raw".to_owned(), ratings.iter().sum::<f64>() / TLX_SCALES.len() as f64)]);
    if pairs.len() == PAIRS {
        let weight = |scale: &TlxScale| pairs.iter().filter(|pair| pair.chosen == scale.id).count() as f64;
        let sum: f64 = TLX_SCALES.iter().zip(&ratings).map(|(scale, rating)| weight(scale) * rating).sum();
        scores.insert("weighted".to_owned(), sum / PAIRS as f64);
    }
    scores
}

/// `sus`: 2.5 · (Σ odd (x − 1) + Σ even (5 − x)), 0–100. An item without an answer counts as the middle, 3; `missing` says how many.
pub fn sus_scores(answers: &[Answer]) -> BTreeMap<String, f64> {
    const MIDDLE: f64 = 3.0;
    let given: Vec<Option<f64>> = (0..SUS_ITEMS.len()).map(|index| number(answers, &sus_id(index))).collect();
    let points = given.iter().enumerate().map(|(index, answer)| {
        let answer = answer.unwrap_or(MIDDLE);
        if index % 2 == 0 { answer - 1.0 } else { 5.0 - answer }
    });
    let mut scores = BTreeMap::from([("sus".to_owned(), 2.5 * points.sum::<f64>())]);
    let missing = given.iter().filter(|answer| answer.is_none()).count();
    if missing > 0 {
        scores.insert("missing".to_owned(), missing as f64);
    }
    scores
}

#[cfg(test)]
mod tests;
