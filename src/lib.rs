//! PinPose: a 6D object pose annotator, in a browser tab and on the desktop.
//!
//! The map of the house. Imports only go down, never sideways or up; `tests/native/layers.rs` reads the tree and holds it
//! to that.
//!
//! | rank | room | what it is for |
//! |---|---|---|
//! | 10 | `page`, `main.rs` | entries: the wasm's exports, the native program |
//! | 9 | [`app`], `api`, [`cli`] | the program; `window.pinpose`; the command line |
//! | 8 | [`ui`] | panels, viewport, dialogs, theme |
//! | 7 | [`render`], [`interact`], [`study`] | wgpu passes (knows no UI); gestures to commands (knows no egui); studies as data and rules |
//! | 6 | [`session`] | a scene being worked on: commands, undo, imports |
//! | 5 | [`formats`], [`solve`], [`metrics`] | files to data and back; poses from pins and pictures; how far a pose is from another |
//! | 4 | [`scene`], [`raster`] | plain data; the CPU rasteriser, the renderer's reference |
//! | 3 | [`mesh`] | meshes, a loader per format, ray casts |
//! | 2 | [`photo`] | photographs |
//! | 1 | [`math`] | frames, poses, the camera |
//! | 0 | [`platform`] | files, storage, clock, the page; reached from rank 9, 10 and `ui` alone |
//!
//! Data flows one way: input becomes a [`session::Command`], the session changes and returns effects, `ui` and `render`
//! draw what the session holds.

#[cfg(target_arch = "wasm32")]
mod api;
pub mod app;
#[cfg(not(target_arch = "wasm32"))]
pub mod cli;
pub mod formats;
pub mod interact;
pub mod math;
pub mod mesh;
pub mod metrics;
#[cfg(target_arch = "wasm32")]
mod page;
pub mod photo;
pub mod platform;
pub mod raster;
pub mod render;
pub mod scene;
pub mod session;
pub mod solve;
pub mod study;
pub mod ui;
