//! What the program begins with.

/// What the program opens first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum StartWith {
    LastOpen,
    Example,
    /// Somebody takes part in a study.
    Study(super::StudyLink),
    Nothing,
}
