//! How fast meshes load, and in how much memory, against trimesh reading the same files in the same run.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a measurement that cannot be made had better stop"
)]

mod made;
mod python;

use std::path::Path;
use std::time::Instant;

use peak_alloc::PeakAlloc;
use pinpose::mesh::{load, no_companions};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

const REPETITIONS: usize = 5;

struct Case {
    name: &'static str,
    bytes: Vec<u8>,
    triangles: usize,
    /// How many times as fast as trimesh it has to be.
    least_ratio: f64,
    /// Peak memory while loading to the file's size, without the file.
    most_memory: Option<f64>,
}

fn main() {
    let large = made::ball(1000, 501);
    let small = made::ball(400, 251);
    let cases = [
        Case::new("binary.ply", made::binary_ply(&large), &large, 1.0, Some(4.0)),
        Case::new("binary.glb", made::glb(&large), &large, 1.0, Some(4.0)),
        Case::new("ascii.ply", made::ascii_ply(&small), &small, 2.0, None),
        Case::new("text.obj", made::obj(&small), &small, 2.0, None),
    ];
    drop((large, small));
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let python = python::with_trimesh();
    if let Err(problem) = &python {
        println!("trimesh is not compared with: {problem}");
    }
    println!(
        "{:12} {:>10} {:>9} {:>10} {:>7} {:>12}",
        "file", "triangles", "MB", "seconds", "ratio", "memory/file"
    );
    for case in cases {
        let path = folder.join(case.name);
        std::fs::write(&path, &case.bytes).expect("the file can be written");
        let (seconds, memory) = case.measure();
        let theirs = python.as_ref().ok().map(|python| python::load(python, &path, REPETITIONS));
        let ratio = match theirs {
            Some(Ok(theirs)) => {
                assert_eq!(theirs.triangles, case.triangles, "trimesh {} reads another mesh", theirs.version);
                let ratio = theirs.seconds / seconds;
                let verdict = if ratio < case.least_ratio { " too slow" } else { "" };
                format!("{ratio:.1}{verdict}")
            }
            Some(Err(problem)) => format!("none ({problem})"),
            None => "-".to_owned(),
        };
        let verdict = if case.most_memory.is_some_and(|most| memory > most) { " too much" } else { "" };
        let megabytes = case.bytes.len() as f64 / 1e6;
        println!(
            "{:12} {:>10} {megabytes:>9.1} {seconds:>10.4} {ratio:>7} {memory:>12.2}{verdict}",
            case.name, case.triangles
        );
    }
}

impl Case {
    fn new(
        name: &'static str,
        bytes: Vec<u8>,
        mesh: &made::Ball,
        least_ratio: f64,
        most_memory: Option<f64>,
    ) -> Self {
        Self { name, bytes, triangles: mesh.triangles.len(), least_ratio, most_memory }
    }

    /// The quickest of several, in seconds, and the most memory as a multiple of the file's size.
    fn measure(&self) -> (f64, f64) {
        let (mut quickest, mut most) = (f64::INFINITY, 0);
        for _ in 0..REPETITIONS {
            let before = MEMORY.current_usage();
            MEMORY.reset_peak_usage();
            let start = Instant::now();
            let loaded = load(self.name, &self.bytes, &no_companions).expect("a whole file");
            quickest = f64::min(quickest, start.elapsed().as_secs_f64());
            most = most.max(MEMORY.peak_usage().saturating_sub(before));
            assert_eq!(loaded.mesh.triangles().len(), self.triangles);
        }
        (quickest, most as f64 / self.bytes.len() as f64)
    }
}
