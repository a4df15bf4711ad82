//! The focal length that a photo's EXIF data gives, in pixels.
//!
//! Few cameras say it outright. Millimetres need the size of the sensor: it is in the 35 mm equivalent, in how many pixels
//! there are to a millimetre of it, or in a table of cameras that are common. All of these are about the sensor's long side,
//! so that it does not matter how the camera was held.

use exif::{Exif, In, Rational, Reader, Tag, Value};

/// The width in millimetres of the 36 × 24 mm frame that EXIF's 35 mm equivalent focal length refers to.
const FULL_FRAME_WIDTH_MM: f64 = 36.0;
/// In millimetres: no camera that has EXIF data has a smaller or a larger sensor, but some programs write such numbers.
const SENSOR_WIDTHS_MM: std::ops::RangeInclusive<f64> = 2.0..=60.0;

/// Widths of sensors: `millimetres make: model, model…`, a model's beginning before a star. Makers' data sheets.
const SENSORS: &str = include_str!("sensors.txt");

/// What the EXIF data says of the lens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExifFocal {
    pub focal_px: f64,
    pub source: ExifFocalSource,
}

/// Where the size of the sensor is from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExifFocalSource {
    /// The 35 mm equivalent.
    Equivalent,
    /// Pixels to a millimetre of the sensor.
    FocalPlane,
    /// A table of cameras.
    SensorTable,
}

/// Of raw EXIF data and the size of the picture it is about.
pub fn exif_focal(data: Vec<u8>, (width, height): (u32, u32)) -> Option<ExifFocal> {
    let exif = Reader::new().read_raw(data).ok()?;
    let long_side_px = f64::from(width.max(height));
    let (part, source) = match whole(&exif, Tag::FocalLengthIn35mmFilm) {
        Some(equivalent_mm) => (f64::from(equivalent_mm) / FULL_FRAME_WIDTH_MM, ExifFocalSource::Equivalent),
        None => {
            let focal_mm = rational(&exif, Tag::FocalLength)?;
            let (sensor_mm, source) = sensor_width_mm(&exif, width.max(height))?;
            (focal_mm / sensor_mm, source)
        }
    };
    Some(ExifFocal { focal_px: part * long_side_px, source })
}

fn sensor_width_mm(exif: &Exif, long_side_px: u32) -> Option<(f64, ExifFocalSource)> {
    if let Some(width_mm) = focal_plane_mm(exif, long_side_px) {
        return Some((width_mm, ExifFocalSource::FocalPlane));
    }
    let width_mm = listed_width_mm(&text(exif, Tag::Make)?, &text(exif, Tag::Model)?)?;
    Some((width_mm, ExifFocalSource::SensorTable))
}

/// The long side of the sensor from its pixels, as many as were taken: the picture may be a smaller copy.
fn focal_plane_mm(exif: &Exif, long_side_px: u32) -> Option<f64> {
    let per_unit = rational(exif, Tag::FocalPlaneXResolution)?;
    let unit_mm = match whole(exif, Tag::FocalPlaneResolutionUnit).unwrap_or(2) {
        3 => 10.0,
        4 => 1.0,
        5 => 0.001,
        _ => 25.4,
    };
    let taken_px = whole(exif, Tag::PixelXDimension).max(whole(exif, Tag::PixelYDimension));
    let width_mm = f64::from(taken_px.unwrap_or(long_side_px)) / per_unit * unit_mm;
    SENSOR_WIDTHS_MM.contains(&width_mm).then_some(width_mm)
}

/// The longest entry that fits is the one that is meant.
fn listed_width_mm(make: &str, model: &str) -> Option<f64> {
    let make = make.to_lowercase();
    let model = model.trim();
    // Some makers write their name before the model's.
    let model = match model.split_once(' ') {
        Some((first, rest)) if make.starts_with(&first.to_lowercase()) => rest,
        _ => model,
    };
    let entry = |line: &'static str| {
        let (head, models) = line.split_once(": ")?;
        let (width_mm, listed_make) = head.split_once(' ')?;
        let length = |listed: &str| match listed.strip_suffix('*') {
            Some(beginning) => model.starts_with(beginning).then_some(beginning.len()),
            None => (listed == model).then_some(usize::MAX),
        };
        let length = models.split(", ").filter_map(length).max()?;
        let is_of_make = make.trim().starts_with(&listed_make.to_lowercase());
        Some((length, width_mm)).filter(|_| is_of_make)
    };
    SENSORS.lines().filter_map(entry).max_by_key(|(length, _)| *length)?.1.parse().ok()
}

/// A number above 0, which stands for "unknown".
fn whole(exif: &Exif, tag: Tag) -> Option<u32> {
    exif.get_field(tag, In::PRIMARY)?.value.get_uint(0).filter(|&value| value > 0)
}

fn rational(exif: &Exif, tag: Tag) -> Option<f64> {
    let Value::Rational(values) = &exif.get_field(tag, In::PRIMARY)?.value else { return None };
    let value = values.first().map(Rational::to_f64)?;
    (value > 0.0 && value.is_finite()).then_some(value)
}

fn text(exif: &Exif, tag: Tag) -> Option<String> {
    let Value::Ascii(lines) = &exif.get_field(tag, In::PRIMARY)?.value else { return None };
    Some(String::from_utf8_lossy(lines.first()?).into_owned())
}

#[cfg(test)]
mod tests {
    use exif::Field;
    use exif::experimental::Writer;

    use super::*;

    /// Made EXIF data of these fields.
    fn made(fields: &[(Tag, Value)]) -> Vec<u8> {
        let fields: Vec<Field> = fields
            .iter()
            .map(|(tag, value)| Field { tag: *tag, ifd_num: In::PRIMARY, value: value.clone() })
            .collect();
        let mut writer = Writer::new();
        fields.iter().for_each(|field| writer.push_field(field));
        let mut bytes = std::io::Cursor::new(Vec::new());
        writer.write(&mut bytes, false).unwrap();
        bytes.into_inner()
    }

    fn ascii(text: &str) -> Value {
        Value::Ascii(vec![text.as_bytes().to_vec()])
    }

    fn ratio(num: u32, denom: u32) -> Value {
        Value::Rational(vec![Rational { num, denom }])
    }

    fn focal(fields: &[(Tag, Value)], size: (u32, u32)) -> Option<(f64, ExifFocalSource)> {
        exif_focal(made(fields), size).map(|focal| (focal.focal_px, focal.source))
    }

    fn camera(make: &str, model: &str) -> [(Tag, Value); 3] {
        [(Tag::Make, ascii(make)), (Tag::Model, ascii(model)), (Tag::FocalLength, ratio(50, 1))]
    }

    #[test]
    fn the_equivalent_goes_before_all_else_and_portraits_are_as_landscapes() {
        let mut fields = camera("Canon", "Canon EOS 80D").to_vec();
        fields.push((Tag::FocalLengthIn35mmFilm, Value::Short(vec![72])));
        for size in [(6000, 4000), (4000, 6000)] {
            assert_eq!(focal(&fields, size), Some((12_000.0, ExifFocalSource::Equivalent)));
        }
        fields[3].1 = Value::Short(vec![0]);
        assert_eq!(focal(&fields, (6000, 4000)).unwrap().1, ExifFocalSource::SensorTable, "0 is unknown");
    }

    #[test]
    fn pixels_to_a_unit_of_the_sensor_give_its_width() {
        let of = |resolution: Value, unit: u16, size: (u32, u32)| {
            let fields = [
                (Tag::FocalLength, ratio(35, 1)),
                (Tag::FocalPlaneXResolution, resolution),
                (Tag::FocalPlaneResolutionUnit, Value::Short(vec![unit])),
                (Tag::PixelXDimension, Value::Long(vec![6000])),
                (Tag::PixelYDimension, Value::Long(vec![4000])),
            ];
            focal(&fields, size)
        };
        // 6000 pixels, 250 to a millimetre: 24 mm. The same of a smaller copy, and of one that stands upright.
        for (size, expected) in [((6000, 4000), 8750.0), ((3000, 2000), 4375.0), ((2000, 3000), 4375.0)] {
            for (resolution, unit) in
                [(ratio(6350, 1), 2), (ratio(2500, 1), 3), (ratio(250, 1), 4), (ratio(1, 4), 5)]
            {
                let (focal_px, source) = of(resolution, unit, size).unwrap();
                // Rounding of a few products.
                assert!((focal_px - expected).abs() < 1e-6, "{focal_px} {unit}");
                assert_eq!(source, ExifFocalSource::FocalPlane);
            }
        }
        for broken in [ratio(0, 1), ratio(1, 0), ratio(1, 1), ratio(4_000_000_000, 1)] {
            assert_eq!(of(broken, 2, (6000, 4000)), None);
        }
    }

    #[test]
    fn common_cameras_are_known_by_their_names() {
        for (make, model, width_mm) in [
            ("Canon", "Canon EOS 80D", 22.3),
            ("Canon", "Canon EOS 5D Mark IV", 36.0),
            ("Canon", "Canon EOS R", 36.0),
            ("Canon", "Canon EOS R50", 22.3),
            ("NIKON CORPORATION", "NIKON D3", 35.9),
            ("NIKON CORPORATION", "NIKON D3000", 23.6),
            ("NIKON CORPORATION", "NIKON Z 6_2", 35.9),
            ("NIKON CORPORATION", "NIKON Z50_2", 23.5),
            ("SONY", "ILCE-7M3", 35.8),
            ("SONY", "DSC-RX100M5", 13.2),
            ("SONY", "DSC-RX1", 35.8),
            ("FUJIFILM", "X-S10", 23.5),
            ("OLYMPUS IMAGING CORP.", "E-M5", 17.3),
            ("Panasonic", "DC-GH5", 17.3),
            ("Apple", "iPhone 6s Plus", 4.92),
            ("Google", "Pixel 3a", 5.64),
            ("samsung", "SM-G930F", 5.64),
        ] {
            let found = focal(&camera(make, model), (4000, 3000));
            assert_eq!(found, Some((50.0 / width_mm * 4000.0, ExifFocalSource::SensorTable)), "{model}");
        }
        for (make, model) in
            [("Canon", "Canon EOS 99999D"), ("Other", "EOS 80D"), ("", ""), ("Canon", "Canon")]
        {
            assert_eq!(focal(&camera(make, model), (4000, 3000)), None, "{make} {model}");
        }
    }

    #[test]
    fn every_line_of_the_table_is_read() {
        for line in SENSORS.lines() {
            let (head, models) = line.split_once(": ").unwrap();
            let (width_mm, make) = head.split_once(' ').unwrap();
            assert!(SENSOR_WIDTHS_MM.contains(&width_mm.parse().unwrap()), "{line}");
            for model in models.split(", ") {
                let name = model.replace('*', "x");
                // As cameras have it, some more letters in place of a star.
                let found = listed_width_mm(make, &format!("{make} {name}"));
                assert!(found.is_some(), "{make} {model}");
            }
        }
    }
}
