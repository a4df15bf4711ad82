//! Which symmetries are found, and in what time.

use glam::Vec3;
use pinpose::mesh::{Mesh, load, no_companions};
use pinpose::scene::Fold;
use pinpose::solve::symmetry::{FoundSymmetry, find_symmetries};

use crate::numbers::cpu_secs;
use crate::real::data;
use crate::shapes::{cuboid, cylinder, sphere, turned};

pub fn symmetry() {
    println!(
        "Symmetries: axes that are found, and those that nearly are (3 % of the diameter); 1 s for 50k faces wanted"
    );
    println!("{:<24}{:>9}{:>9}  {:<32}nearly", "", "faces", "ms", "found");
    for (name, mesh) in shapes().into_iter().chain(linemod()) {
        let clock = cpu_secs();
        let found = find_symmetries(&mesh);
        let ms = (cpu_secs() - clock) * 1e3;
        let faces = mesh.triangles().len();
        println!("{name:<24}{faces:>9}{ms:>9.0}  {:<32}{}", words(&found.found), words(&found.nearly));
    }
}

fn shapes() -> Vec<(String, Mesh)> {
    let prism = |corners: u32| (format!("prism of {corners}"), cylinder(40.0, 90.0, corners));
    let cone = turned(&[[0.0, 0.0], [50.0, 0.0], [0.0, 110.0]], 256);
    let mut shapes = vec![
        ("sphere".to_owned(), sphere(60.0, 112)),
        ("cylinder".to_owned(), cylinder(40.0, 110.0, 8192)),
        ("cone".to_owned(), cone),
        ("box".to_owned(), cuboid(Vec3::new(140.0, 90.0, 60.0))),
        ("cube".to_owned(), cuboid(Vec3::splat(90.0))),
    ];
    shapes.extend([3, 4, 5, 6, 8].map(prism));
    shapes
}

/// The asymmetric ones of the data folder, where it is.
fn linemod() -> Vec<(String, Mesh)> {
    let files = std::fs::read_dir(data().join("linemod10")).into_iter().flatten();
    let mut paths: Vec<_> = files.filter_map(|file| Some(file.ok()?.path())).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "ply"));
    paths.sort();
    let mesh = |path: std::path::PathBuf| {
        let bytes = std::fs::read(&path).unwrap();
        let mesh = load(&path.display().to_string(), &bytes, &no_companions).unwrap().mesh;
        (path.file_stem().unwrap().to_string_lossy().into_owned(), mesh)
    };
    paths.into_iter().map(mesh).collect()
}

fn words(found: &[FoundSymmetry]) -> String {
    let word = |found: &FoundSymmetry| match found.axis.fold {
        Fold::Continuous => "any turn".to_owned(),
        Fold::Times(turns) => format!("{turns}-fold"),
    };
    if found.is_empty() { "none".to_owned() } else { found.iter().map(word).collect::<Vec<_>>().join(", ") }
}
