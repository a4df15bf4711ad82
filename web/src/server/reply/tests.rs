//! Each test asks as a browser would, of a folder made for it.

use super::*;

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str, files: &[(&str, &str)]) -> Folder {
        let folder = std::env::temp_dir().join(format!("pinpose-reply-{name}-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("demo")).expect("a folder");
        for (name, text) in files {
            std::fs::write(folder.join(name), text).expect("a file");
        }
        Folder(folder)
    }

    fn get(&self, target: &str, accept_encoding: &str) -> Reply {
        let (method, target) = ("GET".into(), target.into());
        answer(
            &self.0,
            &Request { method, target, accept_encoding: accept_encoding.into(), if_none_match: None },
        )
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).ok();
    }
}

fn header<'a>(reply: &'a Reply, name: &str) -> Option<&'a str> {
    reply.headers.iter().find(|(it, _)| *it == name).map(|(_, value)| value.as_str())
}

#[test]
fn types_are_the_ones_browsers_insist_on() {
    for (name, expected) in [
        ("a.wasm", "application/wasm"),
        ("a.js", "text/javascript; charset=utf-8"),
        ("a.json", "application/json"),
        ("a.svg", "image/svg+xml"),
        ("a.webmanifest", "application/manifest+json"),
        ("a.ply", "application/octet-stream"),
        ("a", "application/octet-stream"),
    ] {
        assert_eq!(content_type(Path::new(name)), expected, "{name}");
    }
}

#[test]
fn the_smallest_accepted_encoding_is_sent() {
    let folder =
        Folder::new("encoding", &[("a.js", "plain"), ("a.js.br", "br"), ("a.js.gz", "gz"), ("b.js", "b")]);
    for (accepted, body, encoding) in [
        ("gzip, deflate, br", "br", Some("br")),
        ("gzip;q=0.5, br;q=0", "gz", Some("gzip")),
        ("GZIP", "gz", Some("gzip")),
        ("identity", "plain", None),
        ("", "plain", None),
    ] {
        let reply = folder.get("/a.js", accepted);
        assert_eq!((reply.body.as_slice(), header(&reply, "Content-Encoding")), (body.as_bytes(), encoding));
        assert_eq!(header(&reply, "Vary"), Some("Accept-Encoding"));
        assert_eq!(header(&reply, "Content-Type"), Some("text/javascript; charset=utf-8"));
    }
    assert_eq!(folder.get("/b.js", "br, gzip").body, b"b", "a file without compressed copies");
}

#[test]
fn nothing_outside_the_folder_is_sent() {
    let folder = Folder::new("traversal", &[("index.html", "page"), ("demo/a b.zip", "archive")]);
    let outside = folder.0.with_extension("outside");
    std::fs::write(&outside, "secret").expect("a file");
    let name = outside.file_name().unwrap_or_default().to_string_lossy().into_owned();
    for target in [
        format!("/../{name}"),
        format!("/demo/../../{name}"),
        format!("/%2e%2e/{name}"),
        format!("/%2E%2E%2F{name}"),
        format!("//{}", outside.display()),
        format!("/..\\{name}"),
        "/%".into(),
        "/%ff".into(),
        "/a%00".into(),
        "index.html".into(),
    ] {
        assert_eq!(folder.get(&target, "").status, 404, "{target}");
    }
    std::fs::remove_file(&outside).ok();
    assert_eq!(folder.get("/?renderer=webgl", "").body, b"page");
    assert_eq!(folder.get("/demo/a%20b.zip", "").body, b"archive");
    assert_eq!(folder.get("/demo", "").status, 404, "folders are not listed");
    assert_eq!(header(&folder.get("/missing", ""), "Content-Type"), Some("text/plain; charset=utf-8"));
}

#[test]
fn an_unchanged_file_is_not_sent_again() {
    let folder = Folder::new("etag", &[("sw.js", "text"), ("sw.js.br", "br")]);
    let first = folder.get("/sw.js", "br");
    let tag = header(&first, "ETag").expect("a tag").to_owned();
    let ask = |method: &str, accept_encoding: &str, tags: &str| {
        let (method, if_none_match) = (method.into(), Some(tags.into()));
        let target = "/sw.js".into();
        answer(&folder.0, &Request { method, target, accept_encoding: accept_encoding.into(), if_none_match })
    };
    let again = ask("GET", "br", &format!("\"other\", W/{tag}"));
    assert_eq!((again.status, again.body.len()), (304, 0));
    assert_eq!(header(&again, "ETag"), Some(tag.as_str()));
    assert_eq!(ask("GET", "", &tag).status, 200, "another encoding is another entity");
    let head = ask("HEAD", "br", "\"other\"");
    assert_eq!((head.status, head.body.len(), header(&head, "Content-Length")), (200, 0, Some("2")));
    assert_eq!(ask("POST", "br", &tag).status, 405);
}

#[test]
fn only_hashed_names_are_kept_for_ever() {
    let forever = "public, max-age=31536000, immutable";
    assert_eq!(cache_control(Path::new("x/pinpose-0123456789_bg.wasm")), forever);
    for name in ["index.html", "sw.js", "build.json", "icon.svg", "demo/scene.zip"] {
        assert_eq!(cache_control(Path::new(name)), "no-cache", "{name}");
    }
}
