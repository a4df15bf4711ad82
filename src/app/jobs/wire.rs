//! Numbers and arrays as bytes, for the way to the worker and back. Both ends are the same build of the same program.

use bytemuck::Pod;

use crate::photo::{ExifFocal, ExifFocalSource};

#[derive(Debug, Default)]
pub struct Writer {
    bytes: Vec<u8>,
}

impl Writer {
    /// With room for so many bytes: growing moves what is there, and a mesh is tens of megabytes.
    pub fn for_bytes(count: usize) -> Self {
        Self { bytes: Vec::with_capacity(count) }
    }

    pub fn byte(&mut self, byte: u8) {
        self.bytes.push(byte);
    }

    pub fn number(&mut self, number: f64) {
        self.bytes.extend_from_slice(&number.to_le_bytes());
    }

    pub fn focal(&mut self, focal: Option<ExifFocal>) {
        self.number(focal.map_or(0.0, |focal| focal.focal_px));
        self.byte(focal.map_or(0, |focal| focal.source as u8));
    }

    /// With its length before it.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(&(bytes.len() as u64).to_le_bytes());
        self.bytes.extend_from_slice(bytes);
    }

    pub fn raw(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    pub fn items<T: Pod>(&mut self, items: &[T]) {
        self.bytes(bytemuck::cast_slice(items));
    }

    pub fn finish(self) -> Vec<u8> {
        self.bytes
    }
}

/// Reads what a [`Writer`] wrote; `None` where there is less.
#[derive(Debug)]
pub struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    pub fn byte(&mut self) -> Option<u8> {
        let (first, rest) = self.rest.split_first()?;
        self.rest = rest;
        Some(*first)
    }

    pub fn number(&mut self) -> Option<f64> {
        let (number, rest) = self.rest.split_first_chunk()?;
        self.rest = rest;
        Some(f64::from_le_bytes(*number))
    }

    /// `Some(None)` where there was none.
    #[allow(clippy::option_option, reason = "less than a whole number is another thing than no focal length")]
    pub fn focal(&mut self) -> Option<Option<ExifFocal>> {
        const SOURCES: [ExifFocalSource; 3] =
            [ExifFocalSource::Equivalent, ExifFocalSource::FocalPlane, ExifFocalSource::SensorTable];
        let focal_px = self.number()?;
        let source = *SOURCES.get(usize::from(self.byte()?))?;
        Some((focal_px > 0.0).then_some(ExifFocal { focal_px, source }))
    }

    pub fn bytes(&mut self) -> Option<&'a [u8]> {
        let (length, rest) = self.rest.split_first_chunk()?;
        let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
        let (bytes, rest) = rest.split_at_checked(length)?;
        self.rest = rest;
        Some(bytes)
    }

    pub fn items<T: Pod>(&mut self) -> Option<Vec<T>> {
        let bytes = self.bytes()?;
        (bytes.len() % size_of::<T>() == 0).then(|| bytemuck::allocation::pod_collect_to_vec(bytes))
    }
}
