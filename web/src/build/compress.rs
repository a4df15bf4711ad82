//! Compresses the site's files ahead of time, so that a server has nothing to do but to pick one.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::sync::Mutex;

use anyhow::Context as _;

use super::compile::Profile;

const COMPRESSIBLE: [&str; 7] = ["css", "html", "js", "json", "svg", "wasm", "webmanifest"];

/// The largest window that every browser accepts; the wasm is smaller than it.
const BROTLI_WINDOW_BITS: u32 = 24;

/// Bytes as they are, and on the wire under either encoding.
#[derive(Clone, Copy, Default)]
pub struct Sizes {
    pub raw: usize,
    pub gzip: usize,
    pub brotli: usize,
}

/// The compressed copies (`name.br`, `name.gz`) and what every file weighs.
pub struct Compressed {
    pub files: BTreeMap<String, Vec<u8>>,
    sizes: BTreeMap<String, Sizes>,
}

impl Compressed {
    pub fn sizes_of(&self, name: &str) -> Sizes {
        self.sizes.get(name).copied().unwrap_or_default()
    }

    /// The whole site without the demo scene, which is fetched only when it is asked for.
    pub fn total(&self) -> Sizes {
        let page = self.sizes.iter().filter(|(name, _)| !name.starts_with("demo/"));
        page.fold(Sizes::default(), |sum, (_, sizes)| Sizes {
            raw: sum.raw + sizes.raw,
            gzip: sum.gzip + sizes.gzip,
            brotli: sum.brotli + sizes.brotli,
        })
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Brotli,
    Gzip,
}

/// Compresses what gains from it, on two threads: the wasm's brotli takes as long as all the rest.
pub fn all(files: &BTreeMap<String, Vec<u8>>, profile: Profile) -> anyhow::Result<Compressed> {
    let mut work: Vec<_> = files.iter().filter(|(name, _)| is_compressible(name)).collect();
    work.sort_by_key(|(_, bytes)| bytes.len());
    let gzips = work.iter().map(|file| (*file, Encoding::Gzip));
    let brotlis = work.iter().map(|file| (*file, Encoding::Brotli));
    // Taken from the end: the longest first.
    let queue = Mutex::new(gzips.chain(brotlis).collect::<Vec<_>>());
    let done = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        let worker = || {
            while let Some((file, encoding)) = pop(&queue) {
                let packed = compress(file.1, encoding, profile);
                lock(&done).push((file, encoding, packed));
            }
        };
        let threads = [scope.spawn(worker), scope.spawn(worker)];
        drop(threads);
    });

    let raw = files.iter().map(|(name, bytes)| (name.clone(), bytes.len()));
    let sizes = raw.map(|(name, raw)| (name, Sizes { raw, gzip: raw, brotli: raw })).collect();
    let mut compressed = Compressed { files: BTreeMap::new(), sizes };
    for ((name, bytes), encoding, packed) in lock(&done).drain(..) {
        let packed = packed.with_context(|| format!("Could not compress {name}"))?;
        if packed.len() < bytes.len() {
            compressed.add(name, encoding, packed);
        }
    }
    Ok(compressed)
}

impl Compressed {
    fn add(&mut self, name: &str, encoding: Encoding, packed: Vec<u8>) {
        let sizes = self.sizes.entry(name.to_owned()).or_default();
        let (size, suffix) = match encoding {
            Encoding::Brotli => (&mut sizes.brotli, "br"),
            Encoding::Gzip => (&mut sizes.gzip, "gz"),
        };
        *size = packed.len();
        self.files.insert(format!("{name}.{suffix}"), packed);
    }
}

fn is_compressible(name: &str) -> bool {
    name.rsplit_once('.').is_some_and(|(_, extension)| COMPRESSIBLE.contains(&extension))
}

fn compress(bytes: &[u8], encoding: Encoding, profile: Profile) -> std::io::Result<Vec<u8>> {
    match encoding {
        Encoding::Brotli => {
            let quality = if profile == Profile::Web { 11 } else { 5 };
            let mut writer = brotli::CompressorWriter::new(Vec::new(), 1 << 16, quality, BROTLI_WINDOW_BITS);
            writer.write_all(bytes)?;
            Ok(writer.into_inner())
        }
        Encoding::Gzip => {
            let mut writer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
            writer.write_all(bytes)?;
            writer.finish()
        }
    }
}

fn pop<T>(queue: &Mutex<Vec<T>>) -> Option<T> {
    lock(queue).pop()
}

/// A thread that panicked ends the scope with that panic, so a poisoned lock is never looked into.
fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read as _;

    #[test]
    fn both_encodings_come_back_as_they_were() {
        let text = "a line of text\n".repeat(200).into_bytes();
        let files =
            BTreeMap::from([("boot.js".to_owned(), text.clone()), ("demo/a.zip".to_owned(), text.clone())]);
        let compressed = all(&files, Profile::Quick).expect("compresses");
        assert_eq!(compressed.files.keys().collect::<Vec<_>>(), ["boot.js.br", "boot.js.gz"]);

        let (mut from_brotli, mut from_gzip) = (Vec::new(), Vec::new());
        let brotli = compressed.files["boot.js.br"].as_slice();
        brotli::Decompressor::new(brotli, 4096).read_to_end(&mut from_brotli).expect("brotli");
        let gzip = compressed.files["boot.js.gz"].as_slice();
        flate2::read::GzDecoder::new(gzip).read_to_end(&mut from_gzip).expect("gzip");
        assert_eq!((&from_brotli, &from_gzip), (&text, &text));
        assert_eq!(compressed.total().raw, text.len(), "the demo is not part of the page's weight");
    }

    #[test]
    fn a_file_that_gains_nothing_has_no_copy() {
        let files = BTreeMap::from([("tiny.js".to_owned(), b"1".to_vec())]);
        let compressed = all(&files, Profile::Web).expect("compresses");
        assert!(compressed.files.is_empty());
        assert_eq!(compressed.sizes_of("tiny.js").brotli, 1);
    }
}
