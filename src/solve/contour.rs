//! Where the edges of an object are seen: points exactly on the silhouette edges of its mesh and on its creases.
//!
//! A silhouette edge lies between a face that looks at the camera and one that looks away. Points on it are exact for the
//! mesh, whatever the resolution of the depth map, which only says whether a point is hidden.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3, Vec3};

use super::motion::project_with_jacobian;
use super::shading::{Shading, barycentric};
use crate::math::{Intrinsics, Pose};
use crate::mesh::{Mesh, simplified};
use crate::raster::{PixelRegion, RasterImage, RasterItem, rasterize, rasterize_triangles};

/// A mesh of more triangles is simplified before solvers look at it.
pub const MAX_TRIANGLES: usize = 8000;
/// Faces that meet at a larger angle have an edge of their own; smaller ones stand for a round surface.
const CREASE_COSINE: f64 = 0.866;

/// What kind of edge a point is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EdgeKind {
    /// The object ends here, and what is behind begins.
    Outline,
    /// A part of the object ends here before another part of it.
    Inner,
    /// Two faces meet here.
    Crease,
}

/// A visible point on an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContourPoint {
    /// In the `object` frame.
    pub point_mm: DVec3,
    pub pixel: DVec2,
    /// Of length one in the image; for a silhouette it points away from the part that ends here.
    pub normal: DVec2,
    pub kind: EdgeKind,
}

/// A mesh prepared for many looks at its edges.
#[derive(Debug, Clone)]
pub struct ContourModel {
    mesh: Mesh,
    /// Unit normals of the faces, outward.
    normals: Vec<DVec3>,
    edges: Vec<Edge>,
    diameter_mm: f64,
    shading: Shading,
}

#[derive(Debug, Clone, Copy)]
struct Edge {
    ends: [DVec3; 2],
    /// The faces at it; the same one twice at an open edge.
    faces: [usize; 2],
    is_sharp: bool,
}

/// What the camera sees of an object and of what is before it, pixel by pixel.
#[derive(Debug, Clone)]
pub struct DepthView {
    pub image: RasterImage,
    pub region: PixelRegion,
}

/// In [`RasterImage::ids`]: the object itself. Occluders have higher numbers.
pub const OBJECT_ID: u32 = 1;
const OCCLUDER_ID: u32 = 2;

/// What may be before an object. It does not move while the object does, so it is drawn once.
#[derive(Debug, Clone)]
pub struct Occluders(Option<RasterImage>);

impl Occluders {
    pub fn draw(camera: &Intrinsics, occluders: &[(&ContourModel, Pose)], region: PixelRegion) -> Self {
        let items: Vec<RasterItem<'_>> = occluders
            .iter()
            .map(|&(model, camera_from_object)| RasterItem {
                mesh: &model.mesh,
                camera_from_object,
                id: OCCLUDER_ID,
            })
            .collect();
        Self((!items.is_empty()).then(|| rasterize(camera, &items, region)))
    }

    /// What was measured nearer than `before_mm` is before the object as well. `measured_mm` gives the depth along the
    /// optical axis at a pixel counted from the region's first, 0 where nothing was measured.
    pub fn add_measured(
        &mut self,
        region: PixelRegion,
        before_mm: f64,
        measured_mm: impl Fn(u32, u32) -> f32,
    ) {
        let (width, height) = (region.width, region.height);
        let count = width as usize * height as usize;
        let empty = || RasterImage { width, height, depth_mm: vec![0.0; count], ids: vec![0; count] };
        let image = self.0.get_or_insert_with(empty);
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        for ((x, y), (depth_mm, id)) in places.zip(image.depth_mm.iter_mut().zip(&mut image.ids)) {
            let measured = measured_mm(x, y);
            let is_before = measured > 0.0 && f64::from(measured) < before_mm;
            if is_before && (*id == 0 || measured < *depth_mm) {
                (*depth_mm, *id) = (measured, OCCLUDER_ID);
            }
        }
    }
}

impl DepthView {
    /// Of a region of the picture; the occluders were drawn for the same one.
    pub fn draw(
        camera: &Intrinsics,
        model: &ContourModel,
        camera_from_object: Pose,
        occluders: &Occluders,
        region: PixelRegion,
    ) -> Self {
        Self::draw_faces(camera, model, camera_from_object, occluders, region).0
    }

    /// With the face that is seen at each pixel: one plus its number, 0 where the object is not seen.
    pub fn draw_faces(
        camera: &Intrinsics,
        model: &ContourModel,
        camera_from_object: Pose,
        occluders: &Occluders,
        region: PixelRegion,
    ) -> (Self, Vec<u32>) {
        let mut image = rasterize_triangles(camera, &model.mesh, &camera_from_object, region);
        let mut faces = image.ids.clone();
        image.ids.iter_mut().for_each(|id| *id = if *id == 0 { 0 } else { OBJECT_ID });
        let Some(other) = &occluders.0 else { return (Self { image, region }, faces) };
        let seen = image.depth_mm.iter_mut().zip(&mut image.ids).zip(&mut faces);
        let others = other.depth_mm.iter().zip(&other.ids);
        for (((depth_mm, id), face), (&other_depth_mm, &other_id)) in seen.zip(others) {
            if other_id != 0 && (*id == 0 || other_depth_mm < *depth_mm) {
                (*depth_mm, *id, *face) = (other_depth_mm, other_id, 0);
            }
        }
        (Self { image, region }, faces)
    }

    /// The number and the depth of what is seen at the pixel nearest to this place; 0 where nothing is, `None` outside.
    pub fn at(&self, pixel: DVec2) -> Option<(u32, f64)> {
        // WebAssembly has an instruction for this, and none for what `round` does with halves.
        let whole = (pixel + 0.5).floor();
        let x = whole.x as i64 - i64::from(self.region.x0);
        let y = whole.y as i64 - i64::from(self.region.y0);
        let (width, height) = (i64::from(self.region.width), i64::from(self.region.height));
        if !(0..width).contains(&x) || !(0..height).contains(&y) {
            return None;
        }
        let i = (y * width + x) as usize;
        Some((*self.image.ids.get(i)?, f64::from(*self.image.depth_mm.get(i)?)))
    }
}

impl ContourModel {
    /// `None` for a mesh without a single proper triangle.
    pub fn new(mesh: &Mesh) -> Option<Self> {
        let mesh = simplified(mesh, MAX_TRIANGLES)?;
        let outward = if mesh.is_inside_out() { -1.0 } else { 1.0 };
        let normals: Vec<DVec3> = mesh
            .triangles()
            .iter()
            .map(|&triangle| {
                let [a, b, c] = mesh.corners(triangle);
                outward * (b - a).cross(c - a).normalize_or_zero()
            })
            .collect();
        let edges = edges(&mesh, &normals);
        let diameter_mm = 2.0 * mesh.sphere().radius;
        let shading = Shading::of(&mesh);
        Some(Self { mesh, normals, edges, diameter_mm, shading })
    }

    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The unit normal and the colour (in sRGB, 0 to 1; white where there are no colours) at a point of a face, in the
    /// `object` frame. `None` for a face without area.
    pub fn shade_at(&self, face: usize, point_mm: DVec3) -> Option<(DVec3, Vec3)> {
        let corners = self.mesh.corners(*self.mesh.triangles().get(face)?);
        self.shading.at(face, barycentric(corners, point_mm)?)
    }

    pub fn diameter_mm(&self) -> f64 {
        self.diameter_mm
    }

    /// The middle of the mesh's box, in the `object` frame.
    pub fn center_mm(&self) -> DVec3 {
        self.mesh.bounds().center()
    }

    /// Points on all visible edges, about `spacing_px` apart.
    pub fn points(
        &self,
        camera: &Intrinsics,
        camera_from_object: &Pose,
        view: &DepthView,
        spacing_px: f64,
    ) -> Vec<ContourPoint> {
        let eye = camera_from_object.inverse().translation_mm;
        let mut points = Vec::new();
        // Edges are short; the distance to the next point is carried on from one to the next.
        let mut until_next = spacing_px / 2.0;
        for edge in &self.edges {
            let faces_eye = edge.faces.map(|face| self.normals[face].dot(eye - edge.ends[0]) > 0.0);
            let is_silhouette = faces_eye[0] != faces_eye[1] || edge.faces[0] == edge.faces[1];
            let is_crease = edge.is_sharp && faces_eye[0];
            if !is_silhouette && !is_crease {
                continue;
            }
            let ends = edge.ends.map(|end| camera.project(camera_from_object.transform_point(end)));
            let [Some(from), Some(to)] = ends else { continue };
            let length = from.distance(to);
            if length > 1e5 || !length.is_finite() {
                continue;
            }
            while until_next < length {
                let point_mm = edge.ends[0].lerp(edge.ends[1], until_next / length);
                let seen = Seen { camera, camera_from_object, view, faces_eye, is_silhouette };
                points.extend(self.visible_point(edge, &seen, point_mm));
                until_next += spacing_px;
            }
            until_next -= length;
        }
        outermost(points, spacing_px)
    }

    fn visible_point(&self, edge: &Edge, seen: &Seen<'_>, point_mm: DVec3) -> Option<ContourPoint> {
        let point_camera = seen.camera_from_object.transform_point(point_mm);
        let (pixel, jacobian) = project_with_jacobian(seen.camera, point_camera)?;
        let in_image = |direction: DVec3| {
            let direction = seen.camera_from_object.rotation * direction;
            DVec2::new(jacobian[0].dot(direction), jacobian[1].dot(direction))
        };
        // Away from the face that is seen: for a sharp edge square to the edge, for a round surface along its normal.
        let front = if seen.faces_eye[0] { edge.faces[0] } else { edge.faces[1] };
        let along = in_image(edge.ends[1] - edge.ends[0]).try_normalize()?;
        let across_face = (edge.ends[1] - edge.ends[0]).cross(self.normals[front]);
        let outward = in_image(self.away_from(front, across_face, point_mm));
        let normal = if edge.is_sharp {
            if along.perp().dot(outward) < 0.0 { -along.perp() } else { along.perp() }
        } else {
            in_image(self.normals[edge.faces[0]] + self.normals[edge.faces[1]]).try_normalize()?
        };
        let tolerance_mm = 0.02 * self.diameter_mm;
        let is_hidden = |place: DVec2| match seen.view.at(place) {
            Some((id, depth_mm)) => id != 0 && depth_mm < point_camera.z - tolerance_mm,
            None => true,
        };
        if !seen.is_silhouette {
            let visible = !is_hidden(pixel);
            return visible.then_some(ContourPoint { point_mm, pixel, normal, kind: EdgeKind::Crease });
        }
        // On the inner side a round surface comes nearer at once, which hides nothing: only what is outside counts, and
        // other objects on both sides.
        let (outside, inside) = (pixel + normal * 1.5, pixel - normal * 1.5);
        let is_occluded =
            |place: DVec2| seen.view.at(place).is_none_or(|(id, _)| id > OBJECT_ID) && is_hidden(place);
        if is_hidden(outside) || is_occluded(inside) {
            return None;
        }
        let is_inner = seen.view.at(outside).is_some_and(|(id, _)| id == OBJECT_ID);
        let kind = if is_inner { EdgeKind::Inner } else { EdgeKind::Outline };
        Some(ContourPoint { point_mm, pixel, normal, kind })
    }

    /// A direction in the plane of a face, turned so that it leads out of the face.
    fn away_from(&self, face: usize, direction: DVec3, point_mm: DVec3) -> DVec3 {
        let [a, b, c] = self.mesh.corners(self.mesh.triangles()[face]);
        if direction.dot(point_mm - (a + b + c) / 3.0) < 0.0 { -direction } else { direction }
    }
}

/// Where a bumpy surface is seen edge-on, several of its silhouette edges lie side by side within a pixel or two, and the
/// depth map cannot tell which of them hides the others. The object ends at the outermost; points on the others are left out.
fn outermost(mut points: Vec<ContourPoint>, spacing_px: f64) -> Vec<ContourPoint> {
    points.sort_by(|a, b| a.pixel.x.total_cmp(&b.pixel.x));
    let beside_px = BESIDE_PX.max(spacing_px);
    let is_outermost = |number: usize| {
        let point = &points[number];
        let is_near = |other: &&ContourPoint| (other.pixel.x - point.pixel.x).abs() < FARTHEST_OUT_PX;
        let before = points[..number].iter().rev().take_while(is_near);
        let after = points[number + 1..].iter().take_while(is_near);
        !before.chain(after).any(|other| {
            let offset = other.pixel - point.pixel;
            let outward_px = offset.dot(point.normal);
            other.kind == point.kind
                && (NEAREST_OUT_PX..FARTHEST_OUT_PX).contains(&outward_px)
                && offset.perp_dot(point.normal).abs() < beside_px
                && other.normal.dot(point.normal) > 0.5
        })
    };
    let keep: Vec<bool> = (0..points.len())
        .map(|number| points[number].kind == EdgeKind::Crease || is_outermost(number))
        .collect();
    let mut keep = keep.into_iter();
    points.retain(|_| keep.next().unwrap_or(false));
    points
}

/// A point this far out or farther hides one, and not one that is farther: that is another part of the object.
const NEAREST_OUT_PX: f64 = 0.3;
const FARTHEST_OUT_PX: f64 = 3.0;
/// How far to its side it may be, or as far as the next point.
const BESIDE_PX: f64 = 1.0;

/// What is the same for all points of an edge.
struct Seen<'a> {
    camera: &'a Intrinsics,
    camera_from_object: &'a Pose,
    view: &'a DepthView,
    faces_eye: [bool; 2],
    is_silhouette: bool,
}

fn edges(mesh: &Mesh, normals: &[DVec3]) -> Vec<Edge> {
    let mut faces_at: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
    for (face, &[a, b, c]) in mesh.triangles().iter().enumerate() {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            faces_at.entry([from.min(to), from.max(to)]).or_default().push(face);
        }
    }
    let position = |vertex: u32| mesh.positions_mm()[vertex as usize].as_dvec3();
    faces_at
        .into_iter()
        .filter_map(|(ends, faces)| {
            let (&first, &last) = (faces.first()?, faces.last()?);
            let is_sharp = faces.len() != 2 || normals[first].dot(normals[last]) < CREASE_COSINE;
            Some(Edge { ends: ends.map(position), faces: [first, last], is_sharp })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use glam::DMat3;

    use super::super::test_chance::camera;
    use super::*;
    use crate::mesh::MeshData;
    use crate::mesh::test_shapes::{cube, sphere};

    fn seen(model: &ContourModel, pose: &Pose, others: &[(&ContourModel, Pose)]) -> DepthView {
        let region = PixelRegion::of_camera(&camera());
        let occluders = Occluders::draw(&camera(), others, region);
        DepthView::draw(&camera(), model, *pose, &occluders, region)
    }

    fn outline(mesh: &Mesh, pose: &Pose) -> Vec<ContourPoint> {
        let model = ContourModel::new(mesh).unwrap();
        let view = seen(&model, pose, &[]);
        let mut points = model.points(&camera(), pose, &view, 2.0);
        points.retain(|point| point.kind == EdgeKind::Outline);
        points
    }

    #[test]
    fn a_mesh_that_is_inside_out_has_the_same_outline() {
        let pose = Pose::IDENTITY.translated(DVec3::new(10.0, -20.0, 700.0));
        let mesh = sphere(80.0, 40, 80);
        let turned = mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
        let turned = Mesh::new(MeshData { triangles: turned, ..mesh.data().clone() }).unwrap();
        assert_eq!(outline(&turned, &pose).len(), outline(&mesh, &pose).len());
        assert!(outline(&mesh, &pose).len() > 100);
    }

    /// Mean and largest signed distance of the points outside of a shape's outline.
    fn bias(points: &[ContourPoint], outside_px: impl Fn(DVec2) -> f64) -> (f64, f64) {
        let distances: Vec<f64> = points.iter().map(|point| outside_px(point.pixel)).collect();
        let largest = distances.iter().fold(0.0_f64, |max, d| max.max(d.abs()));
        (distances.iter().sum::<f64>() / distances.len() as f64, largest)
    }

    #[test]
    fn a_spheres_outline_is_where_its_tangent_cone_is() {
        let center = DVec3::new(60.0, -40.0, 700.0);
        let points = outline(&sphere(80.0, 120, 240), &Pose::from_translation(center));
        // A circumference of 2π · 65 px at 2 px.
        assert!((180..230).contains(&points.len()), "{}", points.len());
        let angle = (80.0 / center.length()).asin();
        let outside_px = |pixel: DVec2| {
            // One radian is a focal length, near enough for an error of a thousandth of it.
            (camera().unproject(pixel).angle_between(center) - angle) * 573.0
        };
        let (mean_px, largest_px) = bias(&points, outside_px);
        // The target of the solvers; facets of 8000 triangles stand off a sphere of 65 px by 0.02 px.
        assert!(mean_px.abs() < 0.03 && largest_px < 0.1, "{mean_px} {largest_px}");
        for point in &points {
            let radial = (point.pixel - camera().project(center).unwrap()).normalize();
            // A triangle of this mesh turns by some 3°.
            assert!(point.normal.dot(radial) > 0.995);
        }
    }

    #[test]
    fn of_ridges_side_by_side_the_outermost_is_the_outline() {
        // A corrugated tube, seen along its axis: ridges of 60 mm at 700, 710 … mm, which are 0.7 px apart in the photo.
        let (segments, rings) = (120_u32, 9_u32);
        let point = |ring: u32, k: u32| {
            let (sin, cos) = (std::f32::consts::TAU * k as f32 / segments as f32).sin_cos();
            let radius = if ring.is_multiple_of(2) { 60.0 } else { 59.0 };
            glam::Vec3::new(radius * cos, radius * sin, 5.0 * ring as f32)
        };
        let positions_mm = (0..rings).flat_map(|ring| (0..segments).map(move |k| point(ring, k))).collect();
        let quad = |ring: u32, k: u32| {
            let [a, b] = [ring * segments + k, ring * segments + (k + 1) % segments];
            [[a, b, b + segments], [a, b + segments, a + segments]]
        };
        let triangles =
            (0..rings - 1).flat_map(|ring| (0..segments).flat_map(move |k| quad(ring, k))).collect();
        let data = MeshData { positions_mm, triangles, ..MeshData::default() };
        let points = outline(&Mesh::new(data).unwrap(), &Pose::from_translation(DVec3::Z * 700.0));
        // A circumference of 2π · 49 px at 2 px.
        assert!((130..180).contains(&points.len()), "{}", points.len());
        let center = DVec2::new(camera().cx, camera().cy);
        for point in points {
            let inside_px = camera().fx * 60.0 / 700.0 - point.pixel.distance(center);
            // A chord of 3° is 0.02 px off its circle; the next ridge is 0.7 px farther in.
            assert!(inside_px.abs() < 0.3, "{inside_px}");
        }
    }

    #[test]
    fn a_cylinders_outline_is_where_its_tangent_planes_are() {
        let (radius, half) = (40.0_f32, 60.0_f32);
        let segments = 200_u32;
        let ring = |y: f32| {
            (0..segments).map(move |k| {
                let angle = std::f32::consts::TAU * k as f32 / segments as f32;
                glam::Vec3::new(radius * angle.cos(), y, radius * angle.sin())
            })
        };
        let positions_mm = ring(-half).chain(ring(half)).collect();
        let next = |k: u32| (k + 1) % segments;
        let triangles = (0..segments)
            .flat_map(|k| [[k, k + segments, next(k)], [next(k), k + segments, next(k) + segments]]);
        let data = MeshData { positions_mm, triangles: triangles.collect(), ..MeshData::default() };
        // Seen square to its axis, from a place on the optical axis: the outline's sides are two vertical lines.
        let pose = Pose::from_translation(DVec3::Z * 600.0);
        let points = outline(&Mesh::new(data).unwrap(), &pose);
        let sides: Vec<ContourPoint> =
            points.into_iter().filter(|point| point.normal.x.abs() > 0.99).collect();
        assert!(sides.len() > 50, "{}", sides.len());
        let half_width_px = camera().fx * 40.0 / f64::sqrt(600.0 * 600.0 - 40.0 * 40.0);
        let (mean_px, largest_px) = bias(&sides, |pixel| (pixel.x - camera().cx).abs() - half_width_px);
        // 200 facets stand off a circle of 38 px by 0.005 px.
        assert!(mean_px.abs() < 0.03 && largest_px < 0.05, "{mean_px} {largest_px}");
    }

    #[test]
    fn a_box_has_its_hull_as_outline_and_its_front_edges_as_creases() {
        let mesh = cube().transformed(&glam::DAffine3::from_scale(DVec3::splat(50.0))).unwrap();
        let rotation = DMat3::from_rotation_x(0.5) * DMat3::from_rotation_y(0.6);
        let pose = Pose { rotation, translation_mm: DVec3::new(20.0, 10.0, 700.0) };
        let model = ContourModel::new(&mesh).unwrap();
        let view = seen(&model, &pose, &[]);
        let points = model.points(&camera(), &pose, &view, 2.0);
        let corners: Vec<DVec2> = mesh
            .positions_mm()
            .iter()
            .map(|corner| camera().project(pose.transform_point(corner.as_dvec3())).unwrap())
            .collect();
        for point in points.iter().filter(|point| point.kind == EdgeKind::Outline) {
            // No corner is farther out along the normal than the edge itself: the outline is the hull, exactly.
            let farthest =
                corners.iter().map(|corner| (*corner - point.pixel).dot(point.normal)).fold(0.0, f64::max);
            assert!(farthest < 1e-6, "{farthest}");
        }
        let count = |kind| points.iter().filter(|point| point.kind == kind).count();
        // Three edges meet in the corner in front, six make the hull.
        assert!(
            count(EdgeKind::Crease) > 60 && count(EdgeKind::Outline) > 120 && count(EdgeKind::Inner) == 0
        );
    }

    #[test]
    fn what_is_behind_something_has_no_contour() {
        let ball = ContourModel::new(&sphere(40.0, 40, 80)).unwrap();
        let (far, near) =
            (Pose::from_translation(DVec3::Z * 700.0), Pose::from_translation(DVec3::new(40.0, 0.0, 500.0)));
        let alone = seen(&ball, &far, &[]);
        let behind = seen(&ball, &far, &[(&ball, near)]);
        let [all, some] = [alone, behind].map(|view| ball.points(&camera(), &far, &view, 1.0));
        assert!(some.len() < all.len() * 2 / 3 && some.len() > all.len() / 4, "{} {}", some.len(), all.len());
        // Circles of 33 and 46 px, 46 px apart, cross 14 px from the middle of the one behind.
        assert!(some.iter().all(|point| point.pixel.x < camera().cx + 16.0));
    }
}
