use proptest::prelude::*;

use glam::Vec2;

use crate::mesh::load::{Parsed, Source};
use crate::mesh::test_shapes::{Folder, checker_png};
use crate::mesh::{LoadedMesh, MeshError, companion_names, load, no_companions};

fn parse(bytes: &[u8]) -> Result<Parsed, MeshError> {
    super::parse(&Source { file_name: "a.ply", bytes, find: &no_companions })
}

/// A small mesh and how to write it as PLY.
#[derive(Debug, Clone)]
struct Sample {
    positions: Vec<[f32; 3]>,
    colors: Vec<[u8; 3]>,
    polygons: Vec<Vec<u32>>,
    /// Writes properties and elements that nobody asked for, and the face element first.
    is_odd: bool,
}

#[derive(Debug, Clone, Copy)]
enum Encoding {
    Ascii,
    Little,
    Big,
}

const ENCODINGS: [Encoding; 3] = [Encoding::Ascii, Encoding::Little, Encoding::Big];

struct Writer {
    encoding: Encoding,
    bytes: Vec<u8>,
}

impl Writer {
    fn value<const N: usize>(&mut self, shown: impl ToString, little_endian: [u8; N]) {
        match self.encoding {
            Encoding::Ascii => self.bytes.extend([shown.to_string().as_bytes(), b" "].concat()),
            Encoding::Little => self.bytes.extend(little_endian),
            Encoding::Big => self.bytes.extend(little_endian.iter().rev()),
        }
    }

    fn byte(&mut self, value: u8) {
        self.value(value, [value]);
    }

    fn end_row(&mut self) {
        if matches!(self.encoding, Encoding::Ascii) {
            self.bytes.push(b'\n');
        }
    }
}

impl Sample {
    fn vertex_header(&self) -> String {
        let count = self.positions.len();
        let odd = if self.is_odd { "property list uint8 short extra\nproperty double quality\n" } else { "" };
        format!(
            "element vertex {count}\n{odd}property uchar red\nproperty float x\nproperty double y\nproperty float32 z\n\
             property uchar green\nproperty uint8 blue\n"
        )
    }

    fn face_header(&self) -> String {
        let count = self.polygons.len();
        let odd = if self.is_odd { "property char kind\nproperty list uchar float texcoord\n" } else { "" };
        format!("element face {count}\n{odd}property list uchar int vertex_indices\n")
    }

    fn write_vertices(&self, writer: &mut Writer) {
        for (&[x, y, z], &[r, g, b]) in self.positions.iter().zip(&self.colors) {
            if self.is_odd {
                writer.byte(2);
                writer.value(-7, (-7_i16).to_le_bytes());
                writer.value(300, 300_i16.to_le_bytes());
                writer.value(0.5, 0.5_f64.to_le_bytes());
            }
            writer.byte(r);
            writer.value(x, x.to_le_bytes());
            writer.value(y, f64::from(y).to_le_bytes());
            writer.value(z, z.to_le_bytes());
            writer.byte(g);
            writer.byte(b);
            writer.end_row();
        }
    }

    fn write_faces(&self, writer: &mut Writer) {
        for polygon in &self.polygons {
            if self.is_odd {
                writer.value(-1, (-1_i8).to_le_bytes());
                writer.byte(1);
                writer.value(0.25, 0.25_f32.to_le_bytes());
            }
            writer.byte(polygon.len() as u8);
            for &index in polygon {
                writer.value(index, index.to_le_bytes());
            }
            writer.end_row();
        }
    }

    fn write(&self, encoding: Encoding) -> Vec<u8> {
        let name = match encoding {
            Encoding::Ascii => "ascii",
            Encoding::Little => "binary_little_endian",
            Encoding::Big => "binary_big_endian",
        };
        let [first, second] = if self.is_odd {
            [self.face_header(), self.vertex_header()]
        } else {
            [self.vertex_header(), self.face_header()]
        };
        let header = format!(
            "ply\nformat {name} 1.0\ncomment a comment\ncomment TextureFile t.png\n{first}{second}end_header\n"
        );
        let mut writer = Writer { encoding, bytes: header.into_bytes() };
        if self.is_odd {
            self.write_faces(&mut writer);
            self.write_vertices(&mut writer);
        } else {
            self.write_vertices(&mut writer);
            self.write_faces(&mut writer);
        }
        writer.bytes
    }
}

fn sample() -> impl Strategy<Value = Sample> {
    (3_usize..20).prop_flat_map(|count| {
        let coordinate = -1e6_f32..1e6;
        (
            prop::collection::vec([coordinate.clone(), coordinate.clone(), coordinate], count),
            prop::collection::vec(any::<[u8; 3]>(), count),
            prop::collection::vec(prop::collection::vec(0..count as u32, 3..7), 1..20),
            any::<bool>(),
        )
            .prop_map(|(positions, colors, polygons, is_odd)| Sample {
                positions,
                colors,
                polygons,
                is_odd,
            })
    })
}

proptest! {
    #[test]
    fn every_encoding_reads_back(sample in sample()) {
        for encoding in ENCODINGS {
            let data = parse(&sample.write(encoding)).unwrap().data;
            let positions: Vec<[f32; 3]> = data.positions_mm.iter().map(glam::Vec3::to_array).collect();
            prop_assert_eq!(&positions, &sample.positions);
            let colors: Vec<[u8; 3]> = data.colors.unwrap().iter().map(|&[r, g, b, _]| [r, g, b]).collect();
            prop_assert_eq!(&colors, &sample.colors);
            let fans: Vec<[u32; 3]> = sample
                .polygons
                .iter()
                .flat_map(|polygon| polygon.windows(2).skip(1).map(|pair| [polygon[0], pair[0], pair[1]]))
                .collect();
            prop_assert_eq!(&data.triangles, &fans);
        }
    }

    #[test]
    fn broken_files_never_panic(
        sample in sample(),
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4),
        kept in any::<prop::sample::Index>(),
        is_cut in any::<bool>(),
    ) {
        let checker: std::sync::Arc<[u8]> = checker_png().into();
        for encoding in ENCODINGS {
            let mut bytes = sample.write(encoding);
            for (at, byte) in &flips {
                let at = at.index(bytes.len());
                bytes[at] = *byte;
            }
            if is_cut {
                bytes.truncate(kept.index(bytes.len()));
            }
            let _ = load("broken.ply", &bytes, &|_| Some(checker.clone()));
        }
    }
}

fn message(text: &str) -> String {
    parse(text.as_bytes()).unwrap_err().to_string()
}

const VERTICES: &str =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";

#[test]
fn normals_and_float_colors_are_read() {
    let extra = "property float nx\nproperty float ny\nproperty float nz\n\
                 property float red\nproperty float green\nproperty float blue\nproperty uchar alpha\n";
    let text = format!(
        "{VERTICES}{extra}element face 1\nproperty list uchar int vertex_index\nend_header\n\
         0 0 0 0 0 1 1 0.5 0 7\n1 0 0 0 0 1 0 0 0 8\n0 1 0 0 0 1 0 0 0 9\n3 0 1 2"
    );
    let data = parse(text.as_bytes()).unwrap().data;
    assert_eq!(data.normals.unwrap(), [glam::Vec3::Z; 3]);
    assert_eq!(data.colors.unwrap()[0], [255, 128, 0, 7]);
}

#[test]
fn messages_say_where() {
    let faces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n";
    let cut = message(&format!("{VERTICES}{faces}0 1 0\n3 0 1 \n"));
    assert!(cut.starts_with("PLY, line 13: the file ends here"), "{cut}");
    let word = message(&format!("{VERTICES}{faces}0 one 0\n3 0 1 2\n"));
    assert_eq!(word, "PLY, line 12: expected a number, found “one”");
    let index = message(&format!("{VERTICES}{faces}0 1 0\n3 0 1 3\n"));
    assert!(index.starts_with("PLY, line 13: a face names vertex 3"), "{index}");
    let no_faces = message(&format!("{VERTICES}end_header\n"));
    assert!(no_faces.starts_with("no faces: 3 vertices"), "{no_faces}");
    assert!(
        message("ply\nformat ascii 1.0\nelement vertex many\n").starts_with("PLY, line 3: expected a count")
    );
}

#[test]
fn rows_may_wrap_and_may_hold_more_than_was_announced() {
    let faces =
        "element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0 9\n1 0\n0\n\n0 1 0\n";
    let parsed = parse(format!("{VERTICES}{faces}3 0\n1 2\n3 2 1 0 6 0.5 0.5").as_bytes()).unwrap();
    assert_eq!(parsed.data.triangles, [[0, 1, 2], [2, 1, 0]]);
    assert_eq!(parsed.warnings.len(), 2, "{:?}", parsed.warnings);
}

#[test]
fn a_boastful_header_is_refused_before_anything_is_allocated() {
    for (vertices, faces) in [(4_000_000_000_u64, 1), (3, 4_000_000_000_u64), (u64::MAX, 1)] {
        let text = format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
             property float z\nelement face {faces}\nproperty list uint int vertex_indices\nend_header\n\
             {}",
            "\0".repeat(40)
        );
        assert!(message(&text).contains("rows of element"), "{}", message(&text));
    }
    let list = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uchar x\nproperty uchar y\n\
                property uchar z\nelement face 1\nproperty list uint int vertex_indices\nend_header\n\0\0\0~~~~";
    assert!(message(list).contains("a list of"), "{}", message(list));
}

const SQUARE: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

fn square(header: &str, faces: &str) -> String {
    let vertices =
        VERTICES.replace("vertex 3", "vertex 4").replace("1.0\n", "1.0\ncomment TextureFile  my tex.PNG \n");
    format!(
        "{vertices}element face 1\nproperty list uchar int vertex_indices\n{header}end_header\n{SQUARE}{faces}\n"
    )
}

fn load_beside_texture(text: &str) -> LoadedMesh {
    let folder = Folder::of(&[("My Tex.png", &checker_png())]);
    load("a.ply", text.as_bytes(), &|key| folder.find(key)).unwrap()
}

#[test]
fn corners_of_faces_have_texture_coordinates() {
    let text = square("property list uchar float texcoord\n", "4 0 1 2 3 8 0 0 1 0 1 1 0 1");
    let LoadedMesh { mesh, warnings } = load_beside_texture(&text);
    assert_eq!(warnings, Vec::<String>::new());
    let paint = mesh.paint().unwrap();
    // v is up in the file.
    let [low_left, low_right, top_right, top_left] = [Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO];
    assert_eq!(paint.corner_uvs, [[low_left, low_right, top_right], [low_left, top_right, top_left]]);
    assert_eq!((paint.textures.len(), paint.textures[0].width), (1, 2));
    assert_eq!(companion_names("a.ply", text.as_bytes(), &no_companions), ["my tex.png"]);
}

#[test]
fn vertices_have_texture_coordinates_by_three_names() {
    for (u, v) in [("texture_u", "texture_v"), ("s", "t"), ("u", "v")] {
        let uvs = format!(
            "property float z\nproperty float {u}\nproperty float {v}\nproperty uchar red\n\
                           property uchar green\nproperty uchar blue\n"
        );
        let text = format!(
            "{VERTICES}element face 1\nproperty list uchar int vertex_indices\nend_header\n\
             0 0 0 0.25 1 9 9 9\n1 0 0 0 0 9 9 9\n0 1 0 1 nan 9 9 9\n3 0 1 2\n"
        )
        .replace("property float z\n", &uvs);
        let mesh = load_beside_texture(&text.replace("1.0\n", "1.0\ncomment TextureFile my tex.png\n")).mesh;
        assert_eq!(mesh.paint().unwrap().corner_uvs, [[Vec2::new(0.25, 0.0), Vec2::Y, Vec2::ZERO]]);
        assert_eq!(mesh.colors(), None);
        let alone = load("a.ply", text.as_bytes(), &no_companions).unwrap();
        assert_eq!((alone.mesh.paint(), alone.mesh.has_colors()), (None, true));
    }
}

#[test]
fn a_missing_texture_is_one_warning() {
    let text = square("property list uchar float texcoord\n", "4 0 1 2 3 2 0 0");
    let LoadedMesh { mesh, warnings } = load("a.ply", text.as_bytes(), &no_companions).unwrap();
    assert!(warnings.len() == 1 && warnings[0].contains("“my tex.PNG”"), "{warnings:?}");
    assert!(!mesh.has_colors());
}

#[test]
fn faces_have_colors() {
    let text =
        square("property uchar red\nproperty uchar green\nproperty uchar blue\n", "4 0 1 2 3 255 128 0");
    let mesh = load("a.ply", text.as_bytes(), &no_companions).unwrap().mesh;
    assert_eq!(mesh.paint().unwrap().materials[0].base_color, [255, 128, 0, 255]);
    assert_eq!(mesh.paint().unwrap().material_of_triangle, [0, 0]);
}
