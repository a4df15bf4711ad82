//! Samplers and texture groups: of meshes, of the photo's plane, and what stands in where there is no texture.

use super::photos::upload_texture;
use super::pipelines::Pipelines;
use super::{Gpu, Usage};
use crate::photo::Pixels;

/// Textures have fewer.
const ALL_LEVELS: f32 = 32.0;

#[derive(Debug)]
pub struct Surfaces {
    layout: wgpu::BindGroupLayout,
    /// One white pixel.
    pub blank: wgpu::TextureView,
    /// For a mesh without a texture: white.
    pub no_texture: wgpu::BindGroup,
    pub linear: wgpu::Sampler,
    /// The same without the smaller copies.
    pub magnifying: wgpu::Sampler,
    pub nearest: wgpu::Sampler,
    /// A mesh's texture goes on beyond its border.
    repeating: wgpu::Sampler,
}

impl Surfaces {
    pub fn new(gpu: &Gpu, usage: &Usage, pipelines: &Pipelines) -> Self {
        let sampler = |mag_filter, mipmap_filter, address_mode, lod_max_clamp| {
            gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                address_mode_u: address_mode,
                address_mode_v: address_mode,
                mag_filter,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter,
                lod_max_clamp,
                ..wgpu::SamplerDescriptor::default()
            })
        };
        let (filter, mip_filter) = (wgpu::FilterMode::Linear, wgpu::MipmapFilterMode::Linear);
        let one_level = wgpu::MipmapFilterMode::Nearest;
        let repeating = sampler(filter, mip_filter, wgpu::AddressMode::Repeat, ALL_LEVELS);
        let white = Pixels { width: 1, height: 1, rgba: vec![255; 4] };
        let blank = upload_texture(gpu, usage, &white);
        let layout = pipelines.surface_layout.clone();
        Self {
            no_texture: group(gpu, &layout, &blank, &repeating, &blank),
            linear: sampler(filter, mip_filter, wgpu::AddressMode::ClampToEdge, ALL_LEVELS),
            // Said here, not by the shader: software renderers then leave out what chooses a level.
            magnifying: sampler(filter, one_level, wgpu::AddressMode::ClampToEdge, 0.0),
            nearest: sampler(wgpu::FilterMode::Nearest, one_level, wgpu::AddressMode::ClampToEdge, 0.0),
            blank,
            layout,
            repeating,
        }
    }

    /// Of a mesh's texture.
    pub fn of_texture(&self, gpu: &Gpu, usage: &Usage, pixels: &Pixels) -> wgpu::BindGroup {
        let texture = upload_texture(gpu, usage, pixels);
        group(gpu, &self.layout, &texture, &self.repeating, &self.blank)
    }

    /// Of the photo's plane with its masks.
    pub fn of_plane(
        &self,
        gpu: &Gpu,
        photo: &wgpu::TextureView,
        masks: &wgpu::TextureView,
    ) -> wgpu::BindGroup {
        group(gpu, &self.layout, photo, &self.linear, masks)
    }
}

fn group(
    gpu: &Gpu,
    layout: &wgpu::BindGroupLayout,
    texture: &wgpu::TextureView,
    sampler: &wgpu::Sampler,
    second: &wgpu::TextureView,
) -> wgpu::BindGroup {
    let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("surface"),
        layout,
        entries: &[
            entry(0, wgpu::BindingResource::TextureView(texture)),
            entry(1, wgpu::BindingResource::Sampler(sampler)),
            entry(2, wgpu::BindingResource::TextureView(second)),
        ],
    })
}
