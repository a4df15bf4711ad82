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

/// ADD: the mean distance of the vertices under two poses.
pub fn add_mm(a: &Matrix, b: &Matrix, vertices: &[Vector]) -> f64 {
    let sum: f64 =
        vertices.iter().map(|vertex| distance(transformed(a, *vertex), transformed(b, *vertex))).sum();
    sum / vertices.len() as f64
}

/// The rotation that leads from one to another, `to · fromᵀ`, as axis times angle.
pub fn axis_angle_between(from: &[[f64; 3]; 3], to: &[[f64; 3]; 3]) -> Vector {
    let transposed = [0, 1, 2].map(|row| [0, 1, 2].map(|column| from[column][row]));
    let r = product(to, &transposed);
    let angle = ((r[0][0] + r[1][1] + r[2][2] - 1.0) / 2.0).clamp(-1.0, 1.0).acos();
    let twice_sin = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]];
    if angle < 1e-9 {
        return twice_sin.map(|value| value / 2.0);
    }
    if angle > std::f64::consts::PI - 1e-3 {
        // Near half a turn the axis is where R + I is longest.
        let columns = [0, 1, 2]
            .map(|column| [0, 1, 2].map(|row| r[row][column] + if row == column { 1.0 } else { 0.0 }));
        let longest = columns.into_iter().max_by(|a, b| norm(*a).total_cmp(&norm(*b))).unwrap_or_default();
        return longest.map(|value| value / norm(longest) * angle);
    }
    twice_sin.map(|value| value / norm(twice_sin) * angle)
}

/// The shortest rotation that takes one direction to another.
pub fn rotation_between(from: Vector, to: Vector) -> [[f64; 3]; 3] {
    let [a, b] = [from, to].map(|vector| vector.map(|value| value / norm(vector)));
    let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let dot: f64 = (0..3).map(|axis| a[axis] * b[axis]).sum();
    let skew = [[0.0, -cross[2], cross[1]], [cross[2], 0.0, -cross[0]], [-cross[1], cross[0], 0.0]];
    let squared = product(&skew, &skew);
    [0, 1, 2].map(|row| {
        [0, 1, 2].map(|column| {
            let identity = if row == column { 1.0 } else { 0.0 };
            identity + skew[row][column] + squared[row][column] / (1.0 + dot)
        })
    })
}

/// A vector in the frame that a rotation leads from.
pub fn rotated_back(rotation: &[[f64; 3]; 3], vector: Vector) -> Vector {
    [0, 1, 2].map(|column| (0..3).map(|row| rotation[row][column] * vector[row]).sum())
}

pub fn norm(vector: Vector) -> f64 {
    distance(vector, [0.0; 3])
}
