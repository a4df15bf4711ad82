//! The poses that this program exports in a chosen convention, `poses.json` and `poses.csv`, read back.

use std::collections::BTreeSet;

use glam::{DMat3, DVec3};
use serde::Deserialize;

use super::camera::distortion_from_list;
use super::export::{CameraAxes, Convention, LengthUnit, PoseDirection};
use super::gather::{Found, Gather};
use super::{CameraFile, FileKey, FormatError, Incoming};
use crate::math::Pose;
use crate::scene::Sha256;

/// What `poses.json` says it is.
pub(super) const FORMAT: &str = "pinpose-poses";
const CSV_START: &str = "photo,object,mesh_file,direction,camera_axes,length_unit,";
/// As many as a data set of ten thousand photos with fifty objects each has.
const MAX_ROWS: usize = 500_000;

#[derive(Deserialize)]
struct PosesFile {
    version: u64,
    conventions: Words,
    photos: Vec<PhotoEntry>,
}

#[derive(Deserialize)]
struct Words {
    direction: String,
    camera_axes: String,
    length_unit: String,
}

#[derive(Deserialize)]
struct PhotoEntry {
    file: String,
    sha256: String,
    width: u32,
    height: u32,
    #[serde(rename = "K")]
    k: [[f64; 3]; 3],
    distortion: Option<[f64; 5]>,
    poses: Vec<PoseEntry>,
}

#[derive(Deserialize)]
struct PoseEntry {
    mesh_file: String,
    mesh_sha256: String,
    matrix: [[f64; 4]; 4],
}

impl Words {
    /// A file's words begin with the names that a CSV has.
    fn convention(&self) -> Result<Convention, FormatError> {
        let begins = |text: &str, name: &str| text.to_ascii_lowercase().starts_with(name);
        let unknown = |what: &str, text: &str| {
            FormatError::at(
                format!("\"{what}\""),
                format!("\"{}\" is unknown", text.chars().take(40).collect::<String>()),
            )
        };
        let directions = [PoseDirection::CameraFromObject, PoseDirection::ObjectFromCamera];
        let direction = directions.into_iter().find(|direction| begins(&self.direction, direction.name()));
        let axes = [CameraAxes::OpenCv, CameraAxes::OpenGl];
        let axes = axes.into_iter().find(|axes| begins(&self.camera_axes, axes.name()));
        let units = [LengthUnit::Millimetre, LengthUnit::Metre];
        let unit = units.into_iter().find(|unit| self.length_unit == unit.name());
        Ok(Convention {
            direction: direction.ok_or_else(|| unknown("direction", &self.direction))?,
            axes: axes.ok_or_else(|| unknown("camera_axes", &self.camera_axes))?,
            unit: unit.ok_or_else(|| unknown("length_unit", &self.length_unit))?,
        })
    }
}

/// Adds a pose that is written in a convention.
fn gather_pose(
    gather: &mut Gather,
    photo: usize,
    object: FileKey,
    rows: &[[f64; 4]; 4],
    convention: Convention,
    place: impl FnOnce() -> String,
) {
    let mut rows = *rows;
    for row in rows.iter_mut().take(3) {
        row[3] *= convention.unit.in_mm();
    }
    let pose = match Pose::from_rows(&rows) {
        Ok((pose, _)) => pose,
        Err(error) => {
            gather.leave_out(|| format!("{}: {error}", place()));
            return;
        }
    };
    let pose = match convention.direction {
        PoseDirection::CameraFromObject => pose,
        PoseDirection::ObjectFromCamera => pose.inverse(),
    };
    let flip = Pose { rotation: DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0)), ..Pose::IDENTITY };
    let pose = match convention.axes {
        CameraAxes::OpenCv => pose,
        CameraAxes::OpenGl => flip * pose,
    };
    let rotation = pose.rotation.transpose().to_cols_array();
    let translation_mm = pose.translation_mm.to_array();
    gather.pose(Found { photo, object, rotation: &rotation, translation_mm, score: None }, place);
}

/// Reads `poses.json`.
pub(super) fn read_poses_json(file_name: &str, bytes: &[u8]) -> Result<Incoming, FormatError> {
    let file: PosesFile = serde_json::from_slice(bytes).map_err(FormatError::json)?;
    if file.version != 1 {
        return Err(FormatError::Version { found: file.version, supported: 1 });
    }
    let convention = file.conventions.convention()?;
    let mut gather = Gather::new(file_name);
    for (index, entry) in file.photos.into_iter().enumerate() {
        let place = format!("photos[{index}]");
        let distortion =
            distortion_from_list(&place, entry.distortion.as_ref().map_or(&[], |list| list.as_slice()))?;
        let camera = CameraFile::checked(file_name, entry.k, distortion, Some((entry.width, entry.height)))?;
        let photo = gather.photo(content_key(&entry.sha256, &entry.file, &place)?);
        gather.camera(photo, camera);
        for (index, pose) in entry.poses.iter().enumerate() {
            let place = format!("{place}.poses[{index}]");
            let object = content_key(&pose.mesh_sha256, &pose.mesh_file, &place)?;
            gather_pose(&mut gather, photo, object, &pose.matrix, convention, || place.clone());
        }
    }
    gather.finish()
}

fn content_key(sha256: &str, file_name: &str, place: &str) -> Result<FileKey, FormatError> {
    let sha256: Sha256 = sha256.parse().map_err(|reason| FormatError::at(place, reason))?;
    Ok(FileKey::Content { sha256, file_name: file_name.to_owned() })
}

/// Does a text begin as `poses.csv` does?
pub(super) fn is_poses_csv(text: &str) -> bool {
    text.trim_start_matches('\u{feff}').starts_with(CSV_START)
}

/// Reads `poses.csv`, which names photos and meshes by their files.
pub(super) fn read_poses_csv(file_name: &str, text: &str) -> Result<Incoming, FormatError> {
    let mut gather = Gather::new(file_name);
    let mut with_camera = BTreeSet::new();
    for (index, line) in text.lines().enumerate().skip(1).filter(|(_, line)| !line.trim().is_empty()) {
        let place = format!("line {}", index + 1);
        if index > MAX_ROWS {
            return Err(FormatError::at(place, format!("more than {MAX_ROWS} poses")));
        }
        let row = Row::read(line).map_err(|reason| FormatError::at(&place, reason))?;
        let photo = gather.photo(FileKey::Path(row.photo));
        if with_camera.insert(photo) {
            let [fx, fy, cx, cy, skew, lens @ ..] = row.lens;
            let k = [[fx, skew, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]];
            let camera =
                CameraFile::checked(file_name, k, distortion_from_list(&place, &lens)?, Some(row.size));
            gather.camera(photo, camera.map_err(|error| FormatError::at(&place, error))?);
        }
        let convention = row.words.convention().map_err(|error| FormatError::at(&place, error))?;
        gather_pose(&mut gather, photo, FileKey::Path(row.mesh), &row.rows, convention, || place.clone());
    }
    gather.finish()
}

struct Row {
    photo: String,
    mesh: String,
    words: Words,
    rows: [[f64; 4]; 4],
    /// fx fy cx cy skew k1 k2 p1 p2 k3.
    lens: [f64; 10],
    size: (u32, u32),
}

impl Row {
    fn read(line: &str) -> Result<Self, String> {
        let mut fields = fields_of(line).into_iter();
        let mut next = |name: &str| fields.next().ok_or_else(|| format!("\"{name}\" missing"));
        let (photo, _, mesh) = (next("photo")?, next("object")?, next("mesh_file")?);
        let words = Words {
            direction: next("direction")?,
            camera_axes: next("camera_axes")?,
            length_unit: next("length_unit")?,
        };
        let mut numbers = [0.0; 22];
        for number in &mut numbers {
            let field = next("a number")?;
            *number = field
                .trim()
                .parse()
                .map_err(|_| format!("a number expected, found \"{}\"", shown(&field)))?;
        }
        let mut side = |name: &str| {
            let field = next(name)?;
            field
                .trim()
                .parse()
                .map_err(|_| format!("a {name} in pixels expected, found \"{}\"", shown(&field)))
        };
        let size = (side("width")?, side("height")?);
        let [a, b, c, d, e, f, g, h, i, x, y, z, lens @ ..] = numbers;
        let rows = [[a, b, c, x], [d, e, f, y], [g, h, i, z], [0.0, 0.0, 0.0, 1.0]];
        Ok(Self { photo, mesh, words, rows, lens, size })
    }
}

fn shown(text: &str) -> String {
    text.chars().take(20).collect()
}

/// The fields of a line of CSV (RFC 4180); a quoted one may hold commas and doubled quotes.
fn fields_of(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut is_quoted = false;
    let mut characters = line.chars().peekable();
    while let Some(c) = characters.next() {
        let Some(field) = fields.last_mut() else { break };
        match c {
            '"' if is_quoted && characters.peek() == Some(&'"') => {
                characters.next();
                field.push('"');
            }
            '"' => is_quoted = !is_quoted,
            ',' if !is_quoted => fields.push(String::new()),
            _ => field.push(c),
        }
    }
    fields
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::IncomingCamera;

    fn pose() -> Pose {
        Pose::exp(DVec3::new(0.3, -0.9, 0.4), DVec3::new(12.0, -30.0, 640.0))
    }

    fn conventions() -> impl Iterator<Item = Convention> {
        [CameraAxes::OpenCv, CameraAxes::OpenGl].into_iter().flat_map(|axes| {
            [LengthUnit::Millimetre, LengthUnit::Metre].into_iter().flat_map(move |unit| {
                [PoseDirection::CameraFromObject, PoseDirection::ObjectFromCamera]
                    .map(|direction| Convention { axes, unit, direction })
            })
        })
    }

    fn csv(convention: Convention) -> String {
        let [x, y, z, _] = convention.rows(&pose());
        let numbers = [x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2], x[3], y[3], z[3]];
        let numbers = numbers.map(|number| number.to_string()).join(",");
        let names = [convention.direction.name(), convention.axes.name(), convention.unit.name()].join(",");
        format!(
            "{CSV_START}r11…\n\"a, \"\"b\"\".png\",mug,mug.ply,{names},{numbers},500,501,320,240,0,0.1,0,0,0,0,640,480,posed,manual,0\n"
        )
    }

    #[test]
    fn every_convention_leads_back() {
        for convention in conventions() {
            let incoming = read_poses_csv("poses.csv", &csv(convention)).unwrap();
            assert_eq!(incoming.photos[0].key, FileKey::Path("a, \"b\".png".to_owned()));
            let found = incoming.photos[0].poses[0].camera_from_object;
            // A few products of numbers below 1e3.
            assert!(found.translation_mm.distance(pose().translation_mm) < 1e-10, "{convention:?}");
            assert!(found.rotation.abs_diff_eq(pose().rotation, 1e-14), "{convention:?}");
            let Some(IncomingCamera::File(camera)) = &incoming.photos[0].camera else { panic!("no camera") };
            assert_eq!((camera.k[1][1], camera.distortion.k1, camera.size), (501.0, 0.1, Some((640, 480))));
        }
        let ours = read_poses_csv("poses.csv", &csv(Convention::default())).unwrap();
        assert_eq!(ours.photos[0].poses[0].camera_from_object, pose(), "in our convention bit for bit");
    }

    #[test]
    fn broken_rows_say_their_line() {
        let message = |text: String| read_poses_csv("p.csv", &text).unwrap_err().to_string();
        let whole = csv(Convention::default());
        assert!(
            message(whole.replace(",opencv,", ",blender,"))
                .contains("line 2: \"camera_axes\": \"blender\" is unknown")
        );
        assert!(message(whole.replace(",640,480,", ",wide,480,")).contains("width"));
        assert!(message(whole.replace(",500,501,", ",0,501,")).contains("fx is 0"));
        assert!(message(whole[..whole.len() - 60].to_owned()).contains("line 2"));
    }
}
