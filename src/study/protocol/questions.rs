//! What participants are asked.

use serde::{Deserialize, Serialize};

/// One question.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Item {
    pub id: String,
    pub text: String,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub optional: bool,
    pub answer: ItemKind,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum ItemKind {
    /// A whole number from `least` to `most`.
    Scale { least: i32, most: i32, low: String, high: String },
    /// One of these, or several.
    Choice {
        options: Vec<String>,
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        several: bool,
    },
    Text {
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        long: bool,
    },
}

/// A page of questions. Its kind stands beside its id in the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Questionnaire {
    pub id: String,
    #[serde(default)]
    pub when: QuestionnaireTime,
    #[serde(flatten)]
    pub kind: QuestionnaireKind,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum QuestionnaireTime {
    /// Once, after the last trial.
    #[default]
    End,
    /// After each condition's trials.
    EachCondition,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum QuestionnaireKind {
    /// Six scales of 21 marks, 0–20; with `weighted`, fifteen choices between two of them.
    NasaTlx {
        #[serde(default)]
        weighted: bool,
    },
    /// Ten items, 1–5.
    Sus,
    Own {
        title: String,
        items: Vec<Item>,
    },
}
