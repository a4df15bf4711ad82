//! A window takes studies from this computer's files, and sends nothing.

use crate::platform::{BrowserFacts, FetchError, FetchFuture, NetworkFuture, Request};

/// Reads a file of so many bytes at the most, by its path.
pub fn fetch(url: &str, most_bytes: u64) -> FetchFuture {
    let read = match std::fs::read(url) {
        Ok(bytes) if bytes.len() as u64 > most_bytes => Err(FetchError::TooLarge(most_bytes)),
        Ok(bytes) => Ok(bytes),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Err(FetchError::Status(404)),
        Err(error) => Err(FetchError::Unreachable(error.to_string())),
    };
    Box::pin(async { read })
}

pub fn send_request(request: Request) -> NetworkFuture<()> {
    Box::pin(async move { Err(format!("{}: a window sends nothing; keep the file", request.url)) })
}

/// A window that is not looked at is not told of it.
pub fn watch_hidden(_changed: impl Fn(bool, f64) + 'static) {}

/// A window leads nowhere else.
pub fn go_to(_url: &str) {}

pub fn browser_facts() -> BrowserFacts {
    BrowserFacts { browser: format!("window on {}", std::env::consts::OS), ..BrowserFacts::default() }
}
