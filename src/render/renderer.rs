//! The renderer: pictures into views, and from them to the screen or back to the caller.

use wgpu::util::DeviceExt;

use super::base::base_parts;
use super::extent::tolerance_mm;
use super::meshes::Meshes;
use super::occluder::OccluderTexture;
use super::passes::{Passes, begin_pass};
use super::photos::PhotoTextures;
use super::pipelines::{COMPOSE_TEXTURES, PipelineKind, Pipelines};
use super::plane::plane_indices;
use super::surfaces::Surfaces;
use super::targets::picture_target;
use super::view::{Drawn, View, ViewSlot};
use super::{Gpu, PhotoLayer, Picture, PixelsPending, Usage};

/// From so many screen pixels per photo pixel on, the photo's pixels are shown as squares.
const NEAREST_FROM_ZOOM: f64 = 2.0;

/// Photos that are kept on the GPU: the next and the previous one are a key press away, and an export may want another.
const KEPT_PHOTOS: usize = 4;
const KEPT_MASKS: usize = 2;

/// Targets of an export with more pixels are given back at once.
const KEPT_EXPORT_PIXELS: u64 = 4_000_000;

/// What is read back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// The finished picture.
    Picture,
    /// The drawn silhouettes, one sample at each pixel's centre: in alpha the item's id, plus 128 where it is selected.
    Ids,
}

/// All GPU state of the scene. Views have their own targets; pipelines, meshes and photos are there once.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    pipelines: Pipelines,
    surfaces: Surfaces,
    photos: PhotoTextures,
    masks: PhotoTextures,
    occluder: OccluderTexture,
    meshes: Meshes,
    plane_indices: wgpu::Buffer,
    views: [View; ViewSlot::COUNT],
    pub usage: Usage,
}

impl Renderer {
    /// `screen_format`: of the render pass that [`Self::paint`] will be called in.
    pub fn new(gpu: Gpu, screen_format: wgpu::TextureFormat) -> Self {
        let usage = Usage::default();
        let pipelines = Pipelines::new(&gpu.device, screen_format);
        let plane_indices = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("plane indices"),
            contents: bytemuck::cast_slice(&plane_indices()),
            usage: wgpu::BufferUsages::INDEX,
        });
        Self {
            surfaces: Surfaces::new(&gpu, &usage, &pipelines),
            photos: PhotoTextures::keeping(KEPT_PHOTOS),
            masks: PhotoTextures::keeping(KEPT_MASKS),
            occluder: OccluderTexture::default(),
            meshes: Meshes::default(),
            views: std::array::from_fn(|_| View::new(&gpu, &pipelines)),
            plane_indices,
            pipelines,
            usage,
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

    /// Makes every pipeline, also those that are otherwise made when they are first used: to test a backend.
    pub fn make_all_pipelines(&self) {
        self.pipelines.make_all();
    }

    /// Records the passes up to the composition, for a target of `size` pixels at `corner` of its framebuffer. Does nothing
    /// where the view holds that picture already.
    pub fn prepare(
        &mut self,
        slot: ViewSlot,
        encoder: &mut wgpu::CommandEncoder,
        picture: &Picture,
        corner: [u32; 2],
        size: [u32; 2],
    ) {
        self.draw(slot, encoder, Drawn { picture: picture.clone(), corner, size, with_ids: false });
        self.draw_base(slot, encoder);
    }

    /// Keeps what lies below the meshes once it stays the same.
    fn draw_base(&mut self, slot: ViewSlot, encoder: &mut wgpu::CommandEncoder) {
        let view = &mut self.views[slot as usize];
        let (Some(drawn), Some(group)) = (&view.drawn, view.compose_group.clone()) else { return };
        let Some(texture) = view.base.wanted(&self.gpu.device, drawn).cloned() else { return };
        let mut pass = begin_pass(encoder, "base", &texture, None, None);
        let [x, y, width, height] =
            [drawn.corner[0], drawn.corner[1], drawn.size[0], drawn.size[1]].map(|value| value as f32);
        pass.set_viewport(x, y, width, height, 0.0, 1.0);
        pass.set_bind_group(0, &view.frame_group, &[]);
        pass.set_bind_group(1, &group, &[]);
        let parts: Vec<PipelineKind> = base_parts(&drawn.picture).collect();
        self.draw_parts(&mut pass, &parts, |kind| self.pipelines.get(kind));
        drop(pass);
        if let Some(drawn) = self.views[slot as usize].drawn.take() {
            self.bind_textures(slot, &drawn);
            self.views[slot as usize].drawn = Some(drawn);
        }
    }

    /// Composes the prepared picture within a render pass of the screen's format.
    pub fn paint(&self, slot: ViewSlot, pass: &mut wgpu::RenderPass<'_>) {
        self.compose(slot, pass, |kind| self.pipelines.get_on_screen(kind));
    }

    /// Draws a picture off screen and starts reading it back. What is on screen stays as it is.
    pub fn draw_and_read(&mut self, picture: &Picture, size: [u32; 2], layer: Layer) -> PixelsPending {
        let slot = ViewSlot::Export;
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let with_ids = layer == Layer::Ids;
        self.draw(slot, &mut encoder, Drawn { picture: picture.clone(), corner: [0, 0], size, with_ids });
        let composed;
        let texture = match (&self.views[slot as usize].targets, layer) {
            (Some(targets), Layer::Ids) => &targets.ids,
            _ => {
                composed = picture_target(&self.gpu.device, size);
                let view = composed.create_view(&wgpu::TextureViewDescriptor::default());
                let mut pass = begin_pass(&mut encoder, "picture", &view, None, None);
                self.compose(slot, &mut pass, |kind| self.pipelines.get(kind));
                drop(pass);
                &composed
            }
        };
        let pending = PixelsPending::copy(&self.gpu, &mut encoder, texture);
        self.gpu.queue.submit([encoder.finish()]);
        pending.submitted();
        if u64::from(size[0]) * u64::from(size[1]) > KEPT_EXPORT_PIXELS {
            self.views[slot as usize] = View::new(&self.gpu, &self.pipelines);
        }
        pending
    }

    fn draw(&mut self, slot: ViewSlot, encoder: &mut wgpu::CommandEncoder, mut wanted: Drawn) {
        let limit = self.gpu.device.limits().max_texture_dimension_2d;
        wanted.size = wanted.size.map(|side| side.clamp(1, limit));
        if self.views[slot as usize].drawn.as_ref() == Some(&wanted) {
            return;
        }
        let picture = &wanted.picture;
        let pixels_per_photo_pixel = f64::from(wanted.size[0]) / picture.rect.size().x;
        self.upload_meshes(slot, picture, pixels_per_photo_pixel);
        if let Some(occluder) = &picture.occluder {
            self.occluder.ensure(&self.gpu, &self.usage, &self.pipelines, occluder);
        }
        let view = &mut self.views[slot as usize];
        let window = view.fit_targets(&self.gpu, &wanted);
        view.upload(&self.gpu, &self.usage, &self.pipelines, &wanted, &window);
        self.bind_textures(slot, &wanted);
        let view = &self.views[slot as usize];
        if let Some(targets) = &view.targets {
            let passes = Passes {
                pipelines: &self.pipelines,
                meshes: &self.meshes,
                surfaces: &self.surfaces,
                plane_indices: &self.plane_indices,
                occluder: self.occluder.group(),
                usage: &self.usage,
                view,
                targets,
                picture,
                pixels_per_photo_pixel,
            };
            passes.record(encoder, wanted.with_ids);
        }
        self.views[slot as usize].drawn = Some(wanted);
    }

    fn upload_meshes(&mut self, slot: ViewSlot, picture: &Picture, pixels_per_photo_pixel: f64) {
        self.meshes.begin_picture(slot);
        for item in picture.items.iter().chain(&picture.ghosts) {
            let need = (picture.look.mode, tolerance_mm(picture, item, pixels_per_photo_pixel));
            self.meshes.ensure(&self.gpu, &self.usage, slot, &item.mesh, need, &self.surfaces);
        }
    }

    /// Binds what the composition and the plane read.
    fn bind_textures(&mut self, slot: ViewSlot, drawn: &Drawn) {
        let Drawn { picture, size, .. } = drawn;
        let blank = self.surfaces.blank.clone();
        let texture = |textures: &mut PhotoTextures, layer: &Option<PhotoLayer>| match layer {
            Some(layer) => textures.view(&self.gpu, &self.usage, &layer.0).clone(),
            None => blank.clone(),
        };
        let photo = texture(&mut self.photos, &picture.photo);
        let masks = texture(&mut self.masks, &picture.masks);
        let zoom = f64::from(size[0]) / picture.rect.size().x;
        let sampler = match zoom {
            _ if zoom >= NEAREST_FROM_ZOOM => &self.surfaces.nearest,
            _ if zoom >= 1.0 => &self.surfaces.magnifying,
            _ => &self.surfaces.linear,
        };
        let view = &mut self.views[slot as usize];
        view.plane_group = picture.plane().map(|_| self.surfaces.of_plane(&self.gpu, &photo, &masks));
        let Some(targets) = &view.targets else { return };
        let textures: [&wgpu::TextureView; COMPOSE_TEXTURES] = [
            &photo,
            &targets.overlay,
            &targets.ids_view,
            &targets.ghosts,
            &masks,
            targets.hidden_ids.as_ref().unwrap_or(&blank),
            targets.backdrop.as_ref().unwrap_or(&blank),
            view.base.of(drawn).unwrap_or(&blank),
        ];
        let mut entries =
            vec![wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(sampler) }];
        entries.extend([0, 2, 3, 4, 5, 6, 7, 8].into_iter().zip(textures).map(|(binding, texture)| {
            wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(texture) }
        }));
        view.compose_group = Some(self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("compose"),
            layout: &self.pipelines.compose_layout,
            entries: &entries,
        }));
    }

    fn compose<'a>(
        &'a self,
        slot: ViewSlot,
        pass: &mut wgpu::RenderPass<'_>,
        pipeline: impl Fn(PipelineKind) -> &'a wgpu::RenderPipeline,
    ) {
        let view = &self.views[slot as usize];
        let (Some(group), Some(drawn)) = (&view.compose_group, &view.drawn) else { return };
        pass.set_bind_group(0, &view.frame_group, &[]);
        pass.set_bind_group(1, group, &[]);
        self.draw_parts(pass, &composed_parts(&drawn.picture, view.base.of(drawn).is_some()), pipeline);
    }

    /// Pipelines that take everything from the two groups that are bound.
    fn draw_parts<'a>(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        parts: &[PipelineKind],
        pipeline: impl Fn(PipelineKind) -> &'a wgpu::RenderPipeline,
    ) {
        for &kind in parts {
            let vertices = kind.composed_vertices();
            pass.set_pipeline(pipeline(kind));
            pass.draw(0..vertices, 0..1);
            self.usage.add_draw(vertices / 3);
        }
    }
}

/// What a picture is composed of, from below.
fn composed_parts(picture: &Picture, has_base: bool) -> Vec<PipelineKind> {
    use PipelineKind as Kind;
    let mut parts = Vec::new();
    let is_free = picture.surroundings.is_some();
    match is_free {
        true => parts.push(Kind::Backdrop),
        false if has_base => parts.push(Kind::Base),
        false => parts.extend(base_parts(picture)),
    }
    // In a free view the photo is somewhere else than the meshes, and there is nothing to take a difference to.
    let is_difference = picture.look.difference && !is_free && picture.fills();
    let has_lines = picture.lines().iter().any(|line| line.in_front);
    let when = |condition: bool, kind: Kind| condition.then_some(kind);
    let above = [
        when(is_difference, Kind::Difference),
        when(!is_difference && (picture.fills() || has_lines), Kind::Overlay),
        when(picture.outlines_hidden(), Kind::HiddenOutlines),
        when(picture.outlines(), Kind::Outlines),
        when(picture.shows_ghosts(), Kind::GhostOutlines),
        when(picture.look.wipe.is_some() && picture.shows_meshes(), Kind::Wipe),
    ];
    parts.extend(above.into_iter().flatten());
    parts
}
