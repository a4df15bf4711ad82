//! How exact the solvers are and what they cost, against named peers in the same run.
//!
//! All parts, or those that are named: `cargo bench --bench solvers -- pins`.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a measurement that cannot be made had better stop"
)]

mod chance;
mod contour;
mod numbers;
mod opencv;
mod photos;
mod pins;
mod real;
mod shapes;
mod snap;
mod symmetry;

const PARTS: [(&str, fn()); 5] = [
    ("pins", pins::pins),
    ("contour", contour::contour),
    ("symmetry", symmetry::symmetry),
    ("snap", snap::snap),
    ("real-snap", real::real),
];

fn main() {
    let named: Vec<String> = std::env::args().skip(1).filter(|name| !name.starts_with('-')).collect();
    for (name, part) in PARTS {
        if named.is_empty() || named.iter().any(|wanted| wanted == name) {
            part();
        }
    }
}
