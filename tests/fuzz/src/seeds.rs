//! Small whole files of each format: what the fuzzers begin with, and what the tests of damaged files damage.

use std::io::{Cursor, Write};

use image::{DynamicImage, ImageFormat};

/// Between the parts of a seed.
pub const SEPARATOR: u8 = 0x1e;

pub const CAMERA: &str =
    r#"{"fx": 572.4, "fy": 573.5, "cx": 325.2, "cy": 242.0, "width": 640, "height": 480, "k1": 0.1}"#;
pub const POSE: &str = "[[1, 0, 0, 10.5],\n [0, 1, 0, -2],\n [0, 0, 1, 900],\n [0, 0, 0, 1]]";
const IDENTITY: &str = "1, 0, 0, 0, 1, 0, 0, 0, 1";

const OBJ: &str = "mtllib m.mtl\nv 0 0 0\nv 1 0 0 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvn 0 0 1\nusemtl a\n\
    f 1/1/1 2/2/1 3/1/1\nusemtl b\nf -1//1 -2//1 -3//1\nf 1 2 3 4\n";
const MTL: &str = "newmtl a\nKd 1 0 0\nmap_Kd t.png\nnewmtl b\nKd 0.5 0.5 0.5\nd 0.5\n";
const OFF: &str = "COFF\n# four\n4 2 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n0 1 0 0 0 255 255\n0 0 1 9 9 9 255\n\
    3 0 1 2\n4 0 1 2 3 0.5 0.5 0.5\n";
const STL: &str = "solid a\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1e0 0\n\
    \x20 endloop\n endfacet\nendsolid a\n";
const GLTF: &str = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
"nodes": [{"children": [1], "translation": [1, 2, 3]}, {"mesh": 0, "rotation": [0, 0, 0, 1]}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
"materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1], "baseColorTexture": {"index": 0}}}],
"textures": [{"source": 0}], "images": [{"uri": "t.png"}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
{"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
"buffers": [{"byteLength": 44, "uri": "b.bin"}]}"#;
const DOCUMENT: &str = include_str!("../document.json");

/// The files of each target.
pub fn by_target() -> Vec<(&'static str, Vec<Vec<u8>>)> {
    let texts = |names: &[&str]| -> Vec<Vec<u8>> {
        let wanted = texts().into_iter().filter(|(name, _)| names.contains(name));
        wanted.map(|(_, text)| text.into_bytes()).collect()
    };
    let cameras = ["camera.json", "K.json", "camera.yml", "K.txt", "scene_camera.json"];
    let pose_files = [
        "poses.json",
        "object_data.json",
        "workspace.json",
        "pose.json",
        "truth.txt",
        "results.csv",
        "poses.csv",
    ];
    let data_set: Vec<Vec<u8>> = data_set().into_iter().map(|(_, text)| text.into_bytes()).collect();
    vec![
        ("ply", ply_files()),
        ("obj", vec![joined(&[OBJ.as_bytes(), MTL.as_bytes()])]),
        ("stl", vec![STL.as_bytes().to_vec(), stl_binary()]),
        ("gltf", vec![joined(&[GLTF.as_bytes(), &gltf_buffer()]), glb()]),
        ("off", vec![OFF.as_bytes().to_vec()]),
        ("photo", photos().into_iter().map(|(_, bytes)| bytes).collect()),
        ("depth", vec![depth()]),
        ("camera", [texts(&cameras), vec![npy()]].concat()),
        ("poses", [texts(&pose_files), vec![npy()]].concat()),
        (
            "scene_gt",
            vec![joined(&[&data_set[0], &data_set[1], &data_set[2]]), texts(&["scene_gt.json"]).concat()],
        ),
        ("document", vec![DOCUMENT.as_bytes().to_vec()]),
        ("archive", vec![zipped(&[("camera.json", CAMERA), ("a/b.txt", POSE)]), workspace()]),
        ("dataset", data_sets()),
    ]
}

/// A text of each kind, by the name it would be dropped under.
pub fn texts() -> Vec<(&'static str, String)> {
    vec![
        ("camera.json", CAMERA.to_owned()),
        (
            "K.json",
            format!(r#"{{"K": [{IDENTITY}], "distortion": [0.1, 0, 0, 0, 0], "resolution": [480, 640]}}"#),
        ),
        (
            "scene_gt.json",
            format!(r#"{{"5": [{{"cam_R_m2c": [{IDENTITY}], "cam_t_m2c": [1, 2, 700], "obj_id": 9}}]}}"#),
        ),
        ("scene_camera.json", format!(r#"{{"5": {{"cam_K": [{IDENTITY}], "depth_scale": 1.0}}}}"#)),
        (
            "poses.json",
            format!(r#"{{"a.jpg": [{{"obj": "duck.obj", "R": [{IDENTITY}], "t": [1, 2, 10.5]}}]}}"#),
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
        (
            "poses.csv",
            "photo,object,mesh_file,direction,camera_axes,length_unit,r11,r12,r13,r21,r22,r23,r31,r32,r33,tx,ty,tz\n\
             a.png,duck,duck.ply,camera_from_object,opencv,mm,1,0,0,0,1,0,0,0,1,0,0,900\n"
                .to_owned(),
        ),
        ("K.txt", "572.4 0 325.2\n0 573.5 242.0\n0 0 1\n".to_owned()),
        (
            "camera.yml",
            format!(
                "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   \
                 cols: 3\n   dt: d\n   data: [ {IDENTITY} ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 1\n   \
                 cols: 5\n   data: [ 0.1, 0., 0., 0., 0. ]\n"
            ),
        ),
    ]
}

/// Two poses, in Fortran's order.
pub fn npy() -> Vec<u8> {
    let mut header = b"{'descr': '<f8', 'fortran_order': True, 'shape': (2, 4, 4), }".to_vec();
    header.resize(117, b' ');
    header.push(b'\n');
    let mut whole = b"\x93NUMPY\x01\0\x76\0".to_vec();
    whole.extend(header);
    whole.extend([0_f64, 1.0, 0.5, 100.0].repeat(8).iter().flat_map(|number| number.to_le_bytes()));
    whole
}

/// One picture in each format.
pub fn photos() -> Vec<(ImageFormat, Vec<u8>)> {
    let formats =
        [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::WebP, ImageFormat::Bmp, ImageFormat::Tiff];
    formats.map(|format| (format, encoded(&picture(), format))).to_vec()
}

pub fn depth() -> Vec<u8> {
    encoded(&DynamicImage::from(picture().to_luma16()), ImageFormat::Png)
}

/// A texture of one pixel.
pub fn pixel_png() -> Vec<u8> {
    encoded(&DynamicImage::new_rgb8(1, 1), ImageFormat::Png)
}

fn picture() -> DynamicImage {
    let color = |x, y| image::Rgb([6 * x as u8, 8 * y as u8, (x ^ y) as u8]);
    DynamicImage::from(image::RgbImage::from_fn(40, 30, color))
}

fn encoded(picture: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut whole = Vec::new();
    picture.write_to(&mut Cursor::new(&mut whole), format).expect("a small picture can be encoded");
    whole
}

/// The small files of a BOP data set with one photo, by their paths.
pub fn data_set() -> [(&'static str, String); 3] {
    [
        (
            "1/scene_gt.json",
            format!(r#"{{"3": [{{"cam_R_m2c": [{IDENTITY}], "cam_t_m2c": [0,0,700], "obj_id": 5}}]}}"#),
        ),
        ("1/scene_camera.json", format!(r#"{{"3": {{"cam_K": [{IDENTITY}], "depth_scale": 0.1}}}}"#)),
        (
            "models/models_info.json",
            r#"{"5": {"diameter": 1, "symmetries_discrete": [[-1,0,0,0,0,-1,0,0,0,0,1,0,0,0,0,1]],
                "symmetries_continuous": [{"axis": [0, 0, 1], "offset": [0, 0, 0]}]}}"#
                .to_owned(),
        ),
    ]
}

pub fn zipped(files: &[(&str, &str)]) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in files {
        writer.start_file(*name, zip::write::SimpleFileOptions::default()).expect("a name");
        writer.write_all(text.as_bytes()).expect("memory takes it");
    }
    writer.finish().expect("memory takes it").into_inner()
}

fn workspace() -> Vec<u8> {
    let mesh = "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n";
    zipped(&[
        ("scene.json", DOCUMENT),
        ("meshes/1/a.ply", mesh),
        ("meshes/1/t.png", "png"),
        ("photos/2/b.png", ""),
    ])
}

/// Ascii and both binaries, with colours, normals, texture coordinates and a polygon.
fn ply_files() -> Vec<Vec<u8>> {
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\ncomment TextureFile t.png\nelement vertex 4\nproperty float x\nproperty float y\n\
             property double z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty uchar red\n\
             property uchar green\nproperty uchar blue\nelement face 2\nproperty list uchar int vertex_indices\n\
             property list uchar float texcoord\nend_header\n"
        )
    };
    let vertices = [[0_i8, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
    let faces: [&[i32]; 2] = [&[0, 1, 2], &[0, 1, 2, 3]];
    let mut ascii = header("ascii");
    for [x, y, z] in vertices {
        ascii += &format!("{x} {y} {z}.5 0 0 1 9 99 255\n");
    }
    ascii += "3 0 1 2 6 0 0 1 0 0 1\n4 0 1 2 3 8 0 0 1 0 0 1 1 1\n";
    let binary = |is_little: bool| {
        let name = if is_little { "binary_little_endian" } else { "binary_big_endian" };
        let mut whole = header(name).into_bytes();
        let put = |whole: &mut Vec<u8>, little: &[u8]| {
            let ordered: Vec<u8> =
                if is_little { little.to_vec() } else { little.iter().rev().copied().collect() };
            whole.extend(ordered);
        };
        for [x, y, z] in vertices {
            put(&mut whole, &f32::from(x).to_le_bytes());
            put(&mut whole, &f32::from(y).to_le_bytes());
            put(&mut whole, &f64::from(z).to_le_bytes());
            for normal in [0_f32, 0.0, 1.0] {
                put(&mut whole, &normal.to_le_bytes());
            }
            whole.extend([9, 99, 255]);
        }
        for corners in faces {
            whole.push(corners.len() as u8);
            corners.iter().for_each(|corner| put(&mut whole, &corner.to_le_bytes()));
            whole.push(2 * corners.len() as u8);
            (0..2 * corners.len()).for_each(|_| put(&mut whole, &0.5_f32.to_le_bytes()));
        }
        whole
    };
    vec![ascii.into_bytes(), binary(true), binary(false)]
}

fn stl_binary() -> Vec<u8> {
    let mut whole = vec![0; 80];
    whole.extend(1_u32.to_le_bytes());
    for number in [0_f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        whole.extend(number.to_le_bytes());
    }
    whole.extend([0, 0]);
    whole
}

fn gltf_buffer() -> Vec<u8> {
    let positions = [0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut buffer: Vec<u8> = positions.iter().flat_map(|number| number.to_le_bytes()).collect();
    buffer.extend([0, 0, 1, 0, 2, 0, 0, 0]);
    buffer
}

fn glb() -> Vec<u8> {
    let mut json = GLTF
        .replace(r#", "uri": "b.bin""#, "")
        .replace(r#""uri": "t.png""#, r#""uri": "data:,""#)
        .into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let buffer = gltf_buffer();
    let mut whole = b"glTF\x02\0\0\0".to_vec();
    whole.extend((28 + json.len() as u32 + buffer.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", buffer)] {
        whole.extend((chunk.len() as u32).to_le_bytes());
        whole.extend(kind);
        whole.extend(chunk);
    }
    whole
}

/// Each layout, as paths and contents by turns.
fn data_sets() -> Vec<Vec<u8>> {
    let [truth, camera, info] = data_set();
    let bop = [
        ("1/rgb/000003.png", ""),
        ("1/mask/000003_000000.png", ""),
        ("models/obj_000005.ply", ""),
        (truth.0, &truth.1),
        (camera.0, &camera.1),
        (info.0, &info.1),
    ];
    let linemod = [
        ("data/color0.jpg", ""),
        ("data/rot0.rot", "3 3\n1 0 0\n0 1 0\n0 0 1\n"),
        ("data/tra0.tra", "1 3\n0\n0\n90\n"),
        ("mesh.ply", ""),
        ("transform.dat", "12\n0 1\n1 0\n2 0\n3 0\n"),
    ];
    let megapose = [
        ("image_rgb.png", ""),
        ("camera_data.json", r#"{"K": [[605, 0, 319], [0, 605, 249], [0, 0, 1]], "resolution": [480, 640]}"#),
        ("inputs/object_data.json", r#"[{"label": "mug", "bbox_modal": [1, 2, 3, 4]}]"#),
        ("meshes/mug/mug.ply", ""),
    ];
    let folder = [("a.png", ""), ("duck.ply", ""), ("camera.json", CAMERA), ("a.json", POSE)];
    let sets: [&[(&str, &str)]; 4] = [&bop, &linemod, &megapose, &folder];
    let set = |files: &&[(&str, &str)]| {
        let parts: Vec<&[u8]> =
            files.iter().flat_map(|(path, content)| [path.as_bytes(), content.as_bytes()]).collect();
        joined(&parts)
    };
    sets.iter().map(set).collect()
}

fn joined(parts: &[&[u8]]) -> Vec<u8> {
    parts.join(&SEPARATOR)
}
