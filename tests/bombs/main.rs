//! Small files that announce, or unpack to, more than a memory holds: each is refused quickly and within 256 MiB, or is
//! opened within them. A program of its own, for its allocator counts.

#![allow(clippy::unwrap_used, reason = "a test that cannot make its files had better stop")]

use std::io::{Cursor, Write as _};
use std::time::{Duration, Instant};

use peak_alloc::PeakAlloc;
use pinpose::formats::dataset::Contents;
use pinpose::formats::{
    Archive, FileKind, NamedFile, classify, parse_text_or_archive, read_document, read_mesh, read_photo,
};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Beside the file itself.
const MOST_BYTES: usize = 256 << 20;
/// Generous: a test build on a busy machine. Without bounds each of these takes minutes, or all of the memory.
const LONGEST: Duration = Duration::from_secs(20);

/// Reads a file, checks what it took, and returns what is said of it; an empty text if it was opened.
fn measured(what: &str, read: impl FnOnce() -> Result<(), String>) -> String {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let start = Instant::now();
    let said = read().err().unwrap_or_default();
    let (took, most) = (start.elapsed(), MEMORY.peak_usage().saturating_sub(before));
    println!(
        "{what}: {:.1} MiB, {:.0} ms: {said}",
        most as f64 / f64::from(1 << 20),
        took.as_secs_f64() * 1e3
    );
    assert!(most <= MOST_BYTES, "{what} took {most} bytes");
    assert!(took <= LONGEST, "{what} took {took:?}");
    said
}

fn file(name: &str, bytes: impl Into<Vec<u8>>) -> NamedFile {
    NamedFile { name: name.to_owned(), bytes: bytes.into().into() }
}

/// Reads it as a drop would be read.
fn dropped(name: &str, bytes: impl Into<Vec<u8>>) -> String {
    let file = file(name, bytes);
    measured(name, || {
        let in_words = |error: &dyn std::fmt::Display| error.to_string();
        match classify(&file.name, &file.bytes) {
            FileKind::Mesh => read_mesh(&file).map(drop).map_err(|error| in_words(&error)),
            FileKind::Photo => read_photo(&file).map(drop).map_err(|error| in_words(&error)),
            kind => parse_text_or_archive(&file, kind).map(drop).map_err(|error| in_words(&error)),
        }
    })
}

/// One test: what one allocates would be counted for the others.
#[test]
fn bombs_are_refused_within_bounds() {
    zips();
    meshes();
    nested_texts();
    pictures_and_arrays();
}

fn zips() {
    // A megabyte of zip for a gigabyte.
    let zeros = vec![0; 16 << 20];
    let mut bomb = ZipWriter::new(Cursor::new(Vec::new()));
    let packed = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    bomb.start_file("scene.json", packed).unwrap();
    for _ in 0..64 {
        bomb.write_all(&zeros).unwrap();
    }
    let bomb = bomb.finish().unwrap().into_inner();
    drop(zeros);
    assert!(dropped("one-large.zip", bomb.clone()).contains("unpacks to more than"));
    measured("one-large.zip as a folder", || {
        let mut archive = Archive::open(bomb.clone().into()).map_err(|error| error.to_string())?;
        archive.read("scene.json").map(drop).map_err(|error| error.to_string())
    });

    // Each of them harmless, all together not.
    let spaces = vec![b' '; 32 << 20];
    let many = |first: &str| {
        let mut bomb = ZipWriter::new(Cursor::new(Vec::new()));
        for number in 0..32 {
            let name = if number == 0 { first.to_owned() } else { format!("{number}/scene_gt.json") };
            bomb.start_file(name, packed).unwrap();
            bomb.write_all(&spaces).unwrap();
        }
        bomb.finish().unwrap().into_inner()
    };
    assert!(dropped("many.zip", many("photos/0/a.png")).contains("unpacks to more than"));
    let folder = many("0/scene_gt.json");
    let said = measured("many.zip as a folder", || {
        let mut archive = Archive::open(folder.into()).map_err(|error| error.to_string())?;
        let listing = archive.listing("many.zip").map_err(|error| error.to_string())?;
        let mut contents = Contents::new();
        for path in listing.paths() {
            let content = archive.read(path).map_err(|error| error.to_string())?;
            contents.insert(path.to_owned(), content);
        }
        Ok(())
    });
    assert!(said.contains("too much"), "{said}");
}

fn meshes() {
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for (element, property) in [
            (
                "vertex 4000000000",
                "property float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices",
            ),
            (
                "vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 4000000000",
                "property list uchar int vertex_indices",
            ),
            (
                "material 18446744073709551615",
                "property uchar red\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices",
            ),
        ] {
            let ply = format!(
                "ply\nformat {format} 1.0\nelement {element}\n{property}\nend_header\n0 0 0\n1 0 0\n0 1 0\n"
            );
            assert!(!dropped("announced.ply", ply).is_empty());
        }
        // A polygon of four thousand million corners.
        let mut ply = format!("ply\nformat {format} 1.0\nelement vertex 3\nproperty uchar x\nproperty uchar y\nproperty uchar z\nelement face 1\nproperty list uint uchar vertex_indices\nend_header\n").into_bytes();
        ply.extend(if format == "ascii" {
            b"0 0 0\n1 0 0\n0 1 0\n4000000000 0\n".to_vec()
        } else {
            vec![255; 20]
        });
        assert!(!dropped("polygon.ply", ply).is_empty());
    }
    let mut stl = vec![0; 80];
    stl.extend(u32::MAX.to_le_bytes());
    stl.extend([0; 50]);
    assert!(!dropped("announced.stl", stl).is_empty());
    assert!(!dropped("announced.off", "OFF\n4000000000 4000000000 0\n0 0 0\n").is_empty());
    assert!(!dropped("far.obj", "v 0 0 0\nf 1 4000000000 3\n").is_empty());

    let gltf = |nodes: &str, count: u64| {
        format!(
            r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{nodes}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
            "accessors": [{{"bufferView": 0, "componentType": 5126, "count": {count}, "type": "VEC3"}}],
            "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
            "buffers": [{{"byteLength": 36, "uri": "data:application/octet-stream;base64,{}"}}]}}"#,
            "A".repeat(48)
        )
    };
    let cycle = gltf(r#"{"children": [1]}, {"children": [0], "mesh": 0}"#, 3);
    assert!(dropped("cycle.gltf", cycle).contains("reached twice"));
    let itself = gltf(r#"{"children": [0], "mesh": 0}"#, 3);
    assert!(dropped("itself.gltf", itself).contains("reached twice"));
    assert!(!dropped("announced.gltf", gltf(r#"{"mesh": 0}"#, 4_000_000_000)).is_empty());
    // A chain as long as the file allows is no cycle, and no recursion either.
    let chain: Vec<String> = (1..20_000).map(|child| format!(r#"{{"children": [{child}]}}"#)).collect();
    assert_eq!(dropped("chain.gltf", gltf(&(chain.join(",") + r#",{"mesh": 0}"#), 3)), "");
    let nodes: Vec<String> = (0..1000).map(|_| r#"{"mesh": 0}"#.to_owned()).collect();
    let all: Vec<String> = (0..1000).map(|node| node.to_string()).collect();
    let instances = instanced(&nodes.join(","), &all.join(","));
    assert!(dropped("instances.glb", instances).contains("copies"));
}

/// One mesh of a hundred thousand vertices, drawn by each of the nodes.
fn instanced(nodes: &str, roots: &str) -> Vec<u8> {
    const VERTICES: usize = 99_999;
    let bytes = VERTICES * 12;
    let mut json = format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [{roots}]}}], "nodes": [{nodes}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": {VERTICES}, "type": "VEC3"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": {bytes}}}], "buffers": [{{"byteLength": {bytes}}}]}}"#
    )
    .into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((28 + json.len() as u32 + bytes as u32).to_le_bytes());
    glb.extend((json.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(json);
    glb.extend((bytes as u32).to_le_bytes());
    glb.extend(b"BIN\0");
    glb.resize(glb.len() + bytes, 0);
    glb
}

fn nested_texts() {
    const DEPTH: usize = 1_000_000;
    for (open, close) in [("[", "]"), ("{\"a\":", "}")] {
        let nested = open.repeat(DEPTH) + "1" + &close.repeat(DEPTH);
        for name in ["nested.json", "scene_gt.json", "camera.json", "nested.gltf"] {
            assert!(!dropped(name, nested.clone()).is_empty());
        }
        measured("nested document", || {
            read_document(nested.as_bytes()).map(drop).map_err(|error| error.to_string())
        });
        // Within a document of ours, where a value is expected.
        let inside = format!("{{\"format\": \"pinpose\", \"version\": 1, \"photos\": {nested}}}");
        assert!(!dropped("inside.json", inside).is_empty());
    }
    assert!(!dropped("nested.yml", "a: ".to_owned() + &"[".repeat(DEPTH) + &"]".repeat(DEPTH)).is_empty());
    assert!(!dropped("dashes.yml", "- ".repeat(DEPTH)).is_empty());
    let deeper: String = (0..3000).map(|depth| format!("{}a:\n", " ".repeat(depth))).collect();
    assert!(!dropped("deeper.yml", deeper).is_empty());
    // Many small values: each takes more than its text.
    for value in ["[],", "{},", "{\"\":0},", "0,"] {
        let count = (8 << 20) / value.len();
        assert!(!dropped("values.json", format!("[{}0]", value.repeat(count))).is_empty());
        assert!(!dropped("values.yml", format!("a: [{}0]", value.repeat(count))).is_empty());
    }
    assert!(!dropped("items.yml", "- 0\n".repeat(4 << 20)).is_empty());
}

fn pictures_and_arrays() {
    // A PNG of two thousand million pixels, and one that announces what a photo may have and holds nothing.
    for (width, height) in [(50_000_u32, 50_000_u32), (8000, 6000)] {
        let mut png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
        png.extend(width.to_be_bytes());
        png.extend(height.to_be_bytes());
        png.extend([8, 2, 0, 0, 0]);
        let checksum = crc32(&png[12..]);
        png.extend(checksum.to_be_bytes());
        png.extend(b"\0\0\0\0IDAT\x35\xaf\x06\x1e\0\0\0\0IEND\xae\x42\x60\x82");
        assert!(!dropped("announced.png", png).is_empty());
    }
    let mut npy =
        b"\x93NUMPY\x01\0\x76\0{'descr': '<f8', 'fortran_order': False, 'shape': (4000000000, 4, 4), }"
            .to_vec();
    npy.resize(128, b' ');
    assert!(!dropped("announced.npy", npy).is_empty());
}

/// As PNG has it.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |checksum: u32, byte: &u8| {
        (0..8).fold(checksum ^ u32::from(*byte), |value, _| {
            if value & 1 == 1 { (value >> 1) ^ 0xedb8_8320 } else { value >> 1 }
        })
    };
    !bytes.iter().fold(u32::MAX, step)
}
