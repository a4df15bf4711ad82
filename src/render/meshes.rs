//! Meshes as vertex and index buffers, uploaded once.

use std::sync::Arc;

use wgpu::util::DeviceExt;

use super::{Gpu, Usage};
use crate::mesh::{ShadingVertex, shading_vertices};
use crate::scene::MeshAsset;

/// A mesh that no picture has shown for so many pictures is dropped.
const KEPT_PICTURES: u64 = 240;

#[derive(Debug)]
pub struct MeshBuffers {
    pub vertices: wgpu::Buffer,
    pub indices: wgpu::Buffer,
    pub index_count: u32,
}

/// The meshes on the GPU.
#[derive(Debug, Default)]
pub struct Meshes {
    kept: Vec<Kept>,
    picture: u64,
}

#[derive(Debug)]
struct Kept {
    mesh: Arc<MeshAsset>,
    buffers: MeshBuffers,
    last_picture: u64,
}

impl Meshes {
    /// Begins a picture; meshes that were not drawn for a while are dropped.
    pub fn begin_picture(&mut self) {
        self.picture += 1;
        let oldest = self.picture.saturating_sub(KEPT_PICTURES);
        self.kept.retain(|kept| kept.last_picture >= oldest);
    }

    /// Makes sure that a mesh is on the GPU.
    pub fn ensure(&mut self, gpu: &Gpu, usage: &Usage, mesh: &Arc<MeshAsset>) {
        let picture = self.picture;
        match self.kept.iter_mut().find(|kept| Arc::ptr_eq(&kept.mesh, mesh)) {
            Some(kept) => kept.last_picture = picture,
            None => {
                let buffers = upload(gpu, usage, mesh);
                self.kept.push(Kept { mesh: mesh.clone(), buffers, last_picture: picture });
            }
        }
    }

    pub fn get(&self, mesh: &Arc<MeshAsset>) -> Option<&MeshBuffers> {
        self.kept.iter().find(|kept| Arc::ptr_eq(&kept.mesh, mesh)).map(|kept| &kept.buffers)
    }
}

impl MeshBuffers {
    pub const LAYOUT: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        array_stride: size_of::<ShadingVertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3],
    };
}

fn upload(gpu: &Gpu, usage: &Usage, mesh: &MeshAsset) -> MeshBuffers {
    let shading = shading_vertices(&mesh.mesh);
    let buffer = |label, contents: &[u8], usage_flag| {
        usage.add_upload(contents.len());
        gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(label),
            contents,
            usage: usage_flag,
        })
    };
    MeshBuffers {
        vertices: buffer(
            "mesh vertices",
            bytemuck::cast_slice(&shading.vertices),
            wgpu::BufferUsages::VERTEX,
        ),
        indices: buffer("mesh indices", bytemuck::cast_slice(&shading.indices), wgpu::BufferUsages::INDEX),
        index_count: shading.indices.len() as u32,
    }
}
