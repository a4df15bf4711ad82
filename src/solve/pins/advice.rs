//! What is wrong with a set of pins, and what pin would help.

use std::fmt;

use glam::{DVec2, DVec3};

use super::spread::Spread;
use super::{Pin, PinOptions};

/// Why a pose from these pins is less sure than it could be. Directions are unit vectors of the `object` frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PinAdvice {
    /// Fewer than three: what they leave open is kept from the pose before.
    TooFew { pins: usize },
    /// Three fit several poses; a fourth says which.
    Ambiguous { poses: usize },
    /// All on one line: the turn about it is open.
    Collinear { line: DVec3 },
    /// All in one plane: two mirrored tilts look nearly alike.
    Planar { normal: DVec3 },
    /// All close to each other: a pixel of error turns the pose far.
    BunchedTogether { spread_mm: f64, object_mm: Option<f64> },
}

impl fmt::Display for PinAdvice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFew { pins: 0 } => {
                write!(f, "No pins in use: add four, far apart and not all in one plane.")
            }
            Self::TooFew { pins: 1 } => {
                write!(f, "One pin moves the object in the picture only. Add a second one far from it.")
            }
            Self::TooFew { pins } => {
                write!(
                    f,
                    "{pins} pins set place, size and roll. Add one or two off their line to set the tilt."
                )
            }
            Self::Ambiguous { poses } => {
                write!(f, "Three pins fit {poses} poses. Add a fourth, away from the plane of the three.")
            }
            Self::Collinear { .. } => {
                write!(
                    f,
                    "The pins are on one line, so the turn about it is open. Add one far off that line."
                )
            }
            Self::Planar { .. } => write!(
                f,
                "The pins are in one plane, so two mirrored tilts look alike. Add one well above or below that plane."
            ),
            Self::BunchedTogether { spread_mm, object_mm: Some(object_mm) } => write!(
                f,
                "The pins cover {spread_mm:.0} mm of an object of {object_mm:.0} mm. Add one at its far end."
            ),
            Self::BunchedTogether { .. } => {
                write!(f, "The pins are close together in the picture. Add one far away from them.")
            }
        }
    }
}

/// Pins that span less of the object than this leave too much to their errors.
const SMALL_PART: f64 = 0.35;
/// As much in the picture, in standard deviations of a click.
const SMALL_SPAN_SIGMAS: f64 = 25.0;

/// What to say of the pins in use. `poses` is how many fit them equally well.
pub fn advise(pins: &[Pin], poses: usize, options: &PinOptions) -> Vec<PinAdvice> {
    let points: Vec<DVec3> = pins.iter().map(|pin| pin.point_mm).collect();
    let Some(spread) = Spread::of(&points).filter(|_| pins.len() >= 3) else {
        return vec![PinAdvice::TooFew { pins: pins.len() }];
    };
    let mut advice = Vec::new();
    if spread.is_collinear() {
        advice.push(PinAdvice::Collinear { line: spread.axes[0] });
    } else if pins.len() == 3 && poses > 1 {
        advice.push(PinAdvice::Ambiguous { poses });
    } else if pins.len() > 3 && spread.is_planar() {
        advice.push(PinAdvice::Planar { normal: spread.axes[2] });
    }
    let spread_mm = longest(points.iter().map(|a| points.iter().map(|b| a.distance(*b)).fold(0.0, f64::max)));
    let clicked: Vec<DVec2> = pins.iter().map(|pin| pin.pixel).collect();
    let span_px = longest(clicked.iter().map(|a| clicked.iter().map(|b| a.distance(*b)).fold(0.0, f64::max)));
    let object_mm = options.object_diameter_mm;
    let is_small = object_mm.is_some_and(|object_mm| spread_mm < SMALL_PART * object_mm);
    if is_small || span_px < SMALL_SPAN_SIGMAS * options.click_sigma_px {
        advice.push(PinAdvice::BunchedTogether { spread_mm, object_mm: object_mm.filter(|_| is_small) });
    }
    advice
}

fn longest(lengths: impl Iterator<Item = f64>) -> f64 {
    lengths.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn advice_for(points: &[[f64; 3]]) -> Vec<PinAdvice> {
        // Seen from afar along z, five pixels a millimetre.
        let pins: Vec<Pin> = points
            .iter()
            .map(|&point| Pin::new(DVec3::from_array(point), DVec2::new(point[0], point[1]) * 5.0))
            .collect();
        advise(&pins, 1, &PinOptions { object_diameter_mm: Some(100.0), ..PinOptions::default() })
    }

    #[test]
    fn each_weakness_has_its_words() {
        assert_eq!(advice_for(&[[0.0; 3]]), [PinAdvice::TooFew { pins: 1 }]);
        let line = advice_for(&[[0.0; 3], [30.0, 30.0, 0.0], [60.0, 60.0, 0.0]]);
        assert!(matches!(line[..], [PinAdvice::Collinear { line }] if (line.x - line.y).abs() < 1e-9));
        let plane = [[0.0; 3], [60.0, 0.0, 0.0], [0.0, 60.0, 0.0], [60.0, 60.0, 0.0]];
        let flat = advice_for(&plane);
        assert!(matches!(flat[..], [PinAdvice::Planar { normal }] if normal.z.abs() > 0.999));
        assert!(flat[0].to_string().contains("above or below"));
        let body = [[0.0; 3], [60.0, 0.0, 0.0], [0.0, 60.0, 0.0], [60.0, 60.0, 40.0]];
        assert_eq!(advice_for(&body), []);
        let small = advice_for(&body.map(|point| point.map(|value| value * 0.2)));
        assert!(
            matches!(small[..], [PinAdvice::BunchedTogether { object_mm: Some(100.0), .. }]),
            "{small:?}"
        );
    }
}
