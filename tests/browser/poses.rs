//! The little arithmetic by which the flows check poses, written apart from the program's own.

use crate::api::Matrix;
use crate::input::Point;

pub type Vector = [f64; 3];

pub fn transformed(pose: &Matrix, point: Vector) -> Vector {
    let row = |row: usize| {
        let [x, y, z, w] = pose[row];
        x * point[0] + y * point[1] + z * point[2] + w
    };
    [row(0), row(1), row(2)]
}

/// `K (R X + t)`, in the `image` frame.
pub fn projected(k: &[[f64; 3]; 3], pose: &Matrix, point: Vector) -> Point {
    let [x, y, z] = transformed(pose, point);
    ((k[0][0] * x + k[0][1] * y) / z + k[0][2], k[1][1] * y / z + k[1][2])
}

/// The point of the camera's frame that is seen at a pixel, at a depth.
pub fn unprojected(k: &[[f64; 3]; 3], (u, v): Point, depth_mm: f64) -> Vector {
    let y = (v - k[1][2]) / k[1][1];
    [((u - k[0][2]) - k[0][1] * y) / k[0][0] * depth_mm, y * depth_mm, depth_mm]
}

/// The pose with this rotation that puts `point` to `target`, both in millimetres.
pub fn placed(rotation: [[f64; 3]; 3], point: Vector, target: Vector) -> Matrix {
    let turned = transformed(&with_translation(rotation, [0.0; 3]), point);
    with_translation(rotation, [0, 1, 2].map(|axis| target[axis] - turned[axis]))
}

pub fn with_translation(rotation: [[f64; 3]; 3], t: Vector) -> Matrix {
    let row = |axis: usize| [rotation[axis][0], rotation[axis][1], rotation[axis][2], t[axis]];
    [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
}

pub fn rotation(pose: &Matrix) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|row| [pose[row][0], pose[row][1], pose[row][2]])
}

/// A rotation by an angle about a coordinate axis (0: x).
pub fn axis_rotation(axis: usize, angle: f64) -> [[f64; 3]; 3] {
    let (sin, cos) = angle.sin_cos();
    let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut matrix = [[0.0; 3]; 3];
    matrix[axis][axis] = 1.0;
    (matrix[next][next], matrix[last][last]) = (cos, cos);
    (matrix[next][last], matrix[last][next]) = (-sin, sin);
    matrix
}

pub fn product(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|row| [0, 1, 2].map(|column| (0..3).map(|inner| a[row][inner] * b[inner][column]).sum()))
}

/// The angle between two poses' rotations.
pub fn angle_between(a: &Matrix, b: &Matrix) -> f64 {
    let product: f64 = (0..3).flat_map(|row| (0..3).map(move |column| a[row][column] * b[row][column])).sum();
    ((product - 1.0) / 2.0).clamp(-1.0, 1.0).acos()
}

pub fn distance(a: Vector, b: Vector) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

pub fn distance_px(a: Point, b: Point) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}
