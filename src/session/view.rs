//! How the session is looked at and worked on; no part of undo.

/// Which views are on screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Arrangement {
    /// Through the camera that took the photo.
    #[default]
    Photo,
    /// A free camera around photo and objects.
    Scene,
    /// Both side by side.
    Split,
}

impl Arrangement {
    /// Each with its name in files and in the page's API.
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::Photo, "photo"), (Self::Scene, "scene"), (Self::Split, "split")];

    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }

    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, candidate)| *candidate == name).map(|(arrangement, _)| *arrangement)
    }

    pub fn next(self) -> Self {
        Self::ALL[(self as usize + 1) % Self::ALL.len()].0
    }

    pub fn shows_photo(self) -> bool {
        self != Self::Scene
    }

    pub fn shows_scene(self) -> bool {
        self != Self::Photo
    }
}

/// The views and what is in them besides the scene.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Panes {
    pub arrangement: Arrangement,
    /// Of the photo's plane in the scene view; `None`: as far as the farthest object reaches.
    pub image_distance_mm: Option<f64>,
    /// Handles to move and turn the selected object are drawn over it.
    pub gizmo: bool,
}

/// What the left mouse button does to an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tool {
    #[default]
    Move,
    Rotate,
    /// Sets pins on it, and drags them to their pixels.
    Pin,
}

impl Tool {
    /// Its name in the page's API.
    pub fn name(self) -> &'static str {
        match self {
            Self::Move => "move",
            Self::Rotate => "rotate",
            Self::Pin => "pin",
        }
    }
}
