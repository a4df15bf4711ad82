//! The textures that the passes draw into.

/// Samples of the overlay: what WebGL2 has everywhere.
pub const OVERLAY_SAMPLES: u32 = 4;
pub const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Offscreen targets of one size.
#[derive(Debug)]
pub struct Targets {
    pub size: [u32; 2],
    /// Multisampled, then resolved into `overlay`: premultiplied sRGB.
    pub overlay_samples: wgpu::TextureView,
    pub overlay: wgpu::TextureView,
    pub overlay_depth: wgpu::TextureView,
    /// One sample at each pixel's centre: outline colour and id.
    pub ids: wgpu::Texture,
    pub ids_view: wgpu::TextureView,
    pub ghosts_view: wgpu::TextureView,
    pub ids_depth: wgpu::TextureView,
}

impl Targets {
    pub fn new(device: &wgpu::Device, size: [u32; 2]) -> Self {
        let read = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let none = wgpu::TextureUsages::empty();
        let ids = target(device, "ids", size, COLOR_FORMAT, 1, read);
        Self {
            size,
            overlay_samples: view(&target(
                device,
                "overlay samples",
                size,
                COLOR_FORMAT,
                OVERLAY_SAMPLES,
                none,
            )),
            overlay: view(&target(device, "overlay", size, COLOR_FORMAT, 1, read)),
            overlay_depth: view(&target(device, "overlay depth", size, DEPTH_FORMAT, OVERLAY_SAMPLES, none)),
            ids_view: view(&ids),
            ids,
            ghosts_view: view(&target(device, "ghosts", size, COLOR_FORMAT, 1, read)),
            ids_depth: view(&target(device, "ids depth", size, DEPTH_FORMAT, 1, none)),
        }
    }
}

/// A texture that a picture is composed into and read back from.
pub fn picture_target(device: &wgpu::Device, size: [u32; 2]) -> wgpu::Texture {
    target(device, "picture", size, COLOR_FORMAT, 1, wgpu::TextureUsages::COPY_SRC)
}

fn target(
    device: &wgpu::Device,
    label: &str,
    size: [u32; 2],
    format: wgpu::TextureFormat,
    sample_count: u32,
    more_usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | more_usage,
        view_formats: &[],
    })
}

fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}
