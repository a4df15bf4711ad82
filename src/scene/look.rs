//! How the overlay is shown: no part of the scene itself and of undo, but saved with it.

/// What the meshes are drawn as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OverlayMode {
    /// Lit, in the object's colour.
    #[default]
    Shaded,
    /// The mesh's texture or vertex colours; where it has none, as [`Self::Shaded`].
    Colors,
    /// Object coordinates as colours, one scale for all axes.
    Nocs,
    /// Normals in the `camera` frame as colours.
    Normals,
    /// Depth as colours, from the nearest to the farthest point that is drawn.
    Depth,
    /// The silhouette's line alone.
    Outline,
    /// Sharp and open edges alone, hidden ones left out.
    Edges,
    /// All edges, hidden ones left out.
    Wireframe,
}

impl OverlayMode {
    /// In the order in which a key goes through them: the mode, its name in files and in the page's API, its title.
    pub const ALL: [(Self, &'static str, &'static str); 8] = [
        (Self::Shaded, "shaded", "Shaded"),
        (Self::Colors, "colors", "Texture"),
        (Self::Nocs, "nocs", "NOCS"),
        (Self::Normals, "normals", "Normals"),
        (Self::Depth, "depth", "Depth"),
        (Self::Outline, "outline", "Outline"),
        (Self::Edges, "edges", "Edges"),
        (Self::Wireframe, "wireframe", "Wireframe"),
    ];

    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }

    pub fn title(self) -> &'static str {
        Self::ALL[self as usize].2
    }

    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, candidate, _)| *candidate == name).map(|(mode, ..)| *mode)
    }

    /// The one that follows, the first after the last.
    pub fn next(self) -> Self {
        Self::ALL[(self as usize + 1) % Self::ALL.len()].0
    }
}

/// How the photo's colours are changed for the eye; each −1 to 1, 0 is as it is. Nothing is measured in changed colours.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PhotoAdjustment {
    pub brightness: f32,
    pub contrast: f32,
    pub saturation: f32,
}

impl PhotoAdjustment {
    /// The photo is shown as it is.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// What of photo and meshes is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Layers {
    #[default]
    Both,
    PhotoOnly,
    MeshOnly,
}

impl Layers {
    pub fn next(self) -> Self {
        match self {
            Self::Both => Self::PhotoOnly,
            Self::PhotoOnly => Self::MeshOnly,
            Self::MeshOnly => Self::Both,
        }
    }
}

/// How a photo and the meshes over it are shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    pub mode: OverlayMode,
    /// 0 to 1, over all objects.
    pub overlay_opacity: f32,
    /// The silhouette's line over whatever the mode draws.
    pub outline: bool,
    /// Hidden parts show through those before them.
    pub x_ray: bool,
    pub layers: Layers,
    pub photo: PhotoAdjustment,
    /// The overlay is drawn only left of this part of the viewport's width, 0 to 1.
    pub wipe: Option<f32>,
    /// The difference of overlay and photo in place of the overlay.
    pub difference: bool,
}

impl Look {
    /// The same with every number within its range, for numbers that come from outside.
    pub fn in_range(self) -> Self {
        let signed = |value: f32| if value.is_finite() { value.clamp(-1.0, 1.0) } else { 0.0 };
        let unit = |value: f32| if value.is_finite() { value.clamp(0.0, 1.0) } else { 1.0 };
        Self {
            overlay_opacity: unit(self.overlay_opacity),
            photo: PhotoAdjustment {
                brightness: signed(self.photo.brightness),
                contrast: signed(self.photo.contrast),
                saturation: signed(self.photo.saturation),
            },
            wipe: self.wipe.map(unit),
            ..self
        }
    }
}

impl Default for Look {
    fn default() -> Self {
        Self {
            mode: OverlayMode::default(),
            overlay_opacity: 1.0,
            outline: true,
            x_ray: false,
            layers: Layers::default(),
            photo: PhotoAdjustment::default(),
            wipe: None,
            difference: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_modes_are_listed_in_their_order() {
        for (index, (mode, name, _)) in OverlayMode::ALL.into_iter().enumerate() {
            assert_eq!(mode as usize, index);
            assert_eq!(OverlayMode::from_name(name), Some(mode));
        }
        assert_eq!(OverlayMode::Wireframe.next(), OverlayMode::Shaded);
    }
}
