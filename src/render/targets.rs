//! The textures that the passes draw into.

/// Samples of the overlay: what WebGL2 has everywhere.
pub const OVERLAY_SAMPLES: u32 = 4;
pub const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// What targets are for. Those that only some pictures need are made for those only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TargetsKind {
    pub size: [u32; 2],
    pub has_backdrop: bool,
    pub has_hidden_ids: bool,
}

/// Offscreen targets of one size.
#[derive(Debug)]
pub struct Targets {
    pub kind: TargetsKind,
    /// Multisampled, then resolved into `backdrop` first and `overlay` after it: premultiplied sRGB.
    pub samples: wgpu::TextureView,
    pub samples_depth: wgpu::TextureView,
    pub overlay: wgpu::TextureView,
    pub backdrop: Option<wgpu::TextureView>,
    /// One sample at each pixel's centre: outline colour and id.
    pub ids: wgpu::Texture,
    pub ids_view: wgpu::TextureView,
    pub hidden_ids: Option<wgpu::TextureView>,
    pub ghosts: wgpu::TextureView,
    pub ids_depth: wgpu::TextureView,
}

impl Targets {
    pub fn new(device: &wgpu::Device, kind: TargetsKind) -> Self {
        let TargetsKind { size, .. } = kind;
        let read = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let none = wgpu::TextureUsages::empty();
        let color = |label| target(device, label, size, COLOR_FORMAT, 1, read);
        let ids = color("ids");
        let samples = target(device, "samples", size, COLOR_FORMAT, OVERLAY_SAMPLES, none);
        let samples_depth = target(device, "samples' depth", size, DEPTH_FORMAT, OVERLAY_SAMPLES, none);
        Self {
            kind,
            samples: view(&samples),
            samples_depth: view(&samples_depth),
            overlay: view(&color("overlay")),
            backdrop: kind.has_backdrop.then(|| view(&color("backdrop"))),
            ids_view: view(&ids),
            ids,
            hidden_ids: kind.has_hidden_ids.then(|| view(&color("hidden ids"))),
            ghosts: view(&color("ghosts")),
            ids_depth: view(&target(device, "ids' depth", size, DEPTH_FORMAT, 1, none)),
        }
    }
}

/// A texture that a picture is composed into, and read back from or drawn again.
pub fn picture_target(device: &wgpu::Device, size: [u32; 2]) -> wgpu::Texture {
    let read = wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::TEXTURE_BINDING;
    target(device, "picture", size, COLOR_FORMAT, 1, read)
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
