//! From the result files of a study and its truth to a paper's tables and figures.

mod analysis;
mod input;
mod job;
mod measure;
mod random;
mod statistics;
mod student;
mod table;
mod table_text;

pub use analysis::{AgreementErrors, Analysis, PairErrors, ReportOptions, Rows, TrialErrors};
pub use input::{
    Answered, ReportCondition, ReportInput, ReportParticipant, ReportSample, SampleView, SusAnswers,
    TLX_SCALES, TLX_TOP, TlxAnswers, Trial,
};
pub use job::{AnalysisJob, PARTNERS, ReportProgress};
pub use measure::{Difference, Measure};
pub use statistics::{BoxStatistics, Equivalence, Interval, RESAMPLES, Spread};
pub use table::{Cell, Column, Table};
pub use table_text::{csv, latex};
