//! Why a study cannot go on, for whoever sits before it, and beneath for who made it.

use crate::platform::FetchError;
use crate::study::StudyError;

/// A sentence for the participant, and what the researcher needs to know.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Trouble {
    pub text: String,
    pub details: String,
    /// It may go better the next time.
    pub can_retry: bool,
}

impl Trouble {
    pub fn of(text: &str, details: impl Into<String>, can_retry: bool) -> Self {
        Self { text: text.to_owned(), details: details.into(), can_retry }
    }

    /// `what` is an address.
    pub fn fetching(what: &str, error: &FetchError) -> Self {
        match error {
            FetchError::Status(404 | 410) => Self::of(
                "A part of this study is not where it should be. Please check that the link is complete.",
                format!("{what}: the server says that there is no such file."),
                true,
            ),
            FetchError::Status(status) => Self::of(
                "The study's server has a problem at the moment. Please try again in a minute.",
                format!("{what}: the server answered {status}."),
                true,
            ),
            FetchError::Unreachable(reason) => Self::of(
                "The study cannot be reached. Please check that you are online, and try again.",
                format!(
                    "{what}: {reason}. If the file is there, its server does not allow this page to read it: it has to send \
                     Access-Control-Allow-Origin (CORS)."
                ),
                true,
            ),
            FetchError::TooLarge(most) => Self::of(
                "A part of this study is larger than it should be, and was not loaded.",
                format!("{what}: more than {most} bytes came."),
                false,
            ),
        }
    }

    /// Of a study, or one of its files, that came but cannot be used.
    pub fn reading(what: &str, error: &StudyError) -> Self {
        let details = format!("{what}: {error}.");
        match error {
            StudyError::Version { .. } => Self::of(
                "This study was made for a newer version of this page. Please reload the page.",
                details,
                true,
            ),
            StudyError::Changed(_) => {
                Self::of("A part of this study was damaged on its way. Please try again.", details, true)
            }
            StudyError::TooLarge { .. } => Self::of(
                "A part of this study is larger than it should be, and was not loaded.",
                details,
                false,
            ),
            StudyError::Format { .. } | StudyError::Json { .. } => Self::of(
                "The link leads to something that is not a study. Please check that it is complete.",
                details,
                false,
            ),
            StudyError::At { .. } | StudyError::Pack(_) => {
                Self::of("This study was not put together correctly.", details, false)
            }
        }
    }
}
