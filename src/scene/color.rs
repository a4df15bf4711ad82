//! Colours that keep one meaning everywhere.

/// sRGB, 8 bits a channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rgb(pub [u8; 3]);

impl Rgb {
    /// `#rrggbb`.
    pub fn to_hex(self) -> String {
        let [red, green, blue] = self.0;
        format!("#{red:02x}{green:02x}{blue:02x}")
    }

    /// `None` for what is not `#rrggbb`.
    pub fn from_hex(text: &str) -> Option<Self> {
        let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii())?;
        let [_, red, green, blue] = u32::from_str_radix(digits, 16).ok()?.to_be_bytes();
        Some(Self([red, green, blue]))
    }
}

/// Objects' colours in the order they are given out. The first is the paper's lime; the rest are apart from one another, from
/// the references' magenta, and for colour-blind eyes (after Okabe and Ito).
const OBJECT_COLORS: [Rgb; 7] = [
    Rgb([152, 230, 60]),
    Rgb([86, 180, 233]),
    Rgb([240, 164, 40]),
    Rgb([0, 196, 150]),
    Rgb([240, 228, 66]),
    Rgb([120, 130, 255]),
    Rgb([235, 110, 50]),
];

/// The colour of the object that is added as number `index`.
pub fn object_color(index: usize) -> Rgb {
    OBJECT_COLORS[index % OBJECT_COLORS.len()]
}

/// The first colour that the fewest objects have: neighbours differ, also after some were removed.
pub fn free_object_color(used: impl Iterator<Item = Rgb>) -> Rgb {
    let used: Vec<Rgb> = used.collect();
    let times = |color: &Rgb| used.iter().filter(|other| *other == color).count();
    OBJECT_COLORS.into_iter().min_by_key(times).unwrap_or(OBJECT_COLORS[0])
}

/// Of a mask that belongs to no object.
pub fn mask_color() -> Rgb {
    Rgb([255, 255, 255])
}

/// References are magenta, as in the paper.
pub fn reference_color() -> Rgb {
    Rgb([255, 64, 220])
}
