//! What a surface looks like between its vertices: normals and colours.

use glam::{DVec3, Vec3};

use crate::mesh::{Mesh, shading_vertices};

/// Per corner of each triangle.
#[derive(Debug, Clone)]
pub struct Shading {
    normals: Vec<[Vec3; 3]>,
    /// In sRGB, 0 to 1.
    colors: Option<Vec<[Vec3; 3]>>,
}

impl Shading {
    pub fn of(mesh: &Mesh) -> Self {
        let drawn = shading_vertices(mesh);
        let corners = |values: &dyn Fn(u32) -> Vec3| {
            drawn.indices.as_chunks::<3>().0.iter().map(|face| face.map(values)).collect::<Vec<_>>()
        };
        let normals = corners(&|vertex| Vec3::from_array(drawn.vertices[vertex as usize].normal));
        let colors = mesh.colors().map(|colors| {
            let color = |vertex: u32| {
                let [red, green, blue, _] = colors[vertex as usize];
                Vec3::new(f32::from(red), f32::from(green), f32::from(blue)) / 255.0
            };
            mesh.triangles().iter().map(|face| face.map(color)).collect()
        });
        Self { normals, colors }
    }

    /// The unit normal in the `object` frame and the colour at these barycentric weights; white where there are no colours.
    pub fn at(&self, face: usize, weights: Vec3) -> Option<(DVec3, Vec3)> {
        let mix = |[a, b, c]: [Vec3; 3]| a * weights.x + b * weights.y + c * weights.z;
        let normal = mix(*self.normals.get(face)?).as_dvec3().normalize_or_zero();
        let color = match &self.colors {
            Some(colors) => mix(*colors.get(face)?),
            None => Vec3::ONE,
        };
        Some((normal, color))
    }
}

/// The weights of a triangle's corners at the point of it that is nearest to this one; `None` for one without area.
pub fn barycentric([a, b, c]: [DVec3; 3], point_mm: DVec3) -> Option<Vec3> {
    let (ab, ac, ap) = (b - a, c - a, point_mm - a);
    let (bb, bc, cc, pb, pc) = (ab.dot(ab), ab.dot(ac), ac.dot(ac), ap.dot(ab), ap.dot(ac));
    let determinant = bb * cc - bc * bc;
    if determinant <= 0.0 {
        return None;
    }
    // A little outside is rounding of the depth map.
    let to_b = ((cc * pb - bc * pc) / determinant).clamp(0.0, 1.0);
    let to_c = ((bb * pc - bc * pb) / determinant).clamp(0.0, 1.0 - to_b);
    Some(Vec3::new((1.0 - to_b - to_c) as f32, to_b as f32, to_c as f32))
}
