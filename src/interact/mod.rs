//! Hands: pointer and wheel in the views to commands.
//!
//! Knows nothing of egui: plain input in, commands out, so that gestures are tested as scripts.

mod drag;
mod eye;
mod gestures;
pub mod gizmo;
mod gizmo_drag;
mod hands;
mod object_drag;
mod photo_view;
mod pick;
mod pin_drag;
mod pointer;
mod scene_content;
mod scene_view;
mod viewpoint;

pub use eye::Eye;
pub use gestures::Gestures;
pub use hands::{Hands, Pane, SceneMove};
pub use photo_view::PhotoView;
pub use pick::{Hit, object_rect, pick_all, pick_along};
pub use pointer::{Button, Modifiers, PointerAction, PointerEvent};
pub use scene_content::{image_distance_mm, orbit_pivot_mm, other_cameras, plane_corners};
pub use scene_view::{SceneView, StandardView};
pub use viewpoint::{GroundDrag, Viewpoint};
