//! What the server answers: which file, as which type, in which encoding, and how long it may be kept.

use std::fmt::Write as _;
use std::fs::Metadata;
use std::path::{Component, Path, PathBuf};
use std::time::UNIX_EPOCH;

use crate::build::is_content_hashed;

/// The parts of a request that matter here.
pub struct Request {
    pub method: String,
    /// Path and query, as sent.
    pub target: String,
    pub accept_encoding: String,
    pub if_none_match: Option<String>,
}

pub struct Reply {
    pub status: u16,
    headers: Vec<(&'static str, String)>,
    pub body: Vec<u8>,
}

impl Reply {
    pub fn text(status: u16, message: &str) -> Reply {
        let mut reply = Reply { status, headers: Vec::new(), body: format!("{message}\n").into_bytes() };
        reply.add("Content-Type", "text/plain; charset=utf-8");
        reply.add("Content-Length", reply.body.len().to_string());
        reply
    }

    fn add(&mut self, name: &'static str, value: impl Into<String>) {
        self.headers.push((name, value.into()));
    }

    /// The status line and the headers, up to the body.
    pub fn head(&self) -> String {
        let reason = match self.status {
            200 => "OK",
            304 => "Not Modified",
            400 => "Bad Request",
            404 => "Not Found",
            405 => "Method Not Allowed",
            _ => "Internal Server Error",
        };
        let mut head = format!("HTTP/1.1 {} {reason}\r\nConnection: close\r\n", self.status);
        for (name, value) in &self.headers {
            // Writing to a string cannot fail.
            let _ = write!(head, "{name}: {value}\r\n");
        }
        head + "\r\n"
    }
}

/// Answers a request from the files below `folder`.
pub fn answer(folder: &Path, request: &Request) -> Reply {
    if request.method != "GET" && request.method != "HEAD" {
        return Reply::text(405, "Only GET and HEAD are answered here");
    }
    let mut reply = match file_path(&request.target) {
        Some(path) => send_file(&folder.join(&path), request),
        None => not_found(request),
    };
    if request.method == "HEAD" {
        reply.body.clear();
    }
    reply
}

fn not_found(request: &Request) -> Reply {
    Reply::text(404, &format!("There is no {} here", request.target))
}

/// The file's path below the folder, or nothing for a target that would lead out of it.
fn file_path(target: &str) -> Option<PathBuf> {
    let path = target.split(['?', '#']).next()?.strip_prefix('/')?;
    let mut path = percent_decoded(path)?;
    if path.is_empty() || path.ends_with('/') {
        path.push_str("index.html");
    }
    let path = PathBuf::from(path);
    let stays_inside = path.components().all(|part| match part {
        // A backslash separates on Windows only, but no file of the page has one either.
        Component::Normal(name) => !name.to_string_lossy().contains(['\\', ':', '\0']),
        _ => false,
    });
    stays_inside.then_some(path)
}

fn percent_decoded(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        if byte == b'%' {
            let digits = [rest.next()?, rest.next()?];
            bytes.push(u8::from_str_radix(std::str::from_utf8(&digits).ok()?, 16).ok()?);
        } else {
            bytes.push(byte);
        }
    }
    String::from_utf8(bytes).ok()
}

fn send_file(path: &Path, request: &Request) -> Reply {
    let encoded = encodings(&request.accept_encoding).find_map(|(encoding, suffix)| {
        let copy = PathBuf::from(format!("{}.{suffix}", path.display()));
        Some((regular_file(&copy)?, copy, Some(encoding)))
    });
    let plain = || Some((regular_file(path)?, path.to_path_buf(), None));
    let Some((metadata, copy, encoding)) = encoded.or_else(plain) else { return not_found(request) };

    let tag = entity_tag(&metadata, encoding);
    let mut reply = Reply { status: 200, headers: Vec::new(), body: Vec::new() };
    reply.add("ETag", tag.clone());
    reply.add("Vary", "Accept-Encoding");
    reply.add("Cache-Control", cache_control(path));
    if request.if_none_match.as_ref().is_some_and(|tags| names_tag(tags, &tag)) {
        reply.status = 304;
        return reply;
    }
    let Ok(body) = std::fs::read(&copy) else { return Reply::text(500, "The file could not be read") };
    reply.add("Content-Type", content_type(path));
    reply.add("Content-Length", body.len().to_string());
    if let Some(encoding) = encoding {
        reply.add("Content-Encoding", encoding);
    }
    reply.body = body;
    reply
}

fn regular_file(path: &Path) -> Option<Metadata> {
    path.metadata().ok().filter(Metadata::is_file)
}

/// The encodings that the browser accepts and the build makes, the smaller first, with their file suffixes.
fn encodings(accept_encoding: &str) -> impl Iterator<Item = (&'static str, &'static str)> {
    [("br", "br"), ("gzip", "gz")].into_iter().filter(|(name, _)| accepts(accept_encoding, name))
}

/// `br;q=0` refuses what `br` and `br;q=0.5` accept.
fn accepts(accept_encoding: &str, name: &str) -> bool {
    accept_encoding.split(',').any(|entry| {
        let mut parts = entry.split(';').map(str::trim);
        let is_named = parts.next().is_some_and(|it| it.eq_ignore_ascii_case(name));
        let quality = parts.find_map(|part| part.strip_prefix("q=")?.parse::<f32>().ok());
        is_named && quality.unwrap_or(1.0) > 0.0
    })
}

/// Changes with every build: a file's size, its time and its encoding.
fn entity_tag(metadata: &Metadata, encoding: Option<&str>) -> String {
    let modified = metadata.modified().ok().and_then(|time| time.duration_since(UNIX_EPOCH).ok());
    let nanoseconds = modified.map_or(0, |duration| duration.as_nanos());
    format!("\"{:x}-{nanoseconds:x}-{}\"", metadata.len(), encoding.unwrap_or("plain"))
}

fn names_tag(if_none_match: &str, tag: &str) -> bool {
    if_none_match.split(',').map(str::trim).any(|it| it == "*" || it.trim_start_matches("W/") == tag)
}

fn cache_control(path: &Path) -> &'static str {
    if is_content_hashed(&path.to_string_lossy()) {
        "public, max-age=31536000, immutable"
    } else {
        "no-cache"
    }
}

fn content_type(path: &Path) -> &'static str {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("wasm") => "application/wasm",
        Some("json") => "application/json",
        Some("webmanifest") => "application/manifest+json",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("jpg" | "jpeg") => "image/jpeg",
        Some("zip") => "application/zip",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests;
