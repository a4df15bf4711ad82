//! The passes, in order: overlay, ids, ghosts, and all of them composed over the photo.

use super::meshes::Meshes;
use super::photos::PhotoTextures;
use super::pipelines::Pipelines;
use super::targets::{Targets, picture_target};
use super::uniforms::{FrameUniform, ObjectUniform};
use super::{Gpu, Item, Picture, PixelsPending, Usage};

/// Dynamic uniform offsets are multiples of this on every backend.
const OBJECT_STRIDE: usize = 256;

/// From so many screen pixels per photo pixel on, the photo's pixels are shown as squares.
const NEAREST_FROM_ZOOM: f64 = 2.0;

/// What is read back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// The finished picture.
    Picture,
    /// The drawn silhouettes, one sample at each pixel's centre: in alpha the item's id, plus 128 where it is selected.
    Ids,
}

/// All GPU state of the scene; one for the screen, others for pictures of other sizes.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    pipelines: Pipelines,
    photos: PhotoTextures,
    meshes: Meshes,
    frame: wgpu::Buffer,
    frame_group: wgpu::BindGroup,
    objects: wgpu::Buffer,
    objects_group: wgpu::BindGroup,
    objects_capacity: usize,
    linear: wgpu::Sampler,
    nearest: wgpu::Sampler,
    no_photo: wgpu::TextureView,
    targets: Option<Targets>,
    compose_group: Option<wgpu::BindGroup>,
    /// What the targets hold, so that a repaint of the interface draws no mesh.
    drawn: Option<Drawn>,
    pub usage: Usage,
}

#[derive(Debug, PartialEq)]
struct Drawn {
    picture: Picture,
    corner: [u32; 2],
    size: [u32; 2],
}

impl Renderer {
    /// `screen_format`: of the render pass that [`Self::paint`] will be called in.
    pub fn new(gpu: Gpu, screen_format: wgpu::TextureFormat) -> Self {
        let device = &gpu.device;
        let pipelines = Pipelines::new(device, screen_format);
        let frame = uniform_buffer(device, "frame", size_of::<FrameUniform>());
        let frame_group = uniform_group(device, &pipelines.frame_layout, &frame, size_of::<FrameUniform>());
        let objects_capacity = 16;
        let (objects, objects_group) = objects_buffer(device, &pipelines, objects_capacity);
        let sampler = |mag_filter, mipmap_filter| {
            device.create_sampler(&wgpu::SamplerDescriptor {
                mag_filter,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter,
                ..wgpu::SamplerDescriptor::default()
            })
        };
        Self {
            linear: sampler(wgpu::FilterMode::Linear, wgpu::MipmapFilterMode::Linear),
            nearest: sampler(wgpu::FilterMode::Nearest, wgpu::MipmapFilterMode::Nearest),
            no_photo: no_photo(device),
            photos: PhotoTextures::default(),
            meshes: Meshes::default(),
            targets: None,
            compose_group: None,
            drawn: None,
            usage: Usage::default(),
            pipelines,
            frame,
            frame_group,
            objects,
            objects_group,
            objects_capacity,
            gpu,
        }
    }

    /// A renderer without a screen.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn headless() -> Result<Self, super::GpuError> {
        Ok(Self::new(Gpu::headless()?, super::targets::COLOR_FORMAT))
    }

    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Records the passes up to the composition, for a target of `size` pixels at `corner` of its framebuffer. Does nothing
    /// where the targets hold that picture already.
    pub fn prepare(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        picture: &Picture,
        corner: [u32; 2],
        size: [u32; 2],
    ) {
        let limit = self.gpu.device.limits().max_texture_dimension_2d;
        let size = size.map(|side| side.clamp(1, limit));
        let wanted = Drawn { picture: picture.clone(), corner, size };
        if self.drawn.as_ref() == Some(&wanted) {
            return;
        }
        if self.targets.as_ref().is_none_or(|targets| targets.size != size) {
            self.targets = Some(Targets::new(&self.gpu.device, size));
        }
        self.upload(picture, corner, size);
        self.draw_meshes(encoder, picture);
        self.bind_compose(picture, size);
        self.drawn = Some(wanted);
    }

    /// Composes the prepared picture within a render pass of the screen's format.
    pub fn paint(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.compose(pass, &self.pipelines.compose_on_screen);
    }

    /// Draws a picture off screen and starts reading it back.
    pub fn draw_and_read(&mut self, picture: &Picture, size: [u32; 2], layer: Layer) -> PixelsPending {
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.prepare(&mut encoder, picture, [0, 0], size);
        let composed;
        let texture = match (&self.targets, layer) {
            (Some(targets), Layer::Ids) => &targets.ids,
            _ => {
                composed = picture_target(&self.gpu.device, size);
                let view = composed.create_view(&wgpu::TextureViewDescriptor::default());
                let mut pass = begin_pass(&mut encoder, "picture", &view, None, None);
                self.compose(&mut pass, &self.pipelines.compose);
                drop(pass);
                &composed
            }
        };
        let pending = PixelsPending::copy(&self.gpu, &mut encoder, texture);
        self.gpu.queue.submit([encoder.finish()]);
        pending.submitted();
        pending
    }

    fn compose(&self, pass: &mut wgpu::RenderPass<'_>, pipeline: &wgpu::RenderPipeline) {
        let Some(group) = &self.compose_group else { return };
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &self.frame_group, &[]);
        pass.set_bind_group(1, group, &[]);
        pass.draw(0..3, 0..1);
        self.usage.add_draw(1);
    }

    fn upload(&mut self, picture: &Picture, corner: [u32; 2], size: [u32; 2]) {
        self.meshes.begin_picture();
        let items = || picture.items.iter().chain(&picture.ghosts);
        for item in items() {
            self.meshes.ensure(&self.gpu, &self.usage, &item.mesh);
        }
        let count = items().count();
        if count > self.objects_capacity {
            self.objects_capacity = count.next_power_of_two();
            let made = objects_buffer(&self.gpu.device, &self.pipelines, self.objects_capacity);
            (self.objects, self.objects_group) = made;
        }
        let mut bytes = vec![0; count * OBJECT_STRIDE];
        for (slot, item) in bytes.chunks_exact_mut(OBJECT_STRIDE).zip(items()) {
            let uniform = ObjectUniform::new(item);
            slot[..size_of::<ObjectUniform>()].copy_from_slice(bytemuck::bytes_of(&uniform));
        }
        self.write(&self.objects, &bytes);
        self.write(&self.frame, bytemuck::bytes_of(&FrameUniform::new(picture, corner, size)));
    }

    fn write(&self, buffer: &wgpu::Buffer, bytes: &[u8]) {
        self.gpu.queue.write_buffer(buffer, 0, bytes);
        self.usage.add_upload(bytes.len());
    }

    fn draw_meshes(&self, encoder: &mut wgpu::CommandEncoder, picture: &Picture) {
        let Some(targets) = &self.targets else { return };
        let (overlay, depth) = (&targets.overlay_samples, &targets.overlay_depth);
        let mut pass = begin_pass(encoder, "overlay", overlay, Some(&targets.overlay), Some(depth));
        self.draw_items(&mut pass, &self.pipelines.lit, &picture.items, 0);
        drop(pass);
        let mut pass = begin_pass(encoder, "ids", &targets.ids_view, None, Some(&targets.ids_depth));
        self.draw_items(&mut pass, &self.pipelines.ids, &picture.items, 0);
        drop(pass);
        if !picture.ghosts.is_empty() {
            let mut pass =
                begin_pass(encoder, "ghosts", &targets.ghosts_view, None, Some(&targets.ids_depth));
            self.draw_items(&mut pass, &self.pipelines.ids, &picture.ghosts, picture.items.len());
        }
    }

    fn draw_items(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        pipeline: &wgpu::RenderPipeline,
        items: &[Item],
        first: usize,
    ) {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &self.frame_group, &[]);
        for (slot, item) in (first..).zip(items) {
            let Some(buffers) = self.meshes.get(&item.mesh) else { continue };
            pass.set_bind_group(1, &self.objects_group, &[(slot * OBJECT_STRIDE) as u32]);
            pass.set_vertex_buffer(0, buffers.vertices.slice(..));
            pass.set_index_buffer(buffers.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..buffers.index_count, 0, 0..1);
            self.usage.add_draw(buffers.index_count / 3);
        }
    }

    fn bind_compose(&mut self, picture: &Picture, size: [u32; 2]) {
        let Some(targets) = &self.targets else { return };
        let zoom = f64::from(size[0]) / picture.rect.size().x;
        let sampler = if zoom >= NEAREST_FROM_ZOOM { &self.nearest } else { &self.linear };
        let photo = match &picture.photo {
            Some(layer) => self.photos.view(&self.gpu, &self.usage, &layer.0),
            None => &self.no_photo,
        };
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        self.compose_group = Some(self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("compose"),
            layout: &self.pipelines.compose_layout,
            entries: &[
                entry(0, wgpu::BindingResource::TextureView(photo)),
                entry(1, wgpu::BindingResource::Sampler(sampler)),
                entry(2, wgpu::BindingResource::TextureView(&targets.overlay)),
                entry(3, wgpu::BindingResource::TextureView(&targets.ids_view)),
                entry(4, wgpu::BindingResource::TextureView(&targets.ghosts_view)),
            ],
        }));
    }
}

/// A pass that clears its targets: colour to nothing, depth to infinity.
fn begin_pass<'encoder>(
    encoder: &'encoder mut wgpu::CommandEncoder,
    label: &str,
    color: &wgpu::TextureView,
    resolve_target: Option<&wgpu::TextureView>,
    depth: Option<&wgpu::TextureView>,
) -> wgpu::RenderPass<'encoder> {
    let store = if resolve_target.is_some() { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: color,
            resolve_target,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store },
            depth_slice: None,
        })],
        depth_stencil_attachment: depth.map(|view| wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(0.0),
                store: wgpu::StoreOp::Discard,
            }),
            stencil_ops: None,
        }),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    })
}

fn objects_buffer(
    device: &wgpu::Device,
    pipelines: &Pipelines,
    capacity: usize,
) -> (wgpu::Buffer, wgpu::BindGroup) {
    let buffer = uniform_buffer(device, "objects", capacity * OBJECT_STRIDE);
    let group = uniform_group(device, &pipelines.object_layout, &buffer, size_of::<ObjectUniform>());
    (buffer, group)
}

fn uniform_buffer(device: &wgpu::Device, label: &str, size: usize) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
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

/// One pixel that stands in where there is no photo; it is bound and never shown.
fn no_photo(device: &wgpu::Device) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("no photo"),
        size: wgpu::Extent3d::default(),
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
