//! What the pointer did, as plain data.

use glam::DVec2;

/// One thing the pointer did, in physical pixels from the viewport's top left corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointerEvent {
    pub position: DVec2,
    pub action: PointerAction,
    pub modifiers: Modifiers,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PointerAction {
    Move,
    /// A button went down over the viewport, with nothing (a panel, a window) before it.
    Press(Button),
    Release(Button),
    DoubleClick,
    /// Notches, up is positive; either axis, as Shift swaps them in some browsers.
    Wheel(f64),
    /// The factor of a pinch.
    Pinch(f64),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Modifiers {
    pub shift: bool,
    pub ctrl: bool,
    pub alt: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Button {
    Left,
    Middle,
    Right,
}
