//! Photos as textures with all their smaller copies.

use std::sync::Arc;

use super::{Gpu, Usage};
use crate::photo::{Pixels, half_size};

/// The photos that were drawn last, newest first; or their masks.
#[derive(Debug)]
pub struct PhotoTextures {
    kept: Vec<(Arc<Pixels>, wgpu::TextureView)>,
    most: usize,
}

impl PhotoTextures {
    /// Keeps so many textures.
    pub fn keeping(most: usize) -> Self {
        Self { kept: Vec::new(), most }
    }

    /// The texture of a photo, uploaded if it is not there yet.
    pub fn view(&mut self, gpu: &Gpu, usage: &Usage, pixels: &Arc<Pixels>) -> &wgpu::TextureView {
        let position = self.kept.iter().position(|(kept, _)| Arc::ptr_eq(kept, pixels));
        let entry = match position {
            Some(position) => self.kept.remove(position),
            None => (pixels.clone(), upload_texture(gpu, usage, pixels)),
        };
        self.kept.truncate(self.most - 1);
        self.kept.insert(0, entry);
        &self.kept[0].1
    }
}

/// A texture with all its smaller copies.
pub fn upload_texture(gpu: &Gpu, usage: &Usage, pixels: &Pixels) -> wgpu::TextureView {
    // A photo larger than the device's textures is shown from its first smaller copy that fits.
    let limit = gpu.device.limits().max_texture_dimension_2d;
    let mut shrunk: Option<Pixels> = None;
    while let larger = shrunk.as_ref().unwrap_or(pixels)
        && larger.width.max(larger.height) > limit
    {
        shrunk = Some(half_size(larger));
    }
    let largest = shrunk.as_ref().unwrap_or(pixels);
    let levels = largest.width.max(largest.height).ilog2() + 1;
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("photo or surface"),
        size: wgpu::Extent3d { width: largest.width, height: largest.height, depth_or_array_layers: 1 },
        mip_level_count: levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    write_level(gpu, usage, &texture, 0, largest);
    let mut smaller: Option<Pixels> = None;
    for level in 1..levels {
        let half = half_size(smaller.as_ref().unwrap_or(largest));
        write_level(gpu, usage, &texture, level, &half);
        smaller = Some(half);
    }
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

fn write_level(gpu: &Gpu, usage: &Usage, texture: &wgpu::Texture, mip_level: u32, pixels: &Pixels) {
    let size = wgpu::Extent3d { width: pixels.width, height: pixels.height, depth_or_array_layers: 1 };
    gpu.queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level,
            origin: wgpu::Origin3d::ZERO,
            aspect: wgpu::TextureAspect::All,
        },
        &pixels.rgba,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * pixels.width),
            rows_per_image: Some(pixels.height),
        },
        size,
    );
    usage.add_upload(pixels.rgba.len());
}
