//! Arrays in a glTF's buffers: types, counts and bounds are checked before a byte is read.

use ::gltf::json;
use json::accessor::ComponentType;
use json::validation::Checked;

use super::{Gltf, malformed, unsupported, unsupported_extension};
use crate::mesh::MeshError;

/// An accessor whose bytes are known to be there.
pub(super) struct Array<'a> {
    number: usize,
    bytes: &'a [u8],
    count: usize,
    stride: usize,
    pub components: usize,
    component: ComponentType,
    is_normalized: bool,
}

impl<'a> Array<'a> {
    pub fn open(gltf: &'a Gltf<'_>, number: usize) -> Result<Self, MeshError> {
        let part = || format!("accessor {number}");
        let accessor = gltf
            .root
            .accessors
            .get(number)
            .ok_or_else(|| malformed(part(), "there is none of this number"))?;
        let (Checked::Valid(component), Checked::Valid(shape)) = (&accessor.component_type, &accessor.type_)
        else {
            return Err(malformed(part(), "its type is none of the format's"));
        };
        if accessor.sparse.is_some() {
            return Err(unsupported(format!("the sparse {}", part()), "export the mesh again without it"));
        }
        let view = accessor.buffer_view.ok_or_else(|| missing_view(&gltf.root, number))?;
        let (view_bytes, view_stride) = view_bytes(gltf, view.value()).ok_or_else(|| {
            malformed(part(), format!("its buffer view {} reaches beyond its buffer", view.value()))
        })?;

        let component = component.0;
        let item_size = component.size() * shape.multiplicity();
        let stride = view_stride.filter(|&stride| stride > 0).unwrap_or(item_size);
        let offset = accessor.byte_offset.unwrap_or_default().0;
        let bytes = usize::try_from(offset).ok().and_then(|offset| view_bytes.get(offset..));
        let count = usize::try_from(accessor.count.0).ok();
        let (Some(bytes), Some(count)) = (bytes, count.filter(|_| stride >= item_size)) else {
            return Err(malformed(part(), "its offset or stride does not fit its buffer view"));
        };
        let needed =
            count.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(item_size));
        if needed.is_none_or(|needed| needed > bytes.len()) {
            let problem = format!(
                "{count} items of {stride} bytes are announced, but only {} bytes follow",
                bytes.len()
            );
            return Err(malformed(part(), problem));
        }
        let is_normalized = accessor.normalized;
        Ok(Self { number, bytes, count, stride, components: shape.multiplicity(), component, is_normalized })
    }

    pub fn len(&self) -> usize {
        self.count
    }

    /// Items of `N` floats, for an array that has to be one of them.
    pub fn floats<const N: usize>(&self, what: &str) -> Result<Vec<[f32; N]>, MeshError> {
        if self.component != ComponentType::F32 {
            return Err(unsupported(format!("{what} of integers"), "export the mesh again with floats"));
        }
        self.scaled_floats(what)
    }

    /// Items of at least `N` numbers, integers made 0..=1 where the file says so.
    pub fn scaled_floats<const N: usize>(&self, what: &str) -> Result<Vec<[f32; N]>, MeshError> {
        let item = self.item_reader(what)?;
        // The last item may be shorter than the stride: `open` saw that it is whole.
        Ok(self.bytes.chunks(self.stride).take(self.count).map(item).collect())
    }

    /// Single items, as [`Self::scaled_floats`] would give them: many primitives may share one large array.
    pub fn into_lookup<const N: usize>(
        self,
        what: &str,
    ) -> Result<impl Fn(u32) -> Option<[f32; N]> + use<'a, N>, MeshError> {
        let read = self.item_reader(what)?;
        Ok(move |number| {
            let number = usize::try_from(number).ok().filter(|&number| number < self.count)?;
            self.bytes.get(number * self.stride..).map(&read)
        })
    }

    fn item_reader<const N: usize>(
        &self,
        what: &str,
    ) -> Result<impl Fn(&[u8]) -> [f32; N] + use<N>, MeshError> {
        if self.components < N {
            return Err(self.wrong(what, &format!("{N} numbers each")));
        }
        let size = self.component.size();
        let scale = match (self.is_normalized, self.component) {
            (true, ComponentType::U8) => 1.0 / 255.0,
            (true, ComponentType::U16) => 1.0 / 65535.0,
            (false, ComponentType::F32) => 1.0,
            _ => return Err(self.wrong(what, "floats or normalised unsigned integers")),
        };
        Ok(move |item: &[u8]| -> [f32; N] {
            std::array::from_fn(|i| match item.get(i * size..(i + 1) * size) {
                Some(&[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
                Some(&[a, b]) => f32::from(u16::from_le_bytes([a, b])) * scale,
                Some(&[a]) => f32::from(a) * scale,
                _ => 0.0,
            })
        })
    }

    /// Vertex numbers.
    pub fn indices(&self) -> Result<Vec<u32>, MeshError> {
        if self.components != 1 {
            return Err(self.wrong("indices", "one number each"));
        }
        let items = self.bytes.chunks(self.stride).take(self.count);
        let number: fn(&[u8]) -> u32 = match self.component {
            ComponentType::U8 => |item| item.first().map_or(0, |&byte| u32::from(byte)),
            ComponentType::U16 => {
                |item| item.first_chunk().map_or(0, |chunk| u32::from(u16::from_le_bytes(*chunk)))
            }
            ComponentType::U32 => |item| item.first_chunk().map_or(0, |chunk| u32::from_le_bytes(*chunk)),
            _ => return Err(self.wrong("indices", "unsigned integers")),
        };
        Ok(items.map(number).collect())
    }

    fn wrong(&self, what: &str, expected: &str) -> MeshError {
        malformed(format!("accessor {}", self.number), format!("it holds {what}, expected {expected}"))
    }
}

/// Only compressed data may do without a buffer view.
fn missing_view(root: &json::Root, number: usize) -> MeshError {
    match root.extensions_used.iter().find(|name| name.contains("compression")) {
        Some(name) => unsupported_extension(name),
        None => malformed(format!("accessor {number}"), "it has no data"),
    }
}

/// The bytes of a buffer view and its stride.
pub(super) fn view_bytes<'a>(gltf: &'a Gltf<'_>, number: usize) -> Option<(&'a [u8], Option<usize>)> {
    let view = gltf.root.buffer_views.get(number)?;
    let buffer = gltf.buffers.get(view.buffer.value())?.bytes();
    let offset = usize::try_from(view.byte_offset.unwrap_or_default().0).ok()?;
    let length = usize::try_from(view.byte_length.0).ok()?;
    let bytes = buffer.get(offset..)?.get(..length)?;
    Some((bytes, view.byte_stride.map(|stride| stride.0)))
}
