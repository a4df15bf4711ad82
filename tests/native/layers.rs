//! The layer rule of `lib.rs`: imports only go down. Read off the tree, so that it cannot be forgotten.

use std::path::{Path, PathBuf};

const RANKS: [(&str, u32); 18] = [
    ("platform", 0),
    ("math", 1),
    ("photo", 2),
    ("mesh", 3),
    ("scene", 4),
    ("raster", 4),
    ("formats", 5),
    ("solve", 5),
    ("metrics", 5),
    ("session", 6),
    ("render", 7),
    ("interact", 7),
    ("study", 7),
    ("ui", 8),
    ("app", 9),
    ("api", 9),
    ("cli", 9),
    ("page", 10),
];

/// Names that may be used only in some rooms.
const RESERVED: [(&str, &[&str]); 11] = [
    ("egui", &["ui", "app", "api", "page", "main"]),
    ("eframe", &["app", "page", "main"]),
    ("egui_wgpu", &["ui", "page"]),
    // Besides the renderer: the viewport's callback, the program that hands it the device, and the entries.
    ("wgpu", &["render", "ui", "app", "page"]),
    ("wasm_bindgen", &["platform", "api", "page"]),
    ("web_sys", &["platform", "api", "page"]),
    ("js_sys", &["platform", "api", "page"]),
    ("std::fs", &["platform", "cli", "main"]),
    ("SystemTime", &["platform"]),
    ("Instant", &["platform"]),
    ("serde", &["formats", "study", "api", "cli"]),
];

/// Files that may use a library beyond its rooms.
const EXEMPT: [(&str, &str); 1] = [("ui/preferences.rs", "serde")];

#[test]
fn imports_only_go_down() {
    let mut violations = Vec::new();
    for (path, room, text) in sources() {
        let Some(rank) = rank(&room) else {
            assert!(matches!(room.as_str(), "lib" | "main"), "{} is in no room", path.display());
            continue;
        };
        for (line, named) in named_rooms(&text) {
            let Some(named_rank) = self::rank(&named) else { continue };
            let platform_from_below = named == "platform" && rank < 8;
            let is_render_scope =
                room != "render" || ["math", "photo", "mesh", "scene", "raster"].contains(&named.as_str());
            if named != room && (named_rank >= rank || platform_from_below || !is_render_scope) {
                violations.push(format!("{}:{line}: {room} names {named}", path.display()));
            }
        }
    }
    assert!(violations.is_empty(), "{}", violations.join("\n"));
}

#[test]
fn libraries_stay_in_their_rooms() {
    let mut violations = Vec::new();
    for (path, room, text) in sources() {
        for (index, line) in code_lines(&text) {
            for (name, rooms) in RESERVED {
                let exempt = EXEMPT.iter().any(|(file, allowed)| path.ends_with(file) && *allowed == name);
                if names(line, name) && !rooms.contains(&room.as_str()) && !exempt {
                    violations.push(format!("{}:{index}: {room} names {name}", path.display()));
                }
            }
        }
    }
    assert!(violations.is_empty(), "{}", violations.join("\n"));
}

#[test]
fn files_fit_a_few_screens() {
    let long: Vec<String> = sources()
        .filter(|(_, _, text)| text.lines().count() > 500)
        .map(|(path, _, _)| path.display().to_string())
        .collect();
    assert!(long.is_empty(), "over 500 lines, so two files: {long:?}");
}

/// Every source file with its room and its text.
fn sources() -> impl Iterator<Item = (PathBuf, String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    collect(&root, &mut files);
    assert!(files.len() > 30, "the tree was not found");
    files.into_iter().map(move |path| {
        let inside = path.strip_prefix(&root).unwrap();
        let room = inside.iter().next().unwrap().to_string_lossy().trim_end_matches(".rs").to_owned();
        let text = std::fs::read_to_string(&path).unwrap();
        (inside.to_owned(), room, text)
    })
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

/// Lines of the program itself: tests within a file may name what they like.
fn code_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let program = text.lines().take_while(|line| !line.starts_with("#[cfg(test)]"));
    program
        .enumerate()
        .map(|(index, line)| (index + 1, line))
        .filter(|(_, line)| !line.trim_start().starts_with("//"))
}

/// Rooms that a file names as `crate::room`.
fn named_rooms(text: &str) -> Vec<(usize, String)> {
    let mut named = Vec::new();
    for (index, line) in code_lines(text) {
        for (position, _) in line.match_indices("crate::") {
            let rest = &line[position + "crate::".len()..];
            let room: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            named.push((index, room));
        }
    }
    named
}

fn names(line: &str, name: &str) -> bool {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    line.match_indices(name).any(|(position, _)| {
        let before = line[..position].chars().next_back();
        let after = line[position + name.len()..].chars().next();
        let whole = !before.is_some_and(is_word) && !after.is_some_and(is_word);
        // `crate::egui`, a field or a text is not the library.
        whole
            && (after == Some(':') || name.contains("::") || name.chars().any(char::is_uppercase))
            && before != Some('"')
    })
}

fn rank(room: &str) -> Option<u32> {
    RANKS.iter().find(|(name, _)| *name == room).map(|(_, rank)| *rank)
}
