//! Lines and words of files that are text, or begin as text.

/// Cuts the next line off `bytes` from `position` on, and moves `position` behind its end: LF, CR LF, or a lone CR.
pub(super) fn next_line<'a>(bytes: &'a [u8], position: &mut usize) -> Option<&'a [u8]> {
    let rest = bytes.get(*position..).filter(|rest| !rest.is_empty())?;
    let length = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(rest.len());
    let end_of_line = match rest.get(length..) {
        Some([b'\r', b'\n', ..]) => 2,
        Some([_, ..]) => 1,
        _ => 0,
    };
    *position += length + end_of_line;
    Some(&rest[..length])
}

/// The words of a line.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A decimal number; also `nan` and `inf`, which the caller has to refuse where they make no sense.
pub(super) fn parse_number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A word as it can be shown in a message: readable and short.
pub(super) fn shown(word: &[u8]) -> String {
    let text: String = String::from_utf8_lossy(word).chars().take(40).collect();
    format!("“{}”", text.escape_debug())
}

/// The file without a UTF-8 byte order mark.
pub(super) fn without_byte_order_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_any_convention() {
        let bytes = b"a\nb\r\n\rc d";
        let mut position = 0;
        let lines: Vec<&[u8]> = std::iter::from_fn(|| next_line(bytes, &mut position)).collect();
        assert_eq!(lines, [b"a".as_slice(), b"b", b"", b"c d"]);
        assert_eq!(words(b" c\t d ").count(), 2);
    }
}
