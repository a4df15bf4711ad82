//! A mesh as a file, for taking one along whose unit, axes or spacing were changed here.

use glam::Vec3;

use super::Mesh;

/// Binary little-endian PLY in millimetres: positions, normals and vertex colours where the mesh has them, and triangles.
/// Vertices keep their order. Materials and textures are not written.
pub fn write_ply(mesh: &Mesh) -> Vec<u8> {
    let vertices = mesh.positions_mm().len();
    let mut bytes = header(mesh).into_bytes();
    bytes.reserve(vertices * 28 + mesh.triangles().len() * 13);
    for vertex in 0..vertices {
        put_floats(&mut bytes, mesh.positions_mm().get(vertex).map(Vec3::to_array));
        put_floats(&mut bytes, mesh.normals().and_then(|normals| normals.get(vertex)).map(Vec3::to_array));
        bytes.extend(mesh.colors().and_then(|colors| colors.get(vertex)).into_iter().flatten());
    }
    for triangle in mesh.triangles() {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|index| index.to_le_bytes()));
    }
    bytes
}

fn header(mesh: &Mesh) -> String {
    let (vertices, triangles) = (mesh.positions_mm().len(), mesh.triangles().len());
    let properties = |kind: &str, names: &[&str]| -> String {
        names.iter().map(|name| format!("property {kind} {name}\n")).collect()
    };
    let position = properties("float", &["x", "y", "z"]);
    let normal = mesh.normals().map_or_else(String::new, |_| properties("float", &["nx", "ny", "nz"]));
    let color =
        mesh.colors().map_or_else(String::new, |_| properties("uchar", &["red", "green", "blue", "alpha"]));
    format!(
        "ply\nformat binary_little_endian 1.0\ncomment written by PinPose\ncomment unit mm\n\
         element vertex {vertices}\n{position}{normal}{color}\
         element face {triangles}\nproperty list uchar uint vertex_indices\nend_header\n"
    )
}

fn put_floats(bytes: &mut Vec<u8>, values: Option<[f32; 3]>) {
    bytes.extend(values.into_iter().flatten().flat_map(f32::to_le_bytes));
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DMat3, DVec3};

    use super::*;
    use crate::mesh::test_shapes::cube;
    use crate::mesh::{MeshData, load, no_companions};

    #[test]
    fn what_is_written_reads_back_the_same() {
        let plain = cube();
        let colors = (0..8).map(|i| [i, 10 * i, 255 - i, 200]).collect();
        let normals = plain.positions_mm().iter().map(|position| position.normalize()).collect();
        let data = MeshData { colors: Some(colors), normals: Some(normals), ..plain.data().clone() };
        let rich = Mesh::new(data).unwrap();
        let mirror = DAffine3::from_mat3(DMat3::from_diagonal(DVec3::new(-25.4, 25.4, 12.7)));
        for mesh in [plain.clone(), rich.clone(), rich.transformed(&mirror).unwrap()] {
            let read = load("a.ply", &write_ply(&mesh), &no_companions).unwrap();
            assert_eq!(read.warnings, Vec::<String>::new());
            assert_eq!(read.mesh.data().positions_mm, mesh.data().positions_mm);
            assert_eq!((read.mesh.triangles(), read.mesh.colors()), (mesh.triangles(), mesh.colors()));
            assert_eq!(read.mesh.normals().is_some(), mesh.normals().is_some());
            for (read, written) in
                read.mesh.normals().into_iter().flatten().zip(mesh.normals().into_iter().flatten())
            {
                // Made unit length once more when read: a rounding of an f32.
                assert!(Vec3::abs_diff_eq(*read, *written, 1e-6));
            }
        }
    }
}
