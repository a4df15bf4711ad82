//! Meshes of analytic shapes.

use std::f32::consts::{PI, TAU};

use glam::Vec3;
use pinpose::mesh::{Mesh, MeshData};

/// About the z axis; `profile` goes from one pole to the other as pairs of radius and height. Poles are fans of thin triangles.
pub fn turned(profile: &[[f32; 2]], segments: u32) -> Mesh {
    let ring = |&[radius, z]: &[f32; 2]| {
        (0..segments).map(move |k| {
            let (sin, cos) = (TAU * k as f32 / segments as f32).sin_cos();
            Vec3::new(radius * cos, radius * sin, z)
        })
    };
    let positions_mm: Vec<Vec3> = profile.iter().flat_map(ring).collect();
    let quad = |ring: u32, k: u32| {
        let [a, b] = [ring * segments + k, ring * segments + (k + 1) % segments];
        [[a, b, b + segments], [a, b + segments, a + segments]]
    };
    let rings = profile.len() as u32 - 1;
    let triangles = (0..rings).flat_map(|ring| (0..segments).flat_map(move |k| quad(ring, k))).collect();
    Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() }).unwrap()
}

pub fn sphere(radius: f32, rings: u32) -> Mesh {
    let profile: Vec<[f32; 2]> = (0..=rings)
        .map(|k| {
            let (sin, cos) = (PI * k as f32 / rings as f32).sin_cos();
            [radius * sin, -radius * cos]
        })
        .collect();
    turned(&profile, 2 * rings)
}

/// With closed ends.
pub fn cylinder(radius: f32, height: f32, segments: u32) -> Mesh {
    let half = height / 2.0;
    turned(&[[0.0, -half], [radius, -half], [radius, half], [0.0, half]], segments)
}

pub fn cuboid(sizes: Vec3) -> Mesh {
    let corner = |k: u32| {
        let side = |axis: u32| if k >> axis & 1 == 1 { 0.5 } else { -0.5 };
        Vec3::new(side(0), side(1), side(2)) * sizes
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let data = MeshData { positions_mm: (0..8).map(corner).collect(), triangles, ..MeshData::default() };
    Mesh::new(data).unwrap()
}
