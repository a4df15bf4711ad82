//! NumPy's `.npy`: one array of numbers. Source: NumPy's "NEP 1, a simple file format".

use super::FormatError;

/// More numbers than any list of cameras or poses has; images and point clouds do not come this way.
const MAX_NUMBERS: usize = 4_000_000;

/// An array, whatever its type and order in the file.
#[derive(Debug, Clone, PartialEq)]
pub struct NpyArray {
    pub shape: Vec<usize>,
    /// The last index runs fastest.
    pub values: Vec<f64>,
}

impl NpyArray {
    pub fn shape_in_words(&self) -> String {
        if self.shape.is_empty() {
            return "a single number".to_owned();
        }
        self.shape.iter().map(usize::to_string).collect::<Vec<_>>().join("×")
    }
}

/// Reads an array of floating-point or whole numbers; Python objects are refused.
pub fn read_npy(bytes: &[u8]) -> Result<NpyArray, FormatError> {
    let (header, data) = split(bytes)?;
    let number = NumberType::of(field(header, "descr")?)?;
    let fortran_order = match field(header, "fortran_order")? {
        "True" => true,
        "False" => false,
        other => {
            return Err(at_header(format!(
                "\"fortran_order\" True or False expected, found {}",
                short(other)
            )));
        }
    };
    let shape = shape_of(field(header, "shape")?)?;
    let count = shape.iter().try_fold(1_usize, |product, side| product.checked_mul(*side));
    let count = count.filter(|count| *count <= MAX_NUMBERS).ok_or_else(|| {
        at_header(format!(
            "an array of more than {} million numbers is no camera and no poses",
            MAX_NUMBERS / 1_000_000
        ))
    })?;
    let data = data.get(..count * number.bytes).ok_or_else(|| {
        FormatError::at(
            "the data",
            format!(
                "{} bytes expected, {} are there: the file is cut short",
                count * number.bytes,
                data.len()
            ),
        )
    })?;
    let values: Vec<f64> = data.chunks_exact(number.bytes).map(|bytes| number.read(bytes)).collect();
    let values = if fortran_order { last_index_fastest(&values, &shape) } else { values };
    Ok(NpyArray { shape, values })
}

/// The header's text and what follows it.
fn split(bytes: &[u8]) -> Result<(&str, &[u8]), FormatError> {
    let cut_short = || FormatError::at("the header", "the file is cut short");
    let rest = bytes
        .strip_prefix(b"\x93NUMPY")
        .ok_or_else(|| FormatError::at("the start", "\\x93NUMPY expected: not a NumPy array"))?;
    let (length_bytes, rest) = match rest {
        [1, _, rest @ ..] => (2, rest),
        [2 | 3, _, rest @ ..] => (4, rest),
        [version, ..] => return Err(at_header(format!("version 1, 2 or 3 expected, found {version}"))),
        [] => return Err(cut_short()),
    };
    let (length, rest) = rest.split_at_checked(length_bytes).ok_or_else(cut_short)?;
    let length = length.iter().rev().fold(0_usize, |length, byte| (length << 8) | usize::from(*byte));
    let (header, data) = rest.split_at_checked(length).ok_or_else(cut_short)?;
    let header = std::str::from_utf8(header).map_err(|_| at_header("text expected"))?;
    Ok((header, data))
}

fn at_header(reason: impl ToString) -> FormatError {
    FormatError::at("the header", reason)
}

fn short(text: &str) -> String {
    text.chars().take(20).collect()
}

/// What follows a key in the header, which is a Python dictionary as NumPy prints it.
fn field<'a>(header: &'a str, key: &str) -> Result<&'a str, FormatError> {
    let missing = || at_header(format!("\"{key}\" expected"));
    let (_, rest) = header.split_once(&format!("'{key}'")).ok_or_else(missing)?;
    let rest = rest.trim_start().strip_prefix(':').ok_or_else(missing)?.trim_start();
    let end = match rest.as_bytes().first() {
        Some(b'\'') => rest.get(1..).and_then(|text| text.find('\'')).map(|end| end + 2),
        Some(b'(') => rest.find(')').map(|end| end + 1),
        // A structured type is a list; it is refused by its first character.
        Some(b'[') => Some(1),
        _ => rest.find([',', '}']),
    };
    end.and_then(|end| rest.get(..end)).map(str::trim).ok_or_else(missing)
}

/// The bytes of one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct NumberType {
    is_float: bool,
    bytes: usize,
    is_big_endian: bool,
}

impl NumberType {
    fn of(descr: &str) -> Result<Self, FormatError> {
        let refused = |found: &str| {
            at_header(format!("numbers of type f4, f8, i4 or i8 expected, found {}", short(found)))
        };
        let name = descr.strip_prefix('\'').and_then(|name| name.strip_suffix('\''));
        let name = name.ok_or_else(|| refused("a structured type"))?;
        let is_big_endian = name.starts_with('>');
        let (is_float, bytes) = match name.trim_start_matches(['<', '>', '=', '|']) {
            "f4" => (true, 4),
            "f8" => (true, 8),
            "i4" => (false, 4),
            "i8" => (false, 8),
            "O" => {
                return Err(at_header(
                    "the array holds Python objects (a pickle), which could run code and is never opened: save plain \
                     numbers, np.save(path, np.asarray(matrix, dtype=float))",
                ));
            }
            other => return Err(refused(other)),
        };
        Ok(Self { is_float, bytes, is_big_endian })
    }

    fn read(self, bytes: &[u8]) -> f64 {
        let place = |bits: u64, byte: &u8| (bits << 8) | u64::from(*byte);
        let bits = match self.is_big_endian {
            true => bytes.iter().fold(0, place),
            false => bytes.iter().rev().fold(0, place),
        };
        match (self.is_float, self.bytes) {
            (true, 4) => f64::from(f32::from_bits(bits as u32)),
            (true, _) => f64::from_bits(bits),
            (false, 4) => f64::from(bits as u32 as i32),
            (false, _) => bits as i64 as f64,
        }
    }
}

/// `(3, 3)`, `(4,)` or `()`.
fn shape_of(text: &str) -> Result<Vec<usize>, FormatError> {
    let wrong = || at_header(format!("a shape like (3, 3) expected, found {}", short(text)));
    let inside = text.strip_prefix('(').and_then(|text| text.strip_suffix(')')).ok_or_else(wrong)?;
    let sides = inside.split(',').map(str::trim).filter(|side| !side.is_empty());
    let shape: Vec<usize> = sides.map(|side| side.parse().map_err(|_| wrong())).collect::<Result<_, _>>()?;
    if shape.len() > 8 { Err(wrong()) } else { Ok(shape) }
}

/// Turns an array whose first index runs fastest round.
fn last_index_fastest(values: &[f64], shape: &[usize]) -> Vec<f64> {
    let mut turned = Vec::with_capacity(values.len());
    let mut index = vec![0_usize; shape.len()];
    for _ in 0..values.len() {
        let position = index.iter().zip(shape).rev().fold(0, |position, (i, side)| position * side + i);
        turned.push(values.get(position).copied().unwrap_or(f64::NAN));
        for (i, side) in index.iter_mut().zip(shape).rev() {
            *i += 1;
            if *i < *side {
                break;
            }
            *i = 0;
        }
    }
    turned
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A file as NumPy writes it.
    pub fn npy(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
        let order = if fortran { "True" } else { "False" };
        let mut header = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}");
        while (10 + header.len() + 1) % 64 != 0 {
            header.push(' ');
        }
        header.push('\n');
        let mut bytes = b"\x93NUMPY\x01\0".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    #[test]
    fn types_and_orders_are_read() {
        let doubles: Vec<u8> = (0..6).flat_map(|i| f64::from(i).to_le_bytes()).collect();
        let array = read_npy(&npy("<f8", false, "(2, 3)", &doubles)).unwrap();
        assert_eq!((array.shape, array.values), (vec![2, 3], vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0]));
        let array = read_npy(&npy("<f8", true, "(2, 3)", &doubles)).unwrap();
        assert_eq!(array.values, [0.0, 2.0, 4.0, 1.0, 3.0, 5.0]);
        let floats: Vec<u8> = [0.5_f32, -2.0].iter().flat_map(|value| value.to_be_bytes()).collect();
        assert_eq!(read_npy(&npy(">f4", false, "(2,)", &floats)).unwrap().values, [0.5, -2.0]);
        let whole: Vec<u8> = [-3_i64].iter().flat_map(|value| value.to_le_bytes()).collect();
        assert_eq!(read_npy(&npy("<i8", false, "()", &whole)).unwrap().values, [-3.0]);
    }

    #[test]
    fn three_indices_in_fortran_order() {
        // a[i, j, k] = 100 i + 10 j + k, first index fastest.
        let mut data = Vec::new();
        for (k, j, i) in (0..2).flat_map(|k| (0..3).flat_map(move |j| (0..2).map(move |i| (k, j, i)))) {
            data.extend(f64::from(100 * i + 10 * j + k).to_le_bytes());
        }
        let array = read_npy(&npy("<f8", true, "(2, 3, 2)", &data)).unwrap();
        assert_eq!(array.values[..4], [0.0, 1.0, 10.0, 11.0]);
        assert_eq!(array.values[6], 100.0);
    }

    #[test]
    fn what_is_no_array_of_numbers_is_refused_in_words() {
        let message = |bytes: &[u8]| read_npy(bytes).unwrap_err().to_string();
        assert!(message(&npy("|O", false, "(3, 3)", b"\x80\x04")).contains("pickle"));
        assert!(message(&npy("<U5", false, "(3, 3)", b"")).contains("found U5"));
        assert!(message(&npy("<f8", false, "(3, 3)", &[0; 71])).contains("72 bytes expected, 71 are there"));
        assert!(message(&npy("<f8", false, "(4000000000, 4000000000, 4000000000)", b"")).contains("million"));
        assert!(message(&npy("<f8", false, "(-1,)", b"")).contains("shape"));
        assert!(message(b"\x93NUMPY\x07\0").contains("version"));
        assert!(message(b"nothing").contains("NUMPY"));
        let structured = b"\x93NUMPY\x01\0\x40\0{'descr': [('a', '<f8')], 'fortran_order': False, 'shape': (1,), }         \n";
        assert!(message(structured).contains("structured"));
        let whole = npy("<f8", false, "(3, 3)", &[0; 72]);
        for length in 0..whole.len() {
            assert!(read_npy(&whole[..length]).is_err());
        }
    }
}
