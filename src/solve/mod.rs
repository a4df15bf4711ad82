//! Solvers: the pose from pins, from a photograph's contours, and how sure it is.
//!
//! This room knows meshes, photographs and cameras as data. It has no clock, no screen and no chance: time budgets come as
//! a function that says whether to go on, and seeds as arguments.

pub mod contour;
mod free_turns;
mod least_squares;
mod linear;
mod motion;
pub mod pins;
mod robust;
mod shading;
pub mod snap;
pub mod symmetry;
#[cfg(test)]
mod test_chance;
mod uncertainty;
mod weakest;

pub use free_turns::FreeTurns;
pub use motion::TwistCovariance;
pub use uncertainty::{Tolerances, Uncertainty};
pub use weakest::{Weakest, Weakness, most_helpful_point, weakest};
