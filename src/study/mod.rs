//! Studies: what a researcher asks of participants, what they did, and what comes of it.
//!
//! Plain data and pure rules. Time, randomness and ids are arguments, so that a study replays exactly; knows nothing of
//! screens, networks or storage.

mod chance;
pub mod check;
mod clock;
pub mod comparison;
mod error;
mod events;
mod flow;
pub mod markdown;
pub mod pack;
pub mod paper;
mod protocol;
pub mod questionnaire;
mod record;
mod replay;
pub mod report;
mod results;
mod schedule;
pub mod simulate;
mod stage;
mod table;
mod time;
mod truth;

pub use chance::Chance;
pub use error::StudyError;
pub use events::{Event, EventKind};
pub use flow::{Participation, PinRecord, Reopened, RunningTrial, Step, TrialPlace, steps};
pub use protocol::{
    Asset, Assignment, CameraRecord, Completion, Condition, IdParameters, Item, ItemKind, Limits,
    PracticeSample, Questionnaire, QuestionnaireKind, QuestionnaireTime, ResumePolicy, STUDY_SCHEMA, Sample,
    SampleSets, Saving, Schedule, StartPose, Study, StudyObject, StudyPhoto, Texts, Tool, TrialOrder,
};
pub use record::{PoseRecord, SymmetriesRecord};
pub use replay::Replay;
pub use results::{
    Answer, AnswerValue, Environment, Feedback, FileRecord, Outcome, PairChoice, Participant, Pause,
    PauseKind, PracticeResult, QuestionnaireResult, RESULTS_SCHEMA, Results, StudyRecord, TrialResult,
};
pub use schedule::{AskedFor, Plan, PlannedTrial, start_pose};
pub use stage::{Stage, camera_of, feedback, framed_mesh};
pub use table::{answers_csv, json_object, results_name, trials_csv};
pub use time::rfc3339;
pub use truth::{TRUTH_SCHEMA, Truth, TruthSample};
