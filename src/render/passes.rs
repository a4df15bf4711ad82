//! The passes that fill a view's targets: backdrop, overlay, ids, hidden ids, ghosts.

use super::extent::{sphere_eye, tolerance_mm};
use super::meshes::{MeshBuffers, Meshes};
use super::pipelines::{PipelineKind, Pipelines};
use super::plane::PLANE_INDEX_COUNT;
use super::surfaces::Surfaces;
use super::targets::Targets;
use super::uniforms::draws_edges;
use super::view::View;
use super::{Item, Picture, Usage};
use crate::scene::OverlayMode;

/// Everything that recording needs and none of it changes.
#[derive(Debug)]
pub struct Passes<'a> {
    pub pipelines: &'a Pipelines,
    pub meshes: &'a Meshes,
    pub surfaces: &'a Surfaces,
    pub plane_indices: &'a wgpu::Buffer,
    /// The depth map that hides what is behind it.
    pub occluder: Option<&'a wgpu::BindGroup>,
    pub usage: &'a Usage,
    pub view: &'a View,
    pub targets: &'a Targets,
    pub picture: &'a Picture,
    /// Target pixels per pixel of the eye's image.
    pub pixels_per_photo_pixel: f64,
}

/// Which objects cover which, where depth does not decide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    NearestLast,
    FarthestLast,
}

impl Passes<'_> {
    /// Records all passes that the picture needs; ids too if `with_ids`.
    pub fn record(&self, encoder: &mut wgpu::CommandEncoder, with_ids: bool) {
        let picture = self.picture;
        if let Some(backdrop) = &self.targets.backdrop {
            let mut pass = self.begin_multisampled(encoder, "backdrop", backdrop);
            self.draw_plane(&mut pass, PipelineKind::PlaneBehind);
            self.draw_lines(&mut pass, PipelineKind::LinesBehind, 0..self.view.lines_behind);
        }
        if picture.fills() || self.view.line_count > self.view.lines_behind {
            let mut pass = self.begin_multisampled(encoder, "overlay", &self.targets.overlay);
            self.draw_overlay(&mut pass);
        }
        if picture.outlines() || with_ids {
            let mut pass = self.begin_single(encoder, "ids", &self.targets.ids_view);
            self.draw_occluder(&mut pass, PipelineKind::OccluderOfIds);
            self.draw_items(&mut pass, PipelineKind::Ids, &picture.items, 0);
        }
        if let Some(hidden_ids) = self.targets.hidden_ids.as_ref().filter(|_| picture.outlines_hidden()) {
            let mut pass = self.begin_single(encoder, "hidden ids", hidden_ids);
            self.draw_in_order(&mut pass, Order::FarthestLast, &[PipelineKind::Ids]);
        }
        if picture.shows_ghosts() {
            let mut pass = self.begin_single(encoder, "ghosts", &self.targets.ghosts);
            self.draw_items(&mut pass, PipelineKind::Ids, &picture.ghosts, picture.items.len());
        }
    }

    fn draw_overlay(&self, pass: &mut wgpu::RenderPass<'_>) {
        let picture = self.picture;
        if picture.fills() {
            self.draw_occluder(pass, PipelineKind::Occluder);
            match picture.look.mode {
                mode if draws_edges(mode) => self.draw_mesh_edges(pass),
                mode if picture.look.x_ray => {
                    let kinds = [PipelineKind::Depth, fill_kind(mode, true)];
                    self.draw_in_order(pass, Order::NearestLast, &kinds);
                }
                mode => self.draw_items(pass, fill_kind(mode, false), &picture.items, 0),
            }
        }
        // X-ray leaves each object's depth in a range of its own, in which nothing else can be compared.
        if !picture.look.x_ray {
            self.draw_plane(pass, PipelineKind::PlaneBefore);
            self.draw_lines(pass, PipelineKind::LinesBefore, 0..self.view.lines_behind);
        }
        let in_front = self.view.lines_behind..self.view.line_count;
        self.draw_lines(pass, PipelineKind::LinesInFront, in_front);
    }

    /// Depth of the real scene, before anything else. X-ray shows what is hidden, by the scene too.
    fn draw_occluder(&self, pass: &mut wgpu::RenderPass<'_>, kind: PipelineKind) {
        let Some(occluder) = self.occluder.filter(|_| self.picture.occludes()) else { return };
        self.set(pass, kind);
        pass.set_bind_group(1, occluder, &[]);
        pass.draw(0..3, 0..1);
        self.usage.add_draw(1);
    }

    /// Surfaces as depth alone, then the lines on them that they do not hide.
    fn draw_mesh_edges(&self, pass: &mut wgpu::RenderPass<'_>) {
        let items = &self.picture.items;
        self.draw_items(pass, PipelineKind::DepthBehindLines, items, 0);
        if self.picture.look.x_ray {
            self.draw_edges_of_items(pass, PipelineKind::HiddenEdges);
        }
        self.draw_edges_of_items(pass, PipelineKind::Edges);
    }

    fn draw_edges_of_items(&self, pass: &mut wgpu::RenderPass<'_>, kind: PipelineKind) {
        self.set(pass, kind);
        for (number, item) in self.picture.items.iter().enumerate() {
            let buffers = self.buffers(item);
            let Some(edges) = buffers.and_then(|buffers| buffers.edges(self.picture.look.mode)) else {
                continue;
            };
            self.set_object(pass, number);
            pass.set_vertex_buffer(0, edges.instances.slice(..));
            pass.draw(0..6, 0..edges.count);
            self.usage.add_draw(2 * edges.count);
        }
    }

    /// Draws one object over the other whatever their depths are, each by itself with depth: the range of depths is cut in
    /// slices, and each object has the next nearer one.
    fn draw_in_order(&self, pass: &mut wgpu::RenderPass<'_>, order: Order, kinds: &[PipelineKind]) {
        let items = &self.picture.items;
        let mut numbers: Vec<usize> = (0..items.len()).collect();
        let depth_mm = |number: usize| sphere_eye(self.picture, &items[number]).center.z;
        numbers.sort_by(|&a, &b| depth_mm(b).total_cmp(&depth_mm(a)));
        if order == Order::FarthestLast {
            numbers.reverse();
        }
        let [width, height] = self.targets.kind.size.map(|side| side as f32);
        let count = items.len() as f32;
        for (place, &number) in numbers.iter().enumerate() {
            let nearest = (place + 1) as f32 / count;
            pass.set_viewport(0.0, 0.0, width, height, place as f32 / count, nearest.min(1.0));
            for &kind in kinds {
                self.draw_items(pass, kind, &items[number..=number], number);
            }
        }
        pass.set_viewport(0.0, 0.0, width, height, 0.0, 1.0);
    }

    /// Items whose uniforms are from number `first` on.
    fn draw_items(&self, pass: &mut wgpu::RenderPass<'_>, kind: PipelineKind, items: &[Item], first: usize) {
        self.set(pass, kind);
        for (number, item) in (first..).zip(items) {
            let Some(buffers) = self.buffers(item) else { continue };
            self.set_object(pass, number);
            pass.set_vertex_buffer(0, buffers.positions.slice(..));
            pass.set_index_buffer(buffers.indices.slice(..), wgpu::IndexFormat::Uint32);
            if kind.reads_attributes() {
                pass.set_vertex_buffer(1, buffers.attributes.slice(..));
            }
            if !kind.reads_textures() {
                pass.draw_indexed(0..buffers.index_count, 0, 0..1);
                self.usage.add_draw(buffers.index_count / 3);
                continue;
            }
            for group in &buffers.groups {
                pass.set_bind_group(2, group.texture.as_ref().unwrap_or(&self.surfaces.no_texture), &[]);
                pass.draw_indexed(group.indices.clone(), 0, 0..1);
                self.usage.add_draw(group.indices.len() as u32 / 3);
            }
        }
    }

    fn buffers(&self, item: &Item) -> Option<&MeshBuffers> {
        self.meshes.get(&item.mesh, tolerance_mm(self.picture, item, self.pixels_per_photo_pixel))
    }

    fn draw_plane(&self, pass: &mut wgpu::RenderPass<'_>, kind: PipelineKind) {
        let (Some(_), Some((_, vertices)), Some(group)) =
            (self.picture.plane(), &self.view.plane, &self.view.plane_group)
        else {
            return;
        };
        self.set(pass, kind);
        self.set_object(pass, self.number_of_surroundings());
        pass.set_bind_group(2, group, &[]);
        pass.set_vertex_buffer(0, vertices.slice(..));
        pass.set_index_buffer(self.plane_indices.slice(..), wgpu::IndexFormat::Uint16);
        pass.draw_indexed(0..PLANE_INDEX_COUNT, 0, 0..1);
        self.usage.add_draw(PLANE_INDEX_COUNT / 3);
    }

    fn draw_lines(&self, pass: &mut wgpu::RenderPass<'_>, kind: PipelineKind, numbers: std::ops::Range<u32>) {
        let Some(lines) = self.view.lines.as_ref().filter(|_| !numbers.is_empty()) else { return };
        self.set(pass, kind);
        self.set_object(pass, self.number_of_surroundings());
        // WebGL2 counts instances from the buffer's beginning only.
        let stride = size_of::<super::lines::LineInstance>() as u64;
        pass.set_vertex_buffer(0, lines.slice(u64::from(numbers.start) * stride..));
        let count = numbers.len() as u32;
        pass.draw(0..6, 0..count);
        self.usage.add_draw(2 * count);
    }

    fn set(&self, pass: &mut wgpu::RenderPass<'_>, kind: PipelineKind) {
        pass.set_pipeline(self.pipelines.get(kind));
        pass.set_bind_group(0, &self.view.frame_group, &[]);
    }

    fn set_object(&self, pass: &mut wgpu::RenderPass<'_>, number: usize) {
        pass.set_bind_group(1, &self.view.objects_group, &[View::object_offset(number)]);
    }

    fn number_of_surroundings(&self) -> usize {
        self.picture.items.len() + self.picture.ghosts.len()
    }

    fn begin_multisampled<'encoder>(
        &self,
        encoder: &'encoder mut wgpu::CommandEncoder,
        label: &str,
        resolved: &wgpu::TextureView,
    ) -> wgpu::RenderPass<'encoder> {
        let (samples, depth) = (&self.targets.samples, &self.targets.samples_depth);
        begin_pass(encoder, label, samples, Some(resolved), Some(depth))
    }

    fn begin_single<'encoder>(
        &self,
        encoder: &'encoder mut wgpu::CommandEncoder,
        label: &str,
        color: &wgpu::TextureView,
    ) -> wgpu::RenderPass<'encoder> {
        begin_pass(encoder, label, color, None, Some(&self.targets.ids_depth))
    }
}

/// What draws a surface in a mode that draws surfaces.
fn fill_kind(mode: OverlayMode, is_see_through: bool) -> PipelineKind {
    match (mode, is_see_through) {
        (OverlayMode::Colors, false) => PipelineKind::Colored,
        (OverlayMode::Colors, true) => PipelineKind::ColoredThrough,
        (OverlayMode::Nocs, false) => PipelineKind::Nocs,
        (OverlayMode::Nocs, true) => PipelineKind::NocsThrough,
        (OverlayMode::Normals, false) => PipelineKind::Normals,
        (OverlayMode::Normals, true) => PipelineKind::NormalsThrough,
        (OverlayMode::Depth, false) => PipelineKind::DepthColors,
        (OverlayMode::Depth, true) => PipelineKind::DepthColorsThrough,
        (_, false) => PipelineKind::Lit,
        (_, true) => PipelineKind::LitThrough,
    }
}

/// A pass that clears its targets: colour to nothing, depth to infinity.
pub fn begin_pass<'encoder>(
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
