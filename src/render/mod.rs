//! The picture on the GPU: photo, lit meshes, outlines. The same renderer draws on screen and without one.
//!
//! Knows nothing of the interface: a [`Picture`] in, pixels out. WebGL2 is the floor: no storage buffers, no compute,
//! multisampled targets are resolved and never sampled. All colours are sRGB-encoded from photo to screen, and blended so.

mod export;
mod gpu;
mod meshes;
mod photos;
mod picture;
mod pipelines;
mod readback;
mod renderer;
mod targets;
mod uniforms;

pub use export::{ExportKind, export_picture, raster_png, silhouette_png};
#[cfg(not(target_arch = "wasm32"))]
pub use gpu::GpuError;
pub use gpu::{Gpu, Usage};
pub use picture::{GHOST_WIDTH_POINTS, Item, Outline, PhotoLayer, Picture, picture_of};
pub use pipelines::{SHADERS, ShaderSource};
pub use readback::{PixelsPending, ReadBackError};
pub use renderer::{Layer, Renderer};
