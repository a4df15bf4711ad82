//! Hands: pointer and wheel in the photo view to commands.
//!
//! Knows nothing of egui: plain input in, commands out, so that gestures are tested as scripts.

mod drag;
mod photo_gestures;
mod photo_view;
mod pick;

pub use photo_gestures::{Button, Modifiers, PhotoGestures, PointerAction, PointerEvent};
pub use photo_view::PhotoView;
pub use pick::{Hit, object_rect, pick_all};
