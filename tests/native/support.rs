//! What several tests need: the folder of real photographs, a GPU, Python, the command line, small scenes.

use std::path::{Path, PathBuf};
use std::process::{Command as Program, Output};
use std::sync::Arc;

use pinpose::formats::{NamedFile, Parsed, PosesAs, classify, parse_text_or_archive, read_mesh, read_photo};
use pinpose::interact::Hands;
use pinpose::render::Renderer;
use pinpose::session::{Batch, Command, Effect, Session};
use pinpose::ui::{Saving, StoreView, Surroundings};

/// What is around an interface with nothing going on: no GPU, no decoded photo, nothing stored, nothing waited for.
pub fn quiet_surroundings(hands: &Hands) -> Surroundings<'_> {
    Surroundings {
        drawn_pose: None,
        symmetries: pinpose::ui::SymmetryView::default(),
        hands,
        renderer: None,
        pixels: None,
        masks: None,
        depth: None,
        saving: Saving::Saved,
        busy: None,
        builder: None,
        report: None,
        kept: None,
        update_ready: false,
        files_hover: false,
        dataset: None,
        scenes: &[],
        store: StoreView::default(),
    }
}

/// A time for commands: any fixed one replays the same.
pub const NOW_MS: f64 = 1_700_000_000_000.0;

/// A folder of real data beside the project. Where it is absent the test says so and passes for nothing; on a build server
/// that is a failure.
pub fn data_folder(name: &str) -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(name);
    if folder.is_dir() {
        return Some(folder);
    }
    missing(&format!("the data folder {name}"));
    None
}

/// A renderer on whatever GPU there is, real or in software.
pub fn renderer() -> Option<Renderer> {
    match Renderer::headless() {
        Ok(renderer) => Some(renderer),
        Err(error) => {
            missing(&error.to_string());
            None
        }
    }
}

/// Python with NumPy.
pub struct Python(String);

/// `None`, said aloud, where there is no Python with NumPy.
pub fn numpy() -> Option<Python> {
    let found = pinpose_web::python::with_numpy();
    if found.is_none() {
        missing("Python with NumPy");
    }
    found.map(Python)
}

impl Python {
    /// Runs one of the scripts in `tests/native/python`; what it prints.
    pub fn run(&self, script: &str, arguments: &[&str]) -> String {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/native/python").join(script);
        // Threads of a linear algebra library gain nothing here and spin while others work.
        let mut program = Program::new(&self.0);
        program.env("OMP_NUM_THREADS", "1").env("OPENBLAS_NUM_THREADS", "1");
        let output = program.arg(script).args(arguments).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }
}

/// Runs the command line.
pub fn pinpose(arguments: &[&str]) -> Output {
    Program::new(env!("CARGO_BIN_EXE_pinpose")).args(arguments).output().unwrap()
}

/// A folder for a test's files, empty.
pub fn empty_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::remove_dir_all(&folder).ok();
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn missing(what: &str) {
    assert!(std::env::var_os("CI").is_none(), "missing on a build server: {what}");
    eprintln!("ignored: {what} is not here");
}

pub fn named_file(path: &Path) -> NamedFile {
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    NamedFile { name, bytes: Arc::from(std::fs::read(path).unwrap()) }
}

/// What a drop of these files gives to the session.
pub fn batch_of(files: &[NamedFile], poses_as: Option<PosesAs>) -> Batch {
    let mut batch = Batch { poses_as, ..Batch::default() };
    for file in files {
        match classify(&file.name, &file.bytes) {
            pinpose::formats::FileKind::Photo => batch.photos.push(Arc::new(read_photo(file).unwrap().0)),
            pinpose::formats::FileKind::Mesh => batch.meshes.push(Arc::new(read_mesh(file).unwrap().0)),
            kind => match parse_text_or_archive(file, kind).unwrap() {
                Parsed::Camera(camera) => batch.cameras.push(camera),
                Parsed::Poses(poses) => batch.poses.push(poses),
                Parsed::Pins(pins) => batch.pins = Some(pins),
                other => panic!("{}: {other:?}", file.name),
            },
        }
    }
    batch
}

pub fn drop_files(session: &mut Session, files: &[NamedFile], poses_as: Option<PosesAs>) -> Vec<Effect> {
    session.apply(Command::Import(Box::new(batch_of(files, poses_as))), NOW_MS).unwrap()
}

/// All of linemod10, with the truth as annotations.
pub fn linemod_session() -> Option<Session> {
    let folder = data_folder("linemod10")?;
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| {
        let extension = path.extension().and_then(|extension| extension.to_str());
        matches!(extension, Some("png" | "ply")) || path.ends_with("groud_truth.txt")
    });
    paths.sort();
    let files: Vec<NamedFile> = paths.iter().map(|path| named_file(path)).collect();
    let mut session = Session::default();
    drop_files(&mut session, &files, Some(PosesAs::Annotations));
    Some(session)
}

/// A flat photo as a PNG file.
pub fn flat_photo(name: &str, width: u32, height: u32) -> NamedFile {
    let mut bytes = Vec::new();
    let picture = image::RgbImage::from_pixel(width, height, image::Rgb([90, 100, 110]));
    picture.write_to(&mut std::io::Cursor::new(&mut bytes), image::ImageFormat::Png).unwrap();
    NamedFile { name: name.to_owned(), bytes: Arc::from(bytes) }
}

/// A box of 80 × 60 × 40 mm as an OBJ file.
pub fn box_mesh(name: &str) -> NamedFile {
    let mut text = String::new();
    for corner in 0..8 {
        let side = |bit: u32, half: i32| if corner & bit == 0 { -half } else { half };
        text += &format!("v {} {} {}\n", side(1, 40), side(2, 30), side(4, 20));
    }
    for face in ["1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"] {
        text += &format!("f {face}\n");
    }
    NamedFile { name: name.to_owned(), bytes: Arc::from(text.into_bytes()) }
}

pub fn text_file(name: &str, text: &str) -> NamedFile {
    NamedFile { name: name.to_owned(), bytes: Arc::from(text.as_bytes()) }
}

/// A camera whose numbers are all different, with its centre off the middle.
pub const CAMERA_JSON: &str =
    r#"{"fx": 520.5, "fy": 533.25, "cx": 301.75, "cy": 222.5, "width": 640, "height": 480}"#;

/// One photo, one box, one camera.
pub fn small_session() -> Session {
    let mut session = Session::default();
    let files =
        [flat_photo("photo.png", 640, 480), box_mesh("box.obj"), text_file("camera.json", CAMERA_JSON)];
    drop_files(&mut session, &files, None);
    session
}

/// Numbers from −1 to 1, the same ones every time. (Marsaglia, *Xorshift RNGs*, 2003.)
pub struct Noise(pub u64);

impl Noise {
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub fn vector(&mut self) -> glam::DVec3 {
        glam::DVec3::new(self.next(), self.next(), self.next())
    }

    pub fn whole(&mut self, least: i32, most: i32) -> f64 {
        let part = (self.next() + 1.0) / 2.0;
        f64::from(least) + (part * f64::from(most - least + 1)).floor().min(f64::from(most - least))
    }
}
