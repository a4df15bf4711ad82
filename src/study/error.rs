//! Why a file of a study cannot be used. Who shows it puts the file's name before it.

use serde::Deserialize;
use serde::de::DeserializeOwned;
use thiserror::Error;

#[derive(Debug, Error)]
pub enum StudyError {
    #[error("line {line}, column {column}: {reason}")]
    Json { line: usize, column: usize, reason: String },
    #[error("{place}: {reason}")]
    At { place: String, reason: String },
    #[error("\"format\": \"{expected}\" expected, found \"{found}\"")]
    Format { expected: &'static str, found: String },
    #[error("of version {found}; this page reads up to version {supported}: reload the page to update it")]
    Version { found: u64, supported: u64 },
    #[error("{0}: the file has another content than the study says: it was changed or cut short")]
    Changed(String),
    #[error("{path}: {bytes} bytes, where at most {most} are loaded")]
    TooLarge { path: String, bytes: u64, most: u64 },
    #[error("{0}")]
    Pack(String),
}

impl StudyError {
    pub fn json(error: &serde_json::Error) -> Self {
        let text = error.to_string();
        // serde_json repeats the position at the end of its message.
        let reason = match error.is_eof() {
            true => "the file ends in the middle: it was cut short".to_owned(),
            false => text.split(" at line ").next().unwrap_or(&text).to_owned(),
        };
        Self::Json { line: error.line(), column: error.column(), reason }
    }

    pub fn at(place: impl Into<String>, reason: impl ToString) -> Self {
        Self::At { place: place.into(), reason: reason.to_string() }
    }
}

/// Reads one of a study's files after a look at what it says it is.
pub(super) fn read_versioned<T: DeserializeOwned>(
    bytes: &[u8],
    format: &'static str,
    version: u64,
) -> Result<T, StudyError> {
    #[derive(Deserialize)]
    struct Head {
        format: String,
        version: u64,
    }
    let head: Head = serde_json::from_slice(bytes).map_err(|error| StudyError::json(&error))?;
    if head.format != format {
        return Err(StudyError::Format { expected: format, found: head.format });
    }
    if head.version != version {
        return Err(StudyError::Version { found: head.version, supported: version });
    }
    serde_json::from_slice(bytes).map_err(|error| StudyError::json(&error))
}
