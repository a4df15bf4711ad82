//! Pixels back from the GPU: asynchronous, rows padded to 256 bytes on the way.

use std::sync::{Arc, Mutex};

use thiserror::Error;

use super::Gpu;
use crate::photo::Pixels;

#[derive(Debug, Clone, Error)]
pub enum ReadBackError {
    #[error("the GPU did not hand its pixels back: {0}")]
    Map(String),
}

type MapResult = Arc<Mutex<Option<Result<(), String>>>>;

/// A copy of a texture on its way to us. Somebody has to poll the device until it is there; WebGL2 completes it only then.
#[derive(Debug)]
pub struct PixelsPending {
    buffer: wgpu::Buffer,
    size: [u32; 2],
    padded_row_bytes: u32,
    mapped: MapResult,
}

impl PixelsPending {
    /// Copies an RGBA texture within `encoder`; call [`Self::submitted`] after the encoder's commands were submitted.
    pub fn copy(gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, texture: &wgpu::Texture) -> Self {
        let size = [texture.width(), texture.height()];
        let padded_row_bytes = (4 * size[0]).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read-back"),
            size: u64::from(padded_row_bytes) * u64::from(size[1]),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded_row_bytes),
                    rows_per_image: Some(size[1]),
                },
            },
            wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
        );
        Self { buffer, size, padded_row_bytes, mapped: Arc::default() }
    }

    /// Asks for the copy.
    pub fn submitted(&self) {
        let mapped = self.mapped.clone();
        self.buffer.slice(..).map_async(wgpu::MapMode::Read, move |result| {
            if let Ok(mut slot) = mapped.lock() {
                *slot = Some(result.map_err(|error| error.to_string()));
            }
        });
    }

    /// The pixels, once they are there.
    pub fn poll(&self, gpu: &Gpu) -> Option<Result<Pixels, ReadBackError>> {
        // An error here is a lost device, which is reported by its own callback.
        gpu.device.poll(wgpu::PollType::Poll).ok();
        let result = self.mapped.lock().ok()?.take()?;
        Some(result.map_err(ReadBackError::Map).and_then(|()| self.read()))
    }

    /// The pixels, waiting for them.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn wait(&self, gpu: &Gpu) -> Result<Pixels, ReadBackError> {
        let waited = gpu.device.poll(wgpu::PollType::wait_indefinitely());
        waited.map_err(|error| ReadBackError::Map(error.to_string()))?;
        self.poll(gpu)
            .unwrap_or_else(|| Err(ReadBackError::Map("the device finished without a copy".to_owned())))
    }

    fn read(&self) -> Result<Pixels, ReadBackError> {
        let mapped = self.buffer.slice(..).get_mapped_range();
        let mapped = mapped.map_err(|error| ReadBackError::Map(error.to_string()))?;
        let row_bytes = 4 * self.size[0] as usize;
        let rows = mapped.chunks_exact(self.padded_row_bytes as usize);
        let rgba = rows.flat_map(|row| row.iter().take(row_bytes).copied()).collect();
        Ok(Pixels { width: self.size[0], height: self.size[1], rgba })
    }
}
