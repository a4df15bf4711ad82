//! The data of a PLY file, element by element.

use glam::{Vec2, Vec3};

use super::header::{Element, Encoding, Header, Kind, Scalar};
use super::look::{FaceColors, Look};
use super::malformed;
use super::values::{Ascii, Binary, Values};
use crate::mesh::load::Parsed;
use crate::mesh::{Format, MAX_TRIANGLES, MAX_VERTICES, MeshError};

/// The mesh without its paint, and what the paint is made of.
pub(super) fn read(header: &Header, bytes: &[u8]) -> Result<(Parsed, Look), MeshError> {
    match header.encoding {
        Encoding::Ascii => read_elements(header, Ascii::new(bytes, header.body_byte, header.body_line)),
        Encoding::LittleEndian => read_elements(header, Binary::<false>::new(bytes, header.body_byte)),
        Encoding::BigEndian => read_elements(header, Binary::<true>::new(bytes, header.body_byte)),
    }
}

fn read_elements(header: &Header, mut values: impl Values) -> Result<(Parsed, Look), MeshError> {
    let (mut parsed, mut look) = (Parsed::default(), Look::default());
    let vertex_count = header.element("vertex").map_or(0, |vertex| vertex.count);
    if header.element("tristrips").is_some() {
        let feature = "element “tristrips”".to_owned();
        let advice = "export the mesh again with single faces";
        return Err(MeshError::Unsupported { format: Format::Ply, feature, advice });
    }
    // Who has no faces need not be read to the end; a point cloud is told so even if it is cut off.
    if header.element("face").is_none_or(|face| face.count == 0) {
        return Err(MeshError::NoFaces { vertices: vertex_count });
    }
    for element in &header.elements {
        check_size(element, &values)?;
        match element.name.as_str() {
            "vertex" => read_vertices(element, &mut values, &mut parsed, &mut look)?,
            "face" => read_faces(element, &mut values, vertex_count, &mut parsed, &mut look)?,
            _ => skip_element(element, &mut values)?,
        }
    }
    Ok((parsed, look))
}

/// Refuses an element that the rest of the file cannot hold, before anything is allocated for it.
fn check_size(element: &Element, values: &impl Values) -> Result<(), MeshError> {
    let smallest_row: usize = element
        .properties
        .iter()
        .map(|property| match property.kind {
            Kind::Scalar(scalar) | Kind::List { count: scalar, .. } => values.smallest_size(scalar),
        })
        .sum();
    let (count, remaining) = (element.count, values.remaining_bytes());
    // The last value of an ASCII file need not have anything behind it, hence the one.
    if count.checked_mul(smallest_row).is_none_or(|size| size > remaining.saturating_add(1)) {
        let name = &element.name;
        let problem =
            format!("{count} rows of element “{name}” are announced, but only {remaining} bytes follow");
        return Err(malformed(values.place(), problem));
    }
    Ok(())
}

/// What a row of the vertex element is sorted into: position, normal, colour, texture coordinate, and the rest.
const SLOT_NAMES: [&[&str]; 12] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx", "normal_x"],
    &["ny", "normal_y"],
    &["nz", "normal_z"],
    &["red", "diffuse_red", "r"],
    &["green", "diffuse_green", "g"],
    &["blue", "diffuse_blue", "b"],
    &["alpha", "diffuse_alpha", "a"],
    &["texture_u", "s", "u"],
    &["texture_v", "t", "v"],
];
const UNUSED_SLOT: usize = SLOT_NAMES.len();

fn read_vertices(
    element: &Element,
    values: &mut impl Values,
    parsed: &mut Parsed,
    look: &mut Look,
) -> Result<(), MeshError> {
    let found = SLOT_NAMES.map(|names| scalar_property(element, names));
    if found[..3].contains(&None) {
        return Err(malformed(values.place(), "element “vertex” lacks one of the properties x, y, z"));
    }
    if element.count > MAX_VERTICES {
        return Err(MeshError::TooLarge { what: "vertices", limit: MAX_VERTICES });
    }
    let mut slot_of_property = vec![UNUSED_SLOT; element.properties.len()];
    for (slot, property) in found.iter().enumerate() {
        if let Some((property, _)) = property {
            slot_of_property[*property] = slot;
        }
    }
    let has_normals = !found[3..6].contains(&None);
    let has_colors = !found[6..9].contains(&None);
    let has_uvs = !found[10..12].contains(&None);
    let color_scale = found.map(|property| property.map_or(1.0, |(_, scalar)| byte_scale(scalar)));

    let mut positions_mm = Vec::with_capacity(element.count);
    let mut normals = Vec::with_capacity(if has_normals { element.count } else { 0 });
    let mut colors = Vec::with_capacity(if has_colors { element.count } else { 0 });
    let mut uvs = Vec::with_capacity(if has_uvs { element.count } else { 0 });
    let mut row = [0.0; SLOT_NAMES.len() + 1];
    row[9] = 255.0 / color_scale[9];
    let mut longer_rows = 0_usize;
    for _ in 0..element.count {
        for (property, &slot) in element.properties.iter().zip(&slot_of_property) {
            match property.kind {
                Kind::Scalar(scalar) => row[slot] = number(values, scalar)?,
                Kind::List { count, item } => skip_list(values, count, item)?,
            }
        }
        longer_rows += usize::from(values.end_row());
        positions_mm.push(Vec3::new(row[0] as f32, row[1] as f32, row[2] as f32));
        if has_normals {
            normals.push(Vec3::new(row[3] as f32, row[4] as f32, row[5] as f32));
        }
        if has_colors {
            colors.push([6, 7, 8, 9].map(|slot: usize| (row[slot] * color_scale[slot]).round() as u8));
        }
        if has_uvs {
            uvs.push(Vec2::new(row[10] as f32, row[11] as f32));
        }
    }
    parsed.warnings.extend(warn_of_longer_rows(element, longer_rows));
    let data = &mut parsed.data;
    data.positions_mm = positions_mm;
    data.normals = has_normals.then_some(normals);
    data.colors = has_colors.then_some(colors);
    look.vertex_uvs = uvs;
    Ok(())
}

/// The number and type of the first property that bears one of these names and is no list.
pub(super) fn scalar_property(element: &Element, names: &[&str]) -> Option<(usize, Scalar)> {
    let number = element.property(names)?;
    match element.properties[number].kind {
        Kind::Scalar(scalar) => Some((number, scalar)),
        Kind::List { .. } => None,
    }
}

/// What takes a colour of this type to 0..=255: floats run from 0 to 1, integers over their range.
pub(super) fn byte_scale(scalar: Scalar) -> f64 {
    match scalar {
        Scalar::F32 | Scalar::F64 => 255.0,
        Scalar::I16 | Scalar::U16 => 1.0 / 257.0,
        _ => 1.0,
    }
}

fn read_faces(
    element: &Element,
    values: &mut impl Values,
    vertex_count: usize,
    parsed: &mut Parsed,
    look: &mut Look,
) -> Result<(), MeshError> {
    let indices = element
        .property(&["vertex_indices", "vertex_index"])
        .filter(|&number| matches!(element.properties[number].kind, Kind::List { .. }))
        .ok_or_else(|| malformed(values.place(), "element “face” lacks a list “vertex_indices”"))?;
    let triangles = &mut parsed.data.triangles;
    triangles.reserve(element.count.min(MAX_TRIANGLES));
    let texture_coordinates = element.property(&["texcoord", "texture_coordinates"]);
    let mut face_colors = FaceColors::new(element);
    let (mut small_faces, mut longer_rows) = (0_usize, 0_usize);
    for _ in 0..element.count {
        let triangles_before = triangles.len();
        look.begin_face();
        for (property_number, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::Scalar(scalar) => face_colors.take(property_number, number(values, scalar)?),
                Kind::List { count, item } if Some(property_number) == texture_coordinates => {
                    for _ in 0..values.list_length(count, item)? {
                        look.face_values.push(number(values, item)? as f32);
                    }
                }
                Kind::List { count, item } if property_number == indices => {
                    let corners = values.list_length(count, item)?;
                    small_faces += usize::from(corners < 3);
                    read_polygon(values, corners, item, vertex_count, triangles)?;
                }
                Kind::List { count, item } => skip_list(values, count, item)?,
            }
        }
        longer_rows += usize::from(values.end_row());
        look.end_face(triangles_before, triangles.len());
        face_colors.end_face(triangles.len() - triangles_before);
    }
    look.set_face_colors(face_colors);
    parsed.warnings.extend(warn_of_longer_rows(element, longer_rows));
    if small_faces > 0 {
        parsed.warnings.push(format!("{small_faces} faces have fewer than three corners and are left out."));
    }
    Ok(())
}

/// A polygon of any number of corners, as a fan about its first.
fn read_polygon(
    values: &mut impl Values,
    corners: usize,
    item: Scalar,
    vertex_count: usize,
    triangles: &mut Vec<[u32; 3]>,
) -> Result<(), MeshError> {
    let (mut first, mut previous) = (0, 0);
    for corner in 0..corners {
        let named = number(values, item)?;
        let index = named as u32;
        if f64::from(index) != named || index as usize >= vertex_count {
            let problem =
                format!("a face names vertex {named}, expected a whole number below {vertex_count}");
            return Err(malformed(values.place(), problem));
        }
        match corner {
            0 => first = index,
            1 => {}
            _ => triangles.push([first, previous, index]),
        }
        previous = index;
    }
    if triangles.len() > MAX_TRIANGLES {
        return Err(MeshError::TooLarge { what: "triangles", limit: MAX_TRIANGLES });
    }
    Ok(())
}

fn warn_of_longer_rows(element: &Element, longer_rows: usize) -> Option<String> {
    let name = &element.name;
    (longer_rows > 0).then(|| {
        format!(
            "{longer_rows} rows of “{name}” hold more numbers than the header announces; those are left out."
        )
    })
}

fn skip_element(element: &Element, values: &mut impl Values) -> Result<(), MeshError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            match property.kind {
                Kind::Scalar(scalar) => drop(number(values, scalar)?),
                Kind::List { count, item } => skip_list(values, count, item)?,
            }
        }
        values.end_row();
    }
    Ok(())
}

fn skip_list(values: &mut impl Values, count: Scalar, item: Scalar) -> Result<(), MeshError> {
    for _ in 0..values.list_length(count, item)? {
        number(values, item)?;
    }
    Ok(())
}

#[inline(always)]
fn number(values: &mut impl Values, scalar: Scalar) -> Result<f64, MeshError> {
    match values.number(scalar) {
        Some(number) => Ok(number),
        None => Err(values.problem()),
    }
}
