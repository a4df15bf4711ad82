//! Shaders, bind group layouts and pipelines. A pipeline is made when it is first used: most sessions need a few of them.

mod recipe;

use std::cell::OnceCell;

use super::targets::COLOR_FORMAT;
use super::uniforms::{FrameUniform, ObjectUniform};
use recipe::{DepthUse, Recipe, Shader};

/// One shader file with the common parts before it.
#[derive(Debug, Clone, Copy)]
pub struct ShaderSource {
    pub name: &'static str,
    pub wgsl: &'static str,
}

macro_rules! shader {
    ($name:literal, $($file:literal),+) => {
        ShaderSource { name: $name, wgsl: concat!($(include_str!(concat!("../../shaders/", $file))),+) }
    };
}

const MESH: ShaderSource = shader!("mesh", "common.wgsl", "object.wgsl", "mesh.wgsl");
const LINES: ShaderSource = shader!("lines", "common.wgsl", "object.wgsl", "lines.wgsl");
const PLANE: ShaderSource = shader!("plane", "common.wgsl", "object.wgsl", "plane.wgsl");
const OCCLUDER: ShaderSource = shader!("occluder", "common.wgsl", "occluder.wgsl");
const COMPOSE: ShaderSource = shader!("compose", "common.wgsl", "compose.wgsl");

/// Every shader there is, for the test that validates them for each target language.
pub const SHADERS: &[ShaderSource] = &[MESH, LINES, PLANE, OCCLUDER, COMPOSE];

/// How many textures [`Pipelines::compose_layout`] holds, besides its sampler.
pub const COMPOSE_TEXTURES: usize = 8;

/// Every pipeline there is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PipelineKind {
    Lit,
    Colored,
    Nocs,
    Normals,
    DepthColors,
    /// The same blended over what they hide, at the depth that [`Self::Depth`] left.
    LitThrough,
    ColoredThrough,
    NocsThrough,
    NormalsThrough,
    DepthColorsThrough,
    Depth,
    /// Depth a little behind the surface, for the lines on it.
    DepthBehindLines,
    Ids,
    Edges,
    /// All edges, whatever hides them.
    HiddenEdges,
    /// The photo's plane, and lines, into the backdrop.
    PlaneBehind,
    LinesBehind,
    /// The same where they are before meshes, into the overlay and only where it is.
    PlaneBefore,
    LinesBefore,
    /// Lines over everything.
    LinesInFront,
    /// A depth map before meshes, and before their ids.
    Occluder,
    OccluderOfIds,
    /// What is composed. Below: what is around the photo, the photo as it is or with changes, its masks; or what is around
    /// objects in a free view.
    Background,
    Photo,
    ChangedPhoto,
    Masks,
    Backdrop,
    /// All that is below, drawn before.
    Base,
    /// Above: surfaces or how they differ from the photo, outlines, and the line of a wipe.
    Overlay,
    Difference,
    HiddenOutlines,
    Outlines,
    GhostOutlines,
    Wipe,
}

impl PipelineKind {
    const COUNT: usize = Self::Wipe as usize + 1;
    const ALL: [Self; Self::COUNT] = [
        Self::Lit,
        Self::Colored,
        Self::Nocs,
        Self::Normals,
        Self::DepthColors,
        Self::LitThrough,
        Self::ColoredThrough,
        Self::NocsThrough,
        Self::NormalsThrough,
        Self::DepthColorsThrough,
        Self::Depth,
        Self::DepthBehindLines,
        Self::Ids,
        Self::Edges,
        Self::HiddenEdges,
        Self::PlaneBehind,
        Self::LinesBehind,
        Self::PlaneBefore,
        Self::LinesBefore,
        Self::LinesInFront,
        Self::Occluder,
        Self::OccluderOfIds,
        Self::Background,
        Self::Photo,
        Self::ChangedPhoto,
        Self::Masks,
        Self::Backdrop,
        Self::Base,
        Self::Overlay,
        Self::Difference,
        Self::HiddenOutlines,
        Self::Outlines,
        Self::GhostOutlines,
        Self::Wipe,
    ];

    fn is_composed(self) -> bool {
        self as usize >= Self::Background as usize
    }

    /// Of what covers the target by one triangle; all others that are composed are rectangles.
    pub fn composed_vertices(self) -> u32 {
        if matches!(self, Self::Background | Self::Backdrop | Self::Base) { 3 } else { 6 }
    }

    /// Whether it wants a mesh's normals, colours and texture coordinates.
    pub fn reads_attributes(self) -> bool {
        let reads_normals = matches!(
            self,
            Self::Lit
                | Self::Normals
                | Self::DepthColors
                | Self::LitThrough
                | Self::NormalsThrough
                | Self::DepthColorsThrough
        );
        reads_normals || self.reads_textures()
    }

    /// Whether it is drawn texture by texture.
    pub fn reads_textures(self) -> bool {
        matches!(self, Self::Colored | Self::ColoredThrough)
    }
}

#[derive(Debug)]
pub struct Pipelines {
    device: wgpu::Device,
    pub frame_layout: wgpu::BindGroupLayout,
    pub object_layout: wgpu::BindGroupLayout,
    /// A texture, its sampler, and another texture: of meshes and of the photo's plane.
    pub surface_layout: wgpu::BindGroupLayout,
    /// A texture of numbers.
    pub occluder_layout: wgpu::BindGroupLayout,
    pub compose_layout: wgpu::BindGroupLayout,
    object_pipeline_layout: wgpu::PipelineLayout,
    surface_pipeline_layout: wgpu::PipelineLayout,
    occluder_pipeline_layout: wgpu::PipelineLayout,
    compose_pipeline_layout: wgpu::PipelineLayout,
    mesh: wgpu::ShaderModule,
    lines: wgpu::ShaderModule,
    plane: wgpu::ShaderModule,
    occluder: wgpu::ShaderModule,
    compose: wgpu::ShaderModule,
    screen_format: wgpu::TextureFormat,
    made: Made,
    /// Those that compose, once more for the interface's render pass.
    made_on_screen: Made,
}

type Made = [OnceCell<wgpu::RenderPipeline>; PipelineKind::COUNT];

impl Pipelines {
    pub fn new(device: &wgpu::Device, screen_format: wgpu::TextureFormat) -> Self {
        let frame_layout = uniform_layout(device, "frame", size_of::<FrameUniform>(), false);
        let object_layout = uniform_layout(device, "object", size_of::<ObjectUniform>(), true);
        let surface_layout = textures_layout(device, "surface", 2);
        let occluder_layout = numbers_layout(device);
        let compose_layout = textures_layout(device, "compose", COMPOSE_TEXTURES);
        Self {
            object_pipeline_layout: pipeline_layout(device, &[&frame_layout, &object_layout]),
            surface_pipeline_layout: pipeline_layout(
                device,
                &[&frame_layout, &object_layout, &surface_layout],
            ),
            occluder_pipeline_layout: pipeline_layout(device, &[&frame_layout, &occluder_layout]),
            compose_pipeline_layout: pipeline_layout(device, &[&frame_layout, &compose_layout]),
            mesh: module(device, MESH),
            lines: module(device, LINES),
            plane: module(device, PLANE),
            occluder: module(device, OCCLUDER),
            compose: module(device, COMPOSE),
            device: device.clone(),
            frame_layout,
            object_layout,
            surface_layout,
            occluder_layout,
            compose_layout,
            screen_format,
            made: [const { OnceCell::new() }; PipelineKind::COUNT],
            made_on_screen: [const { OnceCell::new() }; PipelineKind::COUNT],
        }
    }

    /// For our own targets.
    pub fn get(&self, kind: PipelineKind) -> &wgpu::RenderPipeline {
        self.made[kind as usize].get_or_init(|| self.make(kind, COLOR_FORMAT))
    }

    /// For the interface's render pass.
    pub fn get_on_screen(&self, kind: PipelineKind) -> &wgpu::RenderPipeline {
        self.made_on_screen[kind as usize].get_or_init(|| self.make(kind, self.screen_format))
    }

    /// Makes all that were not used yet: what a test of a backend wants to know.
    pub fn make_all(&self) {
        for kind in PipelineKind::ALL {
            self.get(kind);
            if kind.is_composed() {
                self.get_on_screen(kind);
            }
        }
    }

    fn make(&self, kind: PipelineKind, format: wgpu::TextureFormat) -> wgpu::RenderPipeline {
        let recipe = Recipe::of(kind);
        let (module, layout) = match recipe.shader {
            Shader::Mesh => (&self.mesh, &self.object_pipeline_layout),
            Shader::TexturedMesh => (&self.mesh, &self.surface_pipeline_layout),
            Shader::Lines => (&self.lines, &self.object_pipeline_layout),
            Shader::Plane => (&self.plane, &self.surface_pipeline_layout),
            Shader::Occluder => (&self.occluder, &self.occluder_pipeline_layout),
            Shader::Compose => (&self.compose, &self.compose_pipeline_layout),
        };
        let target = wgpu::ColorTargetState {
            format,
            blend: recipe.blend,
            write_mask: if recipe.writes_color { wgpu::ColorWrites::ALL } else { wgpu::ColorWrites::empty() },
        };
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(recipe.fragment),
            layout: Some(layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(recipe.vertex),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: recipe.buffers,
            },
            // Both sides are drawn: scanned meshes have holes, and their faces do not always turn outwards.
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: recipe.depth.map(DepthUse::state),
            multisample: wgpu::MultisampleState {
                count: recipe.samples,
                ..wgpu::MultisampleState::default()
            },
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(recipe.fragment),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(target)],
            }),
            multiview_mask: None,
            cache: None,
        })
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

/// A texture, a sampler, and more textures.
fn textures_layout(device: &wgpu::Device, label: &str, textures: usize) -> wgpu::BindGroupLayout {
    let texture = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: true },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
    let entries: Vec<_> = (0..=textures as u32)
        .map(|binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: if binding == 1 { sampler } else { texture },
            count: None,
        })
        .collect();
    device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

fn numbers_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("occluder"),
        entries: &[wgpu::BindGroupLayoutEntry {
            binding: 0,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                // 32-bit floats are read as they are: not every device can filter them.
                sample_type: wgpu::TextureSampleType::Float { filterable: false },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        }],
    })
}
