//! The device, and the count of what goes to it.

use std::cell::Cell;

/// Device and queue, as the interface made them or without a window.
#[derive(Debug, Clone)]
pub struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
}

/// What the scene's passes cost since they were last asked: independent of machine and load, so that tests can hold them.
#[derive(Debug, Default)]
pub struct Usage {
    pub uploaded_bytes: Cell<u64>,
    pub draw_calls: Cell<u64>,
    pub triangles: Cell<u64>,
}

impl Usage {
    pub fn add_upload(&self, bytes: usize) {
        self.uploaded_bytes.set(self.uploaded_bytes.get() + bytes as u64);
    }

    pub fn add_draw(&self, triangles: u32) {
        self.draw_calls.set(self.draw_calls.get() + 1);
        self.triangles.set(self.triangles.get() + u64::from(triangles));
    }

    pub fn reset(&self) {
        self.uploaded_bytes.set(0);
        self.draw_calls.set(0);
        self.triangles.set(0);
    }
}

#[cfg(not(target_arch = "wasm32"))]
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    #[error("no GPU and no software Vulkan driver was found (Debian: mesa-vulkan-drivers): {0}")]
    NoAdapter(String),
    #[error("the GPU refused: {0}")]
    NoDevice(String),
}

#[cfg(not(target_arch = "wasm32"))]
impl Gpu {
    /// A device without a window, on whatever the machine has, held to the limits of WebGL2.
    pub fn headless() -> Result<Self, GpuError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
            backends: wgpu::Backends::PRIMARY,
            ..wgpu::InstanceDescriptor::new_without_display_handle()
        });
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))
            .map_err(|error| GpuError::NoAdapter(error.to_string()))?;
        let limits = wgpu::Limits {
            max_texture_dimension_2d: adapter.limits().max_texture_dimension_2d.min(8192),
            ..wgpu::Limits::downlevel_webgl2_defaults()
        };
        let descriptor =
            wgpu::DeviceDescriptor { required_limits: limits, ..wgpu::DeviceDescriptor::default() };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| GpuError::NoDevice(error.to_string()))?;
        Ok(Self { device, queue })
    }
}
