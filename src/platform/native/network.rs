//! A window takes studies from this computer's files, and sends nothing.

use crate::platform::{BrowserFacts, NetworkFuture, Request};

/// Reads a file by its path.
pub fn fetch(url: &str) -> NetworkFuture<Vec<u8>> {
    let read = std::fs::read(url).map_err(|error| format!("{url}: {error}"));
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
