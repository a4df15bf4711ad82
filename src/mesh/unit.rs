//! The unit of a mesh file's numbers: what the file says of it, and what the mesh's size makes likely.

use std::fmt;

/// A comment about the unit stands near the beginning.
const HEADER_BYTES: usize = 4096;
/// From this size on nobody measures in anything but millimetres what is put before a camera.
const CERTAINLY_MM: f64 = 40.0;
/// Below this size a number is a metre, for no object is that small; from here on up to the next it is a centimetre.
const LIKELY_CM: f64 = 2.0;
const LIKELY_MM: f64 = 20.0;

/// A unit of length that meshes are made in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshUnit {
    Millimetre,
    Centimetre,
    Metre,
    Inch,
}

/// What a mesh's file says of its unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileUnit {
    /// The format is in metres, and [`super::load`] has made millimetres of them.
    Gltf,
    /// A comment in it.
    Named(MeshUnit),
    Unknown,
}

impl MeshUnit {
    pub const ALL: [Self; 4] = [Self::Millimetre, Self::Centimetre, Self::Metre, Self::Inch];

    pub fn in_mm(self) -> f64 {
        match self {
            Self::Millimetre => 1.0,
            Self::Centimetre => 10.0,
            Self::Metre => 1000.0,
            Self::Inch => 25.4,
        }
    }

    /// The unit that has so many millimetres.
    pub fn of_mm(mm: f64) -> Option<Self> {
        Self::ALL.into_iter().find(|unit| (mm / unit.in_mm() - 1.0).abs() < 1e-9)
    }

    pub fn symbol(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Centimetre => "cm",
            Self::Metre => "m",
            Self::Inch => "in",
        }
    }

    pub fn from_symbol(symbol: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|unit| unit.symbol() == symbol)
    }

    /// What a mesh of this size, the longest side of its box, is most likely measured in; and whether that is doubtful.
    pub fn likely(longest_side: f64) -> (Self, bool) {
        let unit = if longest_side < LIKELY_CM {
            Self::Metre
        } else if longest_side < LIKELY_MM {
            Self::Centimetre
        } else {
            Self::Millimetre
        };
        (unit, longest_side < CERTAINLY_MM)
    }
}

impl fmt::Display for MeshUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Millimetre => "millimetres",
            Self::Centimetre => "centimetres",
            Self::Metre => "metres",
            Self::Inch => "inches",
        })
    }
}

impl FileUnit {
    /// Reads the beginning of a file that was loaded as a mesh.
    pub fn of(bytes: &[u8]) -> Self {
        let bytes = super::text::without_byte_order_mark(bytes);
        // Of the formats that are read, only glTF is JSON.
        if bytes.starts_with(b"glTF") || bytes.trim_ascii_start().starts_with(b"{") {
            return Self::Gltf;
        }
        let header = bytes.get(..HEADER_BYTES).unwrap_or(bytes);
        header
            .split(|byte| matches!(byte, b'\n' | b'\r' | 0))
            .find_map(named_in)
            .map_or(Self::Unknown, Self::Named)
    }

    /// Millimetres a unit of the numbers that [`super::load`] makes of the file's: the file's own unit, but for glTF.
    pub fn loaded_in_mm(self) -> Option<f64> {
        match self {
            Self::Gltf => Some(1.0),
            Self::Named(unit) => Some(unit.in_mm()),
            Self::Unknown => None,
        }
    }

    /// How many of the file's units a loaded number is short of: a thousand where metres were made millimetres.
    pub fn loaded_factor(self) -> f64 {
        if self == Self::Gltf { MeshUnit::Metre.in_mm() } else { 1.0 }
    }
}

/// A length as people say it: "0.12 mm", "120 mm", "12 m".
pub fn length_text(mm: f64) -> String {
    let (number, unit) = match mm {
        _ if mm >= 1e7 => (mm / 1e6, "km"),
        _ if mm >= 1e4 => (mm / 1e3, "m"),
        _ => (mm, "mm"),
    };
    let decimals = if number >= 10.0 {
        0
    } else if number >= 1.0 {
        1
    } else {
        2
    };
    let text = format!("{number:.decimals$}");
    let is_tiny = mm > 0.0 && text.parse() == Ok(0.0);
    if is_tiny { format!("less than 0.01 {unit}") } else { format!("{text} {unit}") }
}

/// The unit in a line such as `# File units = centimeters`, `comment units: mm`, or an STL's `… UNITS=mm`.
fn named_in(line: &[u8]) -> Option<MeshUnit> {
    let line = line.trim_ascii();
    let line = str::from_utf8(line.get(..200).unwrap_or(line)).ok()?.to_ascii_lowercase();
    let is_comment = ["#", "comment", "obj_info", "solid"].iter().any(|start| line.starts_with(start))
        || line.contains("units=");
    let (_, after) = line.split_once("unit").filter(|_| is_comment)?;
    let words =
        || after.split(|c: char| !c.is_ascii_alphanumeric() && c != '.').filter(|word| !word.is_empty());
    // "1 unit = 10 mm" is none of ours.
    if words().any(|word| word.parse::<f64>().is_ok_and(|number| number != 1.0)) {
        return None;
    }
    // "units in mm" has a word that is a unit, too.
    let unit = words().take(4).filter(|word| *word != "in").find_map(unit_of_word);
    unit.or_else(|| words().next_back().filter(|word| *word == "in").map(|_| MeshUnit::Inch))
}

fn unit_of_word(word: &str) -> Option<MeshUnit> {
    match word {
        "mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres" => Some(MeshUnit::Millimetre),
        "cm" | "centimeter" | "centimeters" | "centimetre" | "centimetres" => Some(MeshUnit::Centimetre),
        "m" | "meter" | "meters" | "metre" | "metres" => Some(MeshUnit::Metre),
        "inch" | "inches" => Some(MeshUnit::Inch),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_size_makes_a_unit_likely() {
        assert_eq!(MeshUnit::likely(0.12), (MeshUnit::Metre, true));
        assert_eq!(MeshUnit::likely(12.0), (MeshUnit::Centimetre, true));
        assert_eq!(MeshUnit::likely(25.0), (MeshUnit::Millimetre, true));
        assert_eq!(MeshUnit::likely(120.0), (MeshUnit::Millimetre, false));
        assert_eq!(MeshUnit::likely(4000.0), (MeshUnit::Millimetre, false));
    }

    #[test]
    fn lengths_are_said_with_few_digits() {
        let texts = [0.001, 0.12, 3.048, 120.4, 1200.0, 12_000.0, 1.2e8].map(length_text);
        let expected = ["less than 0.01 mm", "0.12 mm", "3.0 mm", "120 mm", "1200 mm", "12 m", "120 km"];
        assert_eq!(texts, expected);
    }

    #[test]
    fn a_comment_names_the_unit() {
        let named = |text: &str| FileUnit::of(text.as_bytes());
        assert_eq!(
            named("# 3ds Max\n# File units = centimeters\nv 1 2 3\n"),
            FileUnit::Named(MeshUnit::Centimetre)
        );
        assert_eq!(named("ply\nformat ascii 1.0\ncomment Units: m\n"), FileUnit::Named(MeshUnit::Metre));
        assert_eq!(named("Part by CAD UNITS=in\0\0"), FileUnit::Named(MeshUnit::Inch));
        assert_eq!(named("# units in mm\n"), FileUnit::Named(MeshUnit::Millimetre));
        assert_eq!(named("# 1 unit = 1 meter\n"), FileUnit::Named(MeshUnit::Metre));
        assert_eq!(named("# 1 unit = 10 mm\n"), FileUnit::Unknown);
        assert_eq!(named("# unit normals\nv 1 2 3\n"), FileUnit::Unknown);
        assert_eq!(named("v 1 2 3\ng unit_mm\n"), FileUnit::Unknown);
        assert_eq!(named(" {\"asset\": {}}"), FileUnit::Gltf);
    }

    #[test]
    fn units_are_known_by_their_millimetres() {
        for unit in MeshUnit::ALL {
            assert_eq!(MeshUnit::of_mm(unit.in_mm()), Some(unit));
            assert_eq!(MeshUnit::from_symbol(unit.symbol()), Some(unit));
        }
        assert_eq!(MeshUnit::of_mm(2.5), None);
    }
}
