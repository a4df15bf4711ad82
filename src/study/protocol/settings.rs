//! How a study is run: tools, order, limits, saving, the way out.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Asset;

/// What participants read; a subset of Markdown, see [`crate::study`]'s `markdown`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Texts {
    /// To be agreed to; empty: nothing is asked.
    pub consent: String,
    pub instructions: String,
    /// On the last screen.
    pub thanks: String,
    /// What the texts show, by name.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pictures: Vec<Asset>,
}

/// A group of commands and gestures that a condition may allow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Tool {
    /// Dragging the object, and its depth by the wheel.
    Move,
    /// Turning it with the mouse.
    Rotate,
    /// The handles on it.
    Handles,
    /// Keys that move and turn by small steps.
    Nudge,
    /// Pins, and the pose from them.
    Pins,
    /// Refining the pose to the photo.
    Snap,
    /// Typing and pasting numbers.
    Numbers,
    /// The scene view and both views.
    SceneView,
    /// Overlay modes, outline, wipe, difference, hiding the overlay.
    Looks,
    /// Undo, redo, back to the start pose.
    Undo,
}

impl Tool {
    pub const ALL: [Self; 10] = [
        Self::Move,
        Self::Rotate,
        Self::Handles,
        Self::Nudge,
        Self::Pins,
        Self::Snap,
        Self::Numbers,
        Self::SceneView,
        Self::Looks,
        Self::Undo,
    ];
}

/// A way of working: what is allowed under it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Condition {
    pub id: String,
    pub title: String,
    pub tools: Vec<Tool>,
    /// Shown before its first trial, besides the study's instructions.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub instructions: String,
}

impl Condition {
    pub fn with_every_tool() -> Self {
        Self {
            id: "all".to_owned(),
            title: "All tools".to_owned(),
            tools: Tool::ALL.to_vec(),
            instructions: String::new(),
        }
    }

    pub fn allows(&self, tool: Tool) -> bool {
        self.tools.contains(&tool)
    }
}

/// Which conditions a participant works under.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Assignment {
    /// One of them.
    #[default]
    Between,
    /// All, one after the other, in an order that is balanced over participants.
    Within,
}

/// Which sample sets a participant works on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SampleSets {
    /// All, mixed, under each of the participant's conditions.
    #[default]
    All,
    /// One of them: the paper's Linemod and HANDAL participants.
    Between,
    /// Each of the participant's conditions with another set, balanced over participants: nobody sees a sample under two.
    PerCondition,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Schedule {
    /// How often each sample comes, under each of the participant's conditions.
    pub repeats: u32,
    pub order: TrialOrder,
    /// The same order for all; else each participant has one of their own, from the study's and their id.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
}

impl Default for Schedule {
    fn default() -> Self {
        Self { repeats: 3, order: TrialOrder::default(), seed: None }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TrialOrder {
    /// Anew for each repeat, no sample twice in a row where that can be avoided.
    #[default]
    ShuffledEachRepeat,
    /// Once; every repeat is the same.
    ShuffledOnce,
    /// As the samples are listed.
    AsListed,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Limits {
    /// A trial ends by itself after so much working time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trial_seconds: Option<f64>,
    pub may_pause: bool,
    /// A rest is offered after so many trials; also between two conditions, and two repeats.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub break_after_trials: Option<u32>,
    /// A pause is suggested after so many minutes of work without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub remind_after_minutes: Option<f64>,
}

impl Default for Limits {
    fn default() -> Self {
        Self { trial_seconds: None, may_pause: true, break_after_trials: None, remind_after_minutes: None }
    }
}

/// What becomes of a participation that was interrupted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ResumePolicy {
    /// It goes on in the same trial.
    #[default]
    Resume,
    /// It begins anew.
    Restart,
    /// It is over.
    Block,
}

/// Where results go, besides a download that is always offered.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Saving {
    /// The participant sends the downloaded file in.
    #[default]
    Download,
    /// OSF by way of DataPipe.
    DataPipe {
        experiment_id: String,
        /// The service's address, where it is not the public one.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        url: Option<String>,
    },
    /// The JSON as the body of a request. `{file}` in the address is replaced by the file's name.
    Put {
        url: String,
    },
    Post {
        url: String,
    },
}

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Completion {
    /// Shown to be copied to the recruiter's page.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub code: Option<String>,
    /// Where the page goes then; `{participant}` and each recruiter parameter in braces are replaced.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub redirect: Option<String>,
    pub redirect_after_seconds: f64,
}

/// Which parameters of the page's address say what.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct IdParameters {
    /// The first of these that is there is the participant's id.
    pub participant: Vec<String>,
    /// Kept in the results: the name there, and the parameter.
    pub recruiter: BTreeMap<String, String>,
    /// The condition's id, or its number from 1.
    pub condition: String,
    /// The sample set's name, or its number from 1.
    pub sample_set: String,
}

impl Default for IdParameters {
    fn default() -> Self {
        let names = ["PROLIFIC_PID", "STUDY_ID", "SESSION_ID"];
        Self {
            participant: vec!["participant".to_owned(), "PROLIFIC_PID".to_owned()],
            recruiter: names.into_iter().map(|name| (name.to_owned(), name.to_owned())).collect(),
            condition: "cond".to_owned(),
            sample_set: "set".to_owned(),
        }
    }
}
