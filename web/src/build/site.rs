//! Composes the static site: content-hashed names, the page that names them, the service worker that keeps them.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context as _, ensure};
use sha2::{Digest as _, Sha256};

/// Hexadecimal digits of a content hash in a file's name; 40 bits tell a site's few versions apart.
const HASH_DIGITS: usize = 10;

/// File contents by path inside the site, with `/` between folders.
pub type Files = BTreeMap<String, Vec<u8>>;

/// What wasm-bindgen made.
pub struct Bindings {
    pub wasm: Vec<u8>,
    pub script: Vec<u8>,
    /// Scripts that dependencies bring along, by the path at which `script` imports them.
    pub snippets: Files,
}

/// The page's hand-written files.
pub struct Sources {
    index: String,
    service_worker: String,
    /// Named with their hash in the site; the name is the one `index.html` uses.
    hashed: [(&'static str, Vec<u8>); 3],
    /// Named as they are: others find them by these names.
    plain: [(&'static str, Vec<u8>); 2],
}

impl Sources {
    pub fn read(root: &Path) -> anyhow::Result<Sources> {
        let page = root.join("web/page");
        let named = |name: &'static str| anyhow::Ok((name, read(&page.join(name))?));
        Ok(Sources {
            index: read_text(&root.join("index.html"))?,
            service_worker: read_text(&page.join("sw.js"))?,
            hashed: [named("boot.js")?, named("style.css")?, named("worker.js")?],
            plain: [named("icon.svg")?, named("manifest.webmanifest")?],
        })
    }
}

/// The site, ready to be written.
pub struct Site {
    pub files: Files,
    /// The crate's version and a hash of everything in the site but the demo.
    pub version: String,
    /// The wasm's path in `files`.
    pub wasm: String,
}

impl Site {
    /// Puts the page together. All addresses in it are relative, so it works from any folder of any server.
    pub fn compose(sources: &Sources, bindings: Bindings, package_version: &str) -> anyhow::Result<Site> {
        let mut files = Files::new();
        let mut names = BTreeMap::new();
        let hashed = sources.hashed.iter().map(|(name, bytes)| (*name, bytes.clone()));
        let compiled = [("pinpose.js", bindings.script), ("pinpose_bg.wasm", bindings.wasm)];
        for (name, bytes) in hashed.chain(compiled) {
            let hashed_name = hashed_name(name, &content_hash([bytes.as_slice()]));
            files.insert(hashed_name.clone(), bytes);
            names.insert(name, hashed_name);
        }
        files.extend(bindings.snippets);
        files.extend(sources.plain.iter().map(|(name, bytes)| ((*name).to_owned(), bytes.clone())));

        let templates = [sources.index.as_bytes(), sources.service_worker.as_bytes()];
        let everything = files.iter().flat_map(|(name, bytes)| [name.as_bytes(), bytes]).chain(templates);
        let version = format!("{package_version}+{}", content_hash(everything));

        let wasm = names["pinpose_bg.wasm"].clone();
        let index = fill_index(&sources.index, &names, &version, files[&wasm].len())?;
        files.insert("index.html".into(), index.into_bytes());
        let service_worker = fill_service_worker(&sources.service_worker, &version, &files);
        files.insert("sw.js".into(), service_worker.into_bytes());
        Ok(Site { files, version, wasm })
    }

    /// Copies the demo's archives. The service worker keeps them only once somebody has looked at one.
    pub fn add_demo(&mut self, folder: &Path) -> anyhow::Result<()> {
        if folder.is_dir() {
            let archives = read_tree(folder)?.into_iter().filter(|(name, _)| name.ends_with(".zip"));
            self.files.extend(archives.map(|(name, bytes)| (format!("demo/{name}"), bytes)));
        }
        Ok(())
    }
}

/// Replaces the plain names in `index.html` and gives it the facts that the boot script needs.
fn fill_index(
    template: &str,
    names: &BTreeMap<&str, String>,
    version: &str,
    wasm_bytes: usize,
) -> anyhow::Result<String> {
    let facts = serde_json::json!({
        "version": version,
        "script": names["pinpose.js"],
        "wasm": names["pinpose_bg.wasm"],
        "wasmBytes": wasm_bytes,
        "worker": names["worker.js"],
    });
    let mut index = template.to_owned();
    for name in ["boot.js", "style.css", "pinpose.js", "pinpose_bg.wasm"] {
        index = replace_once(&index, &format!("\"{name}\""), &format!("\"{}\"", names[name]))?;
    }
    replace_once(&index, "{{build}}", &facts.to_string())
}

fn replace_once(text: &str, old: &str, new: &str) -> anyhow::Result<String> {
    let count = text.matches(old).count();
    ensure!(count == 1, "index.html should say {old} once, not {count} times");
    Ok(text.replace(old, new))
}

/// The service worker's first lines are the version and the files that it keeps.
fn fill_service_worker(template: &str, version: &str, files: &Files) -> String {
    // The page itself is asked for as the folder it is in.
    let names = files.keys().map(|name| if name == "index.html" { "./" } else { name.as_str() });
    let names: serde_json::Value = names.collect();
    let version: serde_json::Value = version.into();
    format!("const VERSION = {version};\nconst FILES = {names};\n{template}")
}

/// The first digits of a SHA-256 over all parts, each with its length, so that no two lists of parts look alike.
fn content_hash<'a>(parts: impl IntoIterator<Item = &'a [u8]>) -> String {
    let mut hasher = Sha256::new();
    for part in parts {
        hasher.update((part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    let mut digits: String = hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
    digits.truncate(HASH_DIGITS);
    digits
}

/// `boot.js` → `boot-0123456789.js`, `pinpose_bg.wasm` → `pinpose-0123456789_bg.wasm`.
fn hashed_name(name: &str, hash: &str) -> String {
    let end_of_stem = name.find(['_', '.']).unwrap_or(name.len());
    format!("{}-{hash}{}", &name[..end_of_stem], &name[end_of_stem..])
}

/// Whether a path's name carries its content's hash: such a file never changes.
pub fn is_content_hashed(path: &str) -> bool {
    let name = path.rsplit('/').next().unwrap_or(path);
    let Some((_, rest)) = name.split_once('-') else { return false };
    let digits = rest.bytes().take_while(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f')).count();
    digits == HASH_DIGITS && rest[digits..].starts_with(['_', '.'])
}

/// Every file below a folder, by its path in it.
pub fn read_tree(folder: &Path) -> anyhow::Result<Files> {
    let mut files = Files::new();
    let entries = folder.read_dir().with_context(|| format!("Could not list {}", folder.display()))?;
    for entry in entries {
        let path = entry.with_context(|| format!("Could not list {}", folder.display()))?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() {
            files.extend(
                read_tree(&path)?.into_iter().map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)),
            );
        } else {
            files.insert(name, read(&path)?);
        }
    }
    Ok(files)
}

fn read(path: &Path) -> anyhow::Result<Vec<u8>> {
    std::fs::read(path).with_context(|| format!("Could not read {}", path.display()))
}

fn read_text(path: &Path) -> anyhow::Result<String> {
    std::fs::read_to_string(path).with_context(|| format!("Could not read {}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn compose(boot: &str) -> Site {
        let sources = Sources {
            index: r#"<a "boot.js" "style.css" "pinpose.js" "pinpose_bg.wasm">{{build}}"#.into(),
            service_worker: "// keeps FILES\n".into(),
            hashed: [("boot.js", boot.into()), ("style.css", vec![]), ("worker.js", vec![])],
            plain: [("icon.svg", vec![]), ("manifest.webmanifest", vec![])],
        };
        let bindings = Bindings { wasm: vec![1, 2, 3], script: vec![4], snippets: Files::new() };
        Site::compose(&sources, bindings, "1.2.3").expect("composes")
    }

    #[test]
    fn hashed_names_are_recognised() {
        assert_eq!(hashed_name("pinpose_bg.wasm", "0123456789"), "pinpose-0123456789_bg.wasm");
        for name in ["boot.js", "style.css", "pinpose_bg.wasm", "pinpose.js"] {
            assert!(!is_content_hashed(name));
            assert!(is_content_hashed(&format!(
                "sub/{}",
                hashed_name(name, &content_hash([name.as_bytes()]))
            )));
        }
        assert!(!is_content_hashed("demo/two-cups-2024.zip"));
    }

    #[test]
    fn the_page_names_its_files_and_the_service_worker_keeps_them() {
        let site = compose("start()");
        let index = String::from_utf8_lossy(&site.files["index.html"]).into_owned();
        let service_worker = String::from_utf8_lossy(&site.files["sw.js"]).into_owned();
        let kept: Vec<_> =
            site.files.keys().filter(|name| *name != "sw.js" && *name != "index.html").collect();
        assert_eq!(kept.len(), 7);
        for name in kept {
            assert!(service_worker.contains(&format!("\"{name}\"")), "{name} is not kept: {service_worker}");
        }
        assert!(service_worker.contains("\"./\"") && !service_worker.contains("index.html"));
        assert!(
            index.contains(&site.wasm) && index.contains(&site.version) && index.contains("\"wasmBytes\":3")
        );
    }

    #[test]
    fn the_version_follows_the_content() {
        assert_eq!(compose("a").version, compose("a").version);
        assert_ne!(compose("a").version, compose("b").version);
        assert!(compose("a").version.starts_with("1.2.3+"));
    }
}
