//! Depth maps as textures: what is behind them is not drawn.

use std::sync::Arc;

use super::pipelines::Pipelines;
use super::{Gpu, Usage};
use crate::photo::DepthPixels;

/// A photo's depth map.
#[derive(Debug, Clone)]
pub struct Occluder {
    pub pixels: Arc<DepthPixels>,
    pub mm_per_unit: f64,
}

impl PartialEq for Occluder {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.pixels, &other.pixels) && self.mm_per_unit == other.mm_per_unit
    }
}

/// The depth map that was drawn last.
#[derive(Debug, Default)]
pub struct OccluderTexture {
    kept: Option<(Occluder, wgpu::BindGroup)>,
}

impl OccluderTexture {
    /// Uploads a depth map, unless it is there. One that is larger than the device's textures hides nothing.
    pub fn ensure(&mut self, gpu: &Gpu, usage: &Usage, pipelines: &Pipelines, occluder: &Occluder) {
        let DepthPixels { width, height, .. } = *occluder.pixels;
        if width.max(height) > gpu.device.limits().max_texture_dimension_2d {
            self.kept = None;
        } else if self.kept.as_ref().is_none_or(|(kept, _)| kept != occluder) {
            let group = upload(gpu, usage, pipelines, occluder);
            self.kept = Some((occluder.clone(), group));
        }
    }

    pub fn group(&self) -> Option<&wgpu::BindGroup> {
        self.kept.as_ref().map(|(_, group)| group)
    }
}

fn upload(gpu: &Gpu, usage: &Usage, pipelines: &Pipelines, occluder: &Occluder) -> wgpu::BindGroup {
    let DepthPixels { width, height, raw } = &*occluder.pixels;
    let size = wgpu::Extent3d { width: *width, height: *height, depth_or_array_layers: 1 };
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("depth map"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let depth_mm: Vec<f32> = raw.iter().map(|&raw| (f64::from(raw) * occluder.mm_per_unit) as f32).collect();
    let bytes: &[u8] = bytemuck::cast_slice(&depth_mm);
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(4 * width),
        rows_per_image: Some(*height),
    };
    gpu.queue.write_texture(texture.as_image_copy(), bytes, layout, size);
    usage.add_upload(bytes.len());
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("occluder"),
        layout: &pipelines.occluder_layout,
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) }],
    })
}
