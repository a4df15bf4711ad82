//! Studies: what a researcher asks of participants, what they did, and what comes of it.
//!
//! Plain data and pure rules. Time, randomness and ids are arguments, so that a study replays exactly; knows nothing of
//! screens, networks or storage.

mod error;
mod events;
mod protocol;
mod record;
pub mod report;
mod results;
mod truth;

pub use error::StudyError;
pub use events::{Event, EventKind};
pub use protocol::{
    Asset, Assignment, CameraRecord, Completion, Condition, IdParameters, Item, ItemKind, Limits,
    PracticeSample, Questionnaire, QuestionnaireKind, QuestionnaireTime, ResumePolicy, STUDY_SCHEMA, Sample,
    SampleSets, Saving, Schedule, StartPose, Study, StudyObject, StudyPhoto, Texts, Tool, TrialOrder,
};
pub use record::{PoseRecord, SymmetriesRecord};
pub use results::{
    Answer, AnswerValue, Environment, Feedback, FileRecord, Outcome, PairChoice, Participant, Pause,
    PauseKind, PracticeResult, QuestionnaireResult, RESULTS_SCHEMA, Results, StudyRecord, TrialResult,
};
pub use truth::{TRUTH_SCHEMA, Truth, TruthSample};
