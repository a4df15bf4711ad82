//! Axis-aligned boxes and bounding spheres of point sets.

use glam::{DVec3, Vec3};

/// An axis-aligned box, in whatever frame and unit its points were in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    pub min: DVec3,
    pub max: DVec3,
}

/// A sphere around the centre of a box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundingSphere {
    pub center: DVec3,
    pub radius: f64,
}

impl Bounds {
    /// The smallest box around `points`; `None` where there are none.
    pub fn of(points: &[Vec3]) -> Option<Self> {
        let (&first, rest) = points.split_first()?;
        let (min, max) =
            rest.iter().fold((first, first), |(min, max), &point| (min.min(point), max.max(point)));
        Some(Self { min: min.as_dvec3(), max: max.as_dvec3() })
    }

    pub fn center(&self) -> DVec3 {
        (self.min + self.max) / 2.0
    }

    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            DVec3::new(
                if i & 1 == 0 { self.min.x } else { self.max.x },
                if i & 2 == 0 { self.min.y } else { self.max.y },
                if i & 4 == 0 { self.min.z } else { self.max.z },
            )
        })
    }

    /// The sphere around the box's centre that just holds `points`: never larger than the box's own.
    pub fn sphere_of(&self, points: &[Vec3]) -> BoundingSphere {
        let center = self.center();
        let radius_squared =
            points.iter().map(|point| point.as_dvec3().distance_squared(center)).fold(0.0, f64::max);
        BoundingSphere { center, radius: radius_squared.sqrt() }
    }
}
