//! Meshes as vertex and index buffers, uploaded once.

use std::ops::Range;
use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use wgpu::util::DeviceExt;

use super::lines::EdgeInstance;
use super::surfaces::Surfaces;
use super::uniforms::draws_edges;
use super::{Gpu, Usage, ViewSlot};
use crate::mesh::{
    CoarseMesh, DrawnMesh, Mesh, ShadingGroup, ShadingMesh, ShadingVertex, mesh_edges, shading_vertices,
};
use crate::scene::{MeshAsset, OverlayMode};

/// A mesh that none of a view's last so many pictures has shown, nor any other view's, is dropped.
const KEPT_PICTURES: u64 = 240;

/// Positions are apart from the rest: silhouettes and hidden lines need nothing else.
#[derive(Debug)]
pub struct MeshBuffers {
    pub positions: wgpu::Buffer,
    pub attributes: wgpu::Buffer,
    pub indices: wgpu::Buffer,
    pub index_count: u32,
    pub groups: Vec<SurfaceGroup>,
    edges: Option<EdgeBuffers>,
}

/// Triangles that are drawn with one texture.
#[derive(Debug)]
pub struct SurfaceGroup {
    pub indices: Range<u32>,
    /// `None` where they have none.
    pub texture: Option<wgpu::BindGroup>,
}

/// Edges in the `object` frame, made when they are first looked at.
#[derive(Debug)]
struct EdgeBuffers {
    all: Option<EdgeBuffer>,
    features: Option<EdgeBuffer>,
}

#[derive(Debug)]
pub struct EdgeBuffer {
    pub instances: wgpu::Buffer,
    pub count: u32,
}

/// What a vertex has besides its position.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct VertexAttributes {
    /// A unit vector; the fourth is not used.
    normal: [i16; 4],
    color: [u8; 4],
    uv: [f32; 2],
}

/// The meshes on the GPU, for all views.
#[derive(Debug, Default)]
pub struct Meshes {
    kept: Vec<Kept>,
    /// How many pictures each view has had.
    pictures: [u64; ViewSlot::COUNT],
}

#[derive(Debug)]
struct Kept {
    mesh: Arc<MeshAsset>,
    /// Uploaded when it is drawn for the first time: a coarse copy may be shown before it.
    whole: Option<MeshBuffers>,
    waiting: Option<ShadingMesh>,
    /// Of a mesh of very many triangles, to be drawn while things move.
    coarse: Option<(CoarseMesh, MeshBuffers)>,
    textures: Vec<wgpu::BindGroup>,
    /// The number of the last picture that showed it, of each view.
    last_pictures: [Option<u64>; ViewSlot::COUNT],
}

impl Meshes {
    /// Begins a picture; meshes that were not drawn for a while are dropped.
    pub fn begin_picture(&mut self, slot: ViewSlot) {
        self.pictures[slot as usize] += 1;
        let pictures = self.pictures;
        let is_recent =
            |(last, now): (&Option<u64>, u64)| last.is_some_and(|last| last + KEPT_PICTURES >= now);
        self.kept.retain(|kept| kept.last_pictures.iter().zip(pictures).any(is_recent));
    }

    /// Makes sure that a mesh is on the GPU, with what the mode needs, as exact as [`Self::get`] is going to be asked for it.
    pub fn ensure(
        &mut self,
        gpu: &Gpu,
        usage: &Usage,
        slot: ViewSlot,
        mesh: &Arc<MeshAsset>,
        (mode, tolerance_mm): (OverlayMode, f64),
        surfaces: &Surfaces,
    ) {
        let picture = Some(self.pictures[slot as usize]);
        let position = self.kept.iter().position(|kept| Arc::ptr_eq(&kept.mesh, mesh));
        let position = position.unwrap_or_else(|| {
            self.kept.push(Kept::new(gpu, usage, mesh, surfaces));
            self.kept.len() - 1
        });
        let kept = &mut self.kept[position];
        kept.last_pictures[slot as usize] = picture;
        let (mesh, buffers) = match &mut kept.coarse {
            Some((coarse, buffers)) if coarse.cell_mm <= tolerance_mm => (&coarse.mesh, buffers),
            _ => {
                let (waiting, textures) = (&mut kept.waiting, &kept.textures);
                let upload = || {
                    let made = waiting.take().or_else(|| mesh.drawn.take_whole());
                    upload(gpu, usage, &made.unwrap_or_else(|| shading_vertices(&mesh.mesh)), textures)
                };
                (&mesh.mesh, kept.whole.get_or_insert_with(upload))
            }
        };
        if draws_edges(mode) {
            buffers.edges.get_or_insert_with(|| upload_edges(gpu, usage, mesh));
        }
    }

    /// A mesh's buffers: those of its coarse copy where the caller can do with an error of so many millimetres, and there
    /// is one.
    pub fn get(&self, mesh: &Arc<MeshAsset>, tolerance_mm: f64) -> Option<&MeshBuffers> {
        let kept = self.kept.iter().find(|kept| Arc::ptr_eq(&kept.mesh, mesh))?;
        match &kept.coarse {
            Some((coarse, buffers)) if coarse.cell_mm <= tolerance_mm => Some(buffers),
            _ => kept.whole.as_ref(),
        }
    }
}

impl Kept {
    fn new(gpu: &Gpu, usage: &Usage, mesh: &Arc<MeshAsset>, surfaces: &Surfaces) -> Self {
        let textures = mesh.mesh.paint().map_or(&[][..], |paint| &paint.textures);
        let textures: Vec<_> =
            textures.iter().map(|pixels| surfaces.of_texture(gpu, usage, pixels)).collect();
        let drawn = mesh.drawn.take().unwrap_or_else(|| DrawnMesh::of(&mesh.mesh));
        let coarse = drawn.coarse.map(|(coarse, shading)| {
            let buffers = upload(gpu, usage, &shading, &textures);
            (coarse, buffers)
        });
        Self {
            mesh: mesh.clone(),
            whole: None,
            waiting: drawn.shading,
            coarse,
            textures,
            last_pictures: [None; ViewSlot::COUNT],
        }
    }
}

impl MeshBuffers {
    pub const POSITIONS: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        array_stride: size_of::<[f32; 3]>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3],
    };

    pub const ATTRIBUTES: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
        array_stride: size_of::<VertexAttributes>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![1 => Snorm16x4, 2 => Unorm8x4, 3 => Float32x2],
    };

    /// The lines of a mode that draws lines, if the mesh has any.
    pub fn edges(&self, mode: OverlayMode) -> Option<&EdgeBuffer> {
        let edges = self.edges.as_ref()?;
        let edges = if mode == OverlayMode::Wireframe { &edges.all } else { &edges.features };
        edges.as_ref()
    }
}

impl VertexAttributes {
    fn new(vertex: &ShadingVertex) -> Self {
        let [x, y, z] = vertex.normal.map(|value| (value * f32::from(i16::MAX)).round() as i16);
        Self { normal: [x, y, z, 0], color: vertex.color, uv: vertex.uv }
    }
}

fn upload(gpu: &Gpu, usage: &Usage, shading: &ShadingMesh, textures: &[wgpu::BindGroup]) -> MeshBuffers {
    let group = |group: &ShadingGroup| SurfaceGroup {
        indices: group.indices.clone(),
        texture: group.texture.and_then(|texture| textures.get(texture as usize)).cloned(),
    };
    let positions: Vec<[f32; 3]> = shading.vertices.iter().map(|vertex| vertex.position).collect();
    let attributes: Vec<VertexAttributes> = shading.vertices.iter().map(VertexAttributes::new).collect();
    let vertex = wgpu::BufferUsages::VERTEX;
    MeshBuffers {
        positions: buffer(gpu, usage, "mesh positions", bytemuck::cast_slice(&positions), vertex),
        attributes: buffer(gpu, usage, "mesh attributes", bytemuck::cast_slice(&attributes), vertex),
        indices: buffer(
            gpu,
            usage,
            "mesh indices",
            bytemuck::cast_slice(&shading.indices),
            wgpu::BufferUsages::INDEX,
        ),
        index_count: shading.indices.len() as u32,
        groups: shading.groups.iter().map(group).collect(),
        edges: None,
    }
}

fn upload_edges(gpu: &Gpu, usage: &Usage, mesh: &Mesh) -> EdgeBuffers {
    let edges = mesh_edges(mesh);
    let upload = |edges: &[[u32; 2]]| {
        let position = |vertex: u32| mesh.positions_mm()[vertex as usize].to_array();
        let instances: Vec<EdgeInstance> =
            edges.iter().map(|&[from, to]| EdgeInstance { from: position(from), to: position(to) }).collect();
        // An empty buffer cannot be bound.
        (!instances.is_empty()).then(|| EdgeBuffer {
            instances: buffer(
                gpu,
                usage,
                "mesh edges",
                bytemuck::cast_slice(&instances),
                wgpu::BufferUsages::VERTEX,
            ),
            count: instances.len() as u32,
        })
    };
    EdgeBuffers { all: upload(&edges.all), features: upload(&edges.features) }
}

fn buffer(
    gpu: &Gpu,
    usage: &Usage,
    label: &str,
    contents: &[u8],
    usage_flag: wgpu::BufferUsages,
) -> wgpu::Buffer {
    usage.add_upload(contents.len());
    gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some(label),
        contents,
        usage: usage_flag,
    })
}
