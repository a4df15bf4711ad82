//! The photo as a surface in its camera's frustum.

use bytemuck::{Pod, Zeroable};
use glam::DVec2;

use super::PhotoPlane;
use crate::math::ImageRect;

/// Quadrangles per side. Between its corners a quadrangle is flat, where a lens bends: with 24 of them, by well under a
/// hundredth of what it bends over the whole photo.
const QUADS: u32 = 24;

/// Two triangles for each quadrangle.
pub const PLANE_INDEX_COUNT: u32 = QUADS * QUADS * 6;

/// A vertex in the frame of the photo's camera.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct PlaneVertex {
    position: [f32; 3],
    uv: [f32; 2],
}

impl PlaneVertex {
    pub const LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        array_stride: size_of::<Self>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x2],
    };
}

/// The plane's vertices: each where its own pixel's ray is at the plane's distance.
pub fn plane_vertices(plane: &PhotoPlane) -> Vec<PlaneVertex> {
    let rect = ImageRect::of_photo(plane.camera.width, plane.camera.height);
    let places = (0..=QUADS).flat_map(|row| (0..=QUADS).map(move |column| (column, row)));
    places
        .map(|(column, row)| {
            let uv = DVec2::new(f64::from(column), f64::from(row)) / f64::from(QUADS);
            let point = plane.camera.unproject(rect.min + uv * rect.size()) * plane.distance_mm;
            PlaneVertex { position: point.as_vec3().to_array(), uv: uv.as_vec2().to_array() }
        })
        .collect()
}

pub fn plane_indices() -> Vec<u16> {
    let vertex = |column: u32, row: u32| (row * (QUADS + 1) + column) as u16;
    let quads = (0..QUADS).flat_map(|row| (0..QUADS).map(move |column| (column, row)));
    quads
        .flat_map(|(column, row)| {
            let [a, b] = [vertex(column, row), vertex(column + 1, row)];
            let [c, d] = [vertex(column, row + 1), vertex(column + 1, row + 1)];
            [a, b, c, c, b, d]
        })
        .collect()
}
