//! From the result files of a study and its truth to a paper's tables and figures.

mod analysis;
mod contrast;
mod figure;
mod files;
mod gather;
mod input;
mod job;
mod measure;
mod overview;
mod page;
mod people;
mod quantity;
mod statistics;
mod student;
mod table;
mod table_text;
mod tables;
mod whole;

pub use analysis::{AgreementErrors, Analysis, PairErrors, ReportOptions, Rows, TrialErrors};
pub use contrast::Contrast;
pub use figure::{
    Anchor, Drawing, Figure, PNG_SCALE, Shape, Stroke, Text, TupleJob, TuplePictures, figures, svg,
};
pub use files::{ReportFiles, mesh_of_study};
pub use gather::{GatherError, gather};
pub use input::{
    Answered, ReportCondition, ReportInput, ReportParticipant, ReportSample, SampleView, SusAnswers,
    TLX_SCALES, TLX_TOP, TlxAnswers, Trial,
};
pub use job::{AnalysisJob, PARTNERS, ReportProgress};
pub use measure::{Difference, Measure};
pub use overview::{Overview, Part, Person};
pub use quantity::Quantity;
pub use statistics::{BoxStatistics, Equivalence, Interval, RESAMPLES, Spread};
pub use table::{Cell, Column, Table};
pub use table_text::{csv, latex};
pub use tables::tables;
pub use whole::{Report, ReportJob};
