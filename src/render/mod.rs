//! The picture on the GPU: photo, meshes, outlines, and the scene from outside. The same renderer draws on screen and
//! without one.
//!
//! Knows nothing of the interface: a [`Picture`] in, pixels out. WebGL2 is the floor: no storage buffers, no compute,
//! multisampled targets are resolved and never sampled. All colours are sRGB-encoded from photo to screen, and blended so.

mod base;
mod export;
mod extent;
mod gpu;
mod lines;
mod meshes;
mod occluder;
mod passes;
mod photos;
mod picture;
mod pipelines;
mod plane;
mod readback;
mod renderer;
mod scene_picture;
mod surfaces;
mod targets;
mod uniforms;
mod view;

pub use export::{ExportKind, export_picture, raster_png, silhouette_png};
#[cfg(not(target_arch = "wasm32"))]
pub use gpu::GpuError;
pub use gpu::{Gpu, Usage};
pub use lines::Line3;
pub use occluder::Occluder;
pub use picture::{Item, LineWidths, PhotoLayer, PhotoPlane, Picture, Subject, Surroundings, picture_of};
pub use pipelines::{SHADERS, ShaderSource};
pub use readback::{PixelsPending, ReadBackError};
pub use renderer::{Layer, Renderer};
pub use scene_picture::{FreeView, OtherCamera, scene_picture_of};
pub use view::ViewSlot;
