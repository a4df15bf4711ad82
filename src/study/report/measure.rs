//! How far two poses of a sample are apart, in everything a report tables.

use std::sync::Arc;

use super::ReportSample;
use crate::math::Pose;
use crate::mesh::{Mesh, PointTree};
use crate::metrics::{PoseError, adi_mm, mssd_mm};
use crate::scene::Symmetries;

/// One of the numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Measure {
    Rotation,
    Translation,
    Add,
    /// ADD in per cent of the object's diameter: what makes objects of different sizes comparable.
    AddShare,
    /// Signed: how much farther from the camera the middle of the object's box is.
    Depth,
    /// The smallest angle over the object's symmetries.
    SymmetricRotation,
    /// BOP's AD: ADI (ADD-S) for a symmetric object, ADD for any other.
    Ad,
    /// BOP's MSSD.
    Mssd,
}

/// A number for each of [`Measure::ALL`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Difference([f64; Measure::ALL.len()]);

impl Measure {
    pub const ALL: [Self; 8] = [
        Self::Rotation,
        Self::Translation,
        Self::Add,
        Self::AddShare,
        Self::Depth,
        Self::SymmetricRotation,
        Self::Ad,
        Self::Mssd,
    ];

    /// Those of the paper.
    pub const PAPER: [Self; 3] = [Self::Rotation, Self::Translation, Self::Add];

    /// Those that have a meaning between two poses of which neither is the truth. AD has none: ADI is another from the one
    /// pose to the other than back.
    pub const BETWEEN: [Self; 6] =
        [Self::Rotation, Self::Translation, Self::Add, Self::AddShare, Self::SymmetricRotation, Self::Mssd];

    /// A column's name, without the unit.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rotation => "rotation",
            Self::Translation => "translation",
            Self::Add => "ADD",
            Self::AddShare => "ADD of diameter",
            Self::Depth => "depth",
            Self::SymmetricRotation => "rotation (sym.)",
            Self::Ad => "AD",
            Self::Mssd => "MSSD",
        }
    }

    pub fn unit(self) -> &'static str {
        match self {
            Self::Rotation | Self::SymmetricRotation => "deg",
            Self::AddShare => "%",
            Self::Translation | Self::Add | Self::Depth | Self::Ad | Self::Mssd => "mm",
        }
    }
}

impl Difference {
    pub fn get(&self, measure: Measure) -> f64 {
        // The order of the variants is that of `Measure::ALL`.
        self.0[measure as usize]
    }
}

/// A sample's mesh with what its differences need, made once.
#[derive(Debug)]
pub(super) struct Model {
    mesh: Arc<Mesh>,
    /// Only for symmetric objects, which alone need it.
    tree: Option<PointTree>,
    diameter_mm: f64,
    symmetries: Vec<Pose>,
}

impl Model {
    /// `None` for a mesh without vertices.
    pub fn new(sample: &ReportSample) -> Option<Self> {
        let mesh = sample.mesh.clone();
        let tree = PointTree::build(mesh.positions_mm())?;
        let diameter_mm = tree.diameter();
        let symmetries = sample.symmetries.expanded();
        let tree = (!sample.symmetries.is_empty()).then_some(tree);
        Some(Self { mesh, tree, diameter_mm, symmetries })
    }

    pub fn diameter_mm(&self) -> f64 {
        self.diameter_mm
    }

    /// From a pose to the truth; both are `camera_from_object`.
    pub fn errors(&self, pose: &Pose, truth: &Pose) -> Difference {
        let mut errors = self.difference(pose, truth);
        if let Some(tree) = &self.tree {
            errors.0[Measure::Ad as usize] = adi_mm(pose, truth, &self.mesh, tree);
        }
        errors
    }

    /// Between two poses, neither of them the truth: in place of AD there is ADD.
    pub fn difference(&self, pose: &Pose, reference: &Pose) -> Difference {
        let plain = PoseError::between(pose, reference, &self.mesh, &Symmetries::default(), usize::MAX);
        let center = self.mesh.bounds().center();
        let depth_mm = pose.transform_point(center).z - reference.transform_point(center).z;
        let angles = self.symmetries.iter().map(|symmetry| pose.angle_to(&(*reference * *symmetry)));
        Difference([
            plain.rotation_rad.to_degrees(),
            plain.translation_mm,
            plain.add_mm,
            // A mesh of a single point has none.
            100.0 * plain.add_mm / self.diameter_mm.max(f64::MIN_POSITIVE),
            depth_mm,
            angles.fold(f64::INFINITY, f64::min).to_degrees(),
            plain.add_mm,
            mssd_mm(pose, reference, &self.mesh, &self.symmetries),
        ])
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::mesh::test_shapes;
    use crate::scene::ContinuousSymmetry;

    #[test]
    fn symmetric_errors_forgive_a_turn_and_plain_ones_do_not() {
        let mut sample = ReportSample {
            label: "S0".to_owned(),
            set: 0,
            name: "cube".to_owned(),
            mesh: Arc::new(test_shapes::cube()),
            symmetries: Symmetries::default(),
            truth: Pose::from_translation(DVec3::Z * 500.0),
            view: None,
        };
        let pose = sample.truth.translated(DVec3::Z * 2.0) * Pose::exp(DVec3::Z * 1.5, DVec3::ZERO);
        let plain = Model::new(&sample).unwrap().errors(&pose, &sample.truth);
        assert_eq!(plain.get(Measure::Rotation), plain.get(Measure::SymmetricRotation));
        assert_eq!(plain.get(Measure::Add), plain.get(Measure::Ad));
        assert!((plain.get(Measure::Rotation) - 1.5_f64.to_degrees()).abs() < 1e-9);
        assert!((plain.get(Measure::Depth) - 2.0).abs() < 1e-12);
        // The cube is 2 wide: its diagonal is its diameter.
        let share = 100.0 * plain.get(Measure::Add) / 12.0_f64.sqrt();
        assert!((plain.get(Measure::AddShare) - share).abs() < 1e-9);

        let axis = ContinuousSymmetry { axis: DVec3::Z, offset_mm: DVec3::ZERO };
        sample.symmetries = Symmetries { discrete: Vec::new(), continuous: vec![axis] };
        let found = Model::new(&sample).unwrap().errors(&pose, &sample.truth);
        assert_eq!(found.get(Measure::Add), plain.get(Measure::Add));
        // Turns are sampled at 315 per turn: at most half of 1.15 degrees is left.
        assert!(found.get(Measure::SymmetricRotation) < 0.58);
        assert!(found.get(Measure::Ad) < plain.get(Measure::Add) && found.get(Measure::Mssd) < 2.1);
        let itself = Model::new(&sample).unwrap().errors(&pose, &pose);
        assert!(Measure::ALL.iter().all(|measure| itself.get(*measure) == 0.0));
    }
}
