use glam::{DAffine3, DQuat, DVec3, Vec3};

use super::*;
use crate::mesh::{MeshData, test_shapes};

/// Any turn and shift, so that no axis is a coordinate axis and none runs through the origin.
fn displaced(mesh: &Mesh) -> Mesh {
    let turn = DQuat::from_scaled_axis(DVec3::new(0.4, -0.9, 1.3));
    mesh.transformed(&DAffine3::from_rotation_translation(turn, DVec3::new(130.0, -40.0, 75.0))).unwrap()
}

fn up() -> DVec3 {
    DQuat::from_scaled_axis(DVec3::new(0.4, -0.9, 1.3)) * DVec3::Z
}

/// A polygon in the plane z = 0, extruded; its ends are fans about the origin.
fn extruded(outline: &[[f32; 2]], height_mm: f32) -> Mesh {
    let count = outline.len() as u32;
    let level = |z: f32| outline.iter().map(move |&[x, y]| Vec3::new(x, y, z));
    let mut positions_mm: Vec<Vec3> = level(-height_mm / 2.0).chain(level(height_mm / 2.0)).collect();
    positions_mm.extend([Vec3::Z * (-height_mm / 2.0), Vec3::Z * (height_mm / 2.0)]);
    let side = |i: u32| {
        let next = (i + 1) % count;
        let (top, next_top) = (i + count, next + count);
        [[i, next, next_top], [i, next_top, top], [next, i, 2 * count], [top, next_top, 2 * count + 1]]
    };
    let triangles = (0..count).flat_map(side).collect();
    Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() }).unwrap()
}

/// A star of `points` corners; with `inner` as `outer` times cos(π/points) a regular polygon.
fn star(points: u32, outer: f32, inner: f32) -> Vec<[f32; 2]> {
    (0..2 * points)
        .map(|i| {
            let (sin, cos) = (std::f32::consts::PI * i as f32 / points as f32).sin_cos();
            let radius = if i % 2 == 0 { outer } else { inner };
            [radius * cos, radius * sin]
        })
        .collect()
}

fn polygon(corners: u32, radius: f32) -> Vec<[f32; 2]> {
    star(corners, radius, radius * (std::f32::consts::PI / corners as f32).cos())
}

fn folds(found: &FoundSymmetries) -> Vec<Fold> {
    found.found.iter().map(|found| found.axis.fold).collect()
}

fn turns_of(found: &FoundSymmetries, mesh: &Mesh) -> usize {
    let mut symmetries = Symmetries::default();
    found.found.iter().for_each(|found| symmetries.add_axis(&found.axis, &mesh.sphere()).unwrap());
    symmetries.discrete.len()
}

#[test]
fn prisms_have_their_axis_and_can_be_turned_over() {
    for corners in [3, 4, 5, 6, 7, 8, 9, 10, 12] {
        // As high as makes all principal moments differ, and as low as a nut.
        for height in [90.0, 20.0] {
            let mesh = displaced(&extruded(&polygon(corners, 40.0), height));
            let found = find_symmetries(&mesh);
            assert_eq!(folds(&found), [Fold::Times(corners), Fold::Times(2)], "{corners} {height}");
            let main = &found.found[0];
            // The axis is that of exact moments, through numbers of f32.
            assert!(main.axis.axis.cross(up()).length() < 1e-5, "{corners} {height}: {}", main.axis.axis);
            assert!(main.worst_mm < 1e-3, "{}", main.worst_mm);
            assert_eq!(turns_of(&found, &mesh), 2 * corners as usize - 1);
        }
    }
}

#[test]
fn a_round_side_is_continuous() {
    let cylinder = displaced(&extruded(&polygon(64, 40.0), 100.0));
    let found = find_symmetries(&cylinder);
    assert_eq!(folds(&found), [Fold::Continuous, Fold::Times(2)]);
    // 64 sides are 40 (1 − cos(π/64)) = 0.05 mm within their circle.
    assert!(found.found[0].worst_mm < 0.06, "{}", found.found[0].worst_mm);
    // As high as makes all moments alike, so that the axis has to be looked for, and near that
    for height in [52.0, 58.0, 62.0, 68.0] {
        let found = find_symmetries(&displaced(&extruded(&polygon(48, 40.0), height)));
        assert_eq!(folds(&found), [Fold::Continuous, Fold::Times(2)], "{height}");
    }
    // A cone has no way to be turned over.
    let mut cone = extruded(&polygon(64, 40.0), 100.0).data().clone();
    cone.positions_mm.iter_mut().filter(|p| p.z > 0.0).for_each(|p| (p.x, p.y) = (p.x * 0.3, p.y * 0.3));
    assert_eq!(folds(&find_symmetries(&displaced(&Mesh::new(cone).unwrap()))), [Fold::Continuous]);
}

#[test]
fn a_sphere_has_more_than_one_continuous_axis() {
    let found = find_symmetries(&displaced(&test_shapes::sphere(50.0, 48, 96)));
    assert_eq!(folds(&found), [Fold::Continuous; 3]);
}

#[test]
fn boxes_and_solids() {
    let box_of = |x: f32, y: f32, z: f32| {
        let corners = [[x, y], [-x, y], [-x, -y], [x, -y]];
        displaced(&extruded(&corners, 2.0 * z))
    };
    for (mesh, turns) in
        [(box_of(20.0, 35.0, 60.0), 3), (box_of(30.0, 30.0, 55.0), 7), (box_of(30.0, 30.0, 30.0), 23)]
    {
        let found = find_symmetries(&mesh);
        assert_eq!(turns_of(&found, &mesh), turns, "{:?}", folds(&found));
    }
    let icosahedron = displaced(&icosahedron());
    let found = find_symmetries(&icosahedron);
    assert_eq!((turns_of(&found, &icosahedron), folds(&found)[0]), (59, Fold::Times(5)));
}

fn icosahedron() -> Mesh {
    let golden = (1.0 + 5.0_f32.sqrt()) / 2.0;
    let mut positions_mm = Vec::new();
    for (a, b) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
        positions_mm
            .extend([Vec3::new(0.0, a, b), Vec3::new(a, b, 0.0), Vec3::new(b, 0.0, a)].map(|p| p * 25.0));
    }
    let near = |a: u32, b: u32| positions_mm[a as usize].distance(positions_mm[b as usize]) < 51.0;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            triangles
                .extend((b + 1..12).filter(|&c| near(a, b) && near(b, c) && near(a, c)).map(|c| [a, b, c]));
        }
    }
    assert_eq!(triangles.len(), 20);
    Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() }).unwrap()
}

#[test]
fn what_has_no_axis_has_none() {
    // A plate whose corners are all its own.
    let plate = [[40.0, 0.0], [10.0, 30.0], [-35.0, 12.0], [-20.0, -25.0], [5.0, -18.0]];
    let mut wedge = extruded(&plate, 30.0).data().clone();
    wedge.positions_mm.iter_mut().filter(|p| p.z > 0.0).for_each(|p| p.x *= 0.7);
    let found = find_symmetries(&displaced(&Mesh::new(wedge).unwrap()));
    assert_eq!(folds(&found), []);
    // Without area: no mesh that anything could be said of.
    let line = MeshData {
        positions_mm: vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0],
        triangles: vec![[0, 1, 2]],
        ..MeshData::default()
    };
    assert_eq!(find_symmetries(&Mesh::new(line).unwrap()), FoundSymmetries::default());
}

#[test]
fn a_mirror_image_is_no_turn() {
    // An arrow head that grows thinner upwards: its left is its right, seen in a mirror, and nothing else.
    let arrow = [[40.0, 0.0], [0.0, 30.0], [-20.0, 15.0], [-12.0, 0.0], [-20.0, -15.0], [0.0, -30.0]];
    let mut tapered = extruded(&arrow, 24.0).data().clone();
    tapered.positions_mm.iter_mut().filter(|p| p.z > 0.0).for_each(|p| (p.x, p.y) = (p.x * 0.8, p.y * 0.8));
    assert_eq!(folds(&find_symmetries(&displaced(&Mesh::new(tapered).unwrap()))), []);
}

#[test]
fn a_handle_breaks_the_turns_and_a_small_dent_nearly() {
    let mut data = extruded(&polygon(6, 40.0), 60.0).data().clone();
    // One edge drawn outwards by 2 of 100 mm: beyond the tolerance, but not by far.
    let corner = data.positions_mm[0];
    let along: Vec<usize> = (0..data.positions_mm.len())
        .filter(|&i| data.positions_mm[i].truncate() == corner.truncate())
        .collect();
    along.into_iter().for_each(|i| data.positions_mm[i].x += 2.0);
    let found = find_symmetries(&displaced(&Mesh::new(data).unwrap()));
    // What leaves that edge where it is, the half turn through it, is left.
    assert_eq!(folds(&found), [Fold::Times(2)]);
    assert!(found.nearly.iter().any(|near| near.axis.fold == Fold::Times(6)), "{:?}", found.nearly);
}

#[test]
fn noise_of_a_scan_hides_no_axis() {
    let mut data = lobed(5, 60, 100).data().clone();
    let mut chance = crate::solve::test_chance::Chance(7);
    for position in &mut data.positions_mm {
        let step = [0, 1, 2].map(|_| chance.normal() as f32 * 0.1);
        *position += Vec3::from_array(step);
    }
    let found = find_symmetries(&displaced(&Mesh::new(data).unwrap()));
    assert_eq!(folds(&found), [Fold::Times(5), Fold::Times(2)]);
    // The noise, 0.1 mm of 100, turned twice and averaged over the surface.
    assert!(found.found[0].axis.axis.cross(up()).length() < 5e-3);
    assert!(found.found[0].mean_mm < 0.15 && found.found[0].worst_mm < 0.8, "{:?}", found.found[0]);
}

/// A sphere pressed into a body of lobes: curved all over, with many vertices.
fn lobed(lobes: u32, rings: u32, segments: u32) -> Mesh {
    let mut data = test_shapes::sphere(50.0, rings, segments).data().clone();
    for position in &mut data.positions_mm {
        let angle = position.y.atan2(position.x);
        let across = 1.0 + 0.15 * (lobes as f32 * angle).cos() * (position.truncate().length() / 50.0);
        *position = Vec3::new(position.x * across, position.y * across, position.z * 0.6);
    }
    Mesh::new(data).unwrap()
}
