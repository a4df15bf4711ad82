//! Shapes for this crate's tests.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::Vec3;

use super::{Mesh, MeshData, companion_key};
use crate::photo::{Pixels, png_rgba};

/// Files beside a mesh.
pub(crate) struct Folder(BTreeMap<String, Arc<[u8]>>);

impl Folder {
    pub fn of(files: &[(&str, &[u8])]) -> Self {
        Self(files.iter().map(|(name, bytes)| (companion_key(name), Arc::from(*bytes))).collect())
    }

    pub fn find(&self, key: &str) -> Option<Arc<[u8]>> {
        self.0.get(key).cloned()
    }

    pub fn without(mut self, key: &str) -> Self {
        self.0.remove(key);
        self
    }
}

/// Two pixels by two: red, green, and below them blue, white.
pub(crate) fn checker_png() -> Vec<u8> {
    let rgba = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255; 4]].concat();
    png_rgba(&Pixels { width: 2, height: 2, rgba }).expect("a small picture can be written")
}

/// The cube from −1 to 1, front sides out.
pub(crate) fn cube() -> Mesh {
    let corner = |i: u8| Vec3::from_array([0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -1.0 } else { 1.0 }));
    let squares = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Mesh::new(MeshData {
        positions_mm: (0..8).map(corner).collect(),
        triangles: squares.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        ..MeshData::default()
    })
    .expect("a cube is a mesh")
}

/// A sphere of `rings` × `segments` quadrangles, with triangles at the poles, front sides out.
pub(crate) fn sphere(radius_mm: f32, rings: u32, segments: u32) -> Mesh {
    let mut positions_mm = vec![Vec3::Z * radius_mm];
    for ring in 1..rings {
        let polar = std::f32::consts::PI * ring as f32 / rings as f32;
        positions_mm.extend((0..segments).map(|segment| {
            let azimuth = std::f32::consts::TAU * segment as f32 / segments as f32;
            radius_mm * Vec3::new(polar.sin() * azimuth.cos(), polar.sin() * azimuth.sin(), polar.cos())
        }));
    }
    positions_mm.push(Vec3::NEG_Z * radius_mm);
    let last = positions_mm.len() as u32 - 1;
    let vertex = |ring: u32, segment: u32| match ring {
        0 => 0,
        ring if ring == rings => last,
        ring => 1 + (ring - 1) * segments + segment % segments,
    };
    let mut triangles = Vec::new();
    for (ring, segment) in (0..rings).flat_map(|ring| (0..segments).map(move |segment| (ring, segment))) {
        let [a, b] = [vertex(ring, segment), vertex(ring, segment + 1)];
        let [c, d] = [vertex(ring + 1, segment), vertex(ring + 1, segment + 1)];
        if ring > 0 {
            triangles.push([a, c, b]);
        }
        if ring + 1 < rings {
            triangles.push([b, c, d]);
        }
    }
    Mesh::new(MeshData { positions_mm, triangles, ..MeshData::default() }).expect("a sphere is a mesh")
}
