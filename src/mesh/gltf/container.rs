//! Where a glTF's bytes are: the chunks of a GLB, within the JSON, or in files beside it.

use std::sync::Arc;

use ::gltf::json;

use super::{malformed, unsupported};
use crate::mesh::companions::{companion_key, percent_decoded};
use crate::mesh::textures::shown_name;
use crate::mesh::{FindCompanion, Format, MeshError, Place};

/// The bytes of a buffer, wherever they are kept.
pub(super) enum Buffer<'a> {
    Chunk(&'a [u8]),
    Decoded(Vec<u8>),
    File(Arc<[u8]>),
}

impl Buffer<'_> {
    pub fn bytes(&self) -> &[u8] {
        match self {
            Self::Chunk(bytes) => bytes,
            Self::Decoded(bytes) => bytes,
            Self::File(bytes) => bytes,
        }
    }
}

/// The JSON and the binary chunk of a GLB; a file that is no GLB is all JSON.
pub(super) fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), MeshError> {
    let Some(header) = bytes.strip_prefix(b"glTF") else {
        return Ok((bytes, None));
    };
    let at = |byte, problem: &str| MeshError::Malformed {
        format: Format::Gltf,
        place: Place::Byte(byte),
        problem: problem.to_owned(),
    };
    let version = read_u32(header).ok_or_else(|| at(4, "the file ends within its header"))?;
    if version != 2 {
        return Err(unsupported(format!("version {version}"), "glTF 2.0 expected"));
    }
    let (kind, json_chunk, rest) = next_chunk(bytes, 12)
        .ok_or_else(|| at(12, "the file ends within its first chunk, so it is cut off"))?;
    if kind != b"JSON" {
        return Err(at(16, "expected the chunk “JSON”"));
    }
    match next_chunk(bytes, rest) {
        Some((b"BIN\0", binary_chunk, _)) => Ok((json_chunk, Some(binary_chunk))),
        // Unknown chunks are to be ignored, and a few stray bytes at the end do no harm.
        Some(_) => Ok((json_chunk, None)),
        None if bytes.len() < rest + 8 => Ok((json_chunk, None)),
        None => Err(at(rest, "the file ends within its second chunk, so it is cut off")),
    }
}

/// Type and content of the chunk that begins at `start`, and where the next one begins.
fn next_chunk(bytes: &[u8], start: usize) -> Option<(&[u8], &[u8], usize)> {
    let header = bytes.get(start..)?;
    let length = usize::try_from(read_u32(header)?).ok()?;
    let kind = header.get(4..8)?;
    let content = header.get(8..)?.get(..length)?;
    Some((kind, content, start + 8 + length))
}

fn read_u32(bytes: &[u8]) -> Option<u32> {
    bytes.first_chunk().map(|chunk| u32::from_le_bytes(*chunk))
}

/// The bytes of each buffer: the GLB's own chunk, base64 within the JSON, or a file.
pub(super) fn buffers<'a>(
    root: &json::Root,
    binary_chunk: Option<&'a [u8]>,
    find: FindCompanion<'_>,
) -> Result<Vec<Buffer<'a>>, MeshError> {
    root.buffers
        .iter()
        .enumerate()
        .map(|(number, buffer)| match &buffer.uri {
            None => binary_chunk
                .filter(|_| number == 0)
                .map(Buffer::Chunk)
                .ok_or_else(|| malformed(format!("buffer {number}"), "it has no bytes in this file")),
            Some(uri) if uri.starts_with("data:") => data_uri(uri)
                .map(Buffer::Decoded)
                .ok_or_else(|| malformed(format!("buffer {number}"), "expected its data URI to be base64")),
            Some(uri) => buffer_file(uri, find),
        })
        .collect()
}

fn buffer_file<'a>(uri: &str, find: FindCompanion<'_>) -> Result<Buffer<'a>, MeshError> {
    let name = percent_decoded(uri);
    let missing = || MeshError::MissingCompanion { format: Format::Gltf, name: shown_name(&name) };
    find(&companion_key(&name)).map(Buffer::File).ok_or_else(missing)
}

/// What a base64 data URI holds.
pub(super) fn data_uri(uri: &str) -> Option<Vec<u8>> {
    let (_, text) = uri.strip_prefix("data:")?.split_once(";base64,")?;
    decode_base64(text.as_bytes())
}

fn decode_base64(text: &[u8]) -> Option<Vec<u8>> {
    let text = text.trim_ascii_end();
    let padding = text.iter().rev().take_while(|&&byte| byte == b'=').count();
    let digits = &text[..text.len() - padding];
    if padding > 2 || digits.len() % 4 == 1 {
        return None;
    }
    let mut decoded = Vec::with_capacity(digits.len() / 4 * 3 + 2);
    for group in digits.chunks(4) {
        let mut bits = 0_u32;
        for &digit in group {
            bits = bits << 6 | u32::from(base64_digit(digit)?);
        }
        // A last group of two or three digits holds one or two bytes, at the upper end of the 24 bits.
        bits <<= 6 * (4 - group.len());
        let [_, bytes @ ..] = bits.to_be_bytes();
        decoded.extend_from_slice(&bytes[..group.len() - 1]);
    }
    Some(decoded)
}

fn base64_digit(digit: u8) -> Option<u8> {
    match digit {
        b'A'..=b'Z' => Some(digit - b'A'),
        b'a'..=b'z' => Some(digit - b'a' + 26),
        b'0'..=b'9' => Some(digit - b'0' + 52),
        b'+' | b'-' => Some(62),
        b'/' | b'_' => Some(63),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::decode_base64;

    #[test]
    fn base64_of_every_length() {
        // The examples of RFC 4648, section 10.
        for (text, bytes) in [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg", "foob")] {
            assert_eq!(decode_base64(text.as_bytes()).as_deref(), Some(bytes.as_bytes()));
        }
        assert_eq!(decode_base64(b"Zm9vY"), None);
        assert_eq!(decode_base64(b"Zm9 "), Some(b"fo".to_vec()));
        assert_eq!(decode_base64(b"Z!9v"), None);
    }
}
