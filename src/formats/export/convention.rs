//! The convention that poses are written in: everything that others may want otherwise, applied at the file's edge.

use glam::{DMat3, DVec3};
use serde::Serialize;

use crate::math::Pose;

/// The axes of the camera frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum CameraAxes {
    /// x right, y down, z forward.
    #[default]
    OpenCv,
    /// x right, y up, z towards the viewer; also Blender's.
    OpenGl,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LengthUnit {
    #[default]
    Millimetre,
    Metre,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PoseDirection {
    /// `X_camera = R X_object + t`: the object's pose.
    #[default]
    CameraFromObject,
    /// Its inverse: the camera's pose in the object's frame.
    ObjectFromCamera,
}

/// Axes, unit and direction of written poses. The object's axes are never changed, only its unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Convention {
    pub axes: CameraAxes,
    pub unit: LengthUnit,
    pub direction: PoseDirection,
}

/// The convention in words, as files carry it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ConventionWords {
    pub direction: &'static str,
    pub camera_axes: &'static str,
    pub length_unit: &'static str,
    pub matrix_order: &'static str,
    pub pixel_origin: &'static str,
}

impl CameraAxes {
    pub fn name(self) -> &'static str {
        match self {
            Self::OpenCv => "opencv",
            Self::OpenGl => "opengl",
        }
    }
}

impl LengthUnit {
    pub fn name(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Metre => "m",
        }
    }

    pub fn in_mm(self) -> f64 {
        match self {
            Self::Millimetre => 1.0,
            Self::Metre => 1000.0,
        }
    }
}

impl PoseDirection {
    pub fn name(self) -> &'static str {
        match self {
            Self::CameraFromObject => "camera_from_object",
            Self::ObjectFromCamera => "object_from_camera",
        }
    }
}

impl Convention {
    /// The pose as a row-major 4×4 in this convention. In our own one it is the pose bit for bit.
    pub fn rows(&self, camera_from_object: &Pose) -> [[f64; 4]; 4] {
        // Turning about x by half a turn is its own inverse and changes signs alone.
        let flip = Pose { rotation: DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0)), ..Pose::IDENTITY };
        let pose = match self.axes {
            CameraAxes::OpenCv => *camera_from_object,
            CameraAxes::OpenGl => flip * *camera_from_object,
        };
        let pose = match self.direction {
            PoseDirection::CameraFromObject => pose,
            PoseDirection::ObjectFromCamera => pose.inverse(),
        };
        let mut rows = pose.to_rows();
        for row in rows.iter_mut().take(3) {
            // Divided: a product with 0.001 makes 0.7000000000000001 of 700.
            row[3] /= self.unit.in_mm();
        }
        rows
    }

    /// For file names: `camera_from_object_opencv_mm`.
    pub fn file_suffix(&self) -> String {
        format!("{}_{}_{}", self.direction.name(), self.axes.name(), self.unit.name())
    }

    pub fn words(&self) -> ConventionWords {
        ConventionWords {
            direction: match self.direction {
                PoseDirection::CameraFromObject => "camera_from_object: X_camera = R X_object + t",
                PoseDirection::ObjectFromCamera => "object_from_camera: X_object = R X_camera + t",
            },
            camera_axes: match self.axes {
                CameraAxes::OpenCv => "OpenCV: x right, y down, z forward",
                CameraAxes::OpenGl => "OpenGL: x right, y up, z towards the viewer",
            },
            length_unit: self.unit.name(),
            matrix_order: "row-major",
            pixel_origin: "(0, 0) is the centre of the top-left pixel",
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec4;

    use super::*;

    fn all() -> impl Iterator<Item = Convention> {
        let axes = [CameraAxes::OpenCv, CameraAxes::OpenGl];
        let units = [LengthUnit::Millimetre, LengthUnit::Metre];
        let directions = [PoseDirection::CameraFromObject, PoseDirection::ObjectFromCamera];
        axes.into_iter().flat_map(move |axes| {
            units.into_iter().flat_map(move |unit| {
                directions.into_iter().map(move |direction| Convention { axes, unit, direction })
            })
        })
    }

    #[test]
    fn every_convention_sends_a_point_to_the_same_place() {
        let pose = Pose::exp(DVec3::new(0.3, -0.9, 0.4), DVec3::new(12.0, -30.0, 640.0));
        let (object, camera) = (DVec3::new(7.0, 8.0, -9.0), pose.transform_point(DVec3::new(7.0, 8.0, -9.0)));
        for convention in all() {
            let scale = 1.0 / convention.unit.in_mm();
            let in_axes = match convention.axes {
                CameraAxes::OpenCv => camera,
                CameraAxes::OpenGl => DVec3::new(camera.x, -camera.y, -camera.z),
            };
            let (from, to) = match convention.direction {
                PoseDirection::CameraFromObject => (object, in_axes),
                PoseDirection::ObjectFromCamera => (in_axes, object),
            };
            let from = (from * scale).extend(1.0);
            let found = convention.rows(&pose).map(|row| DVec4::from_array(row).dot(from));
            let expected = (to * scale).extend(1.0).to_array();
            for (found, expected) in found.iter().zip(expected) {
                // Products of numbers below 1e3 in f64.
                assert!((found - expected).abs() < 1e-11, "{convention:?}: {found} {expected}");
            }
        }
        assert_eq!(all().count(), 8);
        assert_eq!(Convention::default().rows(&pose), pose.to_rows());
    }
}
