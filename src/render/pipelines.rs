//! Shaders, bind group layouts and pipelines. A pipeline is made when it is first used: most sessions need a few of them.

use std::cell::OnceCell;

use super::lines::{EdgeInstance, LineInstance};
use super::meshes::MeshBuffers;
use super::plane::PlaneVertex;
use super::targets::{COLOR_FORMAT, DEPTH_FORMAT, OVERLAY_SAMPLES};
use super::uniforms::{FrameUniform, ObjectUniform};

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
const COMPOSE: ShaderSource = shader!("compose", "common.wgsl", "compose.wgsl");

/// Every shader there is, for the test that validates them for each target language.
pub const SHADERS: &[ShaderSource] = &[MESH, LINES, PLANE, COMPOSE];

/// How many textures [`Pipelines::compose_layout`] holds, besides its sampler.
pub const COMPOSE_TEXTURES: usize = 7;

/// Every pipeline there is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PipelineKind {
    Lit,
    Colored,
    Nocs,
    /// The same three blended over what they hide, at the depth that [`Self::Depth`] left.
    LitThrough,
    ColoredThrough,
    NocsThrough,
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
    /// What is composed: the photo, without masks or with them, or what is around objects in a free view; overlay and
    /// outlines, or the difference with outlines; and a wipe's line.
    Photo,
    MaskedPhoto,
    Backdrop,
    Overlay,
    Difference,
    Wipe,
}

impl PipelineKind {
    const COUNT: usize = Self::Wipe as usize + 1;
    const ALL: [Self; Self::COUNT] = [
        Self::Lit,
        Self::Colored,
        Self::Nocs,
        Self::LitThrough,
        Self::ColoredThrough,
        Self::NocsThrough,
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
        Self::Photo,
        Self::MaskedPhoto,
        Self::Backdrop,
        Self::Overlay,
        Self::Difference,
        Self::Wipe,
    ];

    fn is_composed(self) -> bool {
        self as usize >= Self::Photo as usize
    }

    /// Whether it wants a mesh's normals, colours and texture coordinates.
    pub fn reads_attributes(self) -> bool {
        matches!(self, Self::Lit | Self::LitThrough) || self.reads_textures()
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
    pub compose_layout: wgpu::BindGroupLayout,
    object_pipeline_layout: wgpu::PipelineLayout,
    surface_pipeline_layout: wgpu::PipelineLayout,
    compose_pipeline_layout: wgpu::PipelineLayout,
    mesh: wgpu::ShaderModule,
    lines: wgpu::ShaderModule,
    plane: wgpu::ShaderModule,
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
        let compose_layout = textures_layout(device, "compose", COMPOSE_TEXTURES);
        Self {
            object_pipeline_layout: pipeline_layout(device, &[&frame_layout, &object_layout]),
            surface_pipeline_layout: pipeline_layout(
                device,
                &[&frame_layout, &object_layout, &surface_layout],
            ),
            compose_pipeline_layout: pipeline_layout(device, &[&frame_layout, &compose_layout]),
            mesh: module(device, MESH),
            lines: module(device, LINES),
            plane: module(device, PLANE),
            compose: module(device, COMPOSE),
            device: device.clone(),
            frame_layout,
            object_layout,
            surface_layout,
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
            Shader::Compose => (&self.compose, &self.compose_pipeline_layout),
        };
        let target = wgpu::ColorTargetState {
            format,
            blend: recipe.blend,
            write_mask: if recipe.fragment.is_some() {
                wgpu::ColorWrites::ALL
            } else {
                wgpu::ColorWrites::empty()
            },
        };
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(recipe.fragment.unwrap_or(recipe.vertex)),
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
                // A pass without colour still has a colour target; it writes nothing there.
                entry_point: Some(recipe.fragment.unwrap_or("fs_id")),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(target)],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

#[derive(Debug, Clone, Copy)]
enum Shader {
    Mesh,
    TexturedMesh,
    Lines,
    Plane,
    Compose,
}

/// How a pipeline treats depth. It is reversed: nearer is greater.
#[derive(Debug, Clone, Copy)]
struct DepthUse {
    writes: bool,
    passes: wgpu::CompareFunction,
    /// Pixels of the surface's own slope that it is moved away by.
    slope_bias: f32,
}

impl DepthUse {
    const SOLID: Self = Self { writes: true, passes: wgpu::CompareFunction::Greater, slope_bias: 0.0 };
    /// Half the width of a line on a screen of two pixels a point, and the part of a pixel that sampling takes.
    const SOLID_BEHIND_LINES: Self = Self { slope_bias: -2.5, ..Self::SOLID };
    const SEEN: Self = Self { writes: false, passes: wgpu::CompareFunction::GreaterEqual, slope_bias: 0.0 };
    const IGNORED: Self = Self { passes: wgpu::CompareFunction::Always, ..Self::SEEN };

    fn state(self) -> wgpu::DepthStencilState {
        wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(self.writes),
            depth_compare: Some(self.passes),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState { constant: 0, slope_scale: self.slope_bias, clamp: 0.0 },
        }
    }
}

/// Where something is already, and nowhere else: for what lies before a mesh that lets through what is behind it.
const ATOP: wgpu::BlendState = wgpu::BlendState {
    color: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::DstAlpha,
        dst_factor: wgpu::BlendFactor::OneMinusSrcAlpha,
        operation: wgpu::BlendOperation::Add,
    },
    alpha: wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::Zero,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    },
};

/// The greater of both: where a mesh's edges meet, their ends do not add up to dots.
const UNION: wgpu::BlendState = {
    let component = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Max,
    };
    wgpu::BlendState { color: component, alpha: component }
};

const OVER: wgpu::BlendState = wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING;

type Buffers = &'static [Option<wgpu::VertexBufferLayout<'static>>];

const POSITIONS: Buffers = &[Some(MeshBuffers::POSITIONS)];
const VERTICES: Buffers = &[Some(MeshBuffers::POSITIONS), Some(MeshBuffers::ATTRIBUTES)];
const EDGES: Buffers = &[Some(EdgeInstance::LAYOUT)];
const LINE_ENDS: Buffers = &[Some(LineInstance::LAYOUT)];
const PLANE_VERTICES: Buffers = &[Some(PlaneVertex::LAYOUT)];

#[derive(Debug, Clone, Copy)]
struct Recipe {
    shader: Shader,
    vertex: &'static str,
    /// `None` draws depth alone.
    fragment: Option<&'static str>,
    buffers: Buffers,
    depth: Option<DepthUse>,
    blend: Option<wgpu::BlendState>,
    samples: u32,
}

impl Recipe {
    fn of(kind: PipelineKind) -> Self {
        use PipelineKind as Kind;
        let lit = Self {
            shader: Shader::Mesh,
            vertex: "vs_lit",
            fragment: Some("fs_lit"),
            buffers: VERTICES,
            depth: Some(DepthUse::SOLID),
            blend: None,
            samples: OVERLAY_SAMPLES,
        };
        let colored =
            Self { shader: Shader::TexturedMesh, vertex: "vs_colored", fragment: Some("fs_colored"), ..lit };
        let nocs = Self { vertex: "vs_coordinates", fragment: Some("fs_nocs"), buffers: POSITIONS, ..lit };
        let depth = Self { vertex: "vs_position", fragment: None, buffers: POSITIONS, ..lit };
        let through = |solid: Self| Self { depth: Some(DepthUse::SEEN), blend: Some(OVER), ..solid };
        let lines = Self {
            shader: Shader::Lines,
            vertex: "vs_line",
            fragment: Some("fs_line"),
            buffers: LINE_ENDS,
            depth: Some(DepthUse::SEEN),
            blend: Some(OVER),
            ..lit
        };
        let edges = Self { vertex: "vs_edge", buffers: EDGES, blend: Some(UNION), ..lines };
        let plane = Self {
            shader: Shader::Plane,
            vertex: "vs_plane",
            fragment: Some("fs_plane"),
            buffers: PLANE_VERTICES,
            // Its own border runs on it.
            depth: Some(DepthUse::SOLID_BEHIND_LINES),
            blend: Some(OVER),
            ..lit
        };
        let composed = Self {
            shader: Shader::Compose,
            vertex: "vs_target",
            fragment: Some("fs_photo"),
            buffers: &[],
            depth: None,
            blend: None,
            samples: 1,
        };
        let overlay =
            Self { vertex: "vs_window", fragment: Some("fs_overlay"), blend: Some(OVER), ..composed };
        match kind {
            Kind::Lit => lit,
            Kind::Colored => colored,
            Kind::Nocs => nocs,
            Kind::LitThrough => through(lit),
            Kind::ColoredThrough => through(colored),
            Kind::NocsThrough => through(nocs),
            Kind::Depth => depth,
            Kind::DepthBehindLines => Self { depth: Some(DepthUse::SOLID_BEHIND_LINES), ..depth },
            Kind::Ids => Self { fragment: Some("fs_id"), samples: 1, ..depth },
            Kind::Edges => edges,
            Kind::HiddenEdges => {
                Self { fragment: Some("fs_faint_line"), depth: Some(DepthUse::IGNORED), ..edges }
            }
            Kind::PlaneBehind => plane,
            Kind::LinesBehind => lines,
            Kind::PlaneBefore => Self { blend: Some(ATOP), ..plane },
            Kind::LinesBefore => Self { blend: Some(ATOP), ..lines },
            Kind::LinesInFront => Self { depth: Some(DepthUse::IGNORED), ..lines },
            Kind::Photo => composed,
            Kind::MaskedPhoto => Self { fragment: Some("fs_masked_photo"), ..composed },
            Kind::Backdrop => Self { fragment: Some("fs_backdrop"), ..composed },
            Kind::Overlay => overlay,
            Kind::Difference => Self { fragment: Some("fs_difference"), ..overlay },
            Kind::Wipe => Self { vertex: "vs_wipe", fragment: Some("fs_wipe"), ..overlay },
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
