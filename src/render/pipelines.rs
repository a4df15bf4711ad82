//! Shaders, bind group layouts and pipelines, made once.

use super::meshes::MeshBuffers;
use super::targets::{COLOR_FORMAT, DEPTH_FORMAT, OVERLAY_SAMPLES};
use super::uniforms::{FrameUniform, ObjectUniform};

/// One shader file with the common part before it.
#[derive(Debug, Clone, Copy)]
pub struct ShaderSource {
    pub name: &'static str,
    pub wgsl: &'static str,
}

const MESH: ShaderSource = ShaderSource {
    name: "mesh",
    wgsl: concat!(include_str!("../../shaders/common.wgsl"), include_str!("../../shaders/mesh.wgsl")),
};

const COMPOSE: ShaderSource = ShaderSource {
    name: "compose",
    wgsl: concat!(include_str!("../../shaders/common.wgsl"), include_str!("../../shaders/compose.wgsl")),
};

/// Every shader there is, for the test that validates them for each target language.
pub const SHADERS: &[ShaderSource] = &[MESH, COMPOSE];

#[derive(Debug)]
pub struct Pipelines {
    pub frame_layout: wgpu::BindGroupLayout,
    pub object_layout: wgpu::BindGroupLayout,
    pub compose_layout: wgpu::BindGroupLayout,
    pub lit: wgpu::RenderPipeline,
    pub ids: wgpu::RenderPipeline,
    /// Into our own targets.
    pub compose: wgpu::RenderPipeline,
    /// Into the interface's render pass.
    pub compose_on_screen: wgpu::RenderPipeline,
}

impl Pipelines {
    pub fn new(device: &wgpu::Device, screen_format: wgpu::TextureFormat) -> Self {
        let frame_layout = uniform_layout(device, "frame", size_of::<FrameUniform>(), false);
        let object_layout = uniform_layout(device, "object", size_of::<ObjectUniform>(), true);
        let compose_layout = compose_layout(device);
        let mesh = module(device, MESH);
        let compose = module(device, COMPOSE);
        let mesh_layout = pipeline_layout(device, &[&frame_layout, &object_layout]);
        let picture_layout = pipeline_layout(device, &[&frame_layout, &compose_layout]);
        Self {
            lit: mesh_pipeline(device, &mesh_layout, &mesh, "fs_lit", OVERLAY_SAMPLES),
            ids: mesh_pipeline(device, &mesh_layout, &mesh, "fs_id", 1),
            compose: compose_pipeline(device, &picture_layout, &compose, COLOR_FORMAT),
            compose_on_screen: compose_pipeline(device, &picture_layout, &compose, screen_format),
            frame_layout,
            object_layout,
            compose_layout,
        }
    }
}

fn module(device: &wgpu::Device, source: ShaderSource) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(source.name),
        source: wgpu::ShaderSource::Wgsl(source.wgsl.into()),
    })
}

fn pipeline_layout(device: &wgpu::Device, groups: &[&wgpu::BindGroupLayout]) -> wgpu::PipelineLayout {
    let groups: Vec<_> = groups.iter().map(|group| Some(*group)).collect();
    device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &groups,
        immediate_size: 0,
    })
}

fn uniform_layout(
    device: &wgpu::Device,
    label: &str,
    size: usize,
    has_dynamic_offset: bool,
) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(label),
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset,
                min_binding_size: wgpu::BufferSize::new(size as u64),
            },
            count: None,
        }],
    })
}

fn compose_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let texture = |binding, filterable| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        },
        count: None,
    };
    let sampler = wgpu::BindGroupLayoutEntry {
        binding: 1,
        visibility: wgpu::ShaderStages::FRAGMENT,
        ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        count: None,
    };
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("compose"),
        entries: &[texture(0, true), sampler, texture(2, true), texture(3, true), texture(4, true)],
    })
}

fn mesh_pipeline(
    device: &wgpu::Device,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
    fragment: &str,
    samples: u32,
) -> wgpu::RenderPipeline {
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(fragment),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("vs_main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(MeshBuffers::LAYOUT)],
        },
        // Both sides are drawn: scanned meshes have holes, and their faces do not always turn outwards.
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            // Reversed: nearer is greater.
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState { count: samples, ..wgpu::MultisampleState::default() },
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(COLOR_FORMAT.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn compose_pipeline(
    device: &wgpu::Device,
    layout: &wgpu::PipelineLayout,
    module: &wgpu::ShaderModule,
    format: wgpu::TextureFormat,
) -> wgpu::RenderPipeline {
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("compose"),
        layout: Some(layout),
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("vs_main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some("fs_main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
