//! Every small format and every photo's, cut short and with bytes changed at random: an error or something bounded comes
//! back, and no panic. Meshes have their own corpus.

use std::io::Cursor;
use std::sync::Arc;

use image::{DynamicImage, ImageFormat};
use pinpose::formats::dataset::{Contents, Listing, recognise};
use pinpose::formats::{Archive, NamedFile, classify, parse_text_or_archive};
use pinpose::photo::{decode, decode_depth, read_header};

/// So many changed files of each format.
const FLIPS: usize = 10_000;

/// Numbers that are the same in every run. Source: Vigna's SplitMix64.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    fn one_of<'a, T>(&mut self, values: &'a [T]) -> &'a T {
        &values[self.below(values.len())]
    }
}

/// Gives a file to `read` cut short at every 64th byte, and with one to four bytes changed.
fn damage(whole: &[u8], flips: usize, read: impl Fn(&[u8])) {
    for length in (0..whole.len()).step_by(64) {
        read(&whole[..length]);
    }
    let mut numbers = Numbers(5);
    for _ in 0..flips {
        let mut changed = whole.to_vec();
        for _ in 0..=numbers.below(4) {
            let position = numbers.below(changed.len());
            changed[position] = match numbers.below(3) {
                0 => numbers.next() as u8,
                1 => changed[position] ^ (1 << numbers.below(8)),
                // What texts and headers are made of.
                _ => *numbers.one_of(b"0123456789-.,:[]{}\"' \n\0\xff"),
            };
        }
        read(&changed);
    }
}

/// Reads a file as a drop would, and whatever it turns out to be.
fn read_as_dropped(name: &str, bytes: &[u8]) {
    let file = NamedFile { name: name.to_owned(), bytes: bytes.into() };
    // What matters is that it returns.
    let _ = parse_text_or_archive(&file, classify(name, bytes));
}

const CAMERA: &str =
    r#"{"fx": 572.4, "fy": 573.5, "cx": 325.2, "cy": 242.0, "width": 640, "height": 480, "k1": 0.1}"#;
const POSE: &str = "[[1, 0, 0, 10.5],\n [0, 1, 0, -2],\n [0, 0, 1, 900],\n [0, 0, 0, 1]]";

#[test]
fn texts() {
    let identity = "1, 0, 0, 0, 1, 0, 0, 0, 1";
    let files: [(&str, String); 12] = [
        ("camera.json", CAMERA.to_owned()),
        (
            "K.json",
            format!(r#"{{"K": [{identity}], "distortion": [0.1, 0, 0, 0, 0], "resolution": [480, 640]}}"#),
        ),
        (
            "scene_gt.json",
            format!(r#"{{"5": [{{"cam_R_m2c": [{identity}], "cam_t_m2c": [1, 2, 700], "obj_id": 9}}]}}"#),
        ),
        ("scene_camera.json", format!(r#"{{"5": {{"cam_K": [{identity}], "depth_scale": 1.0}}}}"#)),
        (
            "poses.json",
            format!(r#"{{"a.jpg": [{{"obj": "duck.obj", "R": [{identity}], "t": [1, 2, 10.5]}}]}}"#),
        ),
        (
            "object_data.json",
            r#"[{"label": "mug", "TWO": [[0, 0, 0.6, 0.8], [0.1, 0.2, 0.5]], "score": 1}]"#.to_owned(),
        ),
        (
            "workspace.json",
            format!(r#"{{"image_path": {{"a": "a.png"}}, "mesh_path": {{"m": ["m.ply", {POSE}]}}}}"#),
        ),
        ("pose.json", POSE.to_owned()),
        ("truth.txt", format!("{CAMERA}\n\nobj_000001 <-> 000019\n{POSE}\n")),
        (
            "results.csv",
            "scene_id,im_id,obj_id,score,R,t,time\n2,764,5,0.25,1 0 0 0 1 0 0 0 1,1 2 600,-1\n".to_owned(),
        ),
        ("K.txt", "572.4 0 325.2\n0 573.5 242.0\n0 0 1\n".to_owned()),
        (
            "camera.yml",
            format!(
                "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n\
                 \x20  dt: d\n   data: [ {identity} ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n\
                 \x20  data: [ 0.1, 0., 0., 0., 0. ]\n"
            ),
        ),
    ];
    for (name, text) in files {
        read_as_dropped(name, text.as_bytes());
        damage(text.as_bytes(), FLIPS, |bytes| read_as_dropped(name, bytes));
    }
}

#[test]
fn arrays() {
    let mut header = b"{'descr': '<f8', 'fortran_order': True, 'shape': (2, 4, 4), }".to_vec();
    header.resize(117, b' ');
    header.push(b'\n');
    let mut whole = b"\x93NUMPY\x01\0\x76\0".to_vec();
    whole.extend(header);
    whole.extend([0_f64, 1.0, 0.5, 100.0].repeat(8).iter().flat_map(|number| number.to_le_bytes()));
    read_as_dropped("poses.npy", &whole);
    damage(&whole, FLIPS, |bytes| read_as_dropped("poses.npy", bytes));
}

#[test]
fn photos() {
    let picture =
        image::RgbImage::from_fn(40, 30, |x, y| image::Rgb([6 * x as u8, 8 * y as u8, (x ^ y) as u8]));
    let picture = DynamicImage::from(picture);
    for format in
        [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::WebP, ImageFormat::Bmp, ImageFormat::Tiff]
    {
        let mut whole = Vec::new();
        picture.write_to(&mut Cursor::new(&mut whole), format).unwrap();
        damage(&whole, FLIPS, |bytes| {
            let header = read_header(bytes);
            if let Ok(photo) = decode(bytes) {
                let pixels = photo.pixels;
                assert_eq!(pixels.rgba.len(), 4 * pixels.width as usize * pixels.height as usize);
                let header = header.unwrap();
                assert_eq!((pixels.width, pixels.height), (header.width, header.height));
            }
        });
    }
    let mut whole = Vec::new();
    DynamicImage::from(picture.to_luma16()).write_to(&mut Cursor::new(&mut whole), ImageFormat::Png).unwrap();
    damage(&whole, FLIPS, |bytes| {
        if let Ok(depth) = decode_depth(bytes) {
            assert_eq!(depth.raw.len(), depth.width as usize * depth.height as usize);
        }
    });
}

#[test]
fn archives() {
    use std::io::Write;
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in [("camera.json", CAMERA), ("a/b.txt", POSE)] {
        writer.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        writer.write_all(text.as_bytes()).unwrap();
    }
    let whole = writer.finish().unwrap().into_inner();
    damage(&whole, FLIPS, |bytes| {
        let Ok(mut archive) = Archive::open(bytes.into()) else { return };
        let Ok(listing) = archive.listing("zip") else { return };
        for path in listing.paths() {
            if let Ok(content) = archive.read(path) {
                assert!(content.len() < 1 << 20, "{path} grew to {} bytes", content.len());
            }
        }
    });
}

#[test]
fn data_sets() {
    let identity = "1,0,0,0,1,0,0,0,1";
    let files = [
        (
            "1/scene_gt.json",
            format!(r#"{{"3": [{{"cam_R_m2c": [{identity}], "cam_t_m2c": [0,0,700], "obj_id": 5}}]}}"#),
        ),
        ("1/scene_camera.json", format!(r#"{{"3": {{"cam_K": [{identity}], "depth_scale": 0.1}}}}"#)),
        (
            "models/models_info.json",
            r#"{"5": {"diameter": 1, "symmetries_discrete": [[-1,0,0,0,0,-1,0,0,0,0,1,0,0,0,0,1]],
                "symmetries_continuous": [{"axis": [0, 0, 1], "offset": [0, 0, 0]}]}}"#
                .to_owned(),
        ),
    ];
    let names = ["1/rgb/000003.png", "1/mask/000003_000000.png", "models/obj_000005.ply"];
    let all = names.into_iter().chain(files.iter().map(|(path, _)| *path));
    let listing = Arc::new(Listing::new("set", all.map(|path| (path.to_owned(), 100))).unwrap());
    let recognised = recognise(&listing).unwrap();
    let whole: Contents =
        files.iter().map(|(path, text)| ((*path).to_owned(), Arc::from(text.as_bytes()))).collect();
    for (path, text) in &files {
        damage(text.as_bytes(), FLIPS, |bytes| {
            let mut contents = whole.clone();
            contents.insert((*path).to_owned(), bytes.into());
            // Whatever happens to its small files, the photo can be opened.
            assert_eq!(recognised.interpret(&[0], &contents).unwrap().photos.len(), 1);
        });
    }
}
