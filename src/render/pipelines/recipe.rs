//! What each pipeline is made of.

use super::PipelineKind;
use crate::render::lines::{EdgeInstance, LineInstance};
use crate::render::meshes::MeshBuffers;
use crate::render::plane::PlaneVertex;
use crate::render::targets::{DEPTH_FORMAT, OVERLAY_SAMPLES};

#[derive(Debug, Clone, Copy)]
pub enum Shader {
    Mesh,
    TexturedMesh,
    Lines,
    Plane,
    Occluder,
    Compose,
}

/// How a pipeline treats depth. It is reversed: nearer is greater.
#[derive(Debug, Clone, Copy)]
pub struct DepthUse {
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

    pub fn state(self) -> wgpu::DepthStencilState {
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
pub struct Recipe {
    pub shader: Shader,
    pub vertex: &'static str,
    pub fragment: &'static str,
    pub writes_color: bool,
    pub buffers: Buffers,
    pub depth: Option<DepthUse>,
    pub blend: Option<wgpu::BlendState>,
    pub samples: u32,
}

impl Recipe {
    pub fn of(kind: PipelineKind) -> Self {
        use PipelineKind as Kind;
        let lit = Self {
            shader: Shader::Mesh,
            vertex: "vs_lit",
            fragment: "fs_lit",
            writes_color: true,
            buffers: VERTICES,
            depth: Some(DepthUse::SOLID),
            blend: None,
            samples: OVERLAY_SAMPLES,
        };
        let colored =
            Self { shader: Shader::TexturedMesh, vertex: "vs_colored", fragment: "fs_colored", ..lit };
        let nocs = Self { vertex: "vs_coordinates", fragment: "fs_nocs", buffers: POSITIONS, ..lit };
        let normals = Self { fragment: "fs_normals", ..lit };
        let depth_colors = Self { fragment: "fs_depth", ..lit };
        let depth = Self {
            vertex: "vs_position",
            // A pass without colour still has a colour target; nothing is written there.
            fragment: "fs_id",
            writes_color: false,
            buffers: POSITIONS,
            ..lit
        };
        let through = |solid: Self| Self { depth: Some(DepthUse::SEEN), blend: Some(OVER), ..solid };
        let lines = Self {
            shader: Shader::Lines,
            vertex: "vs_line",
            fragment: "fs_line",
            buffers: LINE_ENDS,
            depth: Some(DepthUse::SEEN),
            blend: Some(OVER),
            ..lit
        };
        let edges = Self { vertex: "vs_edge", buffers: EDGES, blend: Some(UNION), ..lines };
        let plane = Self {
            shader: Shader::Plane,
            vertex: "vs_plane",
            fragment: "fs_plane",
            buffers: PLANE_VERTICES,
            // Its own border runs on it.
            depth: Some(DepthUse::SOLID_BEHIND_LINES),
            blend: Some(OVER),
            ..lit
        };
        let composed = Self {
            shader: Shader::Compose,
            vertex: "vs_target",
            fragment: "fs_background",
            writes_color: true,
            buffers: &[],
            depth: None,
            blend: None,
            samples: 1,
        };
        let photo = Self { vertex: "vs_photo", fragment: "fs_photo", ..composed };
        let occluder = Self {
            shader: Shader::Occluder,
            vertex: "vs_occluder",
            fragment: "fs_occluder",
            writes_color: false,
            buffers: &[],
            ..lit
        };
        let overlay = Self { vertex: "vs_window", fragment: "fs_overlay", blend: Some(OVER), ..composed };
        match kind {
            Kind::Lit => lit,
            Kind::Colored => colored,
            Kind::Nocs => nocs,
            Kind::Normals => normals,
            Kind::DepthColors => depth_colors,
            Kind::LitThrough => through(lit),
            Kind::ColoredThrough => through(colored),
            Kind::NocsThrough => through(nocs),
            Kind::NormalsThrough => through(normals),
            Kind::DepthColorsThrough => through(depth_colors),
            Kind::Depth => depth,
            Kind::DepthBehindLines => Self { depth: Some(DepthUse::SOLID_BEHIND_LINES), ..depth },
            Kind::Ids => Self { writes_color: true, samples: 1, ..depth },
            Kind::Edges => edges,
            Kind::HiddenEdges => Self { fragment: "fs_faint_line", depth: Some(DepthUse::IGNORED), ..edges },
            Kind::PlaneBehind => plane,
            Kind::LinesBehind => lines,
            Kind::PlaneBefore => Self { blend: Some(ATOP), ..plane },
            Kind::LinesBefore => Self { blend: Some(ATOP), ..lines },
            Kind::LinesInFront => Self { depth: Some(DepthUse::IGNORED), ..lines },
            Kind::Occluder => occluder,
            Kind::OccluderOfIds => Self { samples: 1, ..occluder },
            Kind::Background => composed,
            Kind::Photo => photo,
            Kind::ChangedPhoto => Self { fragment: "fs_changed_photo", ..photo },
            Kind::Masks => Self { fragment: "fs_masks", blend: Some(OVER), ..photo },
            Kind::Backdrop => Self { fragment: "fs_backdrop", ..composed },
            Kind::Base => Self { fragment: "fs_base", ..composed },
            Kind::Overlay => overlay,
            Kind::Difference => Self { fragment: "fs_difference", ..overlay },
            Kind::HiddenOutlines => Self { fragment: "fs_hidden_outlines", ..overlay },
            Kind::Outlines => Self { fragment: "fs_outlines", ..overlay },
            Kind::GhostOutlines => Self { fragment: "fs_ghost_outlines", ..overlay },
            Kind::Wipe => Self { vertex: "vs_wipe", fragment: "fs_wipe", ..overlay },
        }
    }
}
