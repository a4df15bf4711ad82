//! How points lie: along a line, in a plane, in all directions.

use glam::DVec3;

use super::super::linear::symmetric_eigen;

/// The principal axes of a set of points, the longest first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    pub middle_mm: DVec3,
    pub axes: [DVec3; 3],
    /// Root mean squares along the axes.
    pub sizes_mm: [f64; 3],
}

impl Spread {
    /// `None` where there are no points.
    pub fn of(points_mm: &[DVec3]) -> Option<Self> {
        let count = points_mm.len() as f64;
        let middle_mm = points_mm.iter().sum::<DVec3>() / count;
        let mut moments = [[0.0; 3]; 3];
        for point in points_mm {
            let offset = (*point - middle_mm).to_array();
            for (row, a) in moments.iter_mut().zip(offset) {
                row.iter_mut().zip(offset).for_each(|(moment, b)| *moment += a * b / count);
            }
        }
        let (values, vectors) = symmetric_eigen(&moments);
        let sizes_mm = [2, 1, 0].map(|i| f64::sqrt(f64::max(values[i], 0.0)));
        (!points_mm.is_empty()).then_some(Self {
            middle_mm,
            axes: [2, 1, 0].map(|i| DVec3::from_array(vectors[i])),
            sizes_mm,
        })
    }

    /// Nearly on one line, or all at one place: the turn about that line is anybody's guess.
    pub fn is_collinear(&self) -> bool {
        // Clicks are good to a pixel or two, objects some hundred pixels long: below 3 % a line cannot be told from noise.
        self.sizes_mm[1] <= 0.03 * self.sizes_mm[0]
    }

    /// In one plane as far as clicks can tell, but not on a line.
    pub fn is_planar(&self) -> bool {
        !self.is_collinear() && self.sizes_mm[2] <= 0.05 * self.sizes_mm[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_planes_and_bodies_are_told_apart() {
        let line = [0.0, 1.0, 5.0, 9.0].map(|x| DVec3::new(x, 2.0 * x, 7.0));
        let spread = Spread::of(&line).unwrap();
        assert!(spread.is_collinear() && !spread.is_planar());
        assert!(spread.axes[0].cross(DVec3::new(1.0, 2.0, 0.0)).length() < 1e-9);
        let square = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 3.0));
        let spread = Spread::of(&square).unwrap();
        assert!(spread.is_planar() && !spread.is_collinear());
        // The corners of a unit square are half a unit from its middle along each axis.
        assert!((spread.sizes_mm[0] - 0.5).abs() < 1e-12 && spread.sizes_mm[2] < 1e-9);
        let body = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        assert!(!Spread::of(&body).unwrap().is_planar());
        assert!(Spread::of(&[DVec3::ONE; 3]).unwrap().is_collinear());
        assert_eq!(Spread::of(&[]), None);
    }
}
