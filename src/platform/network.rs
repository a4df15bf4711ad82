//! What is fetched from and sent to servers, and what a page says of the browser that it is in.

use std::pin::Pin;

/// A request with a body of text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Request {
    /// `PUT` or `POST`.
    pub method: &'static str,
    pub url: String,
    /// JSON.
    pub body: String,
}

/// Errors are sentences for the user.
pub type NetworkFuture<T> = Pin<Box<dyn Future<Output = Result<T, String>>>>;

/// Why a file did not come.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum FetchError {
    /// There is no network, no such server, or the server does not let this page read the answer.
    Unreachable(String),
    /// What the server answered in its place.
    Status(u16),
    /// It has more bytes than this.
    TooLarge(u64),
}

/// A file on its way.
pub type FetchFuture = Pin<Box<dyn Future<Output = Result<Vec<u8>, FetchError>>>>;

impl std::fmt::Display for FetchError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Unreachable(reason) => write!(f, "cannot be fetched: {reason}"),
            Self::Status(status) => write!(f, "cannot be fetched: the server answered {status}"),
            Self::TooLarge(most) => write!(f, "has more than {most} bytes"),
        }
    }
}

/// The browser and its screen.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BrowserFacts {
    /// The browser's own words: its user agent.
    pub browser: String,
    pub language: String,
    /// CSS pixels.
    pub screen: [u32; 2],
    pub window: [u32; 2],
    /// Physical pixels per CSS pixel.
    pub pixel_ratio: f64,
}
