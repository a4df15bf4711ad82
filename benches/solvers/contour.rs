//! Where the solvers' eyes see the outline of shapes whose outline is known: farther out is positive.

use glam::{DMat3, DVec2, DVec3, Vec3};
use pinpose::math::{Intrinsics, Pose};
use pinpose::mesh::Mesh;
use pinpose::raster::PixelRegion;
use pinpose::solve::contour::{ContourModel, ContourPoint, DepthView, EdgeKind, Occluders};

use crate::chance::Chance;
use crate::numbers::{mean, quantile};
use crate::shapes::{cuboid, cylinder, sphere};

const ROUNDS: usize = 200;
const RADIUS_MM: f64 = 60.0;
const HALF_HEIGHT_MM: f64 = 70.0;
const SIZES_MM: Vec3 = Vec3::new(140.0, 90.0, 60.0);

/// How far out a point of the picture is, by definition.
type Outside = fn(&Pose, DVec2) -> f64;

pub fn contour() {
    println!(
        "Contour of analytic shapes, 12 to 14 cm at 0.8 m, {ROUNDS} views each, seed 5; px (0.03 wanted)"
    );
    println!("{:<12}{:>9}{:>9}{:>9}{:>9}", "", "points", "bias", "p95", "max");
    let shapes: [(&str, Mesh, Outside); 3] = [
        ("sphere", sphere(RADIUS_MM as f32, 180), outside_sphere),
        ("cylinder", cylinder(RADIUS_MM as f32, 2.0 * HALF_HEIGHT_MM as f32, 400), outside_cylinder),
        ("box", cuboid(SIZES_MM), outside_box),
    ];
    for (name, mesh, outside) in shapes {
        let model = ContourModel::new(&mesh).unwrap();
        let mut chance = Chance(5);
        let mut found = Vec::new();
        for _ in 0..ROUNDS {
            let place = DVec3::new(60.0 * chance.signed(), 60.0 * chance.signed(), 800.0);
            let pose = chance.rotation().translated(place);
            found.extend(outline(&model, &pose).iter().map(|point| outside(&pose, point.pixel)));
        }
        let sizes: Vec<f64> = found.iter().map(|distance| distance.abs()).collect();
        println!(
            "{name:<12}{:>9}{:>9.4}{:>9.4}{:>9.4}",
            found.len(),
            mean(&found),
            quantile(&sizes, 0.95),
            quantile(&sizes, 1.0)
        );
    }
}

fn camera() -> Intrinsics {
    Intrinsics::pinhole(572.4114, 573.57043, 325.2611, 242.04899, 640, 480)
}

fn outline(model: &ContourModel, pose: &Pose) -> Vec<ContourPoint> {
    let region = PixelRegion::of_camera(&camera());
    let occluders = Occluders::draw(&camera(), &[], region);
    let view = DepthView::draw(&camera(), model, *pose, &occluders, region);
    let mut points = model.points(&camera(), pose, &view, 1.0);
    points.retain(|point| point.kind == EdgeKind::Outline);
    points
}

/// Rays that touch a sphere make the same angle with its middle's.
fn outside_sphere(pose: &Pose, pixel: DVec2) -> f64 {
    let center = pose.translation_mm;
    let angle = (RADIUS_MM / center.length()).asin();
    let ray = camera().unproject(pixel);
    // Along the picture, not along the ray's circle: a pixel is wider in angle where it is seen squarely.
    (ray.angle_between(center) - angle) * camera().fx * ray.length_squared()
}

/// The outline of a cylinder is the hull of its two circles.
fn outside_cylinder(pose: &Pose, pixel: DVec2) -> f64 {
    const STEPS: usize = 4000;
    let rim = (0..2 * STEPS).map(|k| {
        let (sin, cos) = (std::f64::consts::TAU * (k / 2) as f64 / STEPS as f64).sin_cos();
        let z = if k % 2 == 0 { HALF_HEIGHT_MM } else { -HALF_HEIGHT_MM };
        DVec3::new(RADIUS_MM * cos, RADIUS_MM * sin, z)
    });
    outside_hull(pose, pixel, rim)
}

fn outside_box(pose: &Pose, pixel: DVec2) -> f64 {
    let half = SIZES_MM.as_dvec3() / 2.0;
    let corners = (0..8).map(|k| {
        let side = |axis: u32| if k >> axis & 1 == 1 { 1.0 } else { -1.0 };
        DVec3::new(side(0), side(1), side(2)) * half
    });
    outside_hull(pose, pixel, corners)
}

/// How far a pixel is outside of the hull of the points' pixels.
fn outside_hull(pose: &Pose, pixel: DVec2, points_mm: impl Iterator<Item = DVec3>) -> f64 {
    let pixels: Vec<DVec2> =
        points_mm.map(|point| camera().project(pose.transform_point(point)).unwrap()).collect();
    let hull = hull(pixels);
    let edges = hull.iter().zip(hull.iter().cycle().skip(1));
    let signed = edges.map(|(from, to)| {
        let along = (*to - *from).normalize();
        DMat3::from_cols(along.extend(0.0), (pixel - *from).extend(0.0), DVec3::Z).determinant()
    });
    // Counter-clockwise: what is inside is to the left of every edge.
    signed.map(|left| -left).fold(f64::NEG_INFINITY, f64::max)
}

/// Counter-clockwise, by Andrew's monotone chain (1979).
fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..] {
                if (b - a).perp_dot(point - b) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut lower = half(&mut points.iter().copied());
    lower.extend(half(&mut points.iter().rev().copied()));
    lower
}
