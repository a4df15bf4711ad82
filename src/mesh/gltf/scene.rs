//! Walks a glTF's nodes and gathers their triangles, in millimetres.

use std::collections::BTreeMap;

use ::gltf::json;
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3, Vec2, Vec3};
use json::mesh::{Mode, Primitive, Semantic};
use json::validation::Checked;

use super::accessor::Array;
use super::materials::{Look, TextureMap};
use super::{Gltf, malformed};
use crate::mesh::load::Parsed;
use crate::mesh::paint::srgb_from_linear;
use crate::mesh::{FindCompanion, MAX_TRIANGLES, MAX_VERTICES, MeshData, MeshError};

const MM_PER_METRE: f64 = 1000.0;

/// Nodes may draw so many times the vertices that the file has room for, or so many in any case.
const MOST_COPIES: usize = 20;
const HARMLESS_VERTICES: usize = 2_000_000;
const BYTES_OF_A_POSITION: usize = 12;

pub(super) fn flatten(gltf: &Gltf<'_>, find: FindCompanion<'_>) -> Result<Parsed, MeshError> {
    let mut gathered = Gathered::new(Look::new(gltf, find));
    let mut has_skins = false;
    let mut is_visited = vec![false; gltf.root.nodes.len()];
    // A stack of nodes with the transform of their parent, so that a deep tree cannot overflow the machine's own.
    let mut pending: Vec<(usize, DAffine3)> =
        roots(&gltf.root).into_iter().rev().map(|node| (node, DAffine3::IDENTITY)).collect();
    while let Some((number, world_from_parent)) = pending.pop() {
        let part = || format!("node {number}");
        let node =
            gltf.root.nodes.get(number).ok_or_else(|| malformed(part(), "there is none of this number"))?;
        // The format asks for a tree. Without this a cycle would never end, and a diamond could double at each level.
        if std::mem::replace(&mut is_visited[number], true) {
            return Err(malformed(part(), "it is reached twice, expected a tree of nodes"));
        }
        let world_from_node = world_from_parent * local_transform(node);
        if let Some(mesh) = node.mesh {
            let mesh = gltf
                .root
                .meshes
                .get(mesh.value())
                .ok_or_else(|| malformed(part(), "its mesh does not exist"))?;
            gathered.add_mesh(gltf, mesh, &world_from_node)?;
        }
        has_skins |= node.skin.is_some();
        let children = node.children.iter().flatten().rev();
        pending.extend(children.map(|child| (child.value(), world_from_node)));
    }
    let mut warnings = vec![
        "glTF is in metres: made millimetres (× 1000). Its axes are kept as they are, with y up.".to_owned(),
    ];
    if has_skins {
        warnings.push("A skin is not applied: the mesh is in its rest shape.".to_owned());
    }
    let data = gathered.into_data(&mut warnings);
    Ok(Parsed { data, warnings })
}

/// The nodes of the default scene, or the first; in a file without scenes, those that are nobody's children.
fn roots(root: &json::Root) -> Vec<usize> {
    let scene = root.scenes.get(root.scene.map_or(0, |scene| scene.value()));
    if let Some(scene) = scene {
        return scene.nodes.iter().map(json::Index::value).collect();
    }
    let mut is_child = vec![false; root.nodes.len()];
    for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
        if let Some(is_child) = is_child.get_mut(child.value()) {
            *is_child = true;
        }
    }
    (0..root.nodes.len()).filter(|&node| !is_child[node]).collect()
}

fn local_transform(node: &json::Node) -> DAffine3 {
    if let Some(matrix) = node.matrix {
        return DAffine3::from_mat4(DMat4::from_cols_array(&matrix.map(f64::from)));
    }
    let vector =
        |value: Option<[f32; 3]>, default| value.map_or(default, |v| DVec3::from_array(v.map(f64::from)));
    let rotation = node.rotation.map_or([0.0, 0.0, 0.0, 1.0], |rotation| rotation.0);
    let rotation = DQuat::from_array(rotation.map(f64::from));
    let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
    let scale = vector(node.scale, DVec3::ONE);
    let linear = DMat3::from_quat(rotation) * DMat3::from_diagonal(scale);
    DAffine3 { matrix3: linear, translation: vector(node.translation, DVec3::ZERO) }
}

/// The accessors that a primitive's vertices come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct VertexSource {
    positions: usize,
    normals: Option<usize>,
    colors: Option<usize>,
}

struct Gathered<'a> {
    look: Look<'a>,
    data: MeshData,
    normals: Vec<Vec3>,
    colors: Vec<[u8; 4]>,
    lacks_normals: bool,
    has_colors: bool,
}

impl<'a> Gathered<'a> {
    fn new(look: Look<'a>) -> Self {
        Self {
            look,
            data: MeshData::default(),
            normals: Vec::new(),
            colors: Vec::new(),
            lacks_normals: false,
            has_colors: false,
        }
    }

    fn add_mesh(
        &mut self,
        gltf: &Gltf<'_>,
        mesh: &json::Mesh,
        world_from_mesh: &DAffine3,
    ) -> Result<(), MeshError> {
        // Primitives of one mesh often share their vertices and differ in material only: those are taken once.
        let mut first_vertex_of: BTreeMap<VertexSource, usize> = BTreeMap::new();
        for primitive in &mesh.primitives {
            let Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) =
                primitive.mode
            else {
                continue;
            };
            let Some(source) = vertex_source(primitive) else {
                return Err(malformed("a primitive", "it has no POSITION"));
            };
            let first_vertex = if let Some(&known) = first_vertex_of.get(&source) {
                known
            } else {
                let first_vertex = self.data.positions_mm.len();
                self.add_vertices(gltf, source, world_from_mesh)?;
                first_vertex_of.insert(source, first_vertex);
                first_vertex
            };
            let is_mirrored = world_from_mesh.matrix3.determinant() < 0.0;
            self.add_triangles(gltf, primitive, mode, source, first_vertex, is_mirrored)?;
        }
        Ok(())
    }

    fn add_vertices(
        &mut self,
        gltf: &Gltf<'_>,
        source: VertexSource,
        world_from_mesh: &DAffine3,
    ) -> Result<(), MeshError> {
        let positions = Array::open(gltf, source.positions)?.floats::<3>("positions")?;
        let first_vertex = self.data.positions_mm.len();
        let vertex_count = first_vertex + positions.len();
        // A node costs a few bytes of the file, and each draws a whole mesh.
        let file_bytes: usize = gltf.buffers.iter().map(|buffer| buffer.bytes().len()).sum();
        if vertex_count > HARMLESS_VERTICES.max(file_bytes / BYTES_OF_A_POSITION * MOST_COPIES) {
            let problem = format!("its nodes draw more than {MOST_COPIES} copies of the file's vertices");
            return Err(malformed("the scene", problem));
        }
        if vertex_count > MAX_VERTICES {
            return Err(MeshError::TooLarge { what: "vertices", limit: MAX_VERTICES });
        }
        let to_mm = |position: Vec3| world_from_mesh.transform_point3(position.as_dvec3()) * MM_PER_METRE;
        let positions_mm = positions.iter().map(|&position| to_mm(Vec3::from_array(position)).as_vec3());
        self.data.positions_mm.extend(positions_mm);

        if let Some(normals) = source.normals {
            let normal_matrix = world_from_mesh.matrix3.inverse().transpose();
            let normals = Array::open(gltf, normals)?.floats::<3>("normals")?;
            let turned =
                normals.iter().map(|&normal| (normal_matrix * Vec3::from_array(normal).as_dvec3()).as_vec3());
            self.normals.extend(turned);
        }
        self.lacks_normals |= self.normals.len() != vertex_count;
        self.normals.resize(vertex_count, Vec3::ZERO);

        if let Some(colors) = source.colors {
            self.colors.extend(srgb_colors(&Array::open(gltf, colors)?)?);
            self.has_colors = true;
        }
        self.colors.resize(vertex_count, [255; 4]);
        Ok(())
    }

    fn add_triangles(
        &mut self,
        gltf: &Gltf<'_>,
        primitive: &Primitive,
        mode: Mode,
        source: VertexSource,
        first_vertex: usize,
        is_mirrored: bool,
    ) -> Result<(), MeshError> {
        let vertex_count = Array::open(gltf, source.positions)?.len();
        let corners = match primitive.indices {
            Some(indices) => Array::open(gltf, indices.value())?.indices()?,
            None => (0..vertex_count as u32).collect(),
        };
        if let Some(index) = corners.iter().find(|&&index| index as usize >= vertex_count) {
            let problem = format!("an index is {index}, but the primitive has {vertex_count} vertices");
            return Err(malformed("a primitive", problem));
        }
        // Counted before they are made: many nodes may repeat one mesh.
        if self.data.triangles.len() + corners.len() > MAX_TRIANGLES + 2 {
            return Err(MeshError::TooLarge { what: "triangles", limit: MAX_TRIANGLES });
        }
        let first_vertex = first_vertex as u32;
        let front_outside = |[a, b, c]: [u32; 3]| if is_mirrored { [a, c, b] } else { [a, b, c] };
        let triangles = || triangles_of(mode, &corners).map(front_outside);
        let map = self.look.begin_primitive(gltf, primitive.material.map(|material| material.value()));
        if let Some(map) = map {
            let uv = uv_lookup(gltf, primitive, &map)?;
            self.look.add_uvs(triangles().map(|corners| corners.map(&uv)));
        }
        self.data.triangles.extend(triangles().map(|corners| corners.map(|index| index + first_vertex)));
        self.look.end_primitive(self.data.triangles.len());
        Ok(())
    }

    fn into_data(self, warnings: &mut Vec<String>) -> MeshData {
        MeshData {
            paint: self.look.into_paint(warnings),
            normals: (!self.lacks_normals).then_some(self.normals),
            colors: self.has_colors.then_some(self.colors),
            ..self.data
        }
    }
}

fn vertex_source(primitive: &Primitive) -> Option<VertexSource> {
    let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).map(json::Index::value);
    Some(VertexSource {
        positions: attribute(Semantic::Positions)?,
        normals: attribute(Semantic::Normals),
        colors: attribute(Semantic::Colors(0)),
    })
}

/// Where the vertices of a primitive lie on its texture; at its corner, where the file does not say.
fn uv_lookup<'a>(
    gltf: &'a Gltf<'_>,
    primitive: &Primitive,
    map: &'a TextureMap,
) -> Result<Box<dyn Fn(u32) -> Vec2 + 'a>, MeshError> {
    let semantic = Checked::Valid(Semantic::TexCoords(map.set));
    let Some(accessor) = primitive.attributes.get(&semantic) else {
        return Ok(Box::new(|_| Vec2::ZERO));
    };
    let lookup = Array::open(gltf, accessor.value())?.into_lookup::<2>("texture coordinates")?;
    Ok(Box::new(move |vertex| lookup(vertex).map_or(Vec2::ZERO, |uv| map.apply(Vec2::from_array(uv)))))
}

/// Strips and fans as single triangles, all with the front on the same side.
fn triangles_of(mode: Mode, corners: &[u32]) -> Box<dyn Iterator<Item = [u32; 3]> + '_> {
    match mode {
        Mode::TriangleStrip => Box::new(corners.windows(3).enumerate().map(|(number, corner)| {
            let swap = number % 2;
            [corner[0], corner[1 + swap], corner[2 - swap]]
        })),
        Mode::TriangleFan => Box::new(corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]])),
        _ => Box::new(corners.chunks_exact(3).map(|corner| [corner[0], corner[1], corner[2]])),
    }
}

/// glTF's vertex colours are linear, with or without alpha.
fn srgb_colors(array: &Array<'_>) -> Result<Vec<[u8; 4]>, MeshError> {
    let linear = if array.components >= 4 {
        array.scaled_floats::<4>("colours")?
    } else {
        array.scaled_floats::<3>("colours")?.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect()
    };
    let byte = |value: f32| (value * 255.0).round() as u8;
    Ok(linear
        .into_iter()
        .map(|[r, g, b, alpha]| {
            [byte(srgb_from_linear(r)), byte(srgb_from_linear(g)), byte(srgb_from_linear(b)), byte(alpha)]
        })
        .collect())
}
