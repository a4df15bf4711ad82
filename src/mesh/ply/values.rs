//! The numbers of a PLY body one after the other, from text or from bytes.

use super::header::Scalar;
use super::malformed;
use crate::mesh::text::{parse_number, shown};
use crate::mesh::{MeshError, Place};

/// A stream of numbers. Every type of the format fits an `f64` exactly.
pub(super) trait Values {
    /// `None` where there is none; [`Self::problem`] says why. The reason is not part of the answer, for millions of answers
    /// that fit in registers are read several times as fast.
    fn number(&mut self, scalar: Scalar) -> Option<f64>;

    /// Why the last call of [`Self::number`] had none.
    fn problem(&self) -> MeshError;

    /// Leaves what a row holds beyond what the header announces; whether that was anything. Only text shows it.
    fn end_row(&mut self) -> bool {
        false
    }

    /// How many bytes a value of this type takes at least.
    fn smallest_size(&self, scalar: Scalar) -> usize;

    fn remaining_bytes(&self) -> usize;

    /// Where the last value was read.
    fn place(&self) -> Place;

    /// How many items follow: a whole number, and no more than the rest of the file can hold.
    #[inline(always)]
    fn list_length(&mut self, count: Scalar, item: Scalar) -> Result<usize, MeshError> {
        let Some(number) = self.number(count) else { return Err(self.problem()) };
        let length = number as usize;
        let most = self.remaining_bytes().saturating_add(1) / self.smallest_size(item);
        if length as f64 != number || length > most {
            return Err(bad_length(self.place(), number, most));
        }
        Ok(length)
    }
}

#[cold]
fn bad_length(place: Place, number: f64, most: usize) -> MeshError {
    let problem =
        format!("a list of {number} items, expected a whole number up to the {most} that can follow");
    malformed(place, problem)
}

/// Words between white space. A row may go on over several lines, for some programs wrap long ones, but the next row begins
/// on a new line: MeshLab writes colours of corners that its header does not announce.
pub(super) struct Ascii<'a> {
    bytes: &'a [u8],
    position: usize,
    line: usize,
    /// The last word, if it was no number.
    bad_word: Option<&'a [u8]>,
}

impl<'a> Ascii<'a> {
    pub fn new(bytes: &'a [u8], position: usize, line: usize) -> Self {
        Self { bytes, position, line, bad_word: None }
    }

    fn next_word(&mut self) -> Option<&'a [u8]> {
        let rest = self.bytes.get(self.position..)?;
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        self.line += rest[..start].iter().filter(|&&byte| byte == b'\n').count();
        let rest = &rest[start..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.position += start + length;
        Some(&rest[..length])
    }
}

impl Values for Ascii<'_> {
    fn number(&mut self, _: Scalar) -> Option<f64> {
        let word = self.next_word()?;
        let number = small_integer(word).or_else(|| parse_number(word));
        self.bad_word = number.is_none().then_some(word);
        number
    }

    fn problem(&self) -> MeshError {
        match self.bad_word {
            Some(word) => malformed(self.place(), format!("expected a number, found {}", shown(word))),
            None => malformed(self.place(), "the file ends here, expected more numbers"),
        }
    }

    fn end_row(&mut self) -> bool {
        let rest = self.bytes.get(self.position..).unwrap_or_default();
        let length = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(rest.len());
        self.position += length;
        !rest[..length].trim_ascii().is_empty()
    }

    fn smallest_size(&self, _: Scalar) -> usize {
        // A digit and the space behind it.
        2
    }

    fn remaining_bytes(&self) -> usize {
        self.bytes.len().saturating_sub(self.position)
    }

    fn place(&self) -> Place {
        Place::Line(self.line)
    }
}

/// Half of an ASCII mesh is vertex numbers; this reads them much faster than the parser of floats.
fn small_integer(word: &[u8]) -> Option<f64> {
    if word.len() > 9 {
        return None;
    }
    let mut value = 0_u32;
    for byte in word {
        if !byte.is_ascii_digit() {
            return None;
        }
        value = value * 10 + u32::from(byte - b'0');
    }
    Some(f64::from(value))
}

/// Packed numbers of either byte order.
pub(super) struct Binary<'a, const BIG_ENDIAN: bool> {
    bytes: &'a [u8],
    position: usize,
}

impl<'a, const BIG_ENDIAN: bool> Binary<'a, BIG_ENDIAN> {
    pub fn new(bytes: &'a [u8], position: usize) -> Self {
        Self { bytes, position }
    }

    #[inline(always)]
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let mut chunk = *self.bytes.get(self.position..)?.first_chunk::<N>()?;
        self.position += N;
        if BIG_ENDIAN {
            chunk.reverse();
        }
        Some(chunk)
    }
}

impl<const BIG_ENDIAN: bool> Values for Binary<'_, BIG_ENDIAN> {
    #[inline(always)]
    fn number(&mut self, scalar: Scalar) -> Option<f64> {
        Some(match scalar {
            Scalar::I8 => f64::from(i8::from_le_bytes(self.take()?)),
            Scalar::U8 => f64::from(u8::from_le_bytes(self.take()?)),
            Scalar::I16 => f64::from(i16::from_le_bytes(self.take()?)),
            Scalar::U16 => f64::from(u16::from_le_bytes(self.take()?)),
            Scalar::I32 => f64::from(i32::from_le_bytes(self.take()?)),
            Scalar::U32 => f64::from(u32::from_le_bytes(self.take()?)),
            Scalar::F32 => f64::from(f32::from_le_bytes(self.take()?)),
            Scalar::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    fn problem(&self) -> MeshError {
        malformed(self.place(), "the file ends here, expected more data")
    }

    fn smallest_size(&self, scalar: Scalar) -> usize {
        scalar.size()
    }

    fn remaining_bytes(&self) -> usize {
        self.bytes.len().saturating_sub(self.position)
    }

    fn place(&self) -> Place {
        Place::Byte(self.position)
    }
}
