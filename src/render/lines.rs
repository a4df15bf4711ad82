//! Lines in space, and their instances on the GPU.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use crate::scene::Rgb;

/// A straight line between two points of the photo's camera frame, in millimetres, of some pixels' width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line3 {
    pub from: DVec3,
    pub to: DVec3,
    pub color: Rgb,
    pub width_px: f32,
    /// The length of a dash with its gap; 0 is a solid line.
    pub dash_px: f32,
    /// Over everything, not hidden by meshes.
    pub in_front: bool,
}

impl Line3 {
    pub fn solid(from: DVec3, to: DVec3, color: Rgb, width_px: f32) -> Self {
        Self { from, to, color, width_px, dash_px: 0.0, in_front: false }
    }
}

/// A [`Line3`] as `vs_line` reads it.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct LineInstance {
    from: [f32; 3],
    to: [f32; 3],
    width_and_dash_px: [f32; 2],
    color: [u8; 4],
}

impl LineInstance {
    pub const LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        array_stride: size_of::<Self>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x2, 3 => Unorm8x4],
    };

    fn new(line: &Line3) -> Self {
        let Rgb([red, green, blue]) = line.color;
        Self {
            from: line.from.as_vec3().to_array(),
            to: line.to.as_vec3().to_array(),
            width_and_dash_px: [line.width_px, line.dash_px],
            color: [red, green, blue, 255],
        }
    }

    /// Lines that meshes hide, then those in front of everything; and how many the first are.
    pub fn sorted(lines: &[Line3]) -> (Vec<Self>, u32) {
        let part = |in_front| lines.iter().filter(move |line| line.in_front == in_front).map(Self::new);
        let mut instances: Vec<Self> = part(false).collect();
        let behind = instances.len() as u32;
        instances.extend(part(true));
        (instances, behind)
    }
}

/// A mesh's edge as `vs_edge` reads it.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct EdgeInstance {
    pub from: [f32; 3],
    pub to: [f32; 3],
}

impl EdgeInstance {
    pub const LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        array_stride: size_of::<Self>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3],
    };
}
