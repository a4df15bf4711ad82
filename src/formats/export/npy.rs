//! NumPy's `.npy`, version 1.0: little-endian float64 matrices in C order.

/// A matrix as a file that `numpy.load` reads. All rows have the same length: the type says so.
pub fn write_npy<const COLUMNS: usize>(rows: &[[f64; COLUMNS]]) -> Vec<u8> {
    const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";
    const LENGTH_BYTES: usize = 2;
    /// The data starts at a multiple of this.
    const ALIGNMENT: usize = 64;
    let mut header =
        format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, {COLUMNS}), }}", rows.len());
    let unpadded = MAGIC.len() + LENGTH_BYTES + header.len() + 1;
    header.extend(std::iter::repeat_n(' ', unpadded.next_multiple_of(ALIGNMENT) - unpadded));
    header.push('\n');
    let mut bytes = MAGIC.to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(rows.iter().flatten().flat_map(|value| value.to_le_bytes()));
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_is_numpy_s_own() {
        // numpy.save of numpy.array([[1.0, 2.0], [3.0, -0.5]]), byte for byte.
        let mut expected = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
        expected.extend(b"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), }");
        expected.resize(127, b' ');
        expected.push(b'\n');
        expected.extend([1.0_f64, 2.0, 3.0, -0.5].iter().flat_map(|value| value.to_le_bytes()));
        assert_eq!(write_npy(&[[1.0, 2.0], [3.0, -0.5]]), expected);
    }
}
