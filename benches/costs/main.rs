//! What things cost, each with its ratio to something measured in the same run.

mod frames;

use std::hint::black_box;
use std::time::Instant;

use glam::{DVec3, Vec3};
use pinpose::math::{Intrinsics, Pose, Ray};
use pinpose::mesh::{Bvh, Mesh, MeshData, load, shading_vertices};
use pinpose::raster::{PixelRegion, RasterItem, rasterize};

/// Before anything is loaded come the frames: they also tell the memory that the program itself takes.
const PARTS: [(&str, fn()); 4] =
    [("frames", frames::frames), ("loading", loading), ("picking", picking), ("rasterizing", rasterizing)];

/// All parts, or those that are named: `cargo bench --bench costs -- frames`.
fn main() {
    println!("{:<46}{:>12}{:>10}  against", "", "ms", "ratio");
    let named: Vec<String> = std::env::args().skip(1).filter(|name| !name.starts_with('-')).collect();
    for (name, part) in PARTS {
        if named.is_empty() || named.iter().any(|wanted| wanted == name) {
            part();
        }
    }
}

/// The median of several runs, in milliseconds.
fn median_ms<T>(runs: usize, mut work: impl FnMut() -> T) -> f64 {
    let mut times: Vec<f64> = (0..runs)
        .map(|_| {
            let start = Instant::now();
            black_box(work());
            start.elapsed().as_secs_f64() * 1000.0
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn row(what: &str, ms: f64, peer_ms: f64, peer: &str) {
    println!("{what:<46}{ms:>12.3}{:>10.2}  {peer}", ms / peer_ms);
}

/// A bumpy sheet of `2 * side * side` triangles.
#[expect(clippy::expect_used, reason = "the sheet is made here")]
fn sheet(side: u32) -> Mesh {
    let height = |x: u32, y: u32| ((x as f32 * 0.7).sin() + (y as f32 * 0.3).cos()) * 4.0;
    let scale = 160.0 / side as f32;
    let middle = side as f32 / 2.0;
    let positions_mm = (0..=side)
        .flat_map(|y| (0..=side).map(move |x| (x, y)))
        .map(|(x, y)| Vec3::new((x as f32 - middle) * scale, (y as f32 - middle) * scale, height(x, y)))
        .collect();
    let corner = |x: u32, y: u32| y * (side + 1) + x;
    let triangles = (0..side)
        .flat_map(|y| (0..side).map(move |x| (x, y)))
        .flat_map(|(x, y)| {
            let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() }).expect("the sheet is a mesh")
}

fn binary_ply(mesh: &Mesh) -> Vec<u8> {
    let (vertices, faces) = (mesh.positions_mm(), mesh.triangles());
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        vertices.len(),
        faces.len()
    )
    .into_bytes();
    bytes.extend_from_slice(bytemuck::cast_slice(vertices));
    for face in faces {
        bytes.push(3);
        bytes.extend_from_slice(bytemuck::cast_slice(face));
    }
    bytes
}

fn loading() {
    let mesh = sheet(707);
    let bytes = binary_ply(&mesh);
    let copy_ms = median_ms(9, || bytes.clone());
    let peer = "copying the file's bytes";
    row("binary PLY, 1M triangles", median_ms(5, || load("sheet.ply", &bytes)), copy_ms, peer);
    row("  vertices for the GPU", median_ms(3, || shading_vertices(&mesh)), copy_ms, peer);
    row("  ray tree", median_ms(3, || Bvh::build(&mesh)), copy_ms, peer);
}

fn picking() {
    let ray = Ray { origin: DVec3::new(3.0, 7.0, -500.0), direction: DVec3::Z };
    let cost = |side: u32| {
        let mesh = sheet(side);
        let bvh = Bvh::build(&mesh);
        median_ms(9, || (0..1000).filter(|_| bvh.cast(&mesh, black_box(&ray)).is_some()).count()) / 1000.0
    };
    let small_ms = cost(70);
    row("a pick among 10k triangles", small_ms, small_ms, "itself");
    row("a pick among 1M triangles", cost(707), small_ms, "10k triangles");
}

fn rasterizing() {
    let camera = Intrinsics::pinhole(572.4, 573.6, 325.3, 242.0, 640, 480);
    let region = PixelRegion::of_camera(&camera);
    let camera_from_object = Pose::from_translation(DVec3::new(0.0, 0.0, 900.0));
    let cost = |side: u32| {
        let mesh = sheet(side);
        median_ms(9, || rasterize(&camera, &[RasterItem { mesh: &mesh, camera_from_object, id: 1 }], region))
    };
    let small_ms = cost(55);
    row("CPU mask and depth 640×480, 6k triangles", small_ms, small_ms, "itself");
    row("CPU mask and depth 640×480, 1M triangles", cost(707), small_ms, "6k triangles");
}
