//! One place where pictures are drawn: its targets, its uniforms, and what they hold.

use super::base::Base;
use super::extent::Window;
use super::lines::LineInstance;
use super::pipelines::Pipelines;
use super::plane::{PlaneVertex, plane_vertices};
use super::targets::{Targets, TargetsKind};
use super::uniforms::{FrameUniform, ObjectUniform};
use super::{Gpu, PhotoPlane, Picture, Usage};

/// Dynamic uniform offsets are multiples of this on every backend.
const OBJECT_STRIDE: usize = 256;

/// Where a picture goes. Each has its own targets: drawing one leaves the others as they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ViewSlot {
    /// The photo view.
    Photo,
    /// The free view, which may be beside it.
    Scene,
    /// A part of the photo view, larger.
    Loupe,
    /// Pictures that are read back.
    Export,
}

impl ViewSlot {
    pub(super) const COUNT: usize = Self::Export as usize + 1;
}

/// What a view's targets hold.
#[derive(Debug, PartialEq)]
pub struct Drawn {
    pub picture: Picture,
    pub corner: [u32; 2],
    pub size: [u32; 2],
    /// Whether silhouettes are there though the picture does not show them.
    pub with_ids: bool,
}

#[derive(Debug)]
pub struct View {
    frame: wgpu::Buffer,
    pub frame_group: wgpu::BindGroup,
    objects: wgpu::Buffer,
    pub objects_group: wgpu::BindGroup,
    objects_capacity: usize,
    pub lines: Option<wgpu::Buffer>,
    /// How many lines meshes hide; the rest are over everything.
    pub lines_behind: u32,
    pub line_count: u32,
    pub plane: Option<(PhotoPlane, wgpu::Buffer)>,
    pub plane_group: Option<wgpu::BindGroup>,
    pub targets: Option<Targets>,
    pub compose_group: Option<wgpu::BindGroup>,
    pub base: Base,
    /// What the targets hold, so that a repaint of the interface draws no mesh.
    pub drawn: Option<Drawn>,
}

impl View {
    pub fn new(gpu: &Gpu, pipelines: &Pipelines) -> Self {
        let device = &gpu.device;
        let frame_size = size_of::<FrameUniform>();
        let frame = dynamic_buffer(device, "frame", frame_size, wgpu::BufferUsages::UNIFORM);
        let objects_capacity = 16;
        let (objects, objects_group) = objects_buffer(device, pipelines, objects_capacity);
        Self {
            frame_group: uniform_group(device, &pipelines.frame_layout, &frame, frame_size),
            frame,
            objects,
            objects_group,
            objects_capacity,
            lines: None,
            lines_behind: 0,
            line_count: 0,
            plane: None,
            plane_group: None,
            targets: None,
            compose_group: None,
            base: Base::default(),
            drawn: None,
        }
    }

    /// Targets as a picture needs them, and the part of the view that they show. What is read back, and what is around
    /// the objects of a free view, is as large as the view.
    pub fn fit_targets(&mut self, gpu: &Gpu, wanted: &Drawn) -> Window {
        let picture = &wanted.picture;
        let window = if wanted.with_ids || picture.surroundings.is_some() {
            Window::whole(wanted.size)
        } else {
            Window::around(picture, wanted.size, self.targets.as_ref().map(|targets| targets.kind.size))
        };
        let kind = TargetsKind {
            size: window.size,
            has_backdrop: picture.surroundings.is_some(),
            has_hidden_ids: picture.outlines_hidden(),
        };
        if self.targets.as_ref().is_none_or(|targets| targets.kind != kind) {
            self.targets = Some(Targets::new(&gpu.device, kind));
        }
        window
    }

    /// Uniforms and lines, whose number depends on what is in the scene, not on how fine its meshes are.
    pub fn upload(
        &mut self,
        gpu: &Gpu,
        usage: &Usage,
        pipelines: &Pipelines,
        wanted: &Drawn,
        window: &Window,
    ) {
        let Drawn { picture, corner, size, .. } = wanted;
        let items = picture.items.iter().chain(&picture.ghosts);
        let mut objects: Vec<ObjectUniform> = items.map(|item| ObjectUniform::new(picture, item)).collect();
        objects.push(ObjectUniform::of_surroundings(picture, picture.plane()));
        if objects.len() > self.objects_capacity {
            self.objects_capacity = objects.len().next_power_of_two();
            let made = objects_buffer(&gpu.device, pipelines, self.objects_capacity);
            (self.objects, self.objects_group) = made;
        }
        let mut bytes = vec![0; objects.len() * OBJECT_STRIDE];
        for (slot, uniform) in bytes.chunks_exact_mut(OBJECT_STRIDE).zip(&objects) {
            slot[..size_of::<ObjectUniform>()].copy_from_slice(bytemuck::bytes_of(uniform));
        }
        write(gpu, usage, &self.objects, &bytes);
        let frame = FrameUniform::new(picture, *corner, *size, window);
        write(gpu, usage, &self.frame, bytemuck::bytes_of(&frame));
        self.upload_lines(gpu, usage, picture);
        self.upload_plane(gpu, usage, picture);
    }

    fn upload_lines(&mut self, gpu: &Gpu, usage: &Usage, picture: &Picture) {
        let (instances, behind) = LineInstance::sorted(picture.lines());
        (self.lines_behind, self.line_count) = (behind, instances.len() as u32);
        if instances.is_empty() {
            return;
        }
        let bytes: &[u8] = bytemuck::cast_slice(&instances);
        let fits = |buffer: &wgpu::Buffer| buffer.size() >= bytes.len() as u64;
        let buffer = match self.lines.take().filter(fits) {
            Some(buffer) => buffer,
            None => dynamic_buffer(
                &gpu.device,
                "lines",
                bytes.len().next_power_of_two(),
                wgpu::BufferUsages::VERTEX,
            ),
        };
        write(gpu, usage, &buffer, bytes);
        self.lines = Some(buffer);
    }

    fn upload_plane(&mut self, gpu: &Gpu, usage: &Usage, picture: &Picture) {
        let Some(plane) = picture.plane() else { return };
        let is_there = self
            .plane
            .as_ref()
            .is_some_and(|(there, _)| there.camera == plane.camera && there.distance_mm == plane.distance_mm);
        if is_there {
            return;
        }
        let vertices: Vec<PlaneVertex> = plane_vertices(plane);
        let bytes: &[u8] = bytemuck::cast_slice(&vertices);
        let buffer = match self.plane.take() {
            Some((_, buffer)) => buffer,
            None => dynamic_buffer(&gpu.device, "plane", bytes.len(), wgpu::BufferUsages::VERTEX),
        };
        write(gpu, usage, &buffer, bytes);
        self.plane = Some((*plane, buffer));
    }

    /// The offset of an object's uniform; after items and ghosts comes that of the surroundings.
    pub fn object_offset(number: usize) -> u32 {
        (number * OBJECT_STRIDE) as u32
    }
}

fn write(gpu: &Gpu, usage: &Usage, buffer: &wgpu::Buffer, bytes: &[u8]) {
    gpu.queue.write_buffer(buffer, 0, bytes);
    usage.add_upload(bytes.len());
}

fn objects_buffer(
    device: &wgpu::Device,
    pipelines: &Pipelines,
    capacity: usize,
) -> (wgpu::Buffer, wgpu::BindGroup) {
    let size = capacity * OBJECT_STRIDE;
    let buffer = dynamic_buffer(device, "objects", size, wgpu::BufferUsages::UNIFORM);
    let group = uniform_group(device, &pipelines.object_layout, &buffer, size_of::<ObjectUniform>());
    (buffer, group)
}

fn dynamic_buffer(
    device: &wgpu::Device,
    label: &str,
    size: usize,
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size as u64,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

fn uniform_group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    buffer: &wgpu::Buffer,
    size: usize,
) -> wgpu::BindGroup {
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout,
        entries: &[wgpu::BindGroupEntry {
            binding: 0,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer,
                offset: 0,
                size: wgpu::BufferSize::new(size as u64),
            }),
        }],
    })
}
