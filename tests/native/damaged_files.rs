//! Every small format and every photo's, cut short and with bytes changed at random: an error or something bounded comes
//! back, and no panic. Meshes have their own corpus.

use std::sync::Arc;

use pinpose::formats::dataset::{Contents, Listing, recognise};
use pinpose::formats::{Archive, NamedFile, classify, parse_text_or_archive};
use pinpose::photo::{decode, decode_depth, read_header};

/// What the fuzzers begin with, too.
#[allow(dead_code, reason = "the fuzzers use more of them")]
#[path = "../fuzz/src/seeds.rs"]
mod seeds;

/// So many changed files of each format.
const FLIPS: usize = 10_000;

/// Numbers that are the same in every run. Source: Vigna's SplitMix64.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    fn one_of<'a, T>(&mut self, values: &'a [T]) -> &'a T {
        &values[self.below(values.len())]
    }
}

/// Gives a file to `read` cut short at every 64th byte, and with one to four bytes changed.
fn damage(whole: &[u8], flips: usize, read: impl Fn(&[u8])) {
    for length in (0..whole.len()).step_by(64) {
        read(&whole[..length]);
    }
    let mut numbers = Numbers(5);
    for _ in 0..flips {
        let mut changed = whole.to_vec();
        for _ in 0..=numbers.below(4) {
            let position = numbers.below(changed.len());
            changed[position] = match numbers.below(3) {
                0 => numbers.next() as u8,
                1 => changed[position] ^ (1 << numbers.below(8)),
                // What texts and headers are made of.
                _ => *numbers.one_of(b"0123456789-.,:[]{}\"' \n\0\xff"),
            };
        }
        read(&changed);
    }
}

/// Reads a file as a drop would, and whatever it turns out to be.
fn read_as_dropped(name: &str, bytes: &[u8]) {
    let file = NamedFile { name: name.to_owned(), bytes: bytes.into() };
    // What matters is that it returns.
    let _ = parse_text_or_archive(&file, classify(name, bytes));
}

#[test]
fn texts() {
    for (name, text) in seeds::texts() {
        read_as_dropped(name, text.as_bytes());
        damage(text.as_bytes(), FLIPS, |bytes| read_as_dropped(name, bytes));
    }
}

#[test]
fn arrays() {
    let whole = seeds::npy();
    read_as_dropped("poses.npy", &whole);
    damage(&whole, FLIPS, |bytes| read_as_dropped("poses.npy", bytes));
}

#[test]
fn photos() {
    for (_, whole) in seeds::photos() {
        damage(&whole, FLIPS, |bytes| {
            let header = read_header(bytes);
            if let Ok(photo) = decode(bytes) {
                let pixels = photo.pixels;
                assert_eq!(pixels.rgba.len(), 4 * pixels.width as usize * pixels.height as usize);
                let header = header.unwrap();
                assert_eq!((pixels.width, pixels.height), (header.width, header.height));
            }
        });
    }
    damage(&seeds::depth(), FLIPS, |bytes| {
        if let Ok(depth) = decode_depth(bytes) {
            assert_eq!(depth.raw.len(), depth.width as usize * depth.height as usize);
        }
    });
}

#[test]
fn archives() {
    let whole = seeds::zipped(&[("camera.json", seeds::CAMERA), ("a/b.txt", seeds::POSE)]);
    damage(&whole, FLIPS, |bytes| {
        let Ok(mut archive) = Archive::open(bytes.into()) else { return };
        let Ok(listing) = archive.listing("zip") else { return };
        for path in listing.paths() {
            if let Ok(content) = archive.read(path) {
                assert!(content.len() < 1 << 20, "{path} grew to {} bytes", content.len());
            }
        }
    });
}

#[test]
fn data_sets() {
    let files = seeds::data_set();
    let names = ["1/rgb/000003.png", "1/mask/000003_000000.png", "models/obj_000005.ply"];
    let all = names.into_iter().chain(files.iter().map(|(path, _)| *path));
    let listing = Arc::new(Listing::new("set", all.map(|path| (path.to_owned(), 100))).unwrap());
    let recognised = recognise(&listing).unwrap();
    let whole: Contents =
        files.iter().map(|(path, text)| ((*path).to_owned(), Arc::from(text.as_bytes()))).collect();
    for (path, text) in &files {
        damage(text.as_bytes(), FLIPS, |bytes| {
            let mut contents = whole.clone();
            contents.insert((*path).to_owned(), bytes.into());
            // Whatever happens to its small files, the photo can be opened.
            assert_eq!(recognised.interpret(&[0], &contents).unwrap().photos.len(), 1);
        });
    }
}
