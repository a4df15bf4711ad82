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
